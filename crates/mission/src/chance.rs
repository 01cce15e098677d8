//! What is not known for sure, and draws of it.

use model::{Grade, Manoeuvre, Robot, robot::Battery};
use planner::HiddenRelief;
use rand::{RngExt, SeedableRng};
use rand_distr::{Exp1, StandardNormal};
use rand_pcg::Pcg64Mcg;
use terrain::hidden_relief::MOST_OVERSTATED;

use crate::{Error, journey::Step, pack::Pack};

/// How uncertain a prediction's inputs are, beyond what the robot's file says of itself and its battery.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubt {
    /// One-sigma error of the map's elevation [m]. Default 0.1, the most that lidar surveys of quality level 2 may err on open
    /// ground (USGS Lidar Base Specification).
    pub elevation_sigma_m: f64,
    /// Way over which that error changes [m]. Default 10, some posts of such a map: errors of neighbouring posts are nearly the
    /// same, since what they share (the flight line, the grass) is as large.
    pub elevation_scale_m: f64,
    /// What drives draw more and return less on average than the power model says, though all its parameters are right, over the
    /// sum of both. Default [`MODEL_MEAN`].
    pub model_mean: f64,
    /// One-sigma scatter about that. Default [`MODEL_SIGMA`].
    pub model_sigma: f64,
    /// Whether cells far coarser than the robot hide ups and downs. Default true.
    pub hidden_relief: bool,
}

/// Mean error of a drive's energy that is left when every parameter is known, over what the drives draw and return together:
/// drives start, stop and correct their course, which a path does not. Mean over development seeds of drives through the
/// independent world, whose tyres, motors and driver are others than the model's.
/// `cargo run --release -p joulepath-tests --example range_coverage -- develop` prints it.
pub const MODEL_MEAN: f64 = 0.0102;
/// Scatter of the same about its mean, one sigma.
pub const MODEL_SIGMA: f64 = 0.0082;

impl Default for Doubt {
    fn default() -> Self {
        Doubt {
            elevation_sigma_m: 0.1,
            elevation_scale_m: 10.0,
            model_mean: MODEL_MEAN,
            model_sigma: MODEL_SIGMA,
            hidden_relief: true,
        }
    }
}

impl Doubt {
    /// No doubt beyond the robot's file.
    pub const NONE: Doubt = Doubt {
        elevation_sigma_m: 0.0,
        elevation_scale_m: 10.0,
        model_mean: 0.0,
        model_sigma: 0.0,
        hidden_relief: false,
    };

    /// Checks that the map's error does not change too often along a way of a length.
    ///
    /// # Errors
    /// More than [`MOST_STRETCHES`].
    pub(crate) fn check_length(&self, length_m: f64) -> Result<(), Error> {
        let (scale_m, most) = (self.elevation_scale_m, MOST_STRETCHES);
        if self.elevation_sigma_m == 0.0 || length_m / scale_m <= most as f64 {
            return Ok(());
        }
        Err(Error::ScaleTooFine { scale_m, length_m, most, least_m: length_m / most as f64 })
    }
}

/// Most stretches of one way that the map errs on independently; each draw makes an error for each, in some milliseconds.
const MOST_STRETCHES: usize = 200_000;

/// What draws are made of.
#[derive(Clone, Copy, Debug)]
pub struct Drawn<'a> {
    /// The robot as its file has it.
    pub robot: &'a Robot,
    /// Its battery.
    pub battery: &'a Battery,
    /// Charge when it sets out, as it is told, 1 full.
    pub charge: f64,
    /// How uncertain everything else is.
    pub doubt: &'a Doubt,
    /// Which draws.
    pub seed: u64,
}

/// A robot with its battery and ground as they may be.
#[derive(Clone, Debug)]
pub struct Chance {
    /// The robot.
    pub robot: Robot,
    /// Its battery.
    pub pack: Pack,
    /// Charge when it sets out, 1 full.
    pub charge: f64,
    /// By how much the drives draw more, and return less, than the model says of this robot, over what it says [-].
    pub model_error: f64,
    /// Error of the map's grade by stretches of the way.
    grade_error: Vec<f64>,
    scale_m: f64,
    hidden_ground: Option<HiddenGround>,
}

/// What cells far coarser than the robot hide, as it may be.
#[derive(Clone, Copy, Debug)]
struct HiddenGround {
    /// Slopes that are hidden, over those that the cells around tell [-].
    slope_share: f64,
    /// Which cells add more and which less.
    seed: u64,
}

