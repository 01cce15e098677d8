//! Least cost from every cell to the goal when headings need not join up.

use terrain::Cell;

use crate::{
    cost::{FORBIDDEN, decode},
    heading::Heading,
    lattice::{Lattice, State},
    layout::{Layout, Shift},
    patience::Patience,
    queue::BucketQueue,
    table::CostTable,
};

/// A lower bound of the cost to the goal, cell by cell.
///
/// Every lattice motion, seen without its headings, is a step between cells; the field is the exact least cost over
/// these steps, each as cheap as its cheapest heading and shape. It never exceeds the true cost and falls along every
/// motion by no more than the motion costs, so A* expands hardly a state twice.
pub struct GoalField {
    /// Ones' complement of the cost in the table's units, by cell of the layout; 0, as fresh memory is, where no chain of
    /// motions leads to the goal. Memory that the field does not reach is never touched.
    complement: Vec<u32>,
    /// Cells that were not settled cost at least this; the largest number when all were.
    floor: u32,
    units: f64,
    layout: Layout,
}

/// Where a field begins and how far it has to reach.
#[derive(Clone, Copy, Debug)]
pub struct FieldEnds<'a> {
    /// Goal cells with the cost that still follows there, in the table's own unit.
    pub goals: &'a [(Cell, f64)],
    /// Cells from which a search will start: the field ends soon after it has reached them. Empty: it covers all.
    pub starts: &'a [Cell],
}

pub(crate) const UNREACHED: u32 = u32::MAX;

/// Cells between two looks at the clock.
const CLOCK_EVERY: u32 = 256;

/// The field goes on beyond the starts by a share of 1/`MARGIN` of their cost, which is about what turning adds to it.
const MARGIN: u32 = 32;

/// Buckets of 2048 units, a thirtieth of a step on level ground.
pub(crate) const BUCKET_SHIFT: u32 = 11;

impl GoalField {
    /// Backward Dijkstra from the goal cells; `None` when patience ends first.
    ///
    /// Beyond where it ends, the cost at which it ended stands for all: the bound stays a bound, and no motion drops it by
    /// more than it costs.
    pub fn new(
        lattice: &Lattice<'_>,
        table: &CostTable<'_>,
        ends: FieldEnds<'_>,
        patience: &Patience,
    ) -> Option<Self> {
        let layout = lattice.layout;
        let backward: Vec<Shift> =
            table.displacements().iter().map(|d| layout.prepare(-d.columns, -d.rows)).collect();
        let mut complement = vec![0u32; layout.cells()];
        let mut queue = BucketQueue::new(BUCKET_SHIFT);
        let position = |cell: Cell| Layout::cell(layout.pack(State { cell, heading: Heading::new(0) }));
        let starts: Vec<usize> = ends.starts.iter().map(|&cell| position(cell)).collect();
        for &(cell, after) in ends.goals {
            let at = position(cell);
            let after = (after * table.units()) as u32;
            if !after > complement[at] {
                complement[at] = !after;
                queue.push(after, (after, at as u32));
            }
        }
        let mut settled = 0u32;
        let mut floor = UNREACHED;
        while let Some((reached, cell)) = queue.pop() {
            if !reached < complement[cell as usize] {
                continue;
            }
            if settled.is_multiple_of(CLOCK_EVERY) {
                if patience.is_over() {
                    return None;
                }
                let farthest = starts.iter().map(|&at| !complement[at]).max().unwrap_or(UNREACHED);
                if queue.least_key() > farthest.saturating_add(farthest / MARGIN) {
                    floor = queue.least_key();
                    break;
                }
            }
            settled += 1;
            let state = Layout::state_of_cell(cell);
            for (i, shift) in backward.iter().enumerate() {
                // Beyond the map the packing wraps round; from there no motion of this displacement stays on it.
                let before = layout.shift(state, *shift);
                let Some(known) = complement.get_mut(Layout::cell(before)) else { continue };
                if *known >= !reached {
                    continue;
                }
                let code = table.least(before, i);
                if code == FORBIDDEN {
                    continue;
                }
                let total = reached.saturating_add(decode(code));
                if !total > *known {
                    *known = !total;
                    queue.push(total, (total, Layout::cell(before) as u32));
                }
            }
        }
        Some(GoalField { complement, floor, units: table.units(), layout })
    }

    /// Lower bound of the cost from a cell to the goal, in the objective's unit; infinite where no chain of motions leads
    /// there.
    pub fn at(&self, cell: Cell) -> f64 {
        match self.units_at(self.layout.pack(State { cell, heading: Heading::new(0) })) {
            UNREACHED => f64::INFINITY,
            units => f64::from(units) / self.units,
        }
    }

    /// The same in the table's units, for a packed state.
    #[inline(always)]
    pub(crate) fn units_at(&self, state: u32) -> u32 {
        (!self.complement[Layout::cell(state)]).min(self.floor)
    }
}
