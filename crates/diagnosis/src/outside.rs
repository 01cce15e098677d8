//! Mechanisms that a term outside the list explains better than they do.

use model::Robot;
use rayon::prelude::*;

use crate::{
    Error,
    baseline::Baseline,
    evidence::TOGETHER,
    misfit::least_misfit,
    null::Null,
    search::State,
    series::{Applied, Series},
    term::{self, Term},
    weigh::{system, system_with},
};

/// By how much a term has to explain more, in squared errors over their variance: of thousands of terms, the best explains some 20
/// more than a true mechanism that stands for what a model cannot quite describe.
const BETTER: f64 = 40.0;
/// The same as a share of what the mechanism explains.
const BETTER_SHARE: f64 = 0.25;
/// Share of what the mechanism explains by itself that it may explain beside the term, if that stands for the same.
const SAME: f64 = 0.5;

/// The term that explains far more than one of several mechanisms, beside the others, and leaves it little.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn doubt(
    series: &Series,
    file: &Robot,
    state: &State,
    which: usize,
    null: &Null,
) -> Result<Option<String>, Error> {
    let found = &state.found[which];
    if found.applied.mechanism.name() == "clock_offset" {
        // Delays up to half a row are fitted anyway, so that what it explains does not show.
        return Ok(None);
    }
    let mut others: Vec<Applied> = state.applied();
    others.remove(which);
    let without = Baseline::fit(series, file, &others)?;
    let system = system(series, &without);
    let (common, choice) = (null.common_discount(system.blocks()), (system.blocks() as f64).ln());
    let whole = least_misfit(series, &without, &without) - least_misfit(series, &state.fit, &without);
    let explained = whole / common - found.numbers() as f64 * choice;
    let white = without.whitening(series);
    let terms = term::all(series.channels(), &term::onsets(series, std::iter::once(found.applied.span)));
    let weighed = terms.par_chunks(TOGETHER).flat_map_iter(|terms| {
        let column = |term: &Term| term.column(&without.robot, &series.averages, &without.predicted_w);
        let columns: Vec<Vec<Vec<f64>>> = terms.iter().map(|term| vec![white.of(&column(term))]).collect();
        let cost = |term: &Term| term.choices() as f64 * choice;
        let explained = system.explained(&columns).into_iter().zip(terms);
        explained.map(move |(explained, term)| (explained / common - cost(term), term)).collect::<Vec<_>>()
    });
    let best = weighed.reduce_with(|a, b| if b.0 > a.0 { b } else { a });
    let least = explained + f64::max(BETTER, BETTER_SHARE * explained);
    let Some((_, term)) = best.filter(|(most, _)| *most > least) else { return Ok(None) };
    // A term that leaves the mechanism what it explains by itself is something else that the model misses.
    let column = term.column(&without.robot, &series.averages, &without.predicted_w);
    let with_w = series.predict(&without.robot, &state.applied())?;
    let effect: Vec<f64> = with_w.iter().zip(&without.predicted_w).map(|(a, b)| a - b).collect();
    let effect = [vec![white.of(&effect)]];
    let alone = system.explained(&effect)[0];
    let beside = system_with(series, &without, &[column]).explained(&effect)[0];
    Ok((beside < SAME * alone).then(|| format!("{} explains it better", term.words())))
}
