//! A* over the lattice, with a proof of how good its answer is.

use std::collections::HashMap;

use crate::{
    field::goal_field::GoalField,
    frontier::{
        labels::{UNREACHED, Workspace},
        prefetch::prefetch,
        queue::BUCKET_SHIFT,
    },
    grid::{
        cost::{FORBIDDEN, decode},
        heading::HEADINGS,
        layout::{Layout, Shift},
        state::State,
    },
    lattice::graph::Lattice,
    patience::{Patience, work},
    search::walk_back::{Walked, walk_back},
    table::{cost_table::CostTable, tile_builder::code_place},
};

/// What to search for.
pub struct Search<'s> {
    /// Where the robot may start.
    pub starts: &'s [State],
    /// Where it may end, with the cost that is still to be added there, in the objective's unit.
    pub goals: &'s [(State, f64)],
    /// What every path costs besides, in the objective's unit: for energy the height potential of the lowest goal above
    /// the start, often negative. Bounds are on the sum.
    pub besides: f64,
    /// An answer may cost so many times the least; 1 asks for the least itself.
    pub bound: f64,
    /// When to give up.
    pub patience: &'s Patience,
}

/// How a search ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// A path.
    Found(Found),
    /// No motion leads from a start to a goal.
    Unreachable,
    /// Patience ended before there was any path.
    Timeout {
        /// States expanded.
        expanded: u64,
    },
    /// A goal was reached, but its costs do not lead back to a start; costs that rise along every motion rule it out.
    Untraceable,
}

/// A path and what is proven of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Where it starts.
    pub start: State,
    /// Motions in order.
    pub motions: Vec<usize>,
    /// States expanded.
    pub expanded: u64,
    /// Proven: no path of the lattice takes less of the objective when driven, in its own unit, `besides` included. The
    /// rounding of the table is taken off.
    pub least: f64,
    /// Proven: its cost is at most so many times the least, rounding included; `None` where the least may be nothing or a
    /// gain, which no factor bounds.
    pub bound: Option<f64>,
    /// Whether no path costs less in the table.
    pub optimal: bool,
    /// Whether patience ended before the bound asked for was proven.
    pub late: bool,
}

impl Found {
    /// A path along an exact field, which costs the least that the table allows.
    pub fn along(start: State, motions: Vec<usize>) -> Self {
        let least = f64::NEG_INFINITY;
        Found { start, motions, expanded: 0, least, bound: None, optimal: true, late: false }
    }
}

/// Weights of the estimate, one pass after the other: the first answers at once, the last with the least cost. The weight that
/// proves the bound asked for comes between them.
const WEIGHTS: [f64; 3] = [1.2, 1.05, 1.0];
/// Least weight above 1 that a pass is worth: with a smaller one it expands about as much as with 1.
const LEAST_WEIGHT: f64 = 1.001;
/// A weight of the ladder that exceeds 1 by at most so many times as much as the one that proves the bound is passed over.
const NEXT_TO: f64 = 2.0;
/// Expansions between two looks at the clock, less than a millisecond.
const CLOCK_EVERY: u64 = 2048;
/// Open states that are looked at to prove a bound, even where patience is over.
const OPEN_AT_LEAST: u64 = 1 << 14;
/// How many states before its turn a state is asked of memory. Asking for its successors too gained nothing measurable.
const CODES_AHEAD: usize = 3;

/// Finds a path from any start to any goal whose cost is within the bound asked for.
///
/// Passes with smaller and smaller weights follow each other until the bound is proven; each but the first looks only at
/// what can still beat the best path so far.
pub fn search(
    table: &CostTable,
    field: &GoalField,
    query: &Search<'_>,
    workspace: &mut Workspace,
) -> Outcome {
    search_within(table, field, query, workspace, u64::MAX)
}

