//! Robot parameters that are free, with their priors.

use model::{Robot, knowledge, robot::Uncertainty};
use nalgebra::{DMatrix, DVector};

/// The free parameters of a robot, whose prior is made of independent standard normal numbers u: z = M u.
#[derive(Clone, Debug)]
pub(crate) struct Parameters {
    /// One by one.
    pub(crate) list: Vec<Parameter>,
    /// M: the Cholesky factor of their correlation.
    mixing: DMatrix<f64>,
}

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
    /// Whether its width is that of any robot.
    Hotel {
        as_usual: bool,
    },
    SlipTrack,
    LeftIdle,
    RightIdle,
}

/// Relative width of the slip-angle scale, which no robot file measures.
const SLIP_SCALE_SIGMA: f64 = 0.5;
/// Relative width of the slip track: a Husky A200's is 0.8 to 1.0 m on hard ground (BorealTC).
const SLIP_TRACK_SIGMA: f64 = 0.1;
/// Width of a standing load of a robot of a Husky's strength, a hundredth of its power, in watts, and at least a tenth of what the file gives.
const STANDING_SIGMA_W: f64 = 1.0;
const STANDING_SHARE: f64 = 0.1;
/// Width of the current that is read at rest \[A\]: the zero of a hall sensor of 50 A is good for a hundredth of its range.
pub(crate) const IDLE_SIGMA_A: f64 = 0.5;
/// Difference of logarithms that writing and reading a number may make.
const UNCHANGED: f64 = 1e-9;
/// z beyond which no fit goes: a guard of the exponential, farther off than any verdict of `consistent` allows.
const FARTHEST: f64 = 8.0;

/// Channels that show certain parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown {
    /// The battery's power, which shows standing loads.
    pub(crate) battery: bool,
    /// The yaw rate, which shows the slip track.
    pub(crate) yaw_rate: bool,
    /// Motor currents, which show what is read at rest.
    pub(crate) currents: bool,
}

impl Parameters {
    /// The free parameters of a robot on some surfaces, as its posterior, its sources and its uncertainty leave them open.
    pub(crate) fn of(robot: &Robot, surfaces: &[String], shown: Shown) -> Self {
        let mut list = Parameter::of(robot, surfaces, shown);
        let mut mixing = DMatrix::identity(list.len(), list.len());
        let Some(posterior) = &robot.posterior else { return Parameters { list, mixing } };
        let place = |name: &String| posterior.parameters.iter().position(|other| other == name);
        // What was changed by hand since is known as its source has it.
        let is_as_fitted = |i: usize, j: usize| (list[i].file.ln() - posterior.mean[j]).abs() < UNCHANGED;
        let known: Vec<(usize, usize)> = (0..list.len())
            .filter(|i| list[*i].file > 0.0)
            .filter_map(|i| Some((i, place(&list[i].name)?)))
            .filter(|(i, j)| is_as_fitted(*i, *j))
            .collect();
        let covariance = posterior.covariance();
        let own = DMatrix::from_fn(known.len(), known.len(), |a, b| covariance[(known[a].1, known[b].1)]);
        let Some(root) = knowledge::root(&own) else { return Parameters { list, mixing } };
        for (a, (i, _)) in known.iter().enumerate() {
            let sigma = own[(a, a)].sqrt();
            list[*i].prior = Prior::Log(sigma);
            known.iter().enumerate().for_each(|(b, (j, _))| mixing[(*i, *j)] = root[(a, b)] / sigma);
        }
        Parameters { list, mixing }
    }

    /// Number of parameters.
    pub(crate) fn len(&self) -> usize {
        self.list.len()
    }

    /// z of some u.
    pub(crate) fn z(&self, u: &DVector<f64>) -> DVector<f64> {
        &self.mixing * u
    }

    /// A robot with the parameters at some u.
    pub(crate) fn placed(&self, robot: &Robot, u: &DVector<f64>) -> Robot {
        let mut robot = robot.clone();
        self.list.iter().zip(self.z(u).iter()).for_each(|(parameter, z)| parameter.set(&mut robot, *z));
        robot
    }

    /// Columns per u, of columns per z.
    pub(crate) fn mixed(&self, per_z: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let column = |j: usize| {
            let mut sum = vec![0.0; per_z.first().map_or(0, Vec::len)];
            for (i, column) in per_z.iter().enumerate().filter(|(i, _)| self.mixing[(*i, j)] != 0.0) {
                sum.iter_mut().zip(column).for_each(|(sum, by)| *sum += self.mixing[(i, j)] * by);
            }
            sum
        };
        (0..self.len()).map(column).collect()
    }

    /// Covariance of z of that of u.
    pub(crate) fn covariance_of_z(&self, of_u: &DMatrix<f64>) -> DMatrix<f64> {
        &self.mixing * of_u * self.mixing.transpose()
    }
}

