//! A* over the lattice, with a proof of how good its answer is.

use std::collections::HashMap;

use crate::{
    cost::{FORBIDDEN, decode},
    field::{GoalField, UNREACHED},
    heading::HEADINGS,
    labels::Workspace,
    lattice::{Lattice, State},
    layout::{Layout, Shift},
    patience::Patience,
    prefetch::prefetch,
    queue::BUCKET_SHIFT,
    table::CostTable,
    tile_builder::{QUAD, code_place},
    walk_back::walk_back,
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
    /// By how much it may cost more than the least, in the objective's unit; 0 where it is the least.
    pub excess: f64,
    /// Proven: its cost is at most so many times the least; 1 where it is the least, `None` where the least may be
    /// nothing or a gain, which no factor bounds.
    pub bound: Option<f64>,
    /// Whether patience ended before the bound asked for was proven.
    pub late: bool,
}

/// Weights of the estimate, one pass after the other: the first answers at once, the last with the least cost.
const WEIGHTS: [f64; 3] = [1.2, 1.05, 1.0];
/// Expansions between two looks at the clock, less than a millisecond.
const CLOCK_EVERY: u64 = 2048;
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
    let lattice = table.lattice();
    let units = |amount: f64| (amount * table.units()) as u32;
    let goals: HashMap<u32, u32> =
        query.goals.iter().map(|(state, after)| (lattice.layout.pack(*state), units(*after))).collect();
    let mut passes = Passes {
        table,
        field,
        query,
        moves: moves(lattice),
        highest_after: goals.values().copied().max().unwrap_or(0),
        goals,
        expanded: 0,
        least: 0,
        best: None,
    };
    passes.least =
        query.starts.iter().map(|s| field.units_at(lattice.layout.pack(*s))).min().unwrap_or(UNREACHED);
    if passes.least == UNREACHED {
        return Outcome::Unreachable;
    }
    let loosest = query.bound.max(WEIGHTS[0]);
    let weights = [loosest].into_iter().chain(WEIGHTS[1..].iter().copied());
    for weight in weights {
        let ended = passes.run(weight, workspace);
        if ended == Ended::Late || passes.is_proven() {
            return passes.outcome(ended == Ended::Late);
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
    /// No path costs less than this.
    least: u32,
    best: Option<Best>,
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
        workspace.clear();
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
        // A state that is on the best path and was not expanded at its cost is still in the queue.
        let key = |state| weighted.key(workspace.labels.cost(state), self.field.units_at(state));
        let open = workspace.queue.items(key);
        let open = open.map(|state| workspace.labels.cost(state).saturating_add(self.field.units_at(state)));
        let total = found.map_or(limit, |(total, _)| total.min(limit));
        self.least = self.least.max(open.min().unwrap_or(UNREACHED).min(total));
        if let Some((total, goal)) = found.filter(|(total, _)| *total < limit) {
            let (start, motions) = walk_back(self.table, &workspace.labels, goal);
            self.best = Some(Best { total, start, motions });
        }
        ended
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
            if self.expanded.is_multiple_of(CLOCK_EVERY) && patience.is_over() {
                queue.push(key, state);
                return (best, Ended::Late);
            }
            self.expanded += 1;
            // Only where the field is as low as at a goal is it worth looking the state up.
            if ahead <= self.highest_after
                && let Some(&after) = self.goals.get(&state)
                && cost + after < least_total
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
            let Some(codes) = table.codes(Layout::tile(state), patience) else {
                queue.push(key, state);
                return (best, Ended::Late);
            };
            let codes = &codes[code_place(Layout::within(state), stride)..];
            let moves = &self.moves[(state as usize & (HEADINGS - 1)) * stride..][..stride];
            for (code, step) in codes.iter().step_by(QUAD).zip(moves) {
                if *code == FORBIDDEN {
                    continue;
                }
                let next = layout.shift(state, step.shift) | step.heading;
                let total = cost.saturating_add(decode(*code));
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

    /// The best path's cost over the least possible, where that is above nothing.
    fn proven_bound(&self, best: &Best) -> Option<f64> {
        let whole = |units: u32| f64::from(units) / self.table.units() + self.query.besides;
        let least = whole(self.least);
        (least > 0.0).then(|| whole(best.total) / least)
    }

    fn outcome(self, late: bool) -> Outcome {
        let Some(best) = &self.best else {
            return if late { Outcome::Timeout { expanded: self.expanded } } else { Outcome::Unreachable };
        };
        let is_least = best.total <= self.least;
        let bound = if is_least { Some(1.0) } else { self.proven_bound(best) };
        let excess = f64::from(best.total.saturating_sub(self.least)) / self.table.units();
        let late = late && bound.is_none_or(|bound| bound > self.query.bound);
        let (expanded, start, motions) = (self.expanded, best.start, best.motions.clone());
        Outcome::Found(Found { start, motions, expanded, excess, bound, late })
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
