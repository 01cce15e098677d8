//! Friction shapes of the last robots that were asked about, since most differ in nothing that shapes depend on.

use std::sync::{Arc, Mutex, PoisonError};

use model::{FrictionShape, Robot};

/// Shapes that are kept: those of the robot at hand and of what is tried beside it.
const KEPT: usize = 4;

/// Friction shapes by row of the last robots.
#[derive(Default)]
pub(crate) struct Shapes {
    kept: Mutex<Vec<(Key, Arc<Vec<FrictionShape>>)>>,
}

/// Everything that shapes of recorded wheel speeds depend on.
#[derive(Clone, Debug, PartialEq)]
struct Key {
    geometry: [f64; 7],
    scales_rad: Vec<f64>,
}

impl Shapes {
    /// Those of a robot on surfaces of given slip-angle scales; worked out where they are not kept.
    pub(crate) fn of(
        &self,
        robot: &Robot,
        scales_rad: Vec<f64>,
        work_out: impl FnOnce(&[f64]) -> Vec<FrictionShape>,
    ) -> Arc<Vec<FrictionShape>> {
        let (forward_m, left_m) = (robot.center_of_mass.forward_m, robot.center_of_mass.left_m);
        let [slip, turning] = [robot.wheel_slip(), robot.turning_slip()];
        let geometry =
            [robot.wheelbase_m, robot.track_m, robot.slip_track_m, forward_m, left_m, slip, turning];
        let key = Key { geometry, scales_rad };
        let find = || {
            let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
            let place = kept.iter().position(|(other, _)| *other == key)?;
            kept[..=place].rotate_right(1);
            Some(Arc::clone(&kept[0].1))
        };
        if let Some(known) = find() {
            return known;
        }
        // Not under the lock: a thread that waits for others may take up work that asks for shapes too.
        let shapes = Arc::new(work_out(&key.scales_rad));
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.insert(0, (key, Arc::clone(&shapes)));
        kept.truncate(KEPT);
        shapes
    }
}
