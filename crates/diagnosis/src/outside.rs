//! Mechanisms that a term outside the list explains better than they do.

use model::Robot;

use crate::{
    Error,
    baseline::{Baseline, differences},
    evidence::System,
    misfit::least_misfit,
    null::Null,
    ranked::ranked,
    search::{State, openness},
    series::{Applied, Series},
    term::{self, Term},
    weigh::{self, system_with},
};

/// By how much a term that stands for the same has to explain more, in squared errors over their variance less what choices cost, and as
/// a share of what the mechanism explains where the model can be relied on: of concealed mechanisms, on seeds that none is scored on, the
/// best of thousands of terms, each beyond what healthy drives have of it, was ahead by 8 at most, and of what terms explain better by 19
/// and more. Where healthy drives show the model to miss more, its form of ice may too: on real ice a term is ahead by 0.06.
const BETTER: f64 = 12.0;
const BETTER_SHARE: f64 = 0.01;
/// Share of what a mechanism explains from which a term that is missing beside all that was found is the greater thing. Beside concealed
/// mechanisms that were found it was 0.46 at most, beside names for what no mechanism describes 1.4 and more, or less than 0.15. Where
/// healthy drives show the model to miss more, as on real loam, that much more has to be missing.
const GREATER: f64 = 1.0;
/// Share of what the mechanism explains by itself that it may explain beside the term, if that stands for the same.
const SAME: f64 = 0.5;

/// The term that explains far more than one of several mechanisms, beside the others, and leaves it little, or more than it does beside it.
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
    let system = weigh::system(series, &without);
    let whole = least_misfit(series, &without, &without) - least_misfit(series, &state.fit, &without);
    let choices = found.numbers() as f64 * (system.blocks() as f64).ln();
    let explained = whole / null.common_discount(system.blocks()) - choices;
    let terms = term::of_drives(series, file, std::iter::once(found.applied.span));
    let terms: Vec<&Term> = terms.iter().collect();
    let best = ranked(series, &without, (&system, null), &terms).into_iter().next();
    // A greater thing shows in what goes with one quantity; all terms would take as long again.
    let plain: Vec<&Term> = terms.iter().copied().filter(|term| term.is_plain()).collect();
    let beside = ranked(series, &state.fit, (&weigh::system(series, &state.fit), null), &plain);
    if let Some((missing, term)) = beside.into_iter().next()
        && missing > f64::max(BETTER, GREATER * openness(series).max(1.0) * explained)
    {
        return Ok(Some(format!("{} is missing beside it and explains more", term.words())));
    }
    let least = explained + f64::max(BETTER, BETTER_SHARE * openness(series) * explained);
    let Some((_, term)) = best.filter(|(most, _)| *most > least) else { return Ok(None) };
    let stands_for_it = leaves_little(series, state, (&without, &system), term)?;
    Ok(stands_for_it.then(|| format!("{} explains it better", term.words())))
}

/// Whether a term leaves little of what a mechanism explains beside others: one that leaves it that is something else that the model
/// misses.
fn leaves_little(
    series: &Series,
    state: &State,
    (without, system): (&Baseline, &System),
    term: &Term,
) -> Result<bool, Error> {
    let white = without.whitening(series);
    let column = term.column(&without.robot, &series.averages, &without.predicted_w);
    let with_w = series.predict(&without.robot, &state.applied())?;
    let effect = [vec![white.of(&differences(&with_w, &without.predicted_w))]];
    let alone = system.explained(&effect)[0];
    let beside = system_with(series, without, &[column]).explained(&effect)[0];
    Ok(beside < SAME * alone)
}
