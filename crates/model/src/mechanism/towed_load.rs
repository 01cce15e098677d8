//! `towed_load`: a trailer: it rolls, is lifted and accelerated, but loads no wheel of the robot and does not skid.

use crate::{
    Robot, STANDARD_GRAVITY_MPS2, Sides,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter},
    rolling,
};

/// A trailer: it rolls, is lifted and accelerated, but loads no wheel of the robot and does not skid.
pub(super) struct TowedLoad;

/// Mass that is told as nothing, half of the last digit \[kg\].
const UNSEEN_KG: f64 = 0.05;

impl Mechanism for TowedLoad {
    fn name(&self) -> &'static str {
        "towed_load"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[
            Parameter { name: "rolling_n", unit: "N", bounds: [0.0, 500.0], probe: 1.0 },
            Parameter { name: "mass_kg", unit: "kg", bounds: [0.0, 500.0], probe: 1.0 },
        ]
    }

    fn equation(&self) -> &'static str {
        "F = F_roll sgn(v) + m_t (g sin γ sin β + dv/dt), half on each side"
    }

    fn statement(&self, values: &[f64]) -> String {
        let [rolling_n, mass_kg] = [values[0], values[1]];
        // On level ground at one speed its mass shows nowhere.
        if mass_kg < UNSEEN_KG {
            return format!(
                "the robot tows something that takes {rolling_n:.1} N to roll and shows no weight"
            );
        }
        format!("the robot tows a load of {mass_kg:.1} kg that takes {rolling_n:.1} N to roll")
    }

    fn adjust(&self, _: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        let rolling_n = values[0] * rolling::direction(moment.motion.speed_mps);
        let force_n = rolling_n + values[1] * moment.acceleration.forward_mps2;
        let lifting_n = Sides::both(values[1] * STANDARD_GRAVITY_MPS2 / 2.0);
        Adjustment { force_n: Sides::both(force_n / 2.0), lifting_n, ..Adjustment::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_weighs_nothing_is_no_load_of_no_kilograms() {
        assert_eq!(
            TowedLoad.statement(&[6.94, 12.0]),
            "the robot tows a load of 12.0 kg that takes 6.9 N to roll"
        );
        let light = TowedLoad.statement(&[6.94, 0.0]);
        assert!(light.contains("6.9 N") && !light.contains("kg"), "{light}");
    }
}
