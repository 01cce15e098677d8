//! The fields of a robot file that recordings of power are fitted by, and what is known of them before.

use model::{Robot, fit::LEAST_RISE_K, robot::Surface};
use recording::PowerForm;

use crate::{Drives, fit::Parameter};

/// What is known of ground that the robot file does not name: rolling 0.1 ± 0.1 and skid 0.4 ± 0.3 span hard floor to loose
/// sand (Dogru & Marques 2018, Fig. 13; BorealTC: 0.10 to 0.15 and 0.11 to 0.61); the scale is the file's default.
pub(crate) const NEW_GROUND: [[f64; 2]; 3] = [[0.1, 0.1], [0.4, 0.3], [0.3, 0.15]];
/// Relative sigma of a slip-angle scale that the robot file gives; its `uncertainty` has no such entry.
pub(crate) const SCALE_SIGMA: f64 = 0.5;
/// Sigma of the fraction that comes back: that of a fraction of which nothing is known, √(1/12).
const REGENERATION_SIGMA: f64 = 0.29;
/// Sigma of the power of a motor's driver that the robot file gives as zero \[W\].
const DRIVER_SIGMA_W: f64 = 30.0;
/// Sigma of a hotel load that the robot file gives as zero, which is how it says nothing of it \[W\]: from a microcontroller to computers,
/// lidars and an arm.
const UNSTATED_HOTEL_SIGMA_W: f64 = 300.0;
/// Sigma of α_R \[1/K\]: copper's 0.0039 is certain, but a sensor on the case is warmer or colder than the winding by a quarter.
pub const RESISTANCE_SIGMA_PER_K: f64 = 0.001;
/// Sigma of α_M \[1/K\], which spans the remanence of magnets: AlNiCo −0.0002, NdFeB −0.0012, ferrite −0.0020.
pub const MOTOR_CONSTANT_SIGMA_PER_K: f64 = 0.0006;

/// A field of the robot that is fitted.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Field {
    MuRoll(String),
    MuSkid(String),
    Scale(String),
    LeftK1,
    LeftK2,
    RightK1,
    RightK2,
    Resistance,
    MotorConstant,
    Regeneration,
    Hotel,
    Electronics,
}

/// The robot with the ground that the recording names and it lacks.
pub(crate) fn with_new_ground(robot: &Robot, drives: &Drives) -> Robot {
    let mut robot = robot.clone();
    for name in &drives.surfaces {
        let [[mu_roll, _], [mu_skid, _], [slip_angle_scale_rad, _]] = NEW_GROUND;
        let new =
            Surface { mu_roll, mu_skid, slip_angle_scale_rad, dogru_marques: None, mechanisms: Vec::new() };
        robot.surfaces.entry(name.clone()).or_insert(new);
    }
    robot
}

/// What the robot file says of each field, and how surely; ground that it did not know has its own widths. What such drives cannot
/// tell at all is held.
pub(crate) fn known_before(robot: &Robot, known: &Robot, drives: &Drives) -> (Vec<Field>, Vec<Parameter>) {
    let mut lines = Lines::default();
    let driven = |name: &String| drives.stretches.iter().any(|s| drives.surfaces[s.surface] == *name);
    for name in drives.surfaces.iter().filter(|name| driven(name)) {
        if let Some(surface) = robot.surfaces.get(name) {
            lines.add_surface(name, surface, known);
        }
    }
    lines.add_motors(robot, drives);
    let about = |mean_w: f64, least_w: f64| [mean_w, (0.5 * mean_w).max(least_w)];
    let seen = matches!(drives.form, Some(PowerForm::Battery | PowerForm::CurrentAndVoltage));
    let hotel_w = robot.hotel_power_w;
    let least_w = if hotel_w > 0.0 { DRIVER_SIGMA_W } else { UNSTATED_HOTEL_SIGMA_W };
    let hotel = about(hotel_w, least_w);
    lines.add(Field::Hotel, "hotel_power_w", "W", hotel, [0.0, (hotel_w + 1000.0).min(1e5)]).held |= !seen;
    let electronics_w = robot.drive_electronics_w;
    lines.add(
        Field::Electronics,
        "drive_electronics_w",
        "W",
        about(electronics_w, DRIVER_SIGMA_W),
        [0.0, (electronics_w + 500.0).min(1e4)],
    );
    (lines.fields, lines.parameters)
}

/// Fields with their parameters.
#[derive(Default)]
struct Lines {
    fields: Vec<Field>,
    parameters: Vec<Parameter>,
}

