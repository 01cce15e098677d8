//! The search for what is missing: candidates are weighed beside everything else, one is taken up, all is fitted again.

use model::Robot;
use rayon::prelude::*;
use recording::Recording;

use crate::{
    Error, as_hard,
    baseline::Baseline,
    constancy, faint,
    gates::best,
    limit,
    misfit::{self, Squares},
    missed,
    names::{Names, names, tell_apart},
    needed::drop_one,
    null::Null,
    off_middle,
    onset::{self, Bounded},
    outside, pairs,
    polish::{Polished, form_sigma, polish, settle},
    refused::{Doubt, Refused, refuse},
    ridge, second_ground,
    series::{Applied, Series},
    undoing::last_undoes,
    unshown,
    weigh::{Weighed, left, system},
};

/// Mechanisms that are looked for at most.
pub(crate) const MOST: usize = 3;
/// What is not needed by more than this is not, and no name stands alone that is not better by more: twice the log of a likelihood ratio
/// of 20.
pub(crate) const AS_GOOD: f64 = 6.0;
/// What a model may miss of healthy drives where it can be relied on, as a share of power.
pub(crate) const TOLD: f64 = 0.005;

/// A mechanism that was found.
#[derive(Clone)]
pub struct Found {
    /// It at its fitted values.
    pub applied: Applied,
    /// Half widths of its values' 95 % intervals; `None` for those taken from a grid.
    pub half_widths: Vec<Option<f64>>,
    /// 95 % intervals of what bounds the part of the drives in which it acts, one for each of [`Series::bounds`].
    pub limits_95: Vec<[f64; 2]>,
    /// Chance of as much, corrected for all that was tried.
    pub p_value: f64,
    /// Drop of the penalised likelihood, as of the Bayesian information criterion over blocks.
    pub delta_bic: f64,
    /// Gain of held-out squared errors, as a share of them.
    pub held_out_gain: f64,
    /// Mechanisms that explain it as well or cannot be told from it.
    pub indistinguishable_from: Vec<String>,
    /// Mechanisms that fall short of it by too little to leave it alone, best first, should those turn out to be none.
    pub(crate) next_names: Vec<String>,
}

impl Found {
    /// Numbers that were fitted for it, those that bound the part of the drives in which it acts included.
    pub(crate) fn numbers(&self) -> usize {
        self.half_widths.iter().flatten().count() + self.applied.span.bounds()
    }
}

/// Where the search ended.
pub struct Search {
    /// What was found, in the order in which it was.
    pub found: Vec<Found>,
    /// What explains much, but not at one size all through the drives.
    pub refused: Vec<Refused>,
    /// The robot with nothing found.
    pub(crate) before: Baseline,
    /// The robot with all that was found.
    pub(crate) after: Baseline,
    /// Whitened errors that nothing took, before and after.
    pub left: [Vec<f64>; 2],
    /// By how much evidence is discounted.
    pub(crate) null: Null,
}

impl Search {
    /// Where it begins: the robot fitted, and nothing found yet; `healthy` are those that the series holds beside the suspect ones.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub fn begin(
        series: &Series,
        file: &Robot,
        healthy: Option<&Recording>,
        progress: &dyn Fn(&str, f64),
    ) -> Result<Search, Error> {
        progress("comparing healthy drives", 0.0);
        let null = Null::of(file, healthy, (series.watch(), series.look))?;
        progress("fitting the robot", 0.05);
        let before = Baseline::fit(series, file, &[])?;
        let left = left(series, &before);
        let (after, left) = (before.clone(), [left.clone(), left]);
        Ok(Search { found: Vec::new(), refused: Vec::new(), before, after, left, null })
    }
}

/// What is found so far, and the robot with all of it.
#[derive(Clone)]
pub(crate) struct State {
    pub(crate) found: Vec<Found>,
    pub(crate) fit: Baseline,
}

impl State {
    pub(crate) fn applied(&self) -> Vec<Applied> {
        self.found.iter().map(|f| f.applied.clone()).collect()
    }

