//! Mechanisms that a term outside the list explains better than they do.

use model::Robot;

use crate::{
    Error,
    baseline::Baseline,
    misfit::least_misfit,
    null::Null,
    ranked::ranked,
    search::{State, openness},
    series::{Applied, Series},
    term::{self, Term},
    weigh::{system, system_with},
};

/// By how much a term that stands for the same has to explain more, in squared errors over their variance less what choices cost, and as
/// a share of what the mechanism explains where the model can be relied on: of concealed mechanisms, on seeds that none is scored on, the
/// best of thousands of terms, each beyond what healthy drives have of it, was ahead by 8 at most, and of what terms explain better by 19
/// and more. Where healthy drives show the model to miss more, its form of ice may too: on real ice a term is ahead by 0.06.
const BETTER: f64 = 12.0;
const BETTER_SHARE: f64 = 0.015;
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
    let whole = least_misfit(series, &without, &without) - least_misfit(series, &state.fit, &without);
    let choices = found.numbers() as f64 * (system.blocks() as f64).ln();
    let explained = whole / null.common_discount(system.blocks()) - choices;
    let terms = term::of_drives(series, file, std::iter::once(found.applied.span));
    let terms: Vec<&Term> = terms.iter().collect();
    let best = ranked(series, &without, (&system, null), &terms).into_iter().next();
    let least = explained + f64::max(BETTER, BETTER_SHARE * openness(series) * explained);
    let Some((_, term)) = best.filter(|(most, _)| *most > least) else { return Ok(None) };
    let white = without.whitening(series);
    // A term that leaves the mechanism what it explains by itself is something else that the model misses.
    let column = term.column(&without.robot, &series.averages, &without.predicted_w);
    let with_w = series.predict(&without.robot, &state.applied())?;
    let effect: Vec<f64> = with_w.iter().zip(&without.predicted_w).map(|(a, b)| a - b).collect();
    let effect = [vec![white.of(&effect)]];
    let alone = system.explained(&effect)[0];
    let beside = system_with(series, &without, &[column]).explained(&effect)[0];
    Ok((beside < SAME * alone).then(|| format!("{} explains it better", term.words())))
}
