//! Fitting the current model to one surface.
//!
//! The structure of the model, the widths of the priors and their centres for α_s and C were chosen on all runs of BorealTC;
//! the numbers themselves are fitted to the runs at hand only.

use std::borrow::Cow;

use model::Robot;
use rayon::prelude::*;

use crate::{
    Drives, Error,
    correlation::Correlation,
    current::{COUNT, CurrentModel, CurrentParameters, YawSource, idle_a},
    field::SCALE_SIGMA,
    fit::{Fit, Parameter, Problem},
    folds, force,
    noise::{LARGEST, Noise},
};

/// Size of an error of a one-second average that stands for a sigma in a first, rough fit \[A\]: twice the spread of 1 A that is
/// left on hard ground, since neighbouring seconds err alike. The fit that counts takes what the rough one leaves.
pub(crate) const ROUGH_NOISE_A: f64 = 2.0;

/// Rows that a fit looks at, evenly spread: what is left on real drives is no chance, which more rows would not average out.
pub(crate) const MOST_ROWS: usize = 20_000;
/// Rows that the rough fits look at, which only choose where to begin.
const ROUGH_ROWS: usize = 5_000;

/// The fit of one surface.
#[derive(Clone, Debug)]
pub struct CurrentFit {
    /// The numbers found.
    pub parameters: CurrentParameters,
    /// With their uncertainty, in the order of [`CurrentParameters::to_array`].
    pub fit: Fit,
    /// Reading at standstill \[A\].
    pub idle_a: f64,
    /// Kinematic track that was assumed \[m\].
    pub slip_track_m: f64,
    /// Where yaw rates came from.
    pub yaw: YawSource,
}

/// What is known of a parameter before.
struct Before {
    name: &'static str,
    unit: &'static str,
    bounds: [f64; 2],
    start: f64,
    prior: Option<[f64; 2]>,
}

/// Names, units, bounds and what is known before a robot's first fit, in the order of [`CurrentParameters`]. Skid and its
/// slip-angle scale are left open.
const FIRST: [Before; COUNT] = {
    const fn line(
        name: &'static str,
        unit: &'static str,
        bounds: [f64; 2],
        start: f64,
        prior: Option<[f64; 2]>,
    ) -> Before {
        Before { name, unit, bounds, start, prior }
    }
    [
        line("rolling_current", "A", [0.0, 15.0], 2.0, Some([2.0, 3.0])),
        line("rolling_split", "A", [-3.0, 3.0], 0.0, Some([0.0, 0.5])),
        line("skid_current", "A", [0.0, 60.0], 7.0, None),
        line("slip_angle_scale", "rad", [0.005, 3.0], 0.08, None),
        line("slip_shape", "1", [0.5, 1.95], 1.3, Some([1.3, 0.3])),
        line("lifting_current", "A", [0.0, 100.0], 25.0, Some([25.0, 10.0])),
        line("inertia", "A s²/m", [-5.0, 30.0], 3.0, Some([3.0, 1.5])),
        line("turning_inertia", "A s²/m", [-5.0, 30.0], 0.5, Some([0.5, 0.5])),
        line("relaxation_length", "m", [0.001, 1.0], 0.1, Some([0.1, 0.05])),
        line("load_height", "m", [-1.0, 2.0], 0.25, Some([0.25, 0.15])),
        line("wheel_mismatch", "1", [-0.1, 0.1], 0.0, Some([0.0, 0.03])),
        line("offset_current", "A", [-2.0, 2.0], 0.0, Some([0.0, 0.25])),
    ]
};

/// Both starting points of the slip-angle scale: with a free shape the valley has two ends \[rad\].
pub(crate) const SCALE_STARTS_RAD: [f64; 2] = [0.08, 0.3];

/// How far the numbers of another surface may lie from those of the reference: what belongs to the robot is nearly fixed,
/// what belongs to the ground is open, but for a slip-angle scale that the robot file has.
fn after(robot: &Robot, drives: &Drives, reference: &CurrentParameters) -> [Option<[f64; 2]>; COUNT] {
    /// C of rubber on most ground.
    const SHAPE: f64 = 1.4;
    let r = reference;
    let ground = drives.stretches.first().map(|stretch| &drives.surfaces[stretch.surface]);
    let in_the_file = ground.and_then(|name| robot.surfaces.get(name)).map(|s| s.slip_angle_scale_rad);
    let scale = in_the_file
        .filter(|scale_rad| *scale_rad > 0.0)
        .map_or([0.08, 0.056], |scale_rad| [SHAPE * scale_rad, SCALE_SIGMA * SHAPE * scale_rad]);
    [
        Some([2.0, 5.0]),
        Some([r.split_a, 0.2]),
        None,
        Some(scale),
        Some([SHAPE, 0.25]),
        Some([r.lifting_a, 0.25 * r.lifting_a]),
        Some([r.inertia_a_per_mps2, 0.15]),
        Some([r.turning_inertia_a_per_mps2, 0.1]),
        Some([r.relaxation_length_m, 0.006]),
        Some([0.25, 0.15]),
        Some([r.wheel_mismatch, 0.009]),
        Some([0.0, 0.25]),
    ]
}

