//! `pitch_bias`: an inclinometer that is not level with the robot.

use crate::mechanism::{Kind, Mechanism, Moment, Parameter, Scale, SizePrior};

/// An inclinometer that is not level with the robot.
pub(super) struct PitchBias;

impl Mechanism for PitchBias {
    fn name(&self) -> &'static str {
        "pitch_bias"
    }

    fn label(&self) -> &'static str {
        "a pitch sensor mounted askew"
    }

    fn kind(&self) -> Kind {
        Kind::Measurement
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "bias_rad", unit: "rad", bounds: [-0.2, 0.2], probe: 0.005 }]
    }

    /// Two degrees, as of an inclinometer that was bolted on by eye.
    fn size_prior(&self, _: &Scale<'_>) -> Vec<SizePrior> {
        vec![SizePrior::either(2.0_f64.to_radians())]
    }

    /// An inclinometer is read to a sixteenth of a degree.
    fn healthy_share(&self) -> f64 {
        0.03
    }

    fn equation(&self) -> &'static str {
        "recorded pitch = true pitch + b"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!(
            "recorded pitch is {:.2}° too {}",
            values[0].abs().to_degrees(),
            if values[0] > 0.0 { "high" } else { "low" }
        )
    }

    fn measure(&self, values: &[f64], moment: &mut Moment) {
        moment.attitude.pitch_rad -= values[0];
    }
}