/// The same, given up as if patience had ended once so many states were expanded.
pub(crate) fn search_within(
    table: &CostTable,
    field: &GoalField,
    query: &Search<'_>,
    workspace: &mut Workspace,
    most_expanded: u64,
) -> Outcome {
    let lattice = table.lattice();
    let units = |amount: f64| (amount * table.units()) as u32;
    let mut goals = HashMap::with_capacity(query.goals.len());
    let mut pacer = query.patience.pacer();
    for (state, after) in query.goals {
        if pacer.after(work::STATE).is_none() {
            return Outcome::Timeout { expanded: 0 };
        }
        goals.insert(lattice.layout.pack(*state), units(*after));
    }
    drop(pacer);
    let mut passes = Passes {
        table,
        field,
        query,
        moves: moves(lattice),
        highest_after: goals.values().copied().max().unwrap_or(0),
        goals,
        expanded: 0,
        most_expanded,
        least: 0,
        best: None,
        tried_sufficient: false,
    };
    passes.least =
        query.starts.iter().map(|s| field.units_at(lattice.layout.pack(*s))).min().unwrap_or(UNREACHED);
    if passes.least == UNREACHED {
        return Outcome::Unreachable;
    }
    let mut next = Some(query.bound.max(WEIGHTS[0]));
    while let Some(weight) = next {
        match passes.run(weight, workspace) {
            Ended::Astray => return Outcome::Untraceable,
            Ended::Late => return passes.outcome(true),
            Ended::Done if passes.is_proven() => break,
            Ended::Done => next = passes.next_weight(weight),
        }
    }
    passes.outcome(false)
}

/// The passes of one search.
struct Passes<'p> {
    table: &'p CostTable,
    field: &'p GoalField,
    query: &'p Search<'p>,
    moves: Vec<Move>,
    goals: HashMap<u32, u32>,
    highest_after: u32,
    expanded: u64,
    most_expanded: u64,
    /// No path costs less than this.
    least: u32,
    best: Option<Best>,
    /// Whether a pass had the weight that ought to prove the bound asked for.
    tried_sufficient: bool,
}

/// The best path so far.
struct Best {
    total: u32,
    start: State,
    motions: Vec<usize>,
}

/// Why a pass ended.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Ended {
    /// With a path, or without one better than the best so far.
    Done,
    /// Because patience did.
    Late,
    /// With a path that cannot be traced back.
    Astray,
}

/// A motion as the search takes it.
#[derive(Clone, Copy, Default)]
struct Move {
    shift: Shift,
    heading: u32,
}

