//! What might be missing: every mechanism, at some of the values that its power does not follow in proportion, from some times on.

use model::{Robot, mechanism};
use rayon::prelude::*;

use crate::{
    Error,
    series::{Applied, Series},
};

/// A mechanism with its sensitivities: the change of every prediction per unit of each of its linear parameters.
pub(crate) struct Candidate {
    /// The mechanism at a probe.
    pub(crate) applied: Applied,
    /// Parameters that the columns belong to.
    pub(crate) linear: Vec<usize>,
    /// Change of predictions per unit [W].
    pub(crate) columns: Vec<Vec<f64>>,
}

/// Times from which a mechanism may act, as shares of the longest suspect drive; the first is its beginning.
const ONSETS: [f64; 10] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
/// Time constants of heat that are tried [s].
const MEMORIES_S: [f64; 6] = [60.0, 180.0, 480.0, 900.0, 1800.0, 3600.0];
/// Range of a value that power does not follow in proportion, where the drives themselves would lead it away: heat that comes
/// and goes within seconds is no heat, but power by another name.
pub(crate) fn range(mechanism: &dyn mechanism::Mechanism, robot: &Robot, parameter: usize) -> [f64; 2] {
    match (mechanism.name(), parameter) {
        ("motor_heating", 1) => [MEMORIES_S[0], MEMORIES_S[MEMORIES_S.len() - 1]],
        _ => mechanism.bounds(robot, parameter),
    }
}

/// Winds that are tried [m/s], in eight directions.
const WINDS_MPS: [f64; 3] = [3.0, 6.0, 10.0];

/// A mechanism with its sensitivities, and the times from which it may act.
pub(crate) struct Family {
    /// From the beginning of the drives on.
    always: Candidate,
    onsets_s: Vec<f64>,
}

impl Family {
    /// Whose it is.
    pub(crate) fn name(&self) -> &'static str {
        self.always.applied.mechanism.name()
    }

    /// Number of its candidates.
    pub(crate) fn count(&self) -> usize {
        self.onsets_s.len()
    }

    /// Its candidates, one by one.
    ///
    /// What shifts in time or remembers has no onset but the beginning; all else does from some time on what it would always do.
    pub(crate) fn candidates<'a>(&'a self, series: &'a Series) -> impl Iterator<Item = Candidate> + 'a {
        self.onsets_s.iter().map(|&from_s| {
            let from = |column: &Vec<f64>| {
                let acts = series.averages.iter().map(|average| average.t_s >= from_s);
                column.iter().zip(acts).map(|(by, acts)| if acts { *by } else { 0.0 }).collect()
            };
            Candidate {
                applied: Applied { from_s, ..self.always.applied.clone() },
                linear: self.always.linear.clone(),
                columns: self.always.columns.iter().map(from).collect(),
            }
        })
    }
}

/// All candidates beside mechanisms that act already, by mechanism and values that power does not follow in proportion.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn all(
    series: &Series,
    robot: &Robot,
    applied: &[Applied],
    predicted_w: &[f64],
) -> Result<Vec<Family>, Error> {
    let probes: Vec<(Applied, Vec<usize>)> = series
        .others(applied)
        .flat_map(|mechanism| {
            grids(mechanism)
                .into_iter()
                .map(move |(values, linear)| (Applied { mechanism, values, from_s: 0.0 }, linear))
        })
        .collect();
    let family = |(probe, linear): (Applied, Vec<usize>)| {
        let onsets_s = onsets(series, probe.mechanism.name());
        Ok(Family { always: of(series, robot, applied, predicted_w, probe, linear)?, onsets_s })
    };
    probes.into_par_iter().map(family).collect()
}

/// The sensitivities of one mechanism about a probe whose linear parameters are at nothing.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn of(
    series: &Series,
    robot: &Robot,
    applied: &[Applied],
    predicted_w: &[f64],
    probe: Applied,
    linear: Vec<usize>,
) -> Result<Candidate, Error> {
    let columns = of_more(series, robot, applied, predicted_w, &probe, &linear)?;
    Ok(Candidate { applied: probe, linear, columns })
}

/// Change of predictions, made with a mechanism as it stands or at nothing, per unit of more of each of its parameters.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn of_more(
    series: &Series,
    robot: &Robot,
    others: &[Applied],
    predicted_w: &[f64],
    standing: &Applied,
    linear: &[usize],
) -> Result<Vec<Vec<f64>>, Error> {
    let mut columns = Vec::new();
    for &parameter in linear {
        let by = standing.mechanism.parameters()[parameter].probe;
        let mut more = standing.clone();
        more.values[parameter] += by;
        let seen = series.predict(robot, &[others, &[more]].concat())?;
        columns.push(seen.iter().zip(predicted_w).map(|(a, b)| (a - b) / by).collect());
    }
    Ok(columns)
}

/// Times from which a mechanism is tried.
///
/// Without healthy drives to compare with, what acts all the time looks like what the model itself misses; only what sets in,
/// grows in time or shifts it can then be told.
fn onsets(series: &Series, name: &str) -> Vec<f64> {
    let longest_s = series.longest_s();
    let from_the_beginning = match name {
        "motor_heating" | "clock_offset" => return vec![0.0],
        // These are how the robot or its sensors are built.
        "wheel_radius"
        | "center_of_mass"
        | "load_transfer"
        | "inertia"
        | "speed_dependent_friction"
        | "grade_dependent_friction"
        | "regeneration"
        | "wheel_slip" => true,
        _ => false,
    };
    let shares = if from_the_beginning { &ONSETS[..1] } else { &ONSETS[..] };
    let tried = shares.iter().map(|share| share * longest_s);
    tried.filter(|from_s| series.has_healthy() || *from_s > 0.0).collect()
}

/// Values of the parameters that power does not follow in proportion, with the others at nothing.
pub(crate) fn grids(mechanism: &'static dyn mechanism::Mechanism) -> Vec<(Vec<f64>, Vec<usize>)> {
    match mechanism.name() {
        "motor_heating" => MEMORIES_S.iter().map(|tau_s| (vec![0.0, *tau_s], vec![0])).collect(),
        "wind" => {
            let mut winds = vec![(vec![0.0; 3], vec![0])];
            for wind_mps in WINDS_MPS {
                for eighth in 0..8 {
                    let (sin, cos) = (f64::from(eighth) * std::f64::consts::FRAC_PI_4).sin_cos();
                    winds.push((vec![0.0, wind_mps * cos, wind_mps * sin], vec![0]));
                }
            }
            winds
        }
        // To the side alone as well: how far forward it lies can only add.
        "center_of_mass" => vec![(vec![0.0; 2], vec![0, 1]), (vec![0.0; 2], vec![1])],
        _ => {
            let count = mechanism.parameters().len();
            vec![(vec![0.0; count], (0..count).collect())]
        }
    }
}
