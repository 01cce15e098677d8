//! The search for what is missing: candidates are weighed beside everything else, one is taken up, all is fitted again.

use model::{Robot, mechanism};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::{
    Error,
    baseline::{Baseline, differences},
    candidates::{self, Candidate},
    evidence::{Evidence, System},
    nuisance,
    series::{Applied, Series},
};

/// Length of a block [s]: longer than a manoeuvre, so that errors of different blocks hardly hang together.
pub(crate) const BLOCK_S: f64 = 20.0;
/// A candidate is taken up only if chance would make one of all that are tried look as good in one of a hundred drives.
const LEVEL: f64 = 0.01;
/// Blocks that have to speak for a mechanism: one visit is an event, not evidence.
const LEAST_VISITS: usize = 6;
/// Standard errors by which the fit of blocks that were held out has to gain.
const LEAST_GAIN_SIGMAS: f64 = 2.5;
/// Tenths of the drives that are held out in turn.
const FOLDS: usize = 10;
/// Mechanisms that are looked for at most.
const MOST: usize = 3;
/// Candidates that fall short of the best by less are as good: twice the log of a likelihood ratio of 20.
const AS_GOOD: f64 = 6.0;
/// Sensitivities whose angle has at least this cosine cannot be told apart.
const PARALLEL: f64 = 0.95;

/// A mechanism that was found.
pub struct Found {
    /// It at its fitted values.
    pub applied: Applied,
    /// Half widths of its values' 95 % intervals; `None` for those taken from a grid.
    pub half_widths: Vec<Option<f64>>,
    /// Chance of as much, corrected for all that was tried.
    pub p_value: f64,
    /// Drop of the penalised likelihood, as of the Bayesian information criterion over blocks.
    pub delta_bic: f64,
    /// Gain of held-out squared errors, as a share of them.
    pub held_out_gain: f64,
    /// Mechanisms that explain it as well or cannot be told from it.
    pub indistinguishable_from: Vec<String>,
}

/// Where the search ended.
pub struct Search {
    /// What was found, in the order in which it was.
    pub found: Vec<Found>,
    /// The robot with nothing found.
    pub(crate) before: Baseline,
    /// The robot with all that was found.
    pub(crate) after: Baseline,
    /// Whitened errors that nothing took, before and after.
    pub left: [Vec<f64>; 2],
}

/// Looks for mechanisms in the suspect drives.
///
/// # Errors
/// A surface that the robot does not know.
pub fn search(series: &Series, file: &Robot, progress: &dyn Fn(&str, f64)) -> Result<Search, Error> {
    progress("fitting the robot", 0.05);
    let before = Baseline::fit(series, file, &[])?;
    let mut after = Baseline::fit(series, file, &[])?;
    let left_before = rows(series, &system(series, &after));
    let mut found: Vec<Found> = Vec::new();
    for round in 0..MOST {
        progress("weighing mechanisms", 0.1 + 0.25 * round as f64);
        let applied: Vec<Applied> = found.iter().map(|f| f.applied.clone()).collect();
        let Some(next) = best(series, &after, &applied)? else { break };
        progress("fitting what was found", 0.25 + 0.25 * round as f64);
        let (refitted, polished) = polish(series, file, &applied, next)?;
        after = refitted;
        found.push(polished);
    }
    let left = [left_before, rows(series, &system(series, &after))];
    Ok(Search { found, before, after, left })
}

fn rows(series: &Series, system: &System) -> Vec<f64> {
    system.left().iter().take(series.recorded.len()).copied().collect()
}

/// Everything that is fitted whatever the candidate.
pub(crate) fn system(series: &Series, base: &Baseline) -> System {
    let white = |values: &[f64]| base.noise.whiten(values, &base.predicted_w, &series.averages);
    let mut columns: Vec<Vec<f64>> = base.columns.iter().map(|c| white(c)).collect();
    let mut offset: Vec<f64> = base.moved.iter().map(|m| -m).collect();
    let nuisances = nuisance::columns(&series.averages, &base.predicted_w, series.has_healthy());
    offset.extend(vec![0.0; nuisances.len()]);
    columns.extend(nuisances.iter().map(|c| white(c)));
    let known = vec![1.0; columns.len()];
    let errors = white(&differences(&series.recorded, &base.predicted_w));
    System::new(errors, &columns, &known, &offset, blocks(series))
}