impl Passes<'_> {
    /// Searches in the order of cost plus weighted estimate; a state that is reached at less cost is expanded again.
    fn run(&mut self, weight: f64, workspace: &mut Workspace) -> Ended {
        if workspace.clear(self.query.patience).is_none() {
            return Ended::Late;
        }
        let weighted = Weighted::new(weight);
        let Workspace { labels, queue } = &mut *workspace;
        let layout = &self.table.lattice().layout;
        for &start in self.query.starts {
            let packed = layout.pack(start);
            let ahead = self.field.units_at(packed);
            if ahead != UNREACHED && labels.lower(packed, 0) {
                queue.push(weighted.key(0, ahead), packed);
            }
        }
        let limit = self.best.as_ref().map_or(UNREACHED, |best| best.total);
        let (found, ended) = self.expand(&weighted, limit, workspace);
        let total = found.map_or(limit, |(total, _)| total.min(limit));
        self.least = self.least.max(self.least_open(&weighted, workspace).min(total));
        let Some((total, goal)) = found.filter(|(total, _)| *total < limit) else { return ended };
        match walk_back(self.table, &workspace.labels, (self.query.starts, goal), self.query.patience) {
            Walked::Start(start, motions) => self.best = Some(Best { total, start, motions }),
            Walked::Late => return Ended::Late,
            Walked::Astray => return Ended::Astray,
        }
        ended
    }

    /// A lower bound of what any path by an open state costs, from the lowest keys on as far as patience reaches.
    ///
    /// A state that is on the best path and was not expanded at its cost is still in the queue. Of states in buckets that are
    /// not looked at the key is known, and `cost + ahead` is the key over the weight at least.
    fn least_open(&self, weighted: &Weighted, Workspace { labels, queue }: &Workspace) -> u32 {
        let (field, mut looked_at) = (self.field, 0);
        let mut pacer = self.query.patience.pacer();
        let mut least = UNREACHED;
        for (state, bucket_key) in queue.items() {
            looked_at += 1;
            if pacer.after(work::STATE).is_none() && looked_at > OPEN_AT_LEAST {
                return least.min(weighted.least_sum(bucket_key));
            }
            // A later bucket cannot hold less than this one's keys allow.
            if weighted.least_sum(bucket_key) >= least {
                return least;
            }
            let (cost, ahead) = (labels.cost(state), field.units_at(state));
            if queue.is_in(weighted.key(cost, ahead), bucket_key) {
                least = least.min(cost.saturating_add(ahead));
            }
        }
        least
    }

    /// The loop of a pass: the best goal reached below the limit, and why it ended.
    fn expand(
        &mut self,
        weighted: &Weighted,
        limit: u32,
        Workspace { labels, queue }: &mut Workspace,
    ) -> (Option<(u32, u32)>, Ended) {
        let (table, field, patience) = (self.table, self.field, self.query.patience);
        let layout = &table.lattice().layout;
        let stride = table.stride();
        let mut best: Option<(u32, u32)> = None;
        let mut least_total = limit;
        while let Some(state) = queue.pop() {
            let (cost, ahead) = (labels.cost(state), field.units_at(state));
            let key = weighted.key(cost, ahead);
            if !queue.is_current(key) {
                continue;
            }
            if queue.least_key() >= weighted.key(0, least_total) {
                // Put back what proves the bound.
                queue.push(key, state);
                break;
            }
            if self.expanded.is_multiple_of(CLOCK_EVERY) {
                patience.worked(CLOCK_EVERY * work::STATE);
                if patience.is_over() {
                    queue.push(key, state);
                    return (best, Ended::Late);
                }
            }
            if self.expanded == self.most_expanded {
                queue.push(key, state);
                return (best, Ended::Late);
            }
            self.expanded += 1;
            // Only where the field is as low as at a goal is it worth looking the state up.
            if ahead <= self.highest_after
                && let Some(&after) = self.goals.get(&state)
                && cost.saturating_add(after) < least_total
            {
                least_total = cost + after;
                best = Some((least_total, state));
                if !weighted.is_exact() {
                    queue.push(key, state);
                    break;
                }
            }
            if let Some(soon) = queue.peek(CODES_AHEAD) {
                if let Some(codes) = table.codes_at_hand(Layout::tile(soon)) {
                    prefetch(codes, code_place(Layout::within(soon), stride));
                }
                labels.prefetch(soon);
            }
            let Some(codes) = table.state_codes(state, patience) else {
                queue.push(key, state);
                return (best, Ended::Late);
            };
            let moves = &self.moves[(state as usize & (HEADINGS - 1)) * stride..][..stride];
            for (code, step) in codes.iter().zip(moves) {
                if code == FORBIDDEN {
                    continue;
                }
                let next = layout.shift(state, step.shift) | step.heading;
                let total = cost.saturating_add(decode(code));
                if labels.lower(next, total) {
                    let ahead = field.units_at(next);
                    // What cannot beat the best path need not be looked at; nor can what does not lead to the goal.
                    if total.saturating_add(ahead) < least_total {
                        queue.push(weighted.key(total, ahead), next);
                    }
                }
            }
        }
        (best, Ended::Done)
    }

    /// Whether the best path's cost is proven to be within the bound asked for.
    fn is_proven(&self) -> bool {
        let Some(best) = &self.best else { return false };
        best.total <= self.least || self.proven_bound(best).is_some_and(|bound| bound <= self.query.bound)
    }

    /// No path takes less than this when driven, in the objective's unit.
    fn proven_least(&self) -> f64 {
        self.table.proven(f64::from(self.least)) + self.query.besides
    }

    /// The best path's cost over the least possible, where that is above nothing.
    fn proven_bound(&self, best: &Best) -> Option<f64> {
        let least = self.proven_least();
        // What follows at the goal is cut to whole units.
        let most = self.table.at_most(f64::from(best.total) + 1.0) + self.query.besides;
        (least > 0.0).then(|| most / least)
    }

    /// The weight of the pass after one that has not proven the bound asked for: the next of the ladder, or the one that proves
    /// it where the ladder's is next to it or smaller. `None` after the last.
    fn next_weight(&mut self, weight: f64) -> Option<f64> {
        let ladder = WEIGHTS.into_iter().find(|next| *next < weight);
        let sufficient = self.sufficient_weight();
        let is_next = (LEAST_WEIGHT..weight).contains(&sufficient)
            && ladder.is_none_or(|ladder| ladder - 1.0 <= NEXT_TO * (sufficient - 1.0));
        if is_next && !self.tried_sufficient {
            self.tried_sufficient = true;
            return Some(sufficient);
        }
        ladder
    }

    /// The largest weight with which a pass proves the bound asked for, by what is known of the least cost so far: a path costs
    /// at most its weight times the least, C, and
    ///
    /// ```text
    /// (w C + 1) (1 + σ) / U + b ≤ B (q C / U + b)
    /// ```
    ///
    /// with the bound B, `besides` b, units U, and σ and q of the table's rounding.
    fn sufficient_weight(&self) -> f64 {
        let (least, proven) = (f64::from(self.least), self.proven_least());
        let most = self.query.bound * proven - self.query.besides;
        (most / self.table.at_most(1.0) - 1.0) / least.max(1.0)
    }

    fn outcome(self, late: bool) -> Outcome {
        let Some(best) = &self.best else {
            return if late { Outcome::Timeout { expanded: self.expanded } } else { Outcome::Unreachable };
        };
        let optimal = best.total <= self.least;
        let bound = self.proven_bound(best);
        let late = late && !optimal && bound.is_none_or(|bound| bound > self.query.bound);
        let (expanded, start, motions) = (self.expanded, best.start, best.motions.clone());
        Outcome::Found(Found { start, motions, expanded, least: self.proven_least(), bound, optimal, late })
    }
}

