//! What predictions with a robot's file are worth: which constants are borrowed, how wide the power's interval is at a few moments,
//! and which drive would narrow it most.

use crate::{
    Attitude, Error, Motion, PowerModel, Robot, STANDARD_GRAVITY_MPS2, Sides,
    knowledge::Provenance,
    power,
    robot::{NORMAL_95, interval},
};

/// Rise over run of the slope that robots are looked at on [-].
pub const GRADE: f64 = 0.10;

/// A moment that robots are looked at in, on their default ground with motors at 20 °C.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moment {
    /// Straight ahead on level ground at half the top speed.
    Level,
    /// The same up a slope of [`GRADE`].
    Climb,
    /// The same down it.
    Descent,
    /// An arc whose inner wheels stand still, the outer ones at half the top speed.
    Arc,
    /// A turn on the spot, the rims at half the top speed.
    Spin,
}

impl Moment {
    /// All of them.
    pub const ALL: [Moment; 5] = [Moment::Level, Moment::Climb, Moment::Descent, Moment::Arc, Moment::Spin];

    /// A name for documents.
    pub fn name(self) -> &'static str {
        match self {
            Moment::Level => "level",
            Moment::Climb => "climb",
            Moment::Descent => "descent",
            Moment::Arc => "arc",
            Moment::Spin => "spin",
        }
    }

    /// What the robot does, in words.
    pub fn words(self) -> &'static str {
        match self {
            Moment::Level => "straight on level ground",
            Moment::Climb => "straight up a slope of 10 %",
            Moment::Descent => "straight down a slope of 10 %",
            Moment::Arc => "an arc about the inner wheels",
            Moment::Spin => "a turn on the spot",
        }
    }

    fn motion(self, robot: &Robot) -> Motion {
        let rim_mps = robot.max_wheel_speed_mps / 2.0;
        let rims = match self {
            Moment::Level | Moment::Climb | Moment::Descent => Sides::both(rim_mps),
            Moment::Arc => Sides { left: 0.0, right: rim_mps },
            Moment::Spin => Sides { left: -rim_mps, right: rim_mps },
        };
        Motion::of_wheels(robot, rims)
    }

    fn attitude(self) -> Attitude {
        let pitch_rad = match self {
            Moment::Climb => GRADE.atan(),
            Moment::Descent => -GRADE.atan(),
            _ => 0.0,
        };
        Attitude { pitch_rad, roll_rad: 0.0 }
    }

    /// Power drawn from the battery [W].
    ///
    /// # Errors
    /// [`Error::UnknownSurface`] of a robot that was not validated.
    pub fn power_w(self, robot: &Robot) -> Result<f64, Error> {
        let surface = robot.surface(&robot.default_surface)?;
        let motor_c = Sides::both(robot.motors.reference_temperature_c);
        let model = PowerModel::ForceBalance;
        Ok(power(model, robot, surface, self.motion(robot), self.attitude(), motor_c).bus_w)
    }

    /// Power with its 95 % interval, and what each uncertain parameter leaves open of it.
    ///
    /// # Errors
    /// As [`Moment::power_w`].
    pub fn worth(self, robot: &Robot) -> Result<Worth, Error> {
        let power_w = self.power_w(robot)?;
        let (mut ends_w, mut widths_w) = (Vec::new(), Vec::new());
        for parameter in robot.uncertain() {
            let [upper, lower] = parameter.ends(robot);
            let ends = [self.power_w(&upper)?, self.power_w(&lower)?];
            widths_w.push((parameter.name, (ends[0] - ends[1]).abs() / 2.0));
            ends_w.push(ends);
        }
        widths_w.sort_by(|a, b| b.1.total_cmp(&a.1));
        let interval_w = interval(power_w, self.least_w(robot), &ends_w);
        Ok(Worth { moment: self, power_w, interval_w, half_widths_w: widths_w })
    }

    /// The least power that the moment can take: standing loads at the lower end of their interval, and all that a descent holds.
    fn least_w(self, robot: &Robot) -> f64 {
        let u = &robot.uncertainty;
        let standing_w = robot.hotel_power_w * (-NORMAL_95 * u.hotel_power_w).exp();
        let heavy_kg = robot.mass_kg * (NORMAL_95 * u.mass_kg).exp();
        let sinking_mps = -self.motion(robot).speed_mps * self.attitude().pitch_rad.sin();
        standing_w - (heavy_kg * STANDARD_GRAVITY_MPS2 * sinking_mps).max(0.0)
    }
}

