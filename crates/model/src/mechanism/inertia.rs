//! `inertia`: gears and armatures that are accelerated with the wheels, beyond the robot's own mass.

use crate::{
    Robot,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
};

/// Inertia of the rotors and gears of a side that a robot may have at the rims, in masses of the robot: a rotor of 10⁻⁵ kg m² behind gears
/// of 80:1 and wheels of 0.16 m is 2.5 kg, and no robot has thirty times as much.
const MOST_MASSES: f64 = 1.5;

/// Gears and armatures that are accelerated with the wheels, beyond the robot's own mass.
pub(super) struct Inertia;

impl Mechanism for Inertia {
    fn name(&self) -> &'static str {
        "inertia"
    }

    fn label(&self) -> &'static str {
        "spinning masses in the drive train"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "kg_per_side", unit: "kg", bounds: [0.0, 400.0], probe: 1.0 }]
    }

    /// Rotors and gears that weigh on a robot like several of it are no robot's.
    fn bounds(&self, robot: &Robot, parameter: usize) -> [f64; 2] {
        let [low, high] = self.parameters()[parameter].bounds_of(robot);
        [low, high.min(MOST_MASSES * robot.mass_kg)]
    }

    /// Three tenths of the robot on each side: rotors behind gears of 80:1 are a tenth of it.
    fn size_prior(&self, scale: &Scale<'_>) -> Vec<SizePrior> {
        vec![SizePrior::positive(0.3 * scale.robot.mass_kg)]
    }

    /// Every drive train has rotors, by a few hundredths of the robot's mass at the rims.
    fn healthy_share(&self) -> f64 {
        0.1
    }

    fn equation(&self) -> &'static str {
        "F_i = m_r du_i/dt"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!("turning parts resist acceleration like {:.1} kg on each side", values[0])
    }

    fn adjust(&self, _: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        Adjustment { force_n: moment.rim_mps2.map(|a| values[0] * a), ..Adjustment::default() }
    }
}
