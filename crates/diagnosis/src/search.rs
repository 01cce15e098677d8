//! The search for what is missing: candidates are weighed beside everything else, one is taken up, all is fitted again.

use model::Robot;
use rayon::prelude::*;
use recording::Recording;

use crate::{
    Error,
    baseline::Baseline,
    gates::best,
    null::Null,
    onset::{self, Onset},
    polish::{Polished, polish},
    series::{Applied, Series},
    weigh::{Weighed, left, misfit, system},
};

/// Mechanisms that are looked for at most.
const MOST: usize = 3;
/// Fits that fall short of the best by less are as good: twice the log of a likelihood ratio of 20.
const AS_GOOD: f64 = 6.0;

/// A mechanism that was found.
pub struct Found {
    /// It at its fitted values.
    pub applied: Applied,
    /// Half widths of its values' 95 % intervals; `None` for those taken from a grid.
    pub half_widths: Vec<Option<f64>>,
    /// 95 % interval of the time from which it acts, where it set in during the drives [s].
    pub onset_95_s: Option<[f64; 2]>,
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
    /// By how much evidence is discounted.
    pub(crate) null: Null,
}

/// Looks for mechanisms in the suspect drives; `healthy` are those that the series holds beside them.
///
/// # Errors
/// A surface that the robot does not know.
pub fn search(
    series: &Series,
    file: &Robot,
    healthy: Option<&Recording>,
    progress: &dyn Fn(&str, f64),
) -> Result<Search, Error> {
    progress("comparing healthy drives", 0.0);
    let null = Null::of(file, healthy, series.watch())?;
    progress("fitting the robot", 0.05);
    let before = Baseline::fit(series, file, &[])?;
    let mut after = Baseline::fit(series, file, &[])?;
    let left_before = left(series, &after);
    let mut found: Vec<Found> = Vec::new();
    for round in 0..MOST {
        progress("weighing mechanisms", 0.1 + 0.3 * round as f64);
        let applied: Vec<Applied> = found.iter().map(|f| f.applied.clone()).collect();
        let Some((rivals, held_out_gain)) = best(series, &after, &applied, &null)? else { break };
        progress("fitting what was found", 0.25 + 0.3 * round as f64);
        let (next, fit) = decide(series, file, &applied, (&rivals, held_out_gain), &after, &null)?;
        found.push(next);
        after = fit;
        while let Some((kept, fit)) = drop_one(series, file, &mut found, &after, &null)? {
            (found, after) = (kept, fit);
        }
    }
    let left = [left_before, left(series, &after)];
    Ok(Search { found, before, after, left, null })
}

/// Fits every rival in full and takes the one that explains most; those that explain as much stay beside it.
fn decide(
    series: &Series,
    file: &Robot,
    applied: &[Applied],
    (rivals, held_out_gain): (&[Weighed], f64),
    by: &Baseline,
    null: &Null,
) -> Result<(Found, Baseline), Error> {
    let blocks = system(series, by).blocks();
    let discount = |rival: &Weighed| null.discount(rival.candidate.applied.mechanism.name(), blocks);
    let onsets: Vec<Option<Onset>> = rivals
        .par_iter()
        .map(|rival| onset::refine(series, by, applied, rival, discount(rival)))
        .collect::<Result<_, _>>()?;
    let at_best = |i: usize| onsets[i].as_ref().map_or(&rivals[i], |onset| &onset.weighed);
    let fits: Vec<Polished> = (0..rivals.len())
        .into_par_iter()
        .map(|i| polish(series, file, applied, at_best(i)))
        .collect::<Result<_, _>>()?;
    let common = rivals.iter().map(discount).sum::<f64>() / rivals.len() as f64;
    let cost = |i: usize| {
        misfit(series, &fits[i].base, by) / common
            + rivals[i].candidate.linear.len() as f64 * (blocks as f64).ln()
    };
    let costs: Vec<f64> = (0..fits.len()).map(cost).collect();
    let winner = (0..fits.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
    let indistinguishable_from = (0..fits.len())
        .filter(|i| *i != winner && costs[*i] < costs[winner] + AS_GOOD)
        .map(|i| rivals[i].candidate.applied.mechanism.name().to_owned())
        .collect();
    let (rival, fit) = (at_best(winner), fits.into_iter().nth(winner));
    let onset_95_s = onsets[winner].as_ref().map(|onset| onset.interval_s);
    let Some(Polished { base, applied, half_widths }) = fit else {
        unreachable!("the winner is one of the fits")
    };
    let found = Found {
        applied,
        half_widths,
        onset_95_s,
        p_value: rival.p_value,
        delta_bic: rival.score,
        held_out_gain,
        indistinguishable_from,
    };
    Ok((found, base))
}

/// Leaves out what others found later explain as well; `None` when everything found is needed.
fn drop_one(
    series: &Series,
    file: &Robot,
    found: &mut Vec<Found>,
    all: &Baseline,
    null: &Null,
) -> Result<Option<(Vec<Found>, Baseline)>, Error> {
    if found.len() < 2 {
        return Ok(None);
    }
    let whole = misfit(series, all, all);
    let blocks = system(series, all).blocks();
    for i in 0..found.len() - 1 {
        let others: Vec<Applied> =
            (0..found.len()).filter(|j| *j != i).map(|j| found[j].applied.clone()).collect();
        let without = Baseline::fit(series, file, &others)?;
        let name = found[i].applied.mechanism.name();
        let lost = (misfit(series, &without, all) - whole) / null.discount(name, blocks);
        let count = found[i].half_widths.iter().flatten().count() as f64;
        if lost < count * (blocks as f64).ln() + AS_GOOD {
            let mut kept = std::mem::take(found);
            kept.remove(i);
            return Ok(Some((kept, without)));
        }
    }
    Ok(None)
}