impl Chance {
    /// Everything as the files say.
    pub fn nominal(robot: &Robot, pack: Pack, charge: f64) -> Self {
        Chance {
            robot: robot.clone(),
            pack,
            charge,
            model_error: 0.0,
            grade_error: Vec::new(),
            scale_m: Doubt::NONE.elevation_scale_m,
            hidden_ground: None,
        }
    }

    /// What the map's grade lacks at a place of the way.
    pub(crate) fn grade_error(&self, along_m: f64) -> f64 {
        self.grade_error.get((along_m / self.scale_m) as usize).copied().unwrap_or(0.0)
    }

    /// Power that the relief hidden by a step's cell adds [W]: a cell adds more or less by as much as it adds on average, so that
    /// what it adds is exponentially distributed, and the same for all steps in it.
    pub(crate) fn hidden_w(&self, step: &Step, manoeuvre: &Manoeuvre, grade: Grade<f64>) -> f64 {
        let Some((hidden, ground)) = step.hidden.zip(self.hidden_ground) else { return 0.0 };
        let mut random = Pcg64Mcg::seed_from_u64(ground.seed ^ (hidden.cell as u64).wrapping_mul(SPREAD));
        let times: f64 = random.sample(Exp1);
        let slope_rms = ground.slope_share * hidden.slope_rms;
        times * HiddenRelief { slope_rms, ..hidden }.added_w(manoeuvre, grade)
    }
}

/// Odd number near 2⁶⁴ over the golden ratio: its multiples lie far apart (D. E. Knuth, The Art of Computer Programming 3, 6.4).
const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;

impl Drawn<'_> {
    /// A draw for a way of a length; the same seed and number give the same, however many are drawn and in what order.
    ///
    /// Parameters have log-normal factors, as they are all positive: one for every surface's μ_R, one for μ_S, and one each for
    /// k1 and k2 of both sides, as [`model::robot::Uncertainty`] has it. They are independent, since robot files say nothing of
    /// how they go together. The charge has a normal error. The map errs by independent normal heights, `elevation_scale_m`
    /// apart along the way and straight between them, so that what is climbed too much comes back. Slopes hidden by cells far coarser
    /// than the robot are what their neighbours tell, or less, by a factor between what these overstate at most and 1.
    pub fn chance(&self, length_m: f64, number: u64) -> Chance {
        let Drawn { robot, battery, charge, doubt, seed } = *self;
        let mut random = Pcg64Mcg::seed_from_u64(seed ^ number.wrapping_mul(SPREAD));
        let mut normal = || random.sample::<f64, _>(StandardNormal);
        let mut factor = |sigma: f64| (sigma * normal()).exp();
        let mut changed = robot.clone();
        let u = &robot.uncertainty;
        let (mu_roll, mu_skid) = (factor(u.mu_roll), factor(u.mu_skid));
        let (k1, k2) = (factor(u.k1), factor(u.k2));
        changed.surfaces.values_mut().for_each(|surface| *surface = surface.scaled(mu_roll, mu_skid));
        for motor in [&mut changed.motors.left, &mut changed.motors.right] {
            motor.k1_w_per_n2 *= k1;
            motor.k2 = (motor.k2 * k2).max(1.0);
        }
        changed.mass_kg *= factor(u.mass_kg);
        if u.hotel_power_w > 0.0 {
            changed.hotel_power_w *= factor(u.hotel_power_w);
        }
        let pack = Pack::new(battery, factor(battery.capacity_sigma));
        let charge = (charge + battery.charge_sigma * normal()).clamp(0.0, 1.0);
        let model_error = doubt.model_mean + doubt.model_sigma * normal();
        let grade_error = match doubt.elevation_sigma_m {
            0.0 => Vec::new(),
            sigma_m => {
                let stretches = (length_m / doubt.elevation_scale_m).ceil() as usize + 1;
                let mut before_m = sigma_m * normal();
                let mut grade = || {
                    let after_m = sigma_m * normal();
                    (after_m - std::mem::replace(&mut before_m, after_m)) / doubt.elevation_scale_m
                };
                (0..stretches).map(|_| grade()).collect()
            }
        };
        let hidden_ground = doubt.hidden_relief.then(|| HiddenGround {
            slope_share: random.random_range(1.0 / MOST_OVERSTATED..=1.0),
            seed: random.random(),
        });
        let scale_m = doubt.elevation_scale_m;
        Chance { robot: changed, pack, charge, model_error, grade_error, scale_m, hidden_ground }
    }
}
