//! Dijkstra's search from goals backwards over cells and headings.

use crate::{
    cost::{FORBIDDEN, decode},
    field::UNREACHED,
    heading::HEADINGS,
    labels::Labels,
    lattice::State,
    layout::{Layout, Shift},
    patience::Patience,
    queue::{BUCKET_SHIFT, BucketQueue},
    table::CostTable,
};

/// A search that can be left and its cost so far read.
pub(crate) struct Backward<'t> {
    table: &'t CostTable,
    patience: &'t Patience,
    motions: [Vec<Back>; HEADINGS],
    queue: BucketQueue,
    /// Least cost to a goal of every state reached; of states that were settled, the least of all.
    pub(crate) labels: Labels,
}

/// A motion seen from its end.
#[derive(Clone, Copy)]
struct Back {
    shift: Shift,
    heading: u32,
    motion: usize,
}

/// States between two looks at the clock, less than a millisecond.
const CLOCK_EVERY: u64 = 2048;

impl<'t> Backward<'t> {
    /// Goals come with the cost that still follows there, in the objective's unit.
    pub(crate) fn new(table: &'t CostTable, goals: &[(State, f64)], patience: &'t Patience) -> Self {
        let layout = &table.lattice().layout;
        let mut labels = Labels::unlogged(layout);
        let mut queue = BucketQueue::new(BUCKET_SHIFT);
        for &(goal, after) in goals {
            let after = (after * table.units()) as u32;
            if labels.lower(layout.pack(goal), after) {
                queue.push(after, layout.pack(goal));
            }
        }
        Backward { table, patience, motions: backward(table), queue, labels }
    }

    /// Settles all states, or `at_least` and whatever costs as little as they do. States may be told to `settled` more than
    /// once; when it ends their labels are the least. `None` when patience ends first.
    pub(crate) fn settle(&mut self, at_least: u64, mut settled: impl FnMut(u32)) -> Option<()> {
        let layout = &self.table.lattice().layout;
        let stride = self.table.stride();
        let (mut count, mut last_key) = (0u64, UNREACHED);
        while let Some(state) = self.queue.pop() {
            let cost = self.labels.cost(state);
            if !self.queue.is_current(cost) {
                continue;
            }
            if self.queue.least_key() > last_key {
                self.queue.push(cost, state);
                break;
            }
            if count.is_multiple_of(CLOCK_EVERY) && self.patience.is_over() {
                return None;
            }
            count += 1;
            if count == at_least {
                // The bucket that is being emptied is emptied to its end, so that no label below the next can fall.
                last_key = self.queue.least_key();
            }
            settled(state);
            for back in &self.motions[state as usize & (HEADINGS - 1)] {
                // Beyond the map the packing wraps round; from there no such motion stays on it.
                let before = layout.shift(state, back.shift) | back.heading;
                if Layout::tile(before) >= layout.tiles() || self.labels.cost(before) <= cost {
                    continue;
                }
                let codes = self.table.codes(Layout::tile(before), self.patience)?;
                let place = Layout::within(before) * stride + back.motion;
                let code = codes.get(place).copied().unwrap_or(FORBIDDEN);
                let total = cost.saturating_add(decode(code));
                if code != FORBIDDEN && self.labels.lower(before, total) {
                    self.queue.push(total, before);
                }
            }
        }
        Some(())
    }

    /// States that were reached and not settled, with the least cost at which motions to settled ones leave them.
    pub(crate) fn open(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        let cost = |state| self.labels.cost(state);
        self.queue.items(cost).map(move |state| (state, cost(state)))
    }
}

/// Motions by the heading they end in.
fn backward(table: &CostTable) -> [Vec<Back>; HEADINGS] {
    let lattice = table.lattice();
    let mut backward = [const { Vec::new() }; HEADINGS];
    for motions in &lattice.motions {
        for (motion, m) in motions.iter().enumerate() {
            let shift = lattice.layout.prepare(-m.columns, -m.rows);
            let heading = m.from.index() as u32;
            backward[m.to.index()].push(Back { shift, heading, motion });
        }
    }
    backward
}
