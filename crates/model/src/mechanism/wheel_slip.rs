//! `wheel_slip`: wheels that turn and do not carry the robot as far.

use crate::mechanism::{Kind, Mechanism, Moment, Parameter};

/// Wheels that turn and do not carry the robot as far.
pub(super) struct WheelSlip;

impl Mechanism for WheelSlip {
    fn name(&self) -> &'static str {
        "wheel_slip"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "slip", unit: "1", bounds: [-0.5, 0.9], probe: 0.02 }]
    }

    fn equation(&self) -> &'static str {
        "v = (1 − s) (u_l + u_r)/2, ω = (1 − s) (u_r − u_l)/b_s"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!("the robot moves {:.1} % less than its wheels turn", 100.0 * values[0])
    }

    fn measure(&self, values: &[f64], moment: &mut Moment) {
        let moved = 1.0 - values[0];
        moment.motion.speed_mps *= moved;
        moment.motion.yaw_rate_radps *= moved;
        moment.acceleration.left_mps2 *= moved * moved;
    }
}
