//! `payload`: a load that the robot carries and its file does not know of.

use crate::{
    Robot,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
};

/// Share of a robot that may have been taken off: an arm, one of two batteries.
const LEAST_SHARE: f64 = 0.3;

/// A load that the robot carries and its file does not know of.
pub(super) struct Payload;

impl Mechanism for Payload {
    fn name(&self) -> &'static str {
        "payload"
    }

    fn label(&self) -> &'static str {
        "a load on board"
    }

    fn filed(&self, robot: &Robot, values: &[f64], _: &[String]) -> Option<Robot> {
        Some(Robot { mass_kg: robot.mass_kg + values[0], ..robot.clone() })
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "mass_kg", unit: "kg", bounds: [-60.0, 400.0], probe: 1.0 }]
    }

    /// A robot without three tenths of itself does not drive.
    fn bounds(&self, robot: &Robot, parameter: usize) -> [f64; 2] {
        let [low, high] = self.parameters()[parameter].bounds_of(robot);
        [low.max(-LEAST_SHARE * robot.mass_kg), high]
    }

    /// A quarter of the robot: what its maker lets it carry and people take off.
    fn size_prior(&self, scale: &Scale<'_>) -> Vec<SizePrior> {
        vec![SizePrior::either(0.25 * scale.robot.mass_kg)]
    }

    fn equation(&self) -> &'static str {
        "m = m_file + m_load"
    }

    fn statement(&self, values: &[f64]) -> String {
        if values[0] < 0.0 {
            return format!("the robot is {:.1} kg lighter than its file says", -values[0]);
        }
        format!("the robot carries {:.1} kg that its file does not know of", values[0])
    }

    fn adjust(&self, _: &Robot, values: &[f64], _: &Moment) -> Adjustment {
        Adjustment { mass_kg: values[0], ..Adjustment::default() }
    }
}
