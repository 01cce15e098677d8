//! Mechanisms that a term outside the list explains better than they do.

use model::Robot;

use crate::{
    Error,
    baseline::{Baseline, differences},
    constancy::RESISTANCES,
    everywhere,
    evidence::{Evidence, System},
    misfit::least_misfit,
    null::Null,
    ranked::ranked,
    search::{AS_GOOD, Found, State, openness},
    series::{Applied, Look, Series},
    term::{self, Term},
    weigh::{Sizes, system, system_at},
};

/// By how much a term that stands for the same has to explain more, in squared errors over their variance less what choices cost, and as
/// a share of what the mechanism explains where the model can be relied on: of concealed mechanisms, on seeds that none is scored on, the
/// best of thousands of terms, each beyond what healthy drives have of it, was ahead by 8 at most, and of what terms explain better by 19
/// and more. Where healthy drives show the model to miss more, its form of ice may too: on real ice a term is ahead by 0.06. But however
/// much it misses, no more than `BETTER_SHARE_MOST`, and no more at all of what holds back whatever rolls and stands in for other things
/// that do: of such mechanisms concealed from a model that misses two to sixteen times what it may, terms explained 0.003 to 0.08 less, and
/// of what soft soil explains of grease that sets, one that goes with slowness explained 0.06 and 0.14 more.
const BETTER: f64 = 12.0;
const BETTER_SHARE: f64 = 0.01;
const BETTER_SHARE_MOST: f64 = 0.08;
/// Share of what a mechanism explains from which a term that is missing beside all that was found is the greater thing. Beside concealed
/// mechanisms that were found it was 0.46 at most, beside names for what no mechanism describes 1.4 and more, or less than 0.15. Where
/// healthy drives show the model to miss more, that much more has to be missing, up to `GREATER_MOST`: beside the names of real loam, where
/// the model misses sixteen times what it may, it was 1.06 and 1.17, beside a name for what drivers lose at low duty, at four times, 1.86.
const GREATER: f64 = 1.0;
const GREATER_MOST: f64 = 1.5;
/// Share of what the mechanism explains by itself that it may explain beside the term, if that stands for the same.
const SAME: f64 = 0.5;

/// Terms, of those that explain most, that are looked at more closely.
const MOST_WEIGHED: usize = 24;

/// The term that explains far more than one of several mechanisms, beside the others, and leaves it little, or more than it does beside it;
/// or as much as all of them together.
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
    // The first stands for all of them.
    if which == 0
        && let Some(why) = instead_of_all(series, file, state, null)?
    {
        return Ok(Some(why));
    }
    let mut others: Vec<Applied> = state.applied();
    others.remove(which);
    let without = Baseline::fit(series, file, &others)?;
    let alone = system_at(series, &without, Sizes::Free, &[]);
    let explained = explained(series, state, std::slice::from_ref(found), (&without, &alone, null));
    let terms = term::of_drives(series, file, std::iter::once(found.applied.span));
    let terms: Vec<&Term> = terms.iter().collect();
    let best = ranked(series, &without, (&alone, null), &terms);
    // A greater thing shows in what goes with one quantity; all terms would take as long again.
    let plain: Vec<&Term> = terms.iter().copied().filter(|term| term.is_plain()).collect();
    let beside = ranked(series, &state.fit, (&system(series, &state.fit), null), &plain);
    let open = openness(series);
    if let Some((missing, term)) = beside.into_iter().next()
        && is_greater(missing, explained, open)
    {
        return Ok(Some(format!("{} is missing beside it and explains more", term.words())));
    }
    let stands_in = RESISTANCES.contains(&found.applied.mechanism.name());
    let may_miss = if stands_in { 1.0 } else { open };
    let term = match series.look {
        Look::Usual => {
            let ahead = best.into_iter().take_while(|(most, _)| is_better(*most, explained, may_miss));
            let ahead: Vec<&Term> = ahead.take(MOST_WEIGHED).map(|(_, term)| term).collect();
            first_that_leaves_little(series, state, (&without, &alone), &ahead)?
        }
        // What is weak has no other than the best name.
        Look::Closer => {
            let ahead = best.into_iter().take_while(|(most, _)| *most > explained + AS_GOOD);
            first_surer(series, state, (&without, &alone), ahead)?
        }
    };
    Ok(term.map(|term| format!("{} explains it better", term.words())))
}

/// The one term that explains as much as several mechanisms together: where grease holds wheels back the more the slower they turn, other
/// ground and a heavier drive share it out between them.
fn instead_of_all(
    series: &Series,
    file: &Robot,
    state: &State,
    null: &Null,
) -> Result<Option<String>, Error> {
    let is_delay = |found: &Found| found.applied.mechanism.name() == "clock_offset";
    if state.found.len() < 2 || state.found.iter().any(is_delay) {
        return Ok(None);
    }
    let without = Baseline::fit(series, file, &[])?;
    let alone = system_at(series, &without, Sizes::Free, &[]);
    let explained = explained(series, state, &state.found, (&without, &alone, null));
    let terms = term::of_drives(series, file, state.found.iter().map(|found| found.applied.span));
    let terms: Vec<&Term> = terms.iter().collect();
    let best = ranked(series, &without, (&alone, null), &terms);
    let mut as_good = best.into_iter().take_while(|(most, _)| *most > explained);
    let term = match series.look {
        Look::Usual => as_good.next().map(|(_, term)| term),
        Look::Closer => first_surer(series, state, (&without, &alone), as_good)?,
    };
    Ok(term.map(|term| format!("{} explains as much as all that was found together", term.words())))
}

