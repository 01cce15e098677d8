//! What of the robot's own file a diagnosis fits anew, and how far it trusts the file.

use calibration::{MOTOR_CONSTANT_SIGMA_PER_K, RESISTANCE_SIGMA_PER_K};
use model::Robot;

/// A number of the robot.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Knob {
    /// Its name, as `calibrate` has it.
    pub(crate) name: String,
    place: Place,
    /// One-sigma width of what the file says.
    pub(crate) sigma: f64,
    bounds: [f64; 2],
}

#[derive(Clone, Debug, PartialEq)]
enum Place {
    MuRoll(String),
    MuSkid(String),
    SlipScale(String),
    K1([bool; 2]),
    K2([bool; 2]),
    Resistance,
    MotorConstant,
    Electronics,
    Hotel,
    SlipTrack,
}

/// Relative width of the slip-angle scale, which no robot file tells: as wide as that of ground that is new.
const SCALE_SIGMA: f64 = 0.5;
/// Relative width of the slip track: a Husky A200's effective track is 0.8 to 1.0 m on hard ground (BorealTC's drives).
const SLIP_TRACK_SIGMA: f64 = 0.1;
/// Width of standing loads that a robot file gives as nothing \[W\], on a robot of a Husky's size or smaller; drivers grow with the power
/// that drives a robot, which is in proportion to its weight and top speed.
const STANDING_SIGMA_W: f64 = 2.0;

/// What drives show of a robot beyond what moves it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Seen {
    /// Its hotel load, by the battery; its motor drivers show anyway.
    pub(crate) battery: bool,
    /// How far it turned, by a gyroscope.
    pub(crate) turning: bool,
    /// How its motors are when they are warm, by temperatures that differ.
    pub(crate) warmth: bool,
}

impl Knob {
    /// The knobs of a robot as drives show it.
    pub(crate) fn of(robot: &Robot, surfaces: &[String], seen: Seen) -> Vec<Knob> {
        let u = robot.uncertainty;
        let mut knobs = Vec::new();
        let mut add = |name: String, place: Place, sigma: f64, bounds: [f64; 2]| {
            knobs.push(Knob { name, place, sigma, bounds });
        };
        for name in surfaces {
            let Some(s) = robot.surfaces.get(name) else { continue };
            let at = |field: &str| format!("surfaces.{name}.{field}");
            add(at("mu_roll"), Place::MuRoll(name.clone()), u.mu_roll * s.mu_roll, [1e-4, 1.0]);
            add(at("mu_skid"), Place::MuSkid(name.clone()), u.mu_skid * s.mu_skid, [1e-3, 2.0]);
            let scale_rad = s.slip_angle_scale_rad.max(0.02);
            let sigma_rad = SCALE_SIGMA * scale_rad;
            add(at("slip_angle_scale_rad"), Place::SlipScale(name.clone()), sigma_rad, [0.01, 1.5]);
        }
        for (side, motor) in [("left", robot.motors.left), ("right", robot.motors.right)] {
            let which = [side == "left", side == "right"];
            let (k1, k2) = (motor.k1_w_per_n2, motor.k2);
            let sigma = (u.k1 * k1).max(1e-9);
            add(format!("motors.{side}.k1_w_per_n2"), Place::K1(which), sigma, [0.1 * k1, 10.0 * k1 + 1e-9]);
            add(format!("motors.{side}.k2"), Place::K2(which), u.k2 * k2, [1.0, 2.0 * k2 + 1.0]);
        }
        if seen.warmth {
            let [copper, magnets] = [RESISTANCE_SIGMA_PER_K, MOTOR_CONSTANT_SIGMA_PER_K];
            add("motors.resistance_per_k".into(), Place::Resistance, copper, [0.0, 0.01]);
            add("motors.motor_constant_per_k".into(), Place::MotorConstant, magnets, [-0.005, 0.0]);
        }
        let standing = |w: f64| (0.1 * w).max(STANDING_SIGMA_W * robot.strength().max(1.0));
        let electronics_w = robot.drive_electronics_w;
        add("drive_electronics_w".into(), Place::Electronics, standing(electronics_w), [-50.0, 1000.0]);
        if seen.battery {
            add("hotel_power_w".into(), Place::Hotel, standing(robot.hotel_power_w), [-50.0, 5000.0]);
        }
        if seen.turning {
            // As far as a robot's file may have it.
            let bounds_m = [0.5 * robot.track_m, 10.0 * robot.track_m];
            let sigma_m = SLIP_TRACK_SIGMA * robot.slip_track_m;
            add("slip_track_m".into(), Place::SlipTrack, sigma_m, bounds_m);
        }
        knobs
    }

    /// What a robot has there.
    pub(crate) fn value(&self, robot: &Robot) -> f64 {
        let mut robot = robot.clone();
        let mut value = 0.0;
        self.visit(&mut robot, |place| value = *place);
        value
    }

    /// Sets it, within bounds.
    pub(crate) fn set(&self, robot: &mut Robot, value: f64) {
        let [low, high] = self.bounds;
        self.visit(robot, |place| *place = value.clamp(low, high));
    }

    /// Step for differences: a tenth of the width.
    pub(crate) fn step(&self) -> f64 {
        0.1 * self.sigma
    }

    fn visit(&self, robot: &mut Robot, with: impl FnMut(&mut f64)) {
        let motors = &mut robot.motors;
        let surfaces = &mut robot.surfaces;
        let place = match &self.place {
            Place::MuRoll(name) => surfaces.get_mut(name).map(|s| &mut s.mu_roll),
            Place::MuSkid(name) => surfaces.get_mut(name).map(|s| &mut s.mu_skid),
            Place::SlipScale(name) => surfaces.get_mut(name).map(|s| &mut s.slip_angle_scale_rad),
            Place::K1([true, _]) => Some(&mut motors.left.k1_w_per_n2),
            Place::K1(_) => Some(&mut motors.right.k1_w_per_n2),
            Place::K2([true, _]) => Some(&mut motors.left.k2),
            Place::K2(_) => Some(&mut motors.right.k2),
            Place::Resistance => Some(&mut motors.resistance_per_k),
            Place::MotorConstant => Some(&mut motors.motor_constant_per_k),
            Place::Electronics => Some(&mut robot.drive_electronics_w),
            Place::Hotel => Some(&mut robot.hotel_power_w),
            Place::SlipTrack => Some(&mut robot.slip_track_m),
        };
        place.into_iter().for_each(with);
    }
}