/// A weight of the estimate, in whole 1/1024.
struct Weighted(u64);

impl Weighted {
    const ONE: u64 = 1024;

    fn new(weight: f64) -> Self {
        // Rounded down: the smaller weight proves the larger.
        Weighted((weight * Self::ONE as f64) as u64)
    }

    fn is_exact(&self) -> bool {
        self.0 == Self::ONE
    }

    /// Least sum of cost and estimate of a state whose key is at least this: no weight is below 1.
    fn least_sum(&self, key: u32) -> u32 {
        (u64::from(key) * Self::ONE / self.0) as u32
    }

    /// Place in the order of expansion.
    #[inline(always)]
    fn key(&self, cost: u32, ahead: u32) -> u32 {
        let key = u64::from(cost) + (u64::from(ahead) * self.0) / Self::ONE;
        u32::try_from(key).unwrap_or(u32::MAX)
    }
}

/// All motions by heading, `stride` slots each.
fn moves(lattice: &Lattice) -> Vec<Move> {
    let stride = lattice.motions_per_state();
    let mut moves = vec![Move::default(); HEADINGS * stride];
    for (heading, motions) in lattice.motions.iter().enumerate() {
        for (i, motion) in motions.iter().enumerate() {
            let shift = lattice.layout.prepare(motion.columns, motion.rows);
            moves[heading * stride + i] = Move { shift, heading: motion.to.index() as u32 };
        }
    }
    moves
}

/// A workspace for searches over a lattice.
impl Workspace {
    /// An empty one.
    pub fn of(lattice: &Lattice) -> Self {
        Workspace::new(&lattice.layout, BUCKET_SHIFT)
    }
}