impl Lines {
    /// A field with the mean and sigma of what is known; one that is known exactly is held.
    fn add(
        &mut self,
        field: Field,
        name: &str,
        unit: &'static str,
        [mean, sigma]: [f64; 2],
        bounds: [f64; 2],
    ) -> &mut Parameter {
        self.fields.push(field);
        let exact = sigma <= 0.0;
        let prior = (!exact).then_some([mean, sigma]);
        self.parameters.push(Parameter { name: name.into(), unit, start: mean, bounds, prior, held: exact });
        let last = self.parameters.len() - 1;
        &mut self.parameters[last]
    }

    fn add_surface(&mut self, name: &str, surface: &Surface, known: &Robot) {
        let new = !known.surfaces.contains_key(name);
        let u = &known.uncertainty;
        let of =
            |i: usize, mean: f64, relative: f64| [mean, if new { NEW_GROUND[i][1] } else { relative * mean }];
        let at = |field: &str| format!("surfaces.{name}.{field}");
        let scale_rad = surface.slip_angle_scale_rad.max(0.02);
        let roll = of(0, surface.mu_roll, u.mu_roll);
        self.add(Field::MuRoll(name.into()), &at("mu_roll"), "1", roll, [0.0, 1.0]);
        let skid = of(1, surface.mu_skid, u.mu_skid);
        self.add(Field::MuSkid(name.into()), &at("mu_skid"), "1", skid, [0.0, 2.0]);
        let scale = of(2, scale_rad, SCALE_SIGMA);
        self.add(Field::Scale(name.into()), &at("slip_angle_scale_rad"), "rad", scale, [0.01, 1.5]);
    }

    fn add_motors(&mut self, robot: &Robot, drives: &Drives) {
        let (motors, u) = (&robot.motors, &robot.uncertainty);
        let sides = [
            ("left", motors.left, Field::LeftK1, Field::LeftK2),
            ("right", motors.right, Field::RightK1, Field::RightK2),
        ];
        for (side, motor, first, second) in sides {
            let (k1, k2) = (motor.k1_w_per_n2, motor.k2);
            let name = format!("motors.{side}.k1_w_per_n2");
            self.add(first, &name, "W/N²", [k1, u.k1 * k1], [0.2 * k1, (5.0 * k1 + 1e-9).min(10.0)]);
            self.add(
                second,
                &format!("motors.{side}.k2"),
                "1",
                [k2, u.k2 * k2],
                [1.0, (2.0 * k2).clamp(3.0, 20.0)],
            );
        }
        // At one temperature both coefficients are k1 and k2 by other names.
        let warmed = temperature_span_k(drives) >= LEAST_RISE_K;
        let copper = [motors.resistance_per_k, RESISTANCE_SIGMA_PER_K];
        self.add(Field::Resistance, "motors.resistance_per_k", "1/K", copper, [0.0, 0.01]).held |= !warmed;
        let magnets = [motors.motor_constant_per_k, MOTOR_CONSTANT_SIGMA_PER_K];
        self.add(Field::MotorConstant, "motors.motor_constant_per_k", "1/K", magnets, [-0.005, 0.0]).held |=
            !warmed;
        let regeneration = [motors.regeneration, REGENERATION_SIGMA];
        self.add(Field::Regeneration, "motors.regeneration", "1", regeneration, [0.0, 1.0]);
    }
}

/// How far the warmest and the coldest of either motor's temperatures lie apart \[K\].
fn temperature_span_k(drives: &Drives) -> f64 {
    let of_sides = drives.motor_range_c().map(|[low, high]| high - low);
    of_sides.left.max(of_sides.right)
}

/// The robot with fitted values in their fields.
pub(crate) fn applied(robot: &Robot, fields: &[Field], values: &[f64]) -> Robot {
    let mut robot = robot.clone();
    for (field, &value) in fields.iter().zip(values) {
        let place = match field {
            Field::MuRoll(name) => robot.surfaces.get_mut(name).map(|s| &mut s.mu_roll),
            Field::MuSkid(name) => robot.surfaces.get_mut(name).map(|s| &mut s.mu_skid),
            Field::Scale(name) => robot.surfaces.get_mut(name).map(|s| &mut s.slip_angle_scale_rad),
            Field::LeftK1 => Some(&mut robot.motors.left.k1_w_per_n2),
            Field::LeftK2 => Some(&mut robot.motors.left.k2),
            Field::RightK1 => Some(&mut robot.motors.right.k1_w_per_n2),
            Field::RightK2 => Some(&mut robot.motors.right.k2),
            Field::Resistance => Some(&mut robot.motors.resistance_per_k),
            Field::MotorConstant => Some(&mut robot.motors.motor_constant_per_k),
            Field::Regeneration => Some(&mut robot.motors.regeneration),
            Field::Hotel => Some(&mut robot.hotel_power_w),
            Field::Electronics => Some(&mut robot.drive_electronics_w),
        };
        if let Some(place) = place {
            *place = value;
        }
    }
    robot
}
