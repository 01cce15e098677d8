//! The outline of the robot seen from above.

use model::Robot;

/// The outline, a rectangle about the robot's geometric centre.
///
/// Length is wheelbase plus wheel diameter. Width is track plus one wheel radius: a tyre is taken as wide as its
/// radius, which suits rover tyres (a Husky's 0.125 m against 0.165 m) and errs to the safe side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Along the heading [m].
    pub length_m: f64,
    /// Across it [m].
    pub width_m: f64,
}

impl Footprint {
    /// The outline of a robot.
    pub fn of(robot: &Robot) -> Self {
        Footprint {
            length_m: robot.wheelbase_m + 2.0 * robot.wheel_radius_m,
            width_m: robot.track_m + Self::tyre_width_m(robot),
        }
    }

    /// Width of a tyre [m]: its radius.
    pub(crate) fn tyre_width_m(robot: &Robot) -> f64 {
        robot.wheel_radius_m
    }
}
