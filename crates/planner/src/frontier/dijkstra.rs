//! Dijkstra's search over cells and headings, from goals backwards or from starts forwards.

use crate::{
    frontier::{
        labels::{Labels, UNREACHED},
        queue::{BUCKET_SHIFT, BucketQueue},
    },
    grid::{
        cost::{FORBIDDEN, decode},
        heading::HEADINGS,
        layout::{Layout, Shift},
        state::State,
    },
    patience::{Patience, work},
    table::{
        cost_table::CostTable,
        tile_builder::{QUAD, code_place},
    },
};

/// Which costs a search adds up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// From a state to the nearest goal.
    ToGoals,
    /// From the nearest start to a state.
    FromStarts,
}

/// A search that can be left and its cost so far read.
pub(crate) struct Dijkstra<'t> {
    table: &'t CostTable,
    patience: &'t Patience,
    direction: Direction,
    /// Steps of the search by the heading they are taken from.
    steps: [Vec<Step>; HEADINGS],
    queue: BucketQueue,
    /// Least cost of every state reached; of states that were settled, the least of all.
    pub(crate) labels: Labels,
}

/// A motion as the search takes it: from its end where it works backwards.
#[derive(Clone, Copy)]
struct Step {
    shift: Shift,
    heading: u32,
    motion: usize,
}

/// States between two looks at the clock, less than a millisecond.
const CLOCK_EVERY: u64 = 2048;

impl<'t> Dijkstra<'t> {
    /// Seeds come with the cost that lies beyond them, in the table's units; `None` when patience ends first.
    pub(crate) fn new(
        table: &'t CostTable,
        direction: Direction,
        seeds: impl Iterator<Item = (State, u32)>,
        patience: &'t Patience,
    ) -> Option<Self> {
        let layout = &table.lattice().layout;
        let mut labels = Labels::unlogged(layout);
        let mut queue = BucketQueue::new(BUCKET_SHIFT);
        let mut pacer = patience.pacer();
        for (seed, beyond) in seeds {
            pacer.after(work::STATE)?;
            if labels.lower(layout.pack(seed), beyond) {
                queue.push(beyond, layout.pack(seed));
            }
        }
        Some(Dijkstra { table, patience, direction, steps: steps(table, direction), queue, labels })
    }

    /// Settles all states that cost up to `limit`; their labels are the least then. `None` when patience ends first.
    pub(crate) fn settle_within(&mut self, limit: u32) -> Option<()> {
        self.settle(u64::MAX, limit, |_| {})
    }

    /// Settles `at_least` so many states and whatever costs as little as they do. States may be told to `settled` more than
    /// once; when it ends their labels are the least. `None` when patience ends first.
    pub(crate) fn settle_first(&mut self, at_least: u64, settled: impl FnMut(u32)) -> Option<()> {
        self.settle(at_least, UNREACHED, settled)
    }

    fn settle(&mut self, at_least: u64, limit: u32, mut settled: impl FnMut(u32)) -> Option<()> {
        let (mut count, mut last_key) = (0u64, limit);
        while let Some(state) = self.queue.pop() {
            let cost = self.labels.cost(state);
            if !self.queue.is_current(cost) {
                continue;
            }
            if self.queue.least_key() > last_key {
                self.queue.push(cost, state);
                break;
            }
            if count.is_multiple_of(CLOCK_EVERY) {
                self.patience.worked(CLOCK_EVERY * work::STATE);
                if self.patience.is_over() {
                    return None;
                }
            }
            count += 1;
            if count == at_least {
                // The bucket that is being emptied is emptied to its end, so that no label below the next can fall.
                last_key = self.queue.least_key();
            }
            settled(state);
            self.expand(state, cost)?;
        }
        Some(())
    }

    /// Lowers the states a step away from one that costs `cost`.
    #[inline(always)]
    fn expand(&mut self, state: u32, cost: u32) -> Option<()> {
        let layout = &self.table.lattice().layout;
        let stride = self.table.stride();
        for step in &self.steps[state as usize & (HEADINGS - 1)] {
            // Beyond the map the packing wraps round; backwards no such motion stays on the map, forwards none is allowed.
            let next = layout.shift(state, step.shift) | step.heading;
            if Layout::tile(next) >= layout.tiles() || self.labels.cost(next) <= cost {
                continue;
            }
            let driven_from = match self.direction {
                Direction::ToGoals => next,
                Direction::FromStarts => state,
            };
            let codes = self.table.codes(Layout::tile(driven_from), self.patience)?;
            let place = code_place(Layout::within(driven_from), stride) + step.motion * QUAD;
            let code = codes.get(place).copied().unwrap_or(FORBIDDEN);
            let total = cost.saturating_add(decode(code));
            if code != FORBIDDEN && self.labels.lower(next, total) {
                self.queue.push(total, next);
            }
        }
        Some(())
    }

    /// States that were reached and not settled, with the least cost at which steps from settled ones reach them.
    pub(crate) fn open(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        let current =
            |&(state, bucket_key): &(u32, u32)| self.queue.is_in(self.labels.cost(state), bucket_key);
        self.queue.items().filter(current).map(|(state, _)| (state, self.labels.cost(state)))
    }
}

/// Motions by the heading from which the search takes them.
fn steps(table: &CostTable, direction: Direction) -> [Vec<Step>; HEADINGS] {
    let layout = &table.lattice().layout;
    let mut steps = [const { Vec::new() }; HEADINGS];
    for motions in &table.lattice().motions {
        for (motion, m) in motions.iter().enumerate() {
            let (at, to, shift) = match direction {
                Direction::ToGoals => (m.to, m.from, layout.prepare(-m.columns, -m.rows)),
                Direction::FromStarts => (m.from, m.to, layout.prepare(m.columns, m.rows)),
            };
            steps[at.index()].push(Step { shift, heading: to.index() as u32, motion });
        }
    }
    steps
}
