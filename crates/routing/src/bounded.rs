//! A question with limits, put in amounts that no motion has less than nothing of.

use planner::{
    CostTable, Ends, FieldEnds, GoalField, Lattice, Objective, Outcome, Planner, Query, Search, State,
    Workspace, search, work,
};

use crate::{
    error::Error,
    limits::{Amounts, Limits, only, place, plus, weights},
};

/// Ends and limits of a question. Energy counts without lifting, E − Δφ, so that no amount of a motion is negative; the
/// height between the ends is the same for every path to a goal and stands aside.
pub(crate) struct Bounded<'q> {
    pub(crate) planner: &'q Planner,
    pub(crate) query: &'q Query,
    pub(crate) ends: &'q Ends,
    /// Goals with the energy of their height above the lowest [J].
    pub(crate) goals: Vec<(State, f64)>,
    /// Energy of the lowest goal's height above the start, which every path takes besides [J].
    pub(crate) besides_j: f64,
    /// Place of what the path is to have least of.
    pub(crate) objective: usize,
    /// Most of each amount; infinite where there is no limit.
    pub(crate) most: Amounts,
}

/// A path with what it takes.
#[derive(Clone, Debug)]
pub(crate) struct Way {
    pub(crate) start: State,
    /// Motions in order, each with its variant.
    pub(crate) motions: Vec<(usize, usize)>,
    pub(crate) takes: Amounts,
    /// Proven: no path has less of the sum that this one has least of, whatever the table rounds.
    pub(crate) least: f64,
}

/// By how much the planner's tables may be above what a motion takes, as a share: their rounding, and single precision.
pub(crate) const TABLE_ROUNDING: f64 = CostTable::LARGEST_ROUNDING + SHARE_OF_SINGLE_PRECISION;
/// What sums in single precision may be off by, as a share.
const SHARE_OF_SINGLE_PRECISION: f64 = 1e-4;

/// Share of a path's length that its time may weigh, to choose between equals.
const TIE_SHARE: f64 = 1e-6;

impl<'q> Bounded<'q> {
    pub(crate) fn new(
        planner: &'q Planner,
        (query, ends): (&'q Query, &'q Ends),
        objective: Objective,
        limits: &Limits,
    ) -> Self {
        let lattice = planner.lattice();
        let height_j = |state: &State| lattice.potential_j(state.cell);
        let lowest_j = ends.goals.iter().map(height_j).fold(f64::INFINITY, f64::min);
        let besides_j = lowest_j - ends.starts.first().map_or(0.0, height_j);
        let unlimited = f64::INFINITY;
        Bounded {
            planner,
            query,
            ends,
            goals: ends.goals.iter().map(|goal| (*goal, height_j(goal) - lowest_j)).collect(),
            besides_j,
            objective: place(objective),
            most: [
                limits.max_energy_j.map_or(unlimited, |most_j| most_j - besides_j),
                limits.max_distance_m.unwrap_or(unlimited),
                limits.max_time_s.unwrap_or(unlimited),
            ],
        }
    }