    /// Whether the same mechanisms act in the same parts of the drives.
    fn acts_as(&self, others: &[Applied]) -> bool {
        let is_one = |(own, other): (&Found, &Applied)| {
            own.applied.mechanism.name() == other.mechanism.name() && own.applied.span == other.span
        };
        self.found.len() == others.len() && self.found.iter().zip(others).all(is_one)
    }

    /// Takes up what was decided for beside all that was found before.
    pub(crate) fn take_up(&mut self, (next, fitted): (Found, Polished)) {
        self.found.push(next);
        self.take(fitted);
    }

    /// All that was found as it was fitted together.
    pub(crate) fn take(&mut self, fitted: Polished) {
        let values = fitted.applied.into_iter().zip(fitted.half_widths);
        for (found, (applied, half_widths)) in self.found.iter_mut().zip(values) {
            (found.applied, found.half_widths) = (applied, half_widths);
        }
        self.fit = fitted.base;
    }

    /// Fits all together anew, as when something was left out.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub(crate) fn refit(&mut self, series: &Series, file: &Robot) -> Result<(), Error> {
        let fitted = settle(series, file, &self.applied(), &self.fit.robot)?;
        self.take(fitted);
        Ok(())
    }
}

/// Looks for mechanisms in the suspect drives, from where a search began.
///
/// # Errors
/// A surface that the robot does not know.
pub fn search(
    series: &Series,
    file: &Robot,
    begun: Search,
    progress: &dyn Fn(&str, f64),
) -> Result<Search, Error> {
    let Search { before, null, left: [left_before, _], .. } = begun;
    let mut state = State { found: Vec::new(), fit: before.clone() };
    for round in 0..MOST {
        progress("weighing mechanisms", 0.1 + 0.25 * round as f64);
        let last = state.applied();
        let Some((rivals, held_out_gain)) = best(series, &state.fit, &last, &null)? else { break };
        progress("fitting what was found", 0.2 + 0.25 * round as f64);
        let decided = decide(series, file, (&last, &state.fit), (&rivals, held_out_gain), &null)?;
        state.take_up(decided);
        if last_undoes(series, &state)? {
            state.found.pop();
            state.refit(series, file)?;
            break;
        }
        while drop_one(series, file, &mut state, &null)? {}
        // What was taken up and left out again would be so once more.
        if state.acts_as(&last) {
            break;
        }
        state = pairs::revised(series, file, &before, state, &null)?;
    }
    progress("trying pairs", 0.9);
    let mut state = pairs::tried(series, file, &before, state, &null)?;
    second_ground::part(series, file, &mut state)?;
    let too_much = |state: &State, which: usize, _: bool| Ok(limit::doubt(file, series, state, which));
    let of_many_sizes = |state: &State, which: usize, stands_in: bool| {
        constancy::doubt(series, state, which, (&null, stands_in))
    };
    let told_better =
        |state: &State, which: usize, _: bool| outside::doubt(series, file, state, which, &null);
    let takes_little =
        |state: &State, which: usize, _: bool| missed::doubt(series, file, &before, state, which);
    let unshown = |state: &State, which: usize, _: bool| Ok(unshown::doubt(series, state, which));
    let faint =
        |state: &State, which: usize, stands_in: bool| Ok(faint::doubt(series, state, which, stands_in));
    let doubts: [&Doubt<'_>; 6] = [&too_much, &unshown, &of_many_sizes, &told_better, &takes_little, &faint];
    let refused = refuse(series, file, &mut state, &doubts, &null)?;
    ridge::widen(series, file, &mut state, &null)?;
    let State { mut found, fit: after } = state;
    tell_apart(&mut found);
    let left = [left_before, left(series, &after)];
    Ok(Search { found, refused, before, after, left, null })
}

/// Fits every rival in full, beside mechanisms that act, and decides for the one that explains most; those that explain as much stay
/// beside it.
pub(crate) fn decide(
    series: &Series,
    file: &Robot,
    (applied, by): (&[Applied], &Baseline),
    (rivals, held_out_gain): (&[Weighed], f64),
    null: &Null,
) -> Result<(Found, Polished), Error> {
    let blocks = system(series, by).blocks();
    let common = null.common_discount(blocks);
    let bounded: Vec<Option<Bounded>> = rivals
        .par_iter()
        .map(|rival| onset::refine(series, by, applied, rival, common))
        .collect::<Result<_, _>>()?;
    let at_best = |i: usize| bounded[i].as_ref().map_or(&rivals[i], |bounded| &bounded.weighed);
    let fits: Vec<Polished> = (0..rivals.len())
        .into_par_iter()
        .map(|i| polish(series, file, (applied, &by.robot), at_best(i)))
        .collect::<Result<_, _>>()?;
    let misfits: Vec<Squares> =
        fits.iter().map(|fit| misfit::by_quantity(series, &fit.base, by).map(|m| m / common)).collect();
    let before = misfit::by_quantity(series, by, by).map(|m| m / common);
    // What a form leaves open of all that is explained of a quantity tells no form from another.
    let unit = |of: usize| {
        let explained = before[of] - misfits.iter().map(|m| m[of]).fold(f64::INFINITY, f64::min);
        (form_sigma(series).powi(2) * explained).max(1.0)
    };
    let units: Squares = std::array::from_fn(unit);
    let in_units = |i: usize| misfits[i].iter().zip(units).map(|(misfit, unit)| misfit / unit).sum::<f64>();
    let is_possible = |i: &usize| !off_middle::is_at_its_limit(&fits[*i].applied[applied.len()], file);
    let are_possible = (0..fits.len()).any(|i| is_possible(&i));
    let cost = |i: usize| match !are_possible || is_possible(&i) {
        true => in_units(i) + at_best(i).candidate.numbers() as f64 * (blocks as f64).ln(),
        false => f64::INFINITY,
    };
    let costs: Vec<f64> = (0..fits.len()).map(cost).collect();
    let least = |a: &usize, b: &usize| costs[*a].total_cmp(&costs[*b]);
    // Squares alone make nobody the winner: few blocks may hold all that a rival takes of them.
    let sure = (0..fits.len()).filter(|i| at_best(*i).score > 0.0).min_by(least);
    let winner = sure.or_else(|| (0..fits.len()).min_by(least)).unwrap_or(0);
    let of_rivals: Vec<&str> = rivals.iter().map(Weighed::name).collect();
    let Names { as_good, next } = names(&of_rivals, &costs, winner);
    let (rival, fit) = (at_best(winner), fits.into_iter().nth(winner));
    let limits_95 = bounded[winner].as_ref().map_or(Vec::new(), |bounded| bounded.limits_95.clone());
    let Some(fit) = fit.map(as_hard::in_both) else { unreachable!("the winner is one of the fits") };
    let found = Found {
        applied: fit.applied[applied.len()].clone(),
        half_widths: fit.half_widths[applied.len()].clone(),
        limits_95,
        p_value: rival.p_value,
        delta_bic: rival.score,
        held_out_gain,
        indistinguishable_from: as_good,
        next_names: next,
    };
    Ok((found, fit))
}

/// Whether healthy drives show that the model misses hardly anything.
pub(crate) fn is_told(series: &Series) -> bool {
    openness(series) <= 1.0
}

/// What the model misses of healthy drives over what it may miss where it can be relied on; without healthy drives it may miss anything.
pub(crate) fn openness(series: &Series) -> f64 {
    if series.has_healthy() { missed_share(series) / TOLD } else { f64::INFINITY }
}

/// One sigma of what the model misses, as learnt of healthy drives where there are any, as a share of power.
pub(crate) fn missed_share(series: &Series) -> f64 {
    series.told().learnt.get().map_or(0.0, |learnt| learnt.missed.share(series.channels()))
}
