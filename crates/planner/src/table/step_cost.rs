//! Steps between cells with their costs and the bounds of them, for comparisons of the two.

use terrain::Cell;

use crate::{
    grid::{
        cost::{FORBIDDEN, decode},
        heading::Heading,
        layout::{HEADING_BITS, Layout, TILE_CELLS},
        state::State,
    },
    patience::Patience,
    table::{cost_table::CostTable, tile_builder::LANES},
};

/// What a step from one cell to another costs, whatever the heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepCost {
    /// The cell that it leads from.
    pub from: Cell,
    /// Columns to the east.
    pub columns: i32,
    /// Rows to the north.
    pub rows: i32,
    /// Cost of the cheapest motion.
    pub least_units: Option<u32>,
    /// A lower bound of it.
    pub bound_units: Option<u32>,
}

impl CostTable {
    /// Steps that motions make from the cells of the tile about a cell, with what each costs at least and the lower bound of it
    /// that fields grow over, in the table's units; `None` where no motion makes the step, or none is known to.
    pub fn steps_about(&self, cell: Cell) -> Vec<StepCost> {
        let layout = &self.lattice().layout;
        let tile = Layout::tile(layout.pack(State { cell, heading: Heading::new(0) }));
        let patience = Patience::default();
        // Once least costs are known they stand for bounds.
        let (Some(bounds), Some(least)) = (self.bounds(tile, &patience), self.least(tile, &patience)) else {
            return Vec::new();
        };
        let count = self.displacements().len().max(1);
        let mut steps = Vec::with_capacity(least.len() * LANES);
        for (place, (least, bounds)) in least.iter().zip(&bounds[..]).enumerate() {
            let (group, step) = (place / count, &self.displacements()[place % count]);
            for (x, (least, bound)) in least.0.into_iter().zip(bounds.0).enumerate() {
                let within = ((group * LANES + x) << HEADING_BITS) as u32;
                let (row, column) = layout.place(((tile * TILE_CELLS) << HEADING_BITS) as u32 | within);
                let units = |code| (code != FORBIDDEN).then(|| decode(code));
                steps.push(StepCost {
                    from: Cell { row, column },
                    columns: step.columns,
                    rows: step.rows,
                    least_units: units(least),
                    bound_units: units(bound),
                });
            }
        }
        steps
    }

    /// Whether steps have bounds below their costs, which are known sooner, on ground of one kind.
    pub fn has_bounds(&self) -> bool {
        self.bound_kernel(&Patience::default()).flatten().is_some()
    }
}
