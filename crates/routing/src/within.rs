//! The best path within hard limits, exact in double precision over the motions of the lattice.

use std::time::Instant;

use planner::{Objective, Plan, Planner, Query, RefinedPath, SearchReport};

use crate::{
    bounded::{Bounded, Way},
    corridor::Corridor,
    error::{Contradiction, Error},
    labels::{Labelled, Labelling},
    limits::{Limits, only},
    multiplier::Multiplier,
};

/// The path with least of an objective among those within the limits.
///
/// Where the best path without limits keeps them, it is the answer. Otherwise the search is one of labels, exact for the
/// limits and the objective, over the motions that the planner's tables allow; the query's bound and patience hold as they do
/// for [`Planner::plan`]. The refined path is left out where it would break a limit.
///
/// # Errors
/// As [`Planner::plan`], and limits that no path keeps, with the least of each.
pub fn plan_within(
    planner: &Planner,
    query: &Query,
    objective: Objective,
    limits: &Limits,
) -> Result<Plan, Error> {
    let free = planner.plan(query, objective)?;
    if limits.hold(&free.route.total) {
        let refined = free.refined.filter(|refined| limits.hold(&refined.route.total));
        return Ok(Plan { refined, ..free });
    }
    // Curves to exact ends could break a limit that the lattice's path just keeps.
    let query = &Query { exact_ends: false, ..query.clone() };
    let mut plan = best_within(planner, query, objective, limits)?;
    if query.refine {
        let refined = RefinedPath::of(planner.lattice(), objective, &plan.route, &query.patience);
        plan.refined = refined.filter(|refined| limits.hold(&refined.route.total));
    }
    Ok(plan)
}

/// The same by labels in any case, not refined.
pub(crate) fn best_within(
    planner: &Planner,
    query: &Query,
    objective: Objective,
    limits: &Limits,
) -> Result<Plan, Error> {
    let began = Instant::now();
    let ends = planner.ends(query, objective)?;
    let bounded = Bounded::new(planner, (query, &ends), objective, limits);
    let best = bounded.least_of(bounded.objective)?;
    let least = best.least;
    let hint = multiplier(&bounded, best)?;
    let known =
        hint.within.as_ref().map_or(bounded.most[bounded.objective], |way| way.takes[bounded.objective]);
    // A path that beats the best known keeps the weighted sum within what that path and the limit allow.
    let (sum, most) = match hint.guide {
        Some((at, most)) if known.is_infinite() => (only(at), most),
        _ => (hint.sum, known + hint.off),
    };
    let corridor = Corridor::new(&bounded, sum, most)?;
    let mut report = Labelled { path: None, least, expanded: 0, late: true };
    let mut found = hint.within;
    if let Some(corridor) = &corridor {
        let whole = |amount: f64| bounded.whole(bounded.objective, amount);
        let suffices =
            |found: f64, least: f64| whole(least) > 0.0 && whole(found) <= query.bound * whole(least);
        let labelling = Labelling {
            corridor,
            objective: bounded.objective,
            most: bounded.most,
            bound: (hint.sum, hint.off),
            suffices: &suffices,
            patience: &query.patience,
        };
        // A path exactly at the limit of the objective itself will do.
        let known = if found.is_some() { known } else { f64::INFINITY };
        report = labelling.search(known);
        report.least = report.least.max(least);
        if let Some((start, motions)) = report.path.take() {
            let (start, takes) = (corridor.states[start as usize], [0.0; 3]);
            found = Some(Way { start, motions, takes, least });
        }
    }
    let Some(way) = found else {
        if report.late {
            return Err(planner::Error::Timeout { expanded: report.expanded }.into());
        }
        return Err(contradiction(&bounded));
    };
    let report = SearchReport {
        expanded: report.expanded,
        duration: began.elapsed(),
        bound: None,
        excess: report.least,
        optimal: false,
        timed_out: report.late,
    };
    let mut plan = planner.plan_along((&ends, query), way.start, &way.motions, report)?;
    prove(&bounded, &mut plan);
    Ok(plan)
}

/// States what the least proven, kept as the excess so far, says of the path.
fn prove(bounded: &Bounded<'_>, plan: &mut Plan) {
    let total = &plan.route.total;
    let amount = [total.energy_j, total.length_m, total.duration_s][bounded.objective];
    let least = bounded.whole(bounded.objective, plan.search.excess);
    // Sums in another order differ by rounding.
    let is_least = amount - least <= 1e-7 * amount.abs().max(1.0);
    plan.search.optimal = is_least;
    plan.search.excess = if is_least { 0.0 } else { amount - least };
    plan.search.bound = match is_least {
        true => Some(1.0),
        false => (least > 0.0).then(|| amount / least),
    };
}

/// What guides the search.
struct Hint {
    sum: crate::limits::Amounts,
    off: f64,
    within: Option<Way>,
    /// A limited amount and its limit, where no path within all limits is known.
    guide: Option<(usize, f64)>,
}

/// The multiplier of the limit that the objective's best path exceeds most, once each limit is known to be possible.
fn multiplier(bounded: &Bounded<'_>, best: Way) -> Result<Hint, Error> {
    let objective = bounded.objective;
    let beyond = |way: &Way, at: usize| way.least > bounded.most[at];
    if beyond(&best, objective) {
        return Err(contradiction(bounded));
    }
    let mut ways = Vec::new();
    for at in bounded.limited() {
        let way = bounded.least_of(at)?;
        if beyond(&way, at) {
            return Err(contradiction(bounded));
        }
        ways.push((at, way));
    }
    let known = |ways: &[(usize, Way)]| {
        let within = ways.iter().map(|(_, way)| way).chain([&best]).filter(|way| bounded.holds(&way.takes));
        within.min_by(|a, b| a.takes[objective].total_cmp(&b.takes[objective])).cloned()
    };
    let within = known(&ways);
    let excess = |(at, _): &(usize, Way)| best.takes[*at] / bounded.most[*at];
    ways.sort_by(|a, b| excess(b).total_cmp(&excess(a)));
    let Some((at, below)) = ways.into_iter().next() else {
        return Ok(Hint { sum: only(objective), off: 0.0, within, guide: None });
    };
    let guide = Some((at, bounded.most[at]));
    if best.takes[at] <= bounded.most[at] || below.takes[at] > bounded.most[at] {
        return Ok(Hint { sum: only(objective), off: 0.0, within, guide });
    }
    let found = Multiplier::find(bounded, at, best, below)?;
    let better = [found.within, within].into_iter().flatten();
    let within = better.min_by(|a, b| a.takes[objective].total_cmp(&b.takes[objective]));
    Ok(Hint { sum: found.sum, off: found.off, within, guide })
}

/// The least of each amount, as an error.
fn contradiction(bounded: &Bounded<'_>) -> Error {
    let all = || -> Result<Contradiction, Error> {
        let ways = [bounded.least_of(0)?, bounded.least_of(1)?, bounded.least_of(2)?];
        let least = |at: usize| bounded.whole(at, ways[at].takes[at]);
        Ok(Contradiction {
            least_energy_j: least(0),
            least_distance_m: least(1),
            least_duration_s: least(2),
            each_alone: (0..3).all(|at| ways[at].takes[at] <= bounded.most[at]),
        })
    };
    match all() {
        Ok(contradiction) => Error::Contradiction(Box::new(contradiction)),
        Err(other) => other,
    }
}
