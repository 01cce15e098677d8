//! What a candidate has to pass before it is taken up.

use nalgebra::DVector;

use crate::{
    Error,
    baseline::Baseline,
    candidates,
    evidence::{self, Evidence, System},
    foremost::Foremost,
    manner,
    null::Null,
    series::{Applied, Series},
    span::Span,
    visits,
    weigh::{Weighed, blocks, judged, speaking, system, system_in_place, system_with, undelayed},
};

/// A candidate is taken up only if chance would make one of all that are tried look as good in one of a hundred drives.
pub(crate) const LEVEL: f64 = 0.01;
/// Standard errors by which the fit of blocks that were held out has to gain. What is `w` standard errors from nothing gains by half as
/// many: its evidence tells that it is there, and few blocks may hold all of it, as those in which a robot spins hold what ice does.
const LEAST_GAIN_SIGMAS: f64 = 1.0;
/// The same beside what was found already, whose form may miss as much, of changes of power that are no more than what models miss.
const LEAST_GAIN_SIGMAS_BESIDE_OTHERS: f64 = 2.5;
/// Tenths of the drives that are held out in turn.
const FOLDS: usize = 10;
/// Rivals that are looked at closely.
const MOST_RIVALS: usize = 6;
/// Least cosine between what rivals explain.
const KIN: f64 = 0.5;
/// Least share of the chosen one's rank that a rival's has to reach.
const CONTENDER: f64 = 0.6;

/// The best mechanism that passes every gate, followed by others that may explain the same, and the gain on held-out blocks.
pub(crate) fn best(
    series: &Series,
    base: &Baseline,
    applied: &[Applied],
    null: &Null,
) -> Result<Option<(Vec<Weighed>, f64)>, Error> {
    let is_first = applied.is_empty();
    let least_sigmas = if is_first { LEAST_GAIN_SIGMAS } else { LEAST_GAIN_SIGMAS_BESIDE_OTHERS };
    best_that_gains(series, base, applied, null, least_sigmas)
}

/// The same where something is known to be left, because what was found is doubted for it: held-out blocks are asked less of.
pub(crate) fn best_beside_doubted(
    series: &Series,
    base: &Baseline,
    applied: &[Applied],
    null: &Null,
) -> Result<Option<(Vec<Weighed>, f64)>, Error> {
    best_that_gains(series, base, applied, null, LEAST_GAIN_SIGMAS)
}

/// The best that gains by so many standard errors, or is strong.
fn best_that_gains(
    series: &Series,
    base: &Baseline,
    applied: &[Applied],
    null: &Null,
    least_gain_sigmas: f64,
) -> Result<Option<(Vec<Weighed>, f64)>, Error> {
    let Foremost { surest, closest, .. } = Foremost::of(series, base, applied, null)?;
    let (all_fitted, delay_apart) = (system(series, base), undelayed(series, base));
    let white = base.whitening(series);
    let mut passing = None;
    for one in &surest {
        if one.p_value > LEVEL || one.score <= 0.0 {
            continue;
        }
        let is_delay = one.candidate.applied.mechanism.name() == "clock_offset";
        let system = if is_delay { &delay_apart } else { &all_fitted };
        let columns: Vec<Vec<f64>> = one.candidate.columns.iter().map(|c| white.of(c)).collect();
        if one.is_in_place() && !is_of_place(series, base, one, null) {
            continue;
        }
        if !series.has_healthy() && !is_change(series, base, applied, one, null)? {
            continue;
        }
        let least_sigmas = if one.is_strong { LEAST_GAIN_SIGMAS } else { least_gain_sigmas };
        passing = passes(system, series, &one.evidence, (&columns, least_sigmas)).map(|gain| (one, gain));
        if passing.is_some() {
            break;
        }
    }
    let Some((passed, gain)) = passing else { return Ok(None) };
    let Some(closest_of_it) = closest.iter().find(|one| one.is_like(passed)) else { return Ok(None) };
    // What was judged stands.
    let chosen = Weighed { p_value: passed.p_value, score: passed.score, ..closest_of_it.clone() };
    let rows = series.recorded.len();
    let is_rival = |other: &&Weighed| {
        other.name() != chosen.name()
            && other.rank > CONTENDER * chosen.rank
            && cosine(&chosen.evidence, &other.evidence, rows) > KIN
            && (!other.is_in_place() || is_of_place(series, base, other, null))
    };
    let rivals: Vec<Weighed> = closest.iter().filter(is_rival).take(MOST_RIVALS).cloned().collect();
    Ok(Some(([vec![chosen], rivals].concat(), gain)))
}

/// Change of power in a place, as a share of it, below which it may be what models miss of the slopes and turns there.
const LEAST_IN_PLACE: f64 = 0.015;

/// Standard errors by which ground in a place has to roll otherwise: what models miss of turns differs from place to place, and would
/// pass for ground that skids otherwise.
const LEAST_ROLLING_SIGMAS: f64 = 4.0;

/// Change of power that a candidate stands for where it acts, over the power, both root mean square.
fn share_where_it_acts(series: &Series, base: &Baseline, one: &Weighed) -> f64 {
    let counts = |i: &usize| series.is_power(*i) && series.averages[*i].is_in(one.candidate.applied.span);
    let effect_w = one.candidate.effect_w(&one.evidence.values);
    let (mut change, mut whole) = (0.0, 0.0);
    for i in (0..series.averages.len()).filter(counts).filter(|i| series.averages[*i].suspect) {
        change += effect_w[i].powi(2);
        whole += base.predicted_w[i].powi(2);
    }
    f64::sqrt(change / whole.max(1e-300))
}