impl Parameter {
    fn of(robot: &Robot, surfaces: &[String], shown: Shown) -> Vec<Parameter> {
        let u = robot.uncertainty;
        let by_source =
            |name: &str| robot.provenance_of(name).and_then(knowledge::Provenance::relative_sigma);
        let sigma = |name: &str, stated: f64| by_source(name).unwrap_or(stated);
        // Of one constant alone, what a file states of it is more than what its kind of source has on the whole.
        let default = Uncertainty::default();
        let sigma_of_one = |name: &str, stated: f64, default: f64| {
            if stated == default { sigma(name, stated) } else { stated }
        };
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
            add(&at("mu_roll"), Field::MuRoll(name.clone()), Prior::Log(sigma(&at("mu_roll"), u.mu_roll)));
            add(&at("mu_skid"), Field::MuSkid(name.clone()), Prior::Log(sigma(&at("mu_skid"), u.mu_skid)));
            add(&at("slip_angle_scale_rad"), Field::SlipScale(name.clone()), Prior::Log(SLIP_SCALE_SIGMA));
        }
        let constants = [
            ("motors.left.k1_w_per_n2", Field::LeftK1, u.k1),
            ("motors.left.k2", Field::LeftK2, u.k2),
            ("motors.right.k1_w_per_n2", Field::RightK1, u.k1),
            ("motors.right.k2", Field::RightK2, u.k2),
        ];
        for (name, field, stated) in constants {
            add(name, field, Prior::Log(sigma(name, stated)));
        }
        let mass = sigma_of_one("mass_kg", u.mass_kg, default.mass_kg);
        add("mass_kg", Field::Mass, Prior::Log(mass));
        let standing = |w: f64, share: f64| {
            Prior::Linear((share.max(STANDING_SHARE) * w).max(STANDING_SIGMA_W * robot.strength().max(1.0)))
        };
        add("drive_electronics_w", Field::Electronics, standing(robot.drive_electronics_w, 0.0));
        if shown.battery {
            let share = sigma_of_one("hotel_power_w", u.hotel_power_w, default.hotel_power_w);
            let as_usual = share <= STANDING_SHARE;
            add("hotel_power_w", Field::Hotel { as_usual }, standing(robot.hotel_power_w, share));
        }
        if shown.yaw_rate {
            add("slip_track_m", Field::SlipTrack, Prior::Log(SLIP_TRACK_SIGMA));
        }
        if shown.currents {
            for (name, field) in [
                ("motors.left.idle_current_a", Field::LeftIdle),
                ("motors.right.idle_current_a", Field::RightIdle),
            ] {
                add(name, field, Prior::Linear(IDLE_SIGMA_A));
            }
        }
        list
    }

    /// Its value in a robot.
    pub(crate) fn value(&self, robot: &Robot) -> f64 {
        let mut robot = robot.clone();
        self.place(&mut robot).map_or(0.0, |place| *place)
    }

    /// Its value in the file.
    pub(crate) fn file(&self) -> f64 {
        self.file
    }

    /// Its width relative to its value in the file; none of what may be nothing.
    pub(crate) fn relative_sigma(&self) -> Option<f64> {
        let sigma = match self.prior {
            Prior::Log(sigma) => sigma,
            Prior::Linear(sigma) => sigma / self.file,
        };
        (self.file > 0.0).then_some(sigma)
    }

    /// Its width in words: relative to its value in the file, or in its unit where that may be nothing.
    pub(crate) fn width(&self) -> String {
        match (self.prior, &self.field) {
            (Prior::Log(sigma), _) => format!("{:.0} %", 100.0 * sigma),
            (Prior::Linear(sigma), Field::LeftIdle | Field::RightIdle) => format!("{sigma:.1} A"),
            (Prior::Linear(sigma), _) => format!("{sigma:.1} W"),
        }
    }

    /// Whether its width is that of any robot, of which no file tells.
    pub(crate) fn is_as_usual(&self) -> bool {
        use Field::{Electronics, Hotel, LeftIdle, RightIdle, SlipScale, SlipTrack};
        matches!(
            self.field,
            Electronics | Hotel { as_usual: true } | LeftIdle | RightIdle | SlipScale(_) | SlipTrack
        )
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
        let least = match self.field {
            // Gears and belts only lose.
            Field::LeftK2 | Field::RightK2 => 1.0,
            Field::LeftIdle | Field::RightIdle => 0.0,
            _ => f64::NEG_INFINITY,
        };
        if let Some(place) = self.place(robot) {
            *place = value.max(least);
        }
    }

    /// Whether it belongs to the motors or their electronics.
    pub(crate) fn is_of_motors(&self) -> bool {
        use Field::{Electronics, LeftK1, LeftK2, RightK1, RightK2};
        matches!(self.field, LeftK1 | LeftK2 | RightK1 | RightK2 | Electronics)
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
            Field::Hotel { .. } => &mut robot.hotel_power_w,
            Field::SlipTrack => &mut robot.slip_track_m,
            Field::LeftIdle => motors.left.idle_current_a.get_or_insert(0.0),
            Field::RightIdle => motors.right.idle_current_a.get_or_insert(0.0),
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
        let all = Parameters::of(&robot, &surfaces, Shown { battery: true, yaw_rate: true, currents: false });
        assert_eq!(all.len(), 11);
        for parameter in &all.list {
            let mut moved = robot.clone();
            parameter.set(&mut moved, 0.0);
            assert!((parameter.value(&moved) - parameter.value(&robot)).abs() < 1e-12, "{}", parameter.name);
            parameter.set(&mut moved, 1.0);
            assert!(parameter.value(&moved) > parameter.value(&robot), "{}", parameter.name);
            parameter.set(&mut moved, 0.0);
            assert!((parameter.value(&moved) - parameter.value(&robot)).abs() < 1e-12, "{}", parameter.name);
        }
    }

    #[test]
    fn what_a_file_states_of_its_mass_and_standing_load_goes_before_their_source() {
        let mut robot = model::builtin::husky_a200();
        robot.hotel_power_w = 60.0;
        let borrowed = |name: &str| (name.to_owned(), knowledge::Provenance::Borrowed);
        robot.provenance = ["mass_kg", "hotel_power_w"].map(borrowed).into();
        let shown = Shown { battery: true, yaw_rate: false, currents: false };
        let sigmas = |robot: &Robot| {
            let all = Parameters::of(robot, &[], shown);
            let of = |name: &str| all.list.iter().find(|one| one.name == name).map(Parameter::sigma);
            ["mass_kg", "hotel_power_w"].map(|name| of(name).unwrap())
        };
        assert_eq!(sigmas(&robot), [1.0, 60.0], "by their source where nothing is stated");
        (robot.uncertainty.mass_kg, robot.uncertainty.hotel_power_w) = (0.07, 0.3);
        assert_eq!(sigmas(&robot), [0.07, 18.0]);
        robot.uncertainty.hotel_power_w = 0.05;
        assert_eq!(sigmas(&robot)[1], 6.0, "a tenth at least: loads come and go");
    }

    #[test]
    fn a_posterior_goes_before_the_uncertainty_and_keeps_what_hangs_together() {
        let mut robot = model::builtin::husky_a200();
        let names = ["motors.left.k2", "surfaces.marble.mu_roll", "unheard of"].map(str::to_owned).to_vec();
        let covariance = vec![vec![4e-4, -3e-4, 0.0], vec![-3e-4, 9e-4, 0.0], vec![0.0, 0.0, 1.0]];
        let mean = vec![robot.motors.left.k2.ln(), robot.surfaces["marble"].mu_roll.ln(), 0.0];
        robot.posterior = Some(knowledge::Posterior { parameters: names, mean, covariance });
        let all = Parameters::of(
            &robot,
            &["marble".to_owned()],
            Shown { battery: false, yaw_rate: false, currents: false },
        );
        let at = |name: &str| all.list.iter().position(|one| one.name == name).unwrap();
        let (k2, roll) = (at("motors.left.k2"), at("surfaces.marble.mu_roll"));
        let identity = DMatrix::identity(all.len(), all.len());
        let covariance = all.covariance_of_z(&identity);
        let of = |i: usize, j: usize| covariance[(i, j)] * all.list[i].sigma() * all.list[j].sigma();
        assert!((of(k2, k2) - 4e-4).abs() < 1e-8 && (of(roll, roll) - 9e-4).abs() < 1e-8);
        assert!((of(k2, roll) + 3e-4).abs() < 1e-8);
        let sigma_at = |name: &str, factor: f64| {
            let mut changed = robot.clone();
            changed.motors.left.k2 *= factor;
            let all = Parameters::of(
                &changed,
                &["marble".to_owned()],
                Shown { battery: false, yaw_rate: false, currents: false },
            );
            all.list.iter().find(|one| one.name == name).unwrap().sigma()
        };
        assert!((sigma_at("motors.left.k2", 1.0) - 0.02).abs() < 1e-6);
        assert_eq!(
            sigma_at("motors.left.k2", 1.3),
            robot.uncertainty.k2,
            "a number that was changed by hand"
        );
        let moved = all.placed(&robot, &DVector::from_element(all.len(), 0.3));
        assert!(moved != robot && all.placed(&robot, &DVector::zeros(all.len())).motors == robot.motors);
    }

    #[test]
    fn what_is_borrowed_is_known_to_a_factor() {
        let mut robot = model::builtin::husky_a200();
        robot.provenance = [("mass_kg".to_owned(), knowledge::Provenance::Borrowed)].into();
        let all = Parameters::of(&robot, &[], Shown { battery: false, yaw_rate: false, currents: false });
        let mass = all.list.iter().find(|one| one.name == "mass_kg").unwrap();
        assert_eq!(mass.sigma(), 1.0);
    }
}