/// Fits the surface that tells most about the robot: wide priors.
///
/// The lifting current's prior is centred on the robot file's force per ampere where it gives one. The others are those of a robot
/// of a Husky's size.
///
/// # Errors
/// [`Error::Stopped`] when the drives' watch breaks.
pub fn fit_reference(robot: &Robot, drives: &Drives) -> Result<CurrentFit, Error> {
    let mut priors = FIRST.each_ref().map(|before| before.prior);
    let lifting_a = prior_lifting_a(robot);
    priors[LIFTING] = Some([lifting_a, force::lifting_share(robot) * lifting_a]);
    let mut open = parameters(&priors, drives);
    open[LIFTING].bounds = force::lifting_bounds_a(lifting_a);
    let fit = |open: &[Parameter]| {
        let starts = SCALE_STARTS_RAD.map(|scale_rad| {
            let mut parameters = open.to_vec();
            parameters[SCALE].start = scale_rad;
            parameters
        });
        solve(robot, drives, robot.slip_track_m, YawSource::Wheels, &starts)
    };
    let found = fit(&open)?;
    if is_told(&found.fit, lifting_a) || !found.fit.determined(LIFTING) {
        return Ok(found);
    }
    // Slopes that ask for what no robot has are none.
    open[LIFTING].held = true;
    fit(&open)
}

/// Whether a lifting current is one of a robot: within its bounds, and known better than from nothing.
fn is_told(fit: &Fit, prior_a: f64) -> bool {
    /// Share of the range within which a value is at its end.
    const AT_LIMIT: f64 = 0.01;
    let (value, [low, high]) = (fit.values[LIFTING], force::lifting_bounds_a(prior_a));
    let margin = AT_LIMIT * (high - low);
    let is_sharp = fit.sigma(LIFTING) < force::OF_NONE * value;
    fit.determined(LIFTING) && (low + margin..high - margin).contains(&value) && is_sharp
}

/// The lifting current before anything was driven: by the file's force per ampere where it gives one \[A\].
pub(crate) fn prior_lifting_a(robot: &Robot) -> f64 {
    match robot.motors.left.force_n_per_a {
        Some(force_n_per_a) => force::per_lifting(robot, force_n_per_a),
        None => FIRST[LIFTING].start,
    }
}

/// Fits another surface of the same robot.
///
/// # Errors
/// As [`fit_reference`].
pub fn fit_surface(
    robot: &Robot,
    drives: &Drives,
    reference: &CurrentFit,
    yaw: YawSource,
) -> Result<CurrentFit, Error> {
    let parameters = parameters(&after(robot, drives, &reference.parameters), drives);
    solve(robot, drives, reference.slip_track_m, yaw, &[parameters])
}

/// Fits with the lifting current left open: what one surface alone says about newtons per ampere.
///
/// # Errors
/// As [`fit_reference`].
pub fn fit_force_alone(robot: &Robot, drives: &Drives, reference: &CurrentFit) -> Result<CurrentFit, Error> {
    let mut priors = after(robot, drives, &reference.parameters);
    priors[LIFTING] = None;
    let parameters = parameters(&priors, drives);
    solve(robot, drives, reference.slip_track_m, reference.yaw, &[parameters])
}

/// Place of the lifting current among the parameters.
pub(crate) const LIFTING: usize = 5;
/// Place of the slip-angle scale.
pub(crate) const SCALE: usize = 3;
/// Places of rolling and skid current, their slip-angle scale, and the lifting current, which are told as the robot file has them.
pub(crate) const IN_THE_FILE: [usize; 4] = [0, 2, SCALE, LIFTING];
/// Place of the offset.
const OFFSET: usize = 11;

fn parameters(priors: &[Option<[f64; 2]>; COUNT], drives: &Drives) -> Vec<Parameter> {
    let parameter = |(before, prior): (&Before, &Option<[f64; 2]>)| Parameter {
        name: before.name.into(),
        unit: before.unit,
        start: prior.map_or(before.start, |[mean, _]| mean),
        bounds: before.bounds,
        prior: *prior,
        held: false,
    };
    let mut all: Vec<Parameter> = FIRST.iter().zip(priors).map(parameter).collect();
    if !turns_both_ways(drives) {
        all[OFFSET] = Parameter { start: 0.0, held: true, ..all[OFFSET].clone() };
    }
    all
}