/// The first of some terms that is surer than what a fit is without, block by block: squares alone may be of few blocks, or of a regime
/// that models miss. Of a payload, of other ground and of warm motors, a moment in some turns took 12 to 17 more than they did, whose size
/// differed from regime to regime 2.9 to 4.2 times as much as chance has it.
fn first_surer<'t>(
    series: &Series,
    state: &State,
    (without, alone): (&Baseline, &System),
    terms: impl Iterator<Item = (f64, &'t Term)>,
) -> Result<Option<&'t Term>, Error> {
    let terms: Vec<&Term> = terms.take(MOST_WEIGHED).map(|(_, term)| term).collect();
    if terms.is_empty() {
        return Ok(None);
    }
    let white = without.whitening(series);
    let sureness = |evidence: &Evidence| evidence.wald / evidence.scatter();
    let effect = white.of(&effect_w(series, state, without)?);
    let Some(own) = alone.weigh(&[effect]) else { return Ok(None) };
    let pairs: Vec<[Vec<f64>; 2]> =
        terms.iter().map(|term| everywhere::of_term(series, without, term).map(|c| white.of(&c))).collect();
    let weighed = alone.weigh_beyond(&pairs).into_iter().zip(terms);
    let is_surer = |evidence: Option<Evidence>| evidence.is_some_and(|one| sureness(&one) > sureness(&own));
    Ok(weighed.filter_map(|(evidence, term)| is_surer(evidence).then_some(term)).next())
}

/// What mechanisms change of power beside a fit without one of them, or all [W].
fn effect_w(series: &Series, state: &State, without: &Baseline) -> Result<Vec<f64>, Error> {
    Ok(differences(&series.predict(&without.robot, &state.applied())?, &without.predicted_w))
}

/// What some of what was found explain beside the rest, in squared errors over their variance less what choices cost, from a fit without
/// them.
fn explained(
    series: &Series,
    state: &State,
    some: &[Found],
    (without, system, null): (&Baseline, &System, &Null),
) -> f64 {
    let whole = least_misfit(series, without, without) - least_misfit(series, &state.fit, without);
    let numbers: usize = some.iter().map(Found::numbers).sum();
    whole / null.common_discount(system.blocks()) - numbers as f64 * (system.blocks() as f64).ln()
}

/// Whether what is missing beside all that was found is greater than what one mechanism of it explains, both in squared errors over their
/// variance, where healthy drives show the model to miss so many times what it may.
fn is_greater(missing: f64, explained: f64, openness: f64) -> bool {
    missing > f64::max(BETTER, openness.clamp(GREATER, GREATER_MOST) * explained)
}

/// Whether a term explains so much more than a mechanism that it is the better description.
fn is_better(most: f64, explained: f64, openness: f64) -> bool {
    let share = f64::min(BETTER_SHARE * openness, BETTER_SHARE_MOST);
    most > explained + f64::max(BETTER, share * explained)
}

/// The first of some terms that leaves little of what a mechanism explains beside others: one that leaves it is something else that the
/// model misses, as what one side takes after rests, which was ahead of a name for a fan and hid that terms of the fan were.
fn first_that_leaves_little<'t>(
    series: &Series,
    state: &State,
    (without, system_without): (&Baseline, &System),
    terms: &[&'t Term],
) -> Result<Option<&'t Term>, Error> {
    if terms.is_empty() {
        return Ok(None);
    }
    let white = without.whitening(series);
    let effect = [vec![white.of(&effect_w(series, state, without)?)]];
    let alone = system_without.explained(&effect)[0];
    let leaves_little = |term: &&&Term| {
        let column = term.column(&without.driven(series));
        system_at(series, without, Sizes::Free, &[column]).explained(&effect)[0] < SAME * alone
    };
    Ok(terms.iter().find(leaves_little).copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_term_beside_a_name_refutes_it_if_it_is_the_greater_and_more_so_where_the_model_misses_more() {
        // Real ground beside sensors' noise: ten times what the model may miss.
        for (missing, explained, openness, is_it) in [
            (101.0, 100.0, 0.3, true),
            (99.0, 100.0, 0.3, false),
            (101.0, 100.0, 1.2, false),
            (121.0, 100.0, 1.2, true),
            (149.0, 100.0, 10.0, false),
            (151.0, 100.0, 10.0, true),
            // Next to nothing is no greater thing than next to nothing.
            (11.0, 2.0, 0.3, false),
        ] {
            assert_eq!(is_greater(missing, explained, openness), is_it, "{missing} {explained} {openness}");
        }
    }

    #[test]
    fn a_term_is_better_by_as_much_as_the_best_of_thousands_never_was_beside_the_truth() {
        for (most, explained, openness, is_it) in [
            (108.0, 100.0, 1.0, false),
            (113.0, 100.0, 1.0, true),
            (2019.0, 2000.0, 1.0, false),
            (2021.0, 2000.0, 1.0, true),
            (2100.0, 2000.0, 6.0, false),
            (2150.0, 2000.0, 20.0, false),
            (2170.0, 2000.0, 20.0, true),
        ] {
            assert_eq!(is_better(most, explained, openness), is_it, "{most} {explained} {openness}");
        }
    }
}
