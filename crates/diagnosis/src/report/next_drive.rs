//! The next drive: the one of a catalogue whose power tells the leading explanations apart best.
//!
//! With δ the difference of the powers that two explanations predict of a drive, whitened, and B the columns of what the robot's parameters
//! and the discrepancy may still do to either,
//!
//! ```text
//! expected log odds = ½ δ' (I + B B')⁻¹ δ = ½ (δ'δ − δ'B (I + B'B)⁻¹ B'δ)
//! ```
//!
//! tempered as the posterior is (Rasmussen & Williams, Gaussian Processes for Machine Learning (2006), A.3).

use model::Robot;
use nalgebra::{DMatrix, DVector};

use crate::{
    Applied, Error, Series, Span,
    evidence::linear_model::matrix,
    fit::{baseline::Baseline, member::Member},
    observe::observations::{Observations, YAW_RATE},
    report::planned_drive::{CATALOGUE, PlannedDrive},
    search::{
        engine::Found,
        explanation::{Explanation, credible},
    },
};

/// Explanations beside the first that a drive is planned for: as many as an answer has.
const MOST_OTHERS: usize = 3;
/// Odds by which a drive has to tell explanations apart: those of a credible set of 95 %.
const LEAST_ODDS: f64 = 19.0;
/// Odds beyond which numbers say no more.
const MOST_ODDS: f64 = 1000.0;

/// How one drive tells the first explanation from one other.
struct Gain {
    drive: &'static PlannedDrive,
    log_odds: f64,
    /// Mean power of the first less that of the other \[W\].
    differs_w: f64,
    other: String,
}

/// One sentence: what to drive, and what it would show. None where nothing is to be told apart.
///
/// # Errors
/// A surface that the robot does not know; a watch that breaks.
pub(crate) fn next_drive(
    file: &Robot,
    observed: &Observations<'_>,
    found: &Found,
) -> Result<Option<String>, Error> {
    let is_told = |one: &&Explanation| !one.unlisted && one.fitted.is_some();
    let all: Vec<&Explanation> = credible(&found.explanations).iter().filter(is_told).collect();
    let [first, others @ ..] = &all[..] else { return Ok(None) };
    let others = &others[..others.len().min(MOST_OTHERS)];
    if others.is_empty() {
        return Ok(None);
    }
    let mut best: Option<(f64, Gain)> = None;
    for drive in &CATALOGUE {
        let Some((expected, gain)) = gain(file, observed, found, drive, first, others)? else { continue };
        if best.as_ref().is_none_or(|(known, _)| expected > *known) {
            best = Some((expected, gain));
        }
    }
    Ok(best.map(|(_, gain)| said(&name(first), &gain)))
}

/// The gain over all others, weighted by how likely they are, and the one that is told apart least.
fn gain(
    file: &Robot,
    observed: &Observations<'_>,
    found: &Found,
    drive: &'static PlannedDrive,
    first: &Explanation,
    others: &[&Explanation],
) -> Result<Option<(f64, Gain)>, Error> {
    let by_side = observed.series.channels() == 2;
    let surfaces = observed.series.surfaces();
    let surface = surfaces.first().unwrap_or(&file.default_surface);
    // Only what these drives recorded: of nothing else the noise is known.
    let planned = drive.recording(file, surface, by_side, observed.has_channel(YAW_RATE));
    let series = Series::new(file, &planned, None)?;
    let there = Observations::new(&series, file);
    let baseline = found.baseline.elsewhere(&series, file)?;
    let white = baseline.noise.whitening(&baseline.predicted, &there.places);
    let columns = open(&there, &baseline, found);
    let columns: Vec<DVector<f64>> = columns
        .iter()
        .map(|column| DVector::from_vec(white.apply(column)) / found.temperature.sqrt())
        .collect();
    let columns = matrix(there.rows(), &columns);
    let Some(root) =
        (columns.tr_mul(&columns) + DMatrix::identity(columns.ncols(), columns.ncols())).cholesky()
    else {
        return Ok(None);
    };
    let of_first = powers_w(file, &series, found, first)?;
    let (mut expected, mut least): (f64, Option<Gain>) = (0.0, None);
    for other in others {
        let of_other = powers_w(file, &series, found, other)?;
        let delta: Vec<f64> = of_first.iter().zip(&of_other).map(|(a, b)| a - b).collect();
        let differs_w = series.channels() as f64 * delta.iter().sum::<f64>() / delta.len().max(1) as f64;
        let delta = DVector::from_vec(white.apply(&delta)) / found.temperature.sqrt();
        let with_open = columns.tr_mul(&delta);
        let log_odds = 0.5 * (delta.norm_squared() - with_open.dot(&root.solve(&with_open)));
        expected += other.probability * log_odds.min(MOST_ODDS.ln());
        if least.as_ref().is_none_or(|known| log_odds < known.log_odds) {
            least = Some(Gain { drive, log_odds, differs_w, other: name(other) });
        }
    }
    Ok(least.map(|gain| (expected, gain)))
}

/// What the robot's parameters and the discrepancy may still change.
fn open(there: &Observations<'_>, baseline: &Baseline, found: &Found) -> Vec<Vec<f64>> {
    let count = baseline.sensitivities.len();
    let root = found.parameter_covariance.clone().cholesky().map(|root| root.l());
    let of_parameter = |j: usize| {
        let mut sum = vec![0.0; there.rows()];
        for (i, column) in baseline.sensitivities.iter().enumerate() {
            let weight = root.as_ref().map_or(if i == j { 1.0 } else { 0.0 }, |root| root[(i, j)]);
            sum.iter_mut().zip(column).for_each(|(sum, by)| *sum += weight * by);
        }
        sum
    };
    let mut columns: Vec<Vec<f64>> = (0..count).map(of_parameter).collect();
    columns.extend(baseline.discrepancy(there, found.missed));
    columns
}

/// Powers of a drive as an explanation has them, acting all the time.
fn powers_w(
    file: &Robot,
    series: &Series,
    found: &Found,
    explanation: &Explanation,
) -> Result<Vec<f64>, Error> {
    let Some(fitted) = &explanation.fitted else { return series.predict(&found.baseline.robot, &[]) };
    let robot = found.baseline.parameters.placed(file, &fitted.u);
    let always = |member: &Member| Applied { span: Span::ALL, ..member.applied() };
    series.predict(&robot, &fitted.members.iter().map(always).collect::<Vec<_>>())
}

fn name(explanation: &Explanation) -> String {
    match explanation.names.is_empty() {
        true => "nothing missing".to_owned(),
        false => format!("`{}`", explanation.names.join("` with `")),
    }
}

fn said(first: &str, gain: &Gain) -> String {
    let Gain { drive, log_odds, differs_w, other } = gain;
    let more = if *differs_w >= 0.0 { "more" } else { "less" };
    let by_w = differs_w.abs();
    if *log_odds < LEAST_ODDS.ln() {
        return format!(
            "no simple drive would tell {first} from {other}: at best they differ by {by_w:.1} W on average; look at the robot instead"
        );
    }
    let odds = match log_odds.exp() {
        odds if odds < MOST_ODDS => format!("about {odds:.0} to 1"),
        _ => format!("more than {MOST_ODDS:.0} to 1"),
    };
    format!(
        "let the robot {}, for {:.0} minutes: {first} predicts {by_w:.1} W {more} on average than {other} there, and the recording would \
         favour one of them by {odds}",
        drive.words,
        drive.duration_s / 60.0
    )
}