    /// Places of the amounts that are limited, the objective's own aside.
    pub(crate) fn limited(&self) -> impl Iterator<Item = usize> + '_ {
        (0..3).filter(|at| *at != self.objective && self.most[*at].is_finite())
    }

    /// Whether a path's amounts keep within the limits.
    pub(crate) fn holds(&self, takes: &Amounts) -> bool {
        takes.iter().zip(&self.most).all(|(takes, most)| takes <= most)
    }

    /// The whole amount, for energy with lifting.
    pub(crate) fn whole(&self, at: usize, amount: f64) -> f64 {
        if at == place(Objective::Energy) { amount + self.besides_j } else { amount }
    }

    /// Costs of all motions as a weighted sum of amounts.
    pub(crate) fn table(&self, sum: Amounts) -> CostTable {
        CostTable::weighted(self.planner.lattice(), weights(sum))
    }

    /// Goals with what follows there in a weighted sum.
    pub(crate) fn goals_in(&self, sum: &Amounts) -> Vec<(State, f64)> {
        self.goals.iter().map(|(goal, after_j)| (*goal, after_j * sum[place(Objective::Energy)])).collect()
    }

    /// The path of which a weighted sum of amounts is least, to the table's rounding.
    pub(crate) fn least(&self, mut sum: Amounts) -> Result<Way, Error> {
        if sum[place(Objective::Energy)] == 0.0 && sum[place(Objective::Time)] == 0.0 {
            // Turns on the spot have no length, and a motion that costs nothing leads a walk round in circles.
            let speed_mps = self.planner.lattice().settings.speed_mps;
            sum[place(Objective::Time)] = TIE_SHARE * speed_mps * sum[place(Objective::Distance)];
        }
        let (table, goals) = (self.table(sum), self.goals_in(&sum));
        let late = Error::Planner(planner::Error::Timeout { expanded: 0 });
        let patience = &self.query.patience;
        let start = self.ends.starts.first().map(|start| start.cell);
        let field =
            GoalField::new(&table, FieldEnds { goals: &goals, start }, patience).ok_or(late.clone())?;
        let question =
            Search { starts: &self.ends.starts, goals: &goals, besides: 0.0, bound: 1.0, patience };
        let mut workspace = Workspace::of(self.planner.lattice());
        match search(&table, &field, &question, &mut workspace) {
            Outcome::Found(found) if !found.late => {
                // The tie of length is a small part of the share that single precision may take.
                let least = found.least * (1.0 - SHARE_OF_SINGLE_PRECISION);
                Ok(self.along(&sum, (found.start, least), &found.motions).ok_or(late)?)
            }
            Outcome::Unreachable => self.no_path(),
            _ => Err(late),
        }
    }

    /// The least of one amount that any path takes, to the table's rounding.
    pub(crate) fn least_of(&self, at: usize) -> Result<Way, Error> {
        self.least(only(at))
    }

    /// The planner knows best why there is no path.
    fn no_path(&self) -> Result<Way, Error> {
        let plain = Query { refine: false, bound: Query::LOOSEST_BOUND, ..self.query.clone() };
        self.planner.plan(&plain, Objective::Energy)?;
        Err(Error::Planner(planner::Error::Timeout { expanded: 0 }))
    }

    /// Motions from a start, each in the variant with least of a weighted sum.
    fn along(&self, sum: &Amounts, (start, least): (State, f64), motions: &[usize]) -> Option<Way> {
        let lattice = self.planner.lattice();
        let (mut state, mut takes, mut ways) = (start, Amounts::default(), Vec::new());
        let mut pacer = self.query.patience.pacer();
        for &motion in motions {
            pacer.after(work::MOTION)?;
            let end = lattice.successor(state, motion)?;
            let (variant, amounts) = variants(lattice, state, end, motion).min_by(|a, b| {
                crate::limits::weighed(&a.1, sum).total_cmp(&crate::limits::weighed(&b.1, sum))
            })?;
            takes = plus(&takes, &amounts);
            ways.push((motion, variant));
            state = end;
        }
        let (_, after_j) = self.goals.iter().find(|(goal, _)| *goal == state)?;
        takes[place(Objective::Energy)] += after_j;
        Some(Way { start, motions: ways, takes, least })
    }
}

/// The ways to drive a motion between two states with what each takes.
pub(crate) fn variants(
    lattice: &Lattice,
    state: State,
    end: State,
    motion: usize,
) -> impl Iterator<Item = (usize, Amounts)> + '_ {
    let lifted_j = lattice.potential_j(end.cell) - lattice.potential_j(state.cell);
    lattice.variants(state.cell, state.heading, motion).enumerate().filter_map(move |(variant, edge)| {
        let edge = edge?;
        // Only rounding can have made it negative.
        Some((variant, [(edge.energy_j - lifted_j).max(0.0), edge.length_m, edge.duration_s]))
    })
}