/// One side turned forwards and backwards for a tenth of the rows each: else an offset is rolling resistance by another name.
fn turns_both_ways(drives: &Drives) -> bool {
    /// Clear of standstill \[m/s\]: four encoder steps of a Husky.
    const TURNING_MPS: f64 = 0.03;
    const LEAST_SHARE: f64 = 0.1;
    let used = || drives.rows.iter().filter(|row| row.used && !row.stuck);
    let least = LEAST_SHARE * used().count() as f64;
    let both = |side: fn(&crate::row::Row) -> f64| {
        let forwards = used().filter(|row| side(row) > TURNING_MPS).count() as f64;
        let backwards = used().filter(|row| side(row) < -TURNING_MPS).count() as f64;
        forwards.min(backwards) > least
    };
    both(|row| row.rim_mps.left) || both(|row| row.rim_mps.right)
}

/// Fits roughly from every start, and from the best of what they find with the noise that it leaves.
fn solve(
    robot: &Robot,
    drives: &Drives,
    slip_track_m: f64,
    yaw: YawSource,
    starts: &[Vec<Parameter>],
) -> Result<CurrentFit, Error> {
    let (part, some) = (thinned(drives, MOST_ROWS)?, thinned(drives, ROUGH_ROWS)?);
    let rough = |parameters: &Vec<Parameter>| {
        let model = CurrentModel::new(robot, &some, slip_track_m, yaw, idle_a(&some));
        let predict = |values: &[f64]| model.averages_a(&numbers(values));
        let (recorded, block, series) =
            (some.recorded_averages(), folds::blocks(&some), folds::series(&some));
        let sigma = vec![ROUGH_NOISE_A; recorded.len()];
        let problem = Problem {
            recorded: &recorded,
            block: &block,
            series: &series,
            sigma: &sigma,
            correlation: Correlation::NONE,
            largest: 1.0,
            predict: &predict,
        };
        problem.solve(parameters)
    };
    let rough = starts.par_iter().map(rough).collect::<Result<Vec<Fit>, Error>>()?;
    let best = rough.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut parameters = starts.first().cloned().unwrap_or_default();
    for (parameter, value) in parameters.iter_mut().zip(best.iter().flat_map(|fit| &fit.values)) {
        parameter.start = *value;
    }
    let idle_a = idle_a(&part);
    let model = CurrentModel::new(robot, &part, slip_track_m, yaw, idle_a);
    let predict = |values: &[f64]| model.averages_a(&numbers(values));
    let (recorded, block, series) = (part.recorded_averages(), folds::blocks(&part), folds::series(&part));
    let start: Vec<f64> = parameters.iter().map(|parameter| parameter.start).collect();
    let about = predict(&start)?;
    let noise = Noise::even(&about, &recorded, &part);
    let problem = Problem {
        recorded: &recorded,
        block: &block,
        series: &series,
        sigma: &noise.sigmas(&about),
        correlation: noise.correlation,
        largest: LARGEST,
        predict: &predict,
    };
    let fit = problem.solve_holding(&parameters, 1)?;
    Ok(CurrentFit { parameters: numbers(&fit.values), fit, idle_a, slip_track_m, yaw })
}

/// About so many rows, or all where those are none that count.
pub(crate) fn thinned(drives: &Drives, most_rows: usize) -> Result<Cow<'_, Drives>, Error> {
    let part = (drives.rows.len() > most_rows).then(|| drives.thinned(most_rows)).transpose()?;
    Ok(part.filter(|part| !part.averages.is_empty()).map_or(Cow::Borrowed(drives), Cow::Owned))
}

fn numbers(values: &[f64]) -> CurrentParameters {
    CurrentParameters::from_array(std::array::from_fn(|i| values.get(i).copied().unwrap_or(0.0)))
}

impl CurrentFit {
    /// One-second averages of the reading on other drives, left behind right \[A\].
    ///
    /// # Errors
    /// [`Error::Stopped`] when the drives' watch breaks.
    pub fn predict_a(&self, robot: &Robot, drives: &Drives) -> Result<Vec<f64>, Error> {
        CurrentModel::new(robot, drives, self.slip_track_m, self.yaw, self.idle_a)
            .averages_a(&self.parameters)
    }

    /// c: force at the rim of a side per ampere, `m g / 2 G` \[N/A\].
    pub fn force_n_per_a(&self, robot: &Robot) -> f64 {
        force::per_lifting(robot, self.parameters.lifting_a)
    }

    /// 95 % interval of the force per ampere \[N/A\]; open above where the lifting current may be zero.
    pub fn force_interval_n_per_a(&self, robot: &Robot) -> [f64; 2] {
        let [low_a, high_a] = self.fit.interval_95(LIFTING);
        [
            force::per_lifting(robot, high_a),
            if low_a > 0.0 { force::per_lifting(robot, low_a) } else { f64::INFINITY },
        ]
    }
}
