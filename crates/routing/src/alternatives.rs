//! The trade-off between energy and time or length: paths of which none is beaten in both.

use planner::{Objective, Plan, Planner, Query};
use rayon::prelude::*;

use crate::{
    error::Error,
    limits::{Limits, place},
    within::best_within,
};

/// Paths from the least energy to the least of the other amount; each has less of the other than the one before it and
/// more energy.
///
/// Each is the path of least energy within some limit on the other, found to the query's bound: with a bound of 1 no path of
/// the lattice is better in one and as good in the other, and with 1 + ε none that takes as little of the other has less than
/// 1/(1 + ε) of its energy.
#[derive(Clone, Debug, Default)]
pub struct Alternatives {
    /// The paths.
    pub plans: Vec<Plan>,
    /// Whether there are no others: every path that none beats in both is here, to the query's bound.
    pub complete: bool,
    /// Whether patience ended before all that were asked for were proven; those that were not are left out.
    pub timed_out: bool,
}

/// Amounts that differ by less than this share are the same: more than rounding, less than any motion.
const SAME: f64 = 1e-8;

/// Gaps that are looked into for each path asked for; as paths push each other out there may be more than paths.
const MOST_LOOKS_PER_PATH: usize = 16;

/// Up to `count` paths of the trade-off between energy and `against`, spread evenly between its ends where there are more.
///
/// # Errors
/// As [`plan_within`](crate::plan_within), where not even the ends of the trade-off can be found.
pub fn alternatives(
    planner: &Planner,
    query: &Query,
    against: Objective,
    limits: &Limits,
    count: usize,
) -> Result<Alternatives, Error> {
    let query = Query { refine: false, ..query.clone() };
    let front = Front { planner, query: &query, against, limits };
    let ends = [Objective::Energy, against].into_par_iter();
    let ends: Vec<Plan> =
        ends.map(|objective| best_within(planner, &query, objective, limits)).collect::<Result<_, _>>()?;
    let [most, least] = [0, 1].map(|end| front.amount(&ends[end]));
    let share = |i: usize| i as f64 / (count.max(2) - 1) as f64;
    let inner: Vec<Result<Plan, Error>> =
        (0..count.max(2)).into_par_iter().map(|i| front.below(most - share(i) * (most - least))).collect();
    let mut found = Alternatives::default();
    for plan in inner {
        found.take(&front, plan)?;
    }
    found.fill_gaps(&front, count)?;
    Ok(found)
}

/// The question whose trade-off is sought.
struct Front<'q> {
    planner: &'q Planner,
    query: &'q Query,
    against: Objective,
    limits: &'q Limits,
}

impl Front<'_> {
    /// What a path takes of the other amount.
    fn amount(&self, plan: &Plan) -> f64 {
        let total = &plan.route.total;
        [total.energy_j, total.length_m, total.duration_s][place(self.against)]
    }

    /// The path of least energy with at most so much of the other amount.
    fn below(&self, most: f64) -> Result<Plan, Error> {
        let tighter = |limit: Option<f64>| Some(limit.map_or(most, |limit| limit.min(most)));
        let limits = match self.against {
            Objective::Distance => {
                Limits { max_distance_m: tighter(self.limits.max_distance_m), ..*self.limits }
            }
            _ => Limits { max_time_s: tighter(self.limits.max_time_s), ..*self.limits },
        };
        best_within(self.planner, self.query, Objective::Energy, &limits)
    }
}

impl Alternatives {
    /// Adds a path in its place unless it is there; one that is not proven is left out.
    fn take(&mut self, front: &Front<'_>, plan: Result<Plan, Error>) -> Result<bool, Error> {
        let plan = match plan {
            Ok(plan) if plan.search.timed_out => None,
            Ok(plan) => Some(plan),
            Err(Error::Planner(planner::Error::Timeout { .. })) => None,
            // At the very end of the trade-off rounding may leave nothing within the limit.
            Err(Error::Contradiction(_)) => return Ok(false),
            Err(other) => return Err(other),
        };
        let Some(plan) = plan else {
            self.timed_out = true;
            return Ok(false);
        };
        let amount = front.amount(&plan);
        // Within the query's bound one may beat another.
        let beats = |a: &Plan, b: &Plan| {
            front.amount(a) <= front.amount(b) && a.route.total.energy_j <= b.route.total.energy_j
        };
        if self.plans.iter().any(|other| beats(other, &plan)) {
            return Ok(false);
        }
        self.plans.retain(|other| !beats(&plan, other));
        let at = self.plans.partition_point(|other| front.amount(other) > amount);
        let beside = [at.wrapping_sub(1), at].map(|i| self.plans.get(i));
        let same = |other: &Plan| {
            let near = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs().max(b.abs()).max(1.0);
            near(front.amount(other), amount) || near(other.route.total.energy_j, plan.route.total.energy_j)
        };
        let is_new = !beside.into_iter().flatten().any(same);
        if is_new {
            self.plans.insert(at, plan);
        }
        Ok(is_new)
    }

    /// Looks between neighbours, the widest gap first, until there are as many as asked for or no others.
    fn fill_gaps(&mut self, front: &Front<'_>, count: usize) -> Result<(), Error> {
        // Amounts below which the next path is known to be the neighbour.
        let mut closed: Vec<f64> = Vec::new();
        for _ in 0..MOST_LOOKS_PER_PATH * count.max(1) {
            if self.plans.len() >= count || self.timed_out {
                break;
            }
            let gap = |pair: &[Plan]| {
                let [upper, lower] = [0, 1].map(|i| front.amount(&pair[i]));
                (!closed.contains(&upper)).then_some((upper - lower, upper))
            };
            let widest = self.plans.windows(2).filter_map(gap).max_by(|a, b| a.0.total_cmp(&b.0));
            let Some((width, upper)) = widest else {
                self.complete = true;
                return Ok(());
            };
            // First half way, then next to the upper end, which settles whether there is anything between.
            let half_way = front.below(upper - width / 2.0);
            if !self.take(front, half_way)? {
                let next = front.below(upper * (1.0 - SAME));
                if !self.take(front, next)? {
                    closed.push(upper);
                }
            }
        }
        Ok(())
    }
}