/// Whether what acts in a place is worth a word there, and seen beside all that goes with how the robot was driven.
fn is_of_place(series: &Series, base: &Baseline, one: &Weighed, null: &Null) -> bool {
    // The first number of what is of the ground is that of rolling straight on.
    let rolling_sigmas = one.evidence.values[0].abs() / one.evidence.covariance[(0, 0)].max(1e-300).sqrt();
    if rolling_sigmas < LEAST_ROLLING_SIGMAS || share_where_it_acts(series, base, one) < LEAST_IN_PLACE {
        return false;
    }
    is_seen_in(&system_in_place(series, base, &manner::columns(series)), series, base, one, null)
}

/// Whether something changed during the drives: of what acts in some part of them, without healthy drives, as much as there is beside the
/// same acting all the time. That may be what the model misses of any robot, and a part of it is no better.
fn is_change(
    series: &Series,
    base: &Baseline,
    applied: &[Applied],
    one: &Weighed,
    null: &Null,
) -> Result<bool, Error> {
    if one.candidate.applied.span.is_all() {
        return Ok(true);
    }
    let always = Applied { span: Span::ALL, ..one.candidate.applied.clone() };
    let linear = one.candidate.linear.clone();
    let all = candidates::of(series, &base.robot, applied, &base.predicted_w, always, linear)?;
    Ok(is_seen_in(&system_with(series, base, &all.columns), series, base, one, null))
}

/// Whether a candidate is seen beside all that is fitted in a system as well.
fn is_seen_in(system: &System, series: &Series, base: &Baseline, one: &Weighed, null: &Null) -> bool {
    let white = base.whitening(series);
    let columns: Vec<Vec<f64>> = one.candidate.columns.iter().map(|c| white.of(c)).collect();
    let Some(evidence) = system.weigh(&columns) else { return false };
    let cost = one.candidate.numbers() as f64 * (system.blocks() as f64).ln();
    let speaking = speaking(&evidence, one.candidate.applied.span, system.blocks());
    judged(&evidence, one.name(), null, (system.blocks(), speaking))
        .is_some_and(|(wald, chance)| chance * f64::from(one.tried) < LEVEL && wald > cost)
}

/// The gain on held-out blocks of what has enough visits and gains by so many standard errors.
pub(crate) fn passes(
    system: &System,
    series: &Series,
    evidence: &Evidence,
    (columns, least_sigmas): (&[Vec<f64>], f64),
) -> Option<f64> {
    let acts = acting(system, series, evidence);
    let is_suspect = suspects(system, series);
    let visits = acts.iter().zip(&is_suspect).filter(|(acts, suspect)| **acts && **suspect).count();
    if (visits as f64) < visits::LEAST {
        return None;
    }
    let gains = system.held_out(columns, FOLDS);
    significant_gain(&gains, system, series, &acts, least_sigmas)
}

/// Cosine between what two candidates explain of the rows.
pub(crate) fn cosine(a: &Evidence, b: &Evidence, rows: usize) -> f64 {
    let along = |e: &Evidence| (&e.own * DVector::from_column_slice(&e.values)).rows(0, rows).into_owned();
    let (a, b) = (along(a), along(b));
    a.dot(&b).abs() / (a.norm() * b.norm()).max(1e-300)
}

/// Blocks in which a candidate acts: where it changes more than a tenth of what it does in a mean block. What acts all the time in
/// suspect drives changes what is expected of healthy ones as well, which speak against it as much.
fn acting(system: &System, series: &Series, one: &Evidence) -> Vec<bool> {
    let size = sizes(system, series, one);
    let mean = size.iter().sum::<f64>() / size.len().max(1) as f64;
    size.iter().map(|size| *size > 0.1 * mean).collect()
}

/// Among how many blocks what a candidate does, of which these are the whitened changes, is spread: as many as there are if it does as
/// much in each, one if one holds nearly all. It is no more spread than what it does is before the fit takes its part, as what little a fit
/// leaves of a single block lies all over.
pub(crate) fn spread(system: &System, series: &Series, one: &Evidence, column: &[f64]) -> f64 {
    let whole = DVector::from_column_slice(column);
    f64::min(one.spread, evidence::spread(&by_block(system, series, &whole)))
}

/// Squares of what a candidate does beyond what the fit takes of it, block by block.
fn sizes(system: &System, series: &Series, one: &Evidence) -> Vec<f64> {
    by_block(system, series, &(&one.own * DVector::from_column_slice(&one.values)))
}

fn by_block(system: &System, series: &Series, along: &DVector<f64>) -> Vec<f64> {
    let mut size = vec![0.0; system.blocks()];
    blocks(series).iter().enumerate().for_each(|(i, b)| size[*b] += along[i] * along[i]);
    size
}

/// Blocks of the suspect drives.
fn suspects(system: &System, series: &Series) -> Vec<bool> {
    let mut suspect = vec![false; system.blocks()];
    blocks(series).iter().zip(&series.averages).for_each(|(b, average)| suspect[*b] |= average.suspect);
    suspect
}

/// The gain as a share of the errors, if it is significant over the blocks in which the mechanism acts.
fn significant_gain(
    gains: &[f64],
    system: &System,
    series: &Series,
    acts: &[bool],
    least_sigmas: f64,
) -> Option<f64> {
    let gains: Vec<f64> = gains.iter().zip(acts).filter(|(_, acts)| **acts).map(|(gain, _)| *gain).collect();
    let count = gains.len() as f64;
    let mean = gains.iter().sum::<f64>() / count;
    let spread = (gains.iter().map(|g| (g - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0)).sqrt();
    let left = system.left();
    let block = blocks(series);
    let whole: f64 =
        block.iter().enumerate().filter(|(_, b)| acts[**b]).map(|(i, _)| left[i] * left[i]).sum();
    (mean > 0.0 && mean * count.sqrt() > least_sigmas * spread).then(|| mean * count / whole.max(1e-300))
}
