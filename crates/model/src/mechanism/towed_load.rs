//! `towed_load`: a trailer: it rolls, is lifted and accelerated, but loads no wheel of the robot and does not skid.

use crate::{
    Robot, STANDARD_GRAVITY_MPS2, Sides,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter},
    rolling,
};

/// A trailer: it rolls, is lifted and accelerated, but loads no wheel of the robot and does not skid.
pub(super) struct TowedLoad;

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
        format!("the robot tows a load of {:.1} kg that takes {:.1} N to roll", values[1], values[0])
    }

    fn adjust(&self, _: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        let rolling_n = values[0] * rolling::direction(moment.motion.speed_mps);
        let force_n = rolling_n + values[1] * moment.acceleration.forward_mps2;
        let lifting_n = Sides::both(values[1] * STANDARD_GRAVITY_MPS2 / 2.0);
        Adjustment { force_n: Sides::both(force_n / 2.0), lifting_n, ..Adjustment::default() }
    }
}