/// Power of a moment and how well it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Worth {
    /// The moment.
    pub moment: Moment,
    /// Power drawn from the battery [W].
    pub power_w: f64,
    /// Central 95 % interval of it [W].
    pub interval_w: [f64; 2],
    /// Half the width that each uncertain parameter alone leaves open, the largest first [W].
    pub half_widths_w: Vec<(&'static str, f64)>,
}

impl Worth {
    /// Ends of the interval over the power, less one; none where no power is drawn [-].
    pub fn relative(&self) -> Option<[f64; 2]> {
        (self.power_w > 0.0).then(|| self.interval_w.map(|end_w| end_w / self.power_w - 1.0))
    }

    /// The parameter that leaves most open, if any does.
    pub fn least_known(&self) -> Option<&'static str> {
        self.half_widths_w.first().filter(|(_, width_w)| *width_w > 0.0).map(|(name, _)| *name)
    }
}

/// The drive, or whatever else it takes, that tells a parameter.
pub fn remedy(parameter: &str) -> &'static str {
    match parameter {
        "mu_roll" => "straight stretches at two speeds on level ground of this kind",
        "mu_skid" => "turns on the spot and arcs of several radii on level ground of this kind",
        "k1" => "climbs of several grades, or a lifted weight (`--lift`)",
        "k2" => "straight stretches up and down a slope at two speeds",
        "mass_kg" => "a balance",
        "hotel_power_w" => "a minute of standing with everything switched on",
        "regeneration" => "a descent steep enough to brake on",
        "slip_track_m" => "turns on the spot with the yaw rate recorded",
        _ => "drives of many speeds, turns and slopes",
    }
}

impl Robot {
    /// Constants that the file says are another robot's, in short: `mu_roll`, `k1`, each once.
    pub fn borrowed(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for (field, provenance) in &self.provenance {
            let last = field.rsplit('.').next().unwrap_or(field);
            let name = if last == "k1_w_per_n2" { "k1" } else { last };
            if *provenance == Provenance::Borrowed && !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// The borrowed constant that leaves most open of the power on level ground, straight and in turns.
    pub fn worst_borrowed(&self) -> Option<&str> {
        let borrowed = self.borrowed();
        let width = |name: &str| -> f64 {
            let of = |moment: Moment| {
                let worth = moment.worth(self).ok()?;
                let width = worth.half_widths_w.iter().find(|(other, _)| *other == name)?.1;
                Some(width / worth.power_w.abs().max(f64::MIN_POSITIVE))
            };
            // Most of a path is straight; a tenth of it turns.
            of(Moment::Level).unwrap_or(0.0) + 0.1 * of(Moment::Spin).unwrap_or(0.0)
        };
        borrowed.into_iter().max_by(|a, b| width(a).total_cmp(&width(b)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::husky_a200;

    #[test]
    fn a_measured_robot_borrows_nothing_and_one_that_does_names_each_constant_once() {
        assert!(husky_a200().borrowed().is_empty());
        let mut robot = husky_a200();
        for field in ["motors.left.k1_w_per_n2", "motors.right.k1_w_per_n2", "surfaces.marble.mu_skid"] {
            robot.provenance.insert(field.into(), Provenance::Borrowed);
        }
        robot.provenance.insert("mass_kg".into(), Provenance::DataSheet);
        assert_eq!(robot.borrowed(), ["k1", "mu_skid"]);
    }

    #[test]
    fn rolling_is_least_known_straight_on_and_skid_in_a_spin() {
        let robot = husky_a200();
        assert_eq!(Moment::Level.worth(&robot).unwrap().least_known(), Some("mu_roll"));
        assert_eq!(Moment::Spin.worth(&robot).unwrap().least_known(), Some("mu_skid"));
    }

    #[test]
    fn an_interval_holds_the_power_and_never_less_than_standing_loads_on_level_ground() {
        let mut robot = husky_a200();
        robot.hotel_power_w = 20.0;
        robot.uncertainty.mu_roll = 1.0;
        for moment in Moment::ALL {
            let Worth { power_w, interval_w: [low_w, high_w], .. } = moment.worth(&robot).unwrap();
            assert!(low_w <= power_w && power_w <= high_w, "{moment:?}");
            assert!(moment == Moment::Descent || low_w >= 20.0, "{moment:?}: {low_w}");
        }
    }

    #[test]
    fn without_uncertainty_the_interval_is_the_power() {
        let mut robot = husky_a200();
        let u = &mut robot.uncertainty;
        (u.mu_roll, u.mu_skid, u.k1, u.k2, u.mass_kg) = (0.0, 0.0, 0.0, 0.0, 0.0);
        let worth = Moment::Climb.worth(&robot).unwrap();
        assert_eq!(worth.interval_w, [worth.power_w; 2]);
        assert_eq!(worth.least_known(), None);
    }
}
