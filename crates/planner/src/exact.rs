//! Least cost to a goal from every state: from it any plan is only a walk.

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

/// The exact cost to a goal from every cell and heading, for goals that are asked for again and again.
pub struct ExactField {
    labels: Labels,
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

impl ExactField {
    /// Backward Dijkstra over all states that lead to the goals; `None` when patience ends first.
    ///
    /// `goals` come with the cost that still follows there, in the objective's unit.
    pub fn new(table: &CostTable, goals: &[(State, f64)], patience: &Patience) -> Option<Self> {
        let layout = &table.lattice().layout;
        let backward = backward(table);
        let stride = table.stride();
        let mut labels = Labels::unlogged(layout);
        let mut queue = BucketQueue::new(BUCKET_SHIFT);
        for &(goal, after) in goals {
            let after = (after * table.units()) as u32;
            if labels.lower(layout.pack(goal), after) {
                queue.push(after, layout.pack(goal));
            }
        }
        let mut settled = 0u64;
        while let Some(state) = queue.pop() {
            let cost = labels.cost(state);
            if !queue.is_current(cost) {
                continue;
            }
            if settled.is_multiple_of(CLOCK_EVERY) && patience.is_over() {
                return None;
            }
            settled += 1;
            for back in &backward[state as usize & (HEADINGS - 1)] {
                // Beyond the map the packing wraps round; from there no such motion stays on it.
                let before = layout.shift(state, back.shift) | back.heading;
                if Layout::tile(before) >= layout.tiles() || labels.cost(before) <= cost {
                    continue;
                }
                let codes = table.codes(Layout::tile(before), patience)?;
                let place = Layout::within(before) * stride + back.motion;
                let code = codes.get(place).copied().unwrap_or(FORBIDDEN);
                let total = cost.saturating_add(decode(code));
                if code != FORBIDDEN && labels.lower(before, total) {
                    queue.push(total, before);
                }
            }
        }
        Some(ExactField { labels })
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.labels.bytes()
    }

    /// The best start and the motions from it to the goal; `None` where no motions lead there.
    pub fn walk(&self, table: &CostTable, starts: &[State]) -> Option<(State, Vec<usize>)> {
        let lattice = table.lattice();
        let cost = |state: State| self.labels.cost(lattice.layout.pack(state));
        let start = starts.iter().copied().min_by_key(|start| cost(*start))?;
        if cost(start) == UNREACHED {
            return None;
        }
        let (mut state, mut motions) = (start, Vec::new());
        let mut ahead = cost(state);
        loop {
            let packed = lattice.layout.pack(state);
            let ways = (0..lattice.motions_per_state()).filter_map(|motion| {
                let code = table.code(packed, motion);
                let next = lattice.successor(state, motion).filter(|_| code != FORBIDDEN)?;
                let total = cost(next).saturating_add(decode(code));
                (total <= ahead && cost(next) < ahead).then_some((total, cost(next), next, motion))
            });
            // At a goal no motion gets any nearer.
            let Some((_, less, next, motion)) = ways.min_by_key(|(total, ..)| *total) else { break };
            motions.push(motion);
            (state, ahead) = (next, less);
        }
        Some((start, motions))
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
