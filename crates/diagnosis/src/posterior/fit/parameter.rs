//! Robot parameters that are free, with their priors.

use model::Robot;

/// A free parameter of the robot: z standard deviations of the prior from the file's value.
#[derive(Clone, Debug)]
pub(crate) struct Parameter {
    /// Its field in the robot file.
    pub(crate) name: String,
    field: Field,
    file: f64,
    prior: Prior,
}

#[derive(Clone, Copy, Debug)]
enum Prior {
    /// p = p_file exp(σ z): positive numbers with relative widths.
    Log(f64),
    /// p = p_file + σ z.
    Linear(f64),
}

#[derive(Clone, Debug)]
enum Field {
    MuRoll(String),
    MuSkid(String),
    SlipScale(String),
    LeftK1,
    LeftK2,
    RightK1,
    RightK2,
    Mass,
    Electronics,
    Hotel,
    SlipTrack,
}

/// Relative width of the slip-angle scale, which no robot file measures.
const SLIP_SCALE_SIGMA: f64 = 0.5;
/// Relative width of the slip track: a Husky A200's is 0.8 to 1.0 m on hard ground (BorealTC).
const SLIP_TRACK_SIGMA: f64 = 0.1;
/// Width of a standing load of a robot of a Husky's strength, a hundredth of its power, in watts, and at least a tenth of what the file gives.
const STANDING_SIGMA_W: f64 = 1.0;
const STANDING_SHARE: f64 = 0.1;
/// z beyond which no fit goes.
const FARTHEST: f64 = 8.0;

/// Channels that show certain parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown {
    /// The battery's power, which shows standing loads.
    pub(crate) battery: bool,
    /// The yaw rate, which shows the slip track.
    pub(crate) yaw_rate: bool,
}

impl Parameter {
    /// The free parameters of a robot on some surfaces.
    pub(crate) fn of(robot: &Robot, surfaces: &[String], shown: Shown) -> Vec<Parameter> {
        let u = robot.uncertainty;
        let mut list = Vec::new();
        let mut add = |name: &str, field: Field, prior: Prior| {
            let mut parameter = Parameter { name: name.to_owned(), field, file: 0.0, prior };
            parameter.file = parameter.value(robot);
            let is_usable = match prior {
                Prior::Log(sigma) => sigma > 0.0 && parameter.file > 0.0,
                Prior::Linear(sigma) => sigma > 0.0,
            };
            if is_usable {
                list.push(parameter);
            }
        };
        for name in surfaces.iter().filter(|name| robot.surfaces.contains_key(*name)) {
            let at = |field: &str| format!("surfaces.{name}.{field}");
            add(&at("mu_roll"), Field::MuRoll(name.clone()), Prior::Log(u.mu_roll));
            add(&at("mu_skid"), Field::MuSkid(name.clone()), Prior::Log(u.mu_skid));
            add(&at("slip_angle_scale_rad"), Field::SlipScale(name.clone()), Prior::Log(SLIP_SCALE_SIGMA));
        }
        add("motors.left.k1_w_per_n2", Field::LeftK1, Prior::Log(u.k1));
        add("motors.left.k2", Field::LeftK2, Prior::Log(u.k2));
        add("motors.right.k1_w_per_n2", Field::RightK1, Prior::Log(u.k1));
        add("motors.right.k2", Field::RightK2, Prior::Log(u.k2));
        add("mass_kg", Field::Mass, Prior::Log(u.mass_kg));
        let standing =
            |w: f64| Prior::Linear((STANDING_SHARE * w).max(STANDING_SIGMA_W * robot.strength().max(1.0)));
        add("drive_electronics_w", Field::Electronics, standing(robot.drive_electronics_w));
        if shown.battery {
            add("hotel_power_w", Field::Hotel, standing(robot.hotel_power_w));
        }
        if shown.yaw_rate {
            add("slip_track_m", Field::SlipTrack, Prior::Log(SLIP_TRACK_SIGMA));
        }
        list
    }

    /// Its value in a robot.
    pub(crate) fn value(&self, robot: &Robot) -> f64 {
        let mut robot = robot.clone();
        self.place(&mut robot).map_or(0.0, |place| *place)
    }

    /// Its width on the scale of z times one: relative for positive numbers, else in its unit.
    pub(crate) fn sigma(&self) -> f64 {
        match self.prior {
            Prior::Log(sigma) | Prior::Linear(sigma) => sigma,
        }
    }

    /// Puts it z standard deviations of its prior from the file's value.
    pub(crate) fn set(&self, robot: &mut Robot, z: f64) {
        let z = z.clamp(-FARTHEST, FARTHEST);
        let value = match self.prior {
            Prior::Log(sigma) => self.file * (sigma * z).exp(),
            Prior::Linear(sigma) => self.file + sigma * z,
        };
        // Gears and belts only lose.
        let least =
            if matches!(self.field, Field::LeftK2 | Field::RightK2) { 1.0 } else { f64::NEG_INFINITY };
        if let Some(place) = self.place(robot) {
            *place = value.max(least);
        }
    }

    /// Whether it is the rolling resistance of a surface.
    pub(crate) fn is_rolling(&self) -> bool {
        matches!(self.field, Field::MuRoll(_))
    }

    /// Whether it is the skid resistance of a surface.
    pub(crate) fn is_skid(&self) -> bool {
        matches!(self.field, Field::MuSkid(_))
    }

    fn place<'r>(&self, robot: &'r mut Robot) -> Option<&'r mut f64> {
        let motors = &mut robot.motors;
        Some(match &self.field {
            Field::MuRoll(name) => &mut robot.surfaces.get_mut(name)?.mu_roll,
            Field::MuSkid(name) => &mut robot.surfaces.get_mut(name)?.mu_skid,
            Field::SlipScale(name) => &mut robot.surfaces.get_mut(name)?.slip_angle_scale_rad,
            Field::LeftK1 => &mut motors.left.k1_w_per_n2,
            Field::LeftK2 => &mut motors.left.k2,
            Field::RightK1 => &mut motors.right.k1_w_per_n2,
            Field::RightK2 => &mut motors.right.k2,
            Field::Mass => &mut robot.mass_kg,
            Field::Electronics => &mut robot.drive_electronics_w,
            Field::Hotel => &mut robot.hotel_power_w,
            Field::SlipTrack => &mut robot.slip_track_m,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_is_the_file_at_zero_and_moves_by_its_width() {
        let robot = model::builtin::husky_a200();
        let surfaces = ["marble".to_owned(), "unheard of".to_owned()];
        let all = Parameter::of(&robot, &surfaces, Shown { battery: true, yaw_rate: true });
        assert_eq!(all.len(), 11);
        for parameter in &all {
            let mut moved = robot.clone();
            parameter.set(&mut moved, 0.0);
            assert!((parameter.value(&moved) - parameter.value(&robot)).abs() < 1e-12, "{}", parameter.name);
            parameter.set(&mut moved, 1.0);
            assert!(parameter.value(&moved) > parameter.value(&robot), "{}", parameter.name);
            parameter.set(&mut moved, 0.0);
            assert!((parameter.value(&moved) - parameter.value(&robot)).abs() < 1e-12, "{}", parameter.name);
        }
    }
}
