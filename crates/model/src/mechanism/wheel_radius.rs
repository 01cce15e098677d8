//! `wheel_radius`: encoders that take the wheels for larger or smaller than they are.

use crate::mechanism::{Kind, Mechanism, Moment, Parameter, Scale, SizePrior};

/// Encoders that take the wheels for larger or smaller than they are.
pub(super) struct WheelRadius;

impl Mechanism for WheelRadius {
    fn name(&self) -> &'static str {
        "wheel_radius"
    }

    fn label(&self) -> &'static str {
        "wheels of another size than the encoders assume"
    }

    fn kind(&self) -> Kind {
        Kind::Measurement
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "scale", unit: "1", bounds: [-0.4, 0.4], probe: 0.01 }]
    }

    /// 6 %, as of tyres that are soft or worn.
    fn size_prior(&self, _: &Scale<'_>) -> Vec<SizePrior> {
        vec![SizePrior::either(0.06)]
    }

    /// Half a per cent, as of tyres by their pressure.
    fn healthy_share(&self) -> f64 {
        0.1
    }

    fn equation(&self) -> &'static str {
        "u = (1 + s) u_recorded"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!(
            "wheels turn {:.1} % {} than recorded",
            100.0 * values[0].abs(),
            if values[0] > 0.0 { "faster" } else { "slower" }
        )
    }

    fn measure(&self, values: &[f64], moment: &mut Moment) {
        let scale = 1.0 + values[0];
        moment.motion.speed_mps *= scale;
        moment.motion.yaw_rate_radps *= scale;
        moment.motion.rim_speeds_mps = moment.motion.rim_speeds_mps.map(|u| scale * u);
        moment.rim_mps2 = moment.rim_mps2.map(|a| scale * a);
        moment.acceleration.forward_mps2 *= scale;
        moment.acceleration.yaw_radps2 *= scale;
        moment.acceleration.left_mps2 *= scale * scale;
    }
}
