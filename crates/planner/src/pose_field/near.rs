//! The exact cost to a goal from the poses about it, where the heading that is asked for decides.

use std::collections::BTreeMap;

use crate::{
    frontier::{
        dijkstra::{Dijkstra, Direction},
        labels::UNREACHED,
    },
    grid::{heading::HEADINGS, layout::Layout, state::State},
    patience::{Patience, work},
    table::cost_table::CostTable,
};

/// Least costs of the poses that cost least, and what they cost to reach from the poses about those.
///
/// A field by cells knows no headings, so by itself it tells a search nothing of the turn that a goal with a heading asks
/// for. With the turn driven backwards from the goal, over the ground as it is, and the field grown from the rim of that,
/// it does: everything outside gets there by the rim.
pub(crate) struct Near {
    /// In the table's units, by cell of the layout and heading; [`UNREACHED`] for poses that were not settled.
    pub(crate) costs: BTreeMap<u32, [u32; HEADINGS]>,
    /// Cells of the layout about them with the least cost to the goal by a motion to a settled pose.
    pub(crate) rim: Vec<(usize, u32)>,
}

/// Poses to settle: half a turn with room about it. A quarter as many leave a search on level ground up to twice as many
/// expansions, four times as many spare hardly any and take four times as long.
const POSES: u64 = 1 << 12;

impl Near {
    /// Whether goals leave any heading out, so that turning there matters.
    pub(crate) fn matters(goals: &[(State, f64)]) -> bool {
        let mut missing = (1u32 << HEADINGS) - 1;
        !goals.iter().any(|(goal, _)| {
            missing &= !(1 << goal.heading.index());
            missing == 0
        })
    }

    /// Works back from goals, given with what follows there in the objective's unit; `None` when patience ends first.
    pub(crate) fn new(table: &CostTable, goals: &[(State, f64)], patience: &Patience) -> Option<Self> {
        let goals = goals.iter().map(|(goal, after)| (*goal, (after * table.units()) as u32));
        let mut search = Dijkstra::new(table, Direction::ToGoals, goals, patience)?;
        let mut settled = Vec::new();
        search.settle_first(POSES, |state| settled.push(state))?;
        let (mut costs, mut pacer) = (BTreeMap::new(), patience.pacer());
        for state in settled {
            pacer.after(work::STATE)?;
            let cell = costs.entry(Layout::cell(state) as u32).or_insert([UNREACHED; HEADINGS]);
            cell[state as usize % HEADINGS] = search.labels.cost(state);
        }
        let mut rim = Vec::new();
        for (state, cost) in search.open() {
            pacer.after(work::STATE)?;
            rim.push((Layout::cell(state), cost));
        }
        drop(pacer);
        Some(Near { costs, rim })
    }
}