/// Blocks of neighbouring averages of a drive; channels of the same time share one.
pub(crate) fn blocks(series: &Series) -> Vec<usize> {
    let mut names: Vec<(usize, usize)> = Vec::new();
    let key = |a: &crate::series::Average| (a.run, (a.t_s / BLOCK_S) as usize);
    names.extend(series.averages.iter().map(key));
    let mut distinct = names.clone();
    distinct.sort_unstable();
    distinct.dedup();
    names.iter().map(|name| distinct.partition_point(|d| d < name)).collect()
}

/// A candidate with what it explains.
struct Weighed {
    candidate: Candidate,
    evidence: Evidence,
    score: f64,
    p_value: f64,
}

/// The best mechanism that passes every gate, with all that are as good.
fn best(series: &Series, base: &Baseline, applied: &[Applied]) -> Result<Option<(Weighed, Found)>, Error> {
    let system = system(series, base);
    let candidates = candidates::all(series, &base.robot, applied, &base.predicted_w)?;
    let tried = candidates.len() as f64;
    let white = |values: &[f64]| base.noise.whiten(values, &base.predicted_w, &series.averages);
    let mut weighed: Vec<Weighed> = candidates
        .into_par_iter()
        .filter_map(|candidate| {
            let columns: Vec<Vec<f64>> = candidate.columns.iter().map(|c| white(c)).collect();
            let evidence = system.weigh(&columns)?;
            if !is_plausible(&candidate, &evidence) {
                return None;
            }
            let count = columns.len() as f64;
            let freedom = (system.blocks() as f64 - count - 1.0).max(2.0);
            let chance = FisherSnedecor::new(count, freedom).ok()?.sf(evidence.wald / count);
            let score = evidence.wald - count * (system.blocks() as f64).ln();
            Some(Weighed { candidate, evidence, score, p_value: (chance * tried).min(1.0) })
        })
        .collect();
    weighed.sort_by(|a, b| b.score.total_cmp(&a.score));
    // Of each mechanism only its best.
    let mut names: Vec<&str> = Vec::new();
    weighed.retain(|w| {
        let name = w.candidate.applied.mechanism.name();
        let is_new = !names.contains(&name);
        names.push(name);
        is_new
    });
    let mut chosen = None;
    for (place, one) in weighed.iter().enumerate() {
        if one.p_value > LEVEL || one.score <= 0.0 {
            continue;
        }
        let columns: Vec<Vec<f64>> = one.candidate.columns.iter().map(|c| white(c)).collect();
        if visits(&system, series, one) < LEAST_VISITS {
            continue;
        }
        let gains = system.held_out(&columns, FOLDS);
        let Some(gain) = significant_gain(&gains, &system, series, one) else { continue };
        chosen = Some((place, gain));
        break;
    }
    let Some((place, held_out_gain)) = chosen else { return Ok(None) };
    let indistinguishable_from = weighed
        .iter()
        .enumerate()
        .filter(|(i, other)| *i != place && alike(&weighed[place], other))
        .map(|(_, other)| other.candidate.applied.mechanism.name().to_owned())
        .collect();
    let one = weighed.swap_remove(place);
    let found = Found {
        applied: one.candidate.applied.clone(),
        half_widths: Vec::new(),
        p_value: one.p_value,
        delta_bic: one.score,
        held_out_gain,
        indistinguishable_from,
    };
    Ok(Some((one, found)))
}

fn is_plausible(candidate: &Candidate, evidence: &Evidence) -> bool {
    let parameters = candidate.applied.mechanism.parameters();
    candidate.linear.iter().zip(&evidence.values).enumerate().all(|(j, (&parameter, value))| {
        let [low, high] = parameters[parameter].bounds;
        let sigma = evidence.covariance[(j, j)].max(0.0).sqrt();
        let value = candidate.applied.values[parameter] + value;
        value + 2.0 * sigma >= low && value - 2.0 * sigma <= high
    })
}

/// Whether another candidate explains as much, and the same.
fn alike(best: &Weighed, other: &Weighed) -> bool {
    let cosine = cosine(&best.evidence, &other.evidence);
    other.score > 0.0
        && (other.score >= best.score - AS_GOOD && cosine > 0.5
            || cosine > PARALLEL && other.score > 0.5 * best.score)
}

