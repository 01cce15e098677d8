//! Friction shapes by row of the last robots that were asked about, since most differ in nothing that shapes depend on.

use model::{FrictionShape, Robot};

use crate::kept::Kept;

/// Friction shapes by row of the last robots.
pub(crate) type Shapes = Kept<Key, Vec<FrictionShape>>;

/// Everything that shapes of recorded wheel speeds depend on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Key {
    geometry: [f64; 7],
    /// Slip-angle scales of the surfaces.
    pub(crate) scales_rad: Vec<f64>,
}

impl Key {
    /// That of a robot on surfaces of given slip-angle scales.
    pub(crate) fn of(robot: &Robot, scales_rad: Vec<f64>) -> Self {
        let (forward_m, left_m) = (robot.center_of_mass.forward_m, robot.center_of_mass.left_m);
        let [slip, turning] = [robot.wheel_slip(), robot.turning_slip()];
        let geometry =
            [robot.wheelbase_m, robot.track_m, robot.slip_track_m, forward_m, left_m, slip, turning];
        Key { geometry, scales_rad }
    }
}
