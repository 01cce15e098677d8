//! Least cost from every cell to the goal when headings need not join up.

use crate::{
    cost::{FORBIDDEN, decode},
    footprint::shifted,
    heading::{HEADINGS, Heading},
    lattice::{Lattice, State},
    layout::Layout,
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
    /// In the table's units, by row-major cell; [`UNREACHED`] where no chain of motions leads to the goal.
    cost: Vec<u32>,
    units: f64,
}

pub(crate) const UNREACHED: u32 = u32::MAX;

impl GoalField {
    /// Backward Dijkstra from goal cells with the cost that still follows there, in the table's own unit.
    ///
    /// `None` when patience ends first.
    pub fn new(
        lattice: &Lattice<'_>,
        table: &CostTable<'_>,
        goals: &[(usize, f64)],
        patience: &Patience,
    ) -> Option<Self> {
        let grid = &lattice.terrain.grid;
        let steps = steps_by_displacement(lattice);
        let mut cost = vec![UNREACHED; grid.cells()];
        let mut queue = BucketQueue::new(BUCKET_SHIFT);
        for &(cell, after) in goals {
            let after = (after * table.units()) as u32;
            if after < cost[cell] {
                cost[cell] = after;
                queue.push(after, (after, cell as u32));
            }
        }
        let stride = table.stride();
        let mut settled = 0u32;
        while let Some((reached, index)) = queue.pop() {
            if reached > cost[index as usize] {
                continue;
            }
            if settled.is_multiple_of(CLOCK_EVERY) && patience.is_over() {
                return None;
            }
            settled += 1;
            let cell = grid.cell(index as usize);
            for (displacement, motions) in &steps {
                let back = (-displacement.0, -displacement.1);
                let Some(before) = shifted(lattice.terrain, cell, back) else { continue };
                let packed = lattice.layout.pack(State { cell: before, heading: Heading::new(0) });
                let codes =
                    &table.tile(Layout::tile(packed))[Layout::within(packed) * stride..][..HEADINGS * stride];
                let least = motions.iter().map(|&slot| codes[slot]).min().unwrap_or(FORBIDDEN);
                if least == FORBIDDEN {
                    continue;
                }
                let total = reached.saturating_add(decode(least));
                let before = grid.index(before);
                if total < cost[before] {
                    cost[before] = total;
                    queue.push(total, (total, before as u32));
                }
            }
        }
        Some(GoalField { cost, units: table.units() })
    }

    /// Least cost from a cell to the goal, in the objective's unit; infinite where no chain of motions leads there.
    pub fn at(&self, cell: usize) -> f64 {
        match self.cost[cell] {
            UNREACHED => f64::INFINITY,
            units => f64::from(units) / self.units,
        }
    }

    /// The same in the table's units.
    #[inline(always)]
    pub(crate) fn units_at(&self, cell: usize) -> u32 {
        self.cost[cell]
    }
}

/// Cells between two looks at the clock.
const CLOCK_EVERY: u32 = 1024;

/// Buckets of 2048 units, a thirtieth of a step on level ground.
pub(crate) const BUCKET_SHIFT: u32 = 11;

/// Motions that change the cell, as slots of a cell's codes, collected by the displacement they make.
type Displacements = Vec<((i32, i32), Vec<usize>)>;

fn steps_by_displacement(lattice: &Lattice<'_>) -> Displacements {
    let stride = lattice.motions_per_state().next_multiple_of(4);
    let mut steps = std::collections::BTreeMap::<(i32, i32), Vec<usize>>::new();
    for heading in Heading::all() {
        for (index, motion) in lattice.motions[heading.index()].iter().enumerate() {
            if (motion.columns, motion.rows) != (0, 0) {
                let slot = heading.index() * stride + index;
                steps.entry((motion.columns, motion.rows)).or_default().push(slot);
            }
        }
    }
    steps.into_iter().collect()
}
