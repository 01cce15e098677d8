//! Ground that rolls and skids harder, or easier, alike: other ground with one number.
//!
//! Wet, softer or rougher ground often holds whatever moves on it by the same factor more. Two numbers for that would pay for one that nothing
//! asks for, and a load or a meter that reads too much, which have one, would be told instead.

use model::{
    Robot, Sides,
    mechanism::{self, Adjustment, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
};

use crate::{polish::Polished, second_ground::GROUND, series::Applied};

/// Other ground with one number; in what is found it stands as [`GROUND`] with both.
pub(crate) struct AsHard;

impl Mechanism for AsHard {
    fn name(&self) -> &'static str {
        GROUND
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "change", unit: "1", bounds: [-0.9, 5.0], probe: 0.05 }]
    }

    /// As the rolling resistance of other ground.
    fn size_prior(&self, _: &Scale<'_>) -> Vec<SizePrior> {
        vec![SizePrior::either(0.5)]
    }

    fn equation(&self) -> &'static str {
        "μ_R → μ_R (1 + c), μ_S → μ_S (1 + c)"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!("the ground holds {:+.0} % harder", 100.0 * values[0])
    }

    fn adjust(&self, _: &Robot, values: &[f64], _: &Moment) -> Adjustment {
        let factor = 1.0 + values[0];
        Adjustment { mu_roll: Sides::both(factor), mu_skid: factor, ..Adjustment::default() }
    }
}

/// What was fitted with one number, in the two of the mechanism that it is.
pub(crate) fn in_both(mut fitted: Polished) -> Polished {
    for (one, half_widths) in fitted.applied.iter_mut().zip(&mut fitted.half_widths) {
        if let (Some(ground), [change], [half]) =
            (mechanism::by_name(GROUND), &one.values[..], &half_widths[..])
            && one.mechanism.name() == GROUND
        {
            let (change, half) = (*change, *half);
            *one = Applied { mechanism: ground, values: vec![change; 2], span: one.span };
            *half_widths = vec![half; 2];
        }
    }
    fitted
}

#[cfg(test)]
mod tests {
    use model::{Acceleration, Attitude, Motion, builtin};

    use super::*;

    #[test]
    fn one_number_does_what_two_alike_do() {
        let robot = builtin::husky_a200();
        let moment = Moment {
            motion: Motion::of_body(&robot, 0.5, 0.4),
            acceleration: Acceleration::default(),
            rim_mps2: Sides::both(0.0),
            attitude: Attitude::LEVEL,
            loss_w: Sides::both(0.0),
        };
        let ground = mechanism::by_name(GROUND).unwrap();
        for change in [-0.2, 0.0, 0.3] {
            let alike = AsHard.adjust(&robot, &[change], &moment);
            assert_eq!(alike, ground.adjust(&robot, &[change; 2], &moment));
        }
    }
}
