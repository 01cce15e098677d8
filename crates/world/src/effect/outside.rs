//! Forces from outside: air and trailers.

use super::{Act, Conditions, Surroundings, act::direction};
use crate::RobotFile;

/// Air density at 20 °C [kg/m³].
const AIR_KG_PER_M3: f64 = 1.204;
/// Drag areas of a box of a Husky's size with a mast, head-on and from the side [m²], and the area between its wheels [m²].
const DRAG_AREA_M2: [f64; 2] = [0.45, 0.60];
const OF_FOOTPRINT_M2: f64 = 0.54 * 0.54;
const GRAVITY_MPS2: f64 = 9.806_65;

/// Drag areas of a robot, head-on and from the side [m²]: they grow with the area between its wheels.
pub(crate) fn drag_area_m2(robot: &RobotFile) -> [f64; 2] {
    let size = robot.wheelbase_m * robot.track_m / OF_FOOTPRINT_M2;
    DRAG_AREA_M2.map(|area_m2| size * area_m2)
}

/// Force of the air on the body, forward and left [N].
pub(crate) fn air_force_n(seen: &Surroundings, speed_mps: f64, toward_rad: f64) -> [f64; 2] {
    let angle = toward_rad - seen.heading_rad;
    let relative = [speed_mps * angle.cos() - seen.speed_mps, speed_mps * angle.sin()];
    let speed = relative[0].hypot(relative[1]);
    [0, 1].map(|i| 0.5 * AIR_KG_PER_M3 * seen.drag_area_m2[i] * speed * relative[i])
}

/// Wind that blows to one direction.
#[derive(Debug)]
pub(super) struct Gale {
    pub(super) speed_mps: f64,
    pub(super) toward_rad: f64,
}

impl Act for Gale {
    fn act(&mut self, seen: &Surroundings, out: &mut Conditions) {
        let force_n = air_force_n(seen, self.speed_mps, self.toward_rad);
        out.push_n[0] += force_n[0];
        out.push_n[1] += force_n[1];
    }
}

/// A trailer on a drawbar, which follows the hitch like a tractrix.
#[derive(Debug)]
pub(super) struct Trailer {
    /// Pull on level ground [N].
    pull_n: f64,
    /// Angle of the drawbar against the robot's heading [rad].
    fold_rad: f64,
}

/// Rolling coefficient of the trailer's small wheels, which tells its weight from its pull.
const TRAILER_ROLLING: f64 = 0.12;
/// From hitch to trailer axle [m].
const DRAWBAR_M: f64 = 1.0;
/// A trailer cannot fold further [rad].
const LARGEST_FOLD_RAD: f64 = 1.2;

/// Mass of a trailer by its pull on level ground [kg].
pub(crate) fn trailer_kg(pull_n: f64) -> f64 {
    pull_n / (TRAILER_ROLLING * GRAVITY_MPS2)
}

impl Trailer {
    pub(super) fn new(pull_n: f64) -> Self {
        Trailer { pull_n, fold_rad: 0.0 }
    }
}

impl Act for Trailer {
    fn act(&mut self, seen: &Surroundings, out: &mut Conditions) {
        let rate_radps = -seen.yaw_rate_radps - seen.speed_mps / DRAWBAR_M * self.fold_rad.sin();
        self.fold_rad = (self.fold_rad + seen.step_s * rate_radps).clamp(-LARGEST_FOLD_RAD, LARGEST_FOLD_RAD);
        let mass_kg = trailer_kg(self.pull_n);
        let rolls_mps = seen.speed_mps * self.fold_rad.cos();
        let along_n = self.pull_n * direction(rolls_mps) + mass_kg * GRAVITY_MPS2 * seen.pitch_rad.sin();
        out.push_n[0] -= along_n * self.fold_rad.cos();
        out.towed_kg += mass_kg * self.fold_rad.cos().powi(2);
    }
}