/// Cosine between what two candidates explain.
fn cosine(a: &Evidence, b: &Evidence) -> f64 {
    let along = |e: &Evidence| &e.own * nalgebra::DVector::from_column_slice(&e.values);
    let (a, b) = (along(a), along(b));
    a.dot(&b).abs() / (a.norm() * b.norm()).max(1e-300)
}

/// Blocks of the suspect drives in which a candidate acts: where it changes more than a tenth of what it does in a mean block.
fn acting(system: &System, series: &Series, one: &Weighed) -> Vec<bool> {
    let along = &one.evidence.own * nalgebra::DVector::from_column_slice(&one.evidence.values);
    let block = blocks(series);
    let mut size = vec![0.0; system.blocks()];
    for (i, b) in block.iter().enumerate() {
        size[*b] += along[i] * along[i];
    }
    let suspect: Vec<usize> =
        (0..block.len()).filter(|i| series.averages[*i].suspect).map(|i| block[i]).collect();
    let mean = size.iter().sum::<f64>() / size.len().max(1) as f64;
    (0..size.len()).map(|b| size[b] > 0.1 * mean && suspect.contains(&b)).collect()
}

fn visits(system: &System, series: &Series, one: &Weighed) -> usize {
    acting(system, series, one).iter().filter(|acts| **acts).count()
}

/// The gain as a share of the errors, if it is significant over the blocks in which the mechanism acts.
fn significant_gain(gains: &[f64], system: &System, series: &Series, one: &Weighed) -> Option<f64> {
    let acts = acting(system, series, one);
    let gains: Vec<f64> = gains.iter().zip(&acts).filter(|(_, acts)| **acts).map(|(gain, _)| *gain).collect();
    let count = gains.len() as f64;
    let mean = gains.iter().sum::<f64>() / count;
    let spread = (gains.iter().map(|g| (g - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0)).sqrt();
    let left = system.left();
    let block = blocks(series);
    let whole: f64 =
        block.iter().enumerate().filter(|(_, b)| acts[**b]).map(|(i, _)| left[i] * left[i]).sum();
    (mean > 0.0 && mean * count.sqrt() > LEAST_GAIN_SIGMAS * spread).then(|| mean * count / whole.max(1e-300))
}

/// Rounds in which robot and mechanisms are fitted in turn.
const POLISHES: usize = 3;

/// Fits what was found together with the robot and everything found before, at its own nonlinear values.
fn polish(
    series: &Series,
    file: &Robot,
    applied: &[Applied],
    (one, mut found): (Weighed, Found),
) -> Result<(Baseline, Found), Error> {
    let linear = one.candidate.linear.clone();
    let mut acting = applied.to_vec();
    let mut own = one.candidate.applied.clone();
    add(&mut own, &linear, &one.evidence.values);
    acting.push(own);
    let last = acting.len() - 1;
    let mut base = Baseline::fit(series, file, &acting)?;
    let mut covariance = one.evidence.covariance.clone();
    for _ in 0..POLISHES {
        let probe = acting[last].clone();
        let others = acting[..last].to_vec();
        let at = candidates::of(series, &base.robot, &others, &base.predicted_w, probe, linear.clone())?;
        let white = |values: &[f64]| base.noise.whiten(values, &base.predicted_w, &series.averages);
        let columns: Vec<Vec<f64>> = at.columns.iter().map(|c| white(c)).collect();
        let Some(evidence) = system(series, &base).weigh(&columns) else { break };
        add(&mut acting[last], &linear, &evidence.values);
        covariance = evidence.covariance;
        base = Baseline::fit(series, file, &acting)?;
    }
    let applied = acting[last].clone();
    found.half_widths = vec![None; applied.values.len()];
    for (j, parameter) in linear.iter().enumerate() {
        found.half_widths[*parameter] = Some(1.96 * covariance[(j, j)].max(0.0).sqrt());
    }
    found.applied = applied;
    Ok((base, found))
}

/// Moves values, within what a mechanism can have.
fn add(applied: &mut Applied, linear: &[usize], by: &[f64]) {
    let parameters: &[mechanism::Parameter] = applied.mechanism.parameters();
    for (parameter, by) in linear.iter().zip(by) {
        let [low, high] = parameters[*parameter].bounds;
        applied.values[*parameter] = (applied.values[*parameter] + by).clamp(low, high);
    }
}
