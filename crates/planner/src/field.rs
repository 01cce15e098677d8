//! Least cost from every cell to the goal when headings need not join up.

use terrain::Cell;

use crate::{
    growth::Home,
    heading::Heading,
    lattice::State,
    layout::{Layout, TILE, TILE_CELLS},
    patience::Patience,
    table::CostTable,
};

/// A lower bound of the cost to the goal, cell by cell.
///
/// Every lattice motion, seen without its headings, is a step between cells; the field is the exact least cost over
/// these steps, each as cheap as its cheapest heading and shape. It never exceeds the true cost and falls along every
/// motion by no more than the motion costs, so A* expands hardly a state twice.
pub struct GoalField {
    /// Ones' complement of the bound in the table's units, by cell of the layout; 0, as fresh memory is, where the field
    /// did not come or no chain of motions leads to the goal. Memory that the field does not reach is never touched.
    pub(crate) complement: Vec<u32>,
    beyond: Beyond,
    units: f64,
    pub(crate) layout: Layout,
}

/// Where a field begins and how far it has to reach.
#[derive(Clone, Copy, Debug)]
pub struct FieldEnds<'a> {
    /// Goal cells with the cost that still follows there, in the table's own unit.
    pub goals: &'a [(Cell, f64)],
    /// The cell from which a search will start: the field grows towards it and ends soon after. `None`: it covers all.
    pub start: Option<Cell>,
}

/// What is known of cells that a field does not hold.
#[derive(Clone, Copy, Debug)]
enum Beyond {
    /// No motions lead from there to the goal.
    Unreachable,
    /// Any way from the start to the goal by such a cell costs `floor` at least, of which reaching it takes at least its
    /// distance times the least cost per metre.
    Towards { floor: u32, home: Home },
}

pub(crate) const UNREACHED: u32 = u32::MAX;

impl GoalField {
    /// Backward search from the goal cells, towards the start if there is one; `None` when patience ends first.
    ///
    /// Cells are settled in the order of their cost to the goal and the least that getting there from the start can cost.
    /// Once the start is settled and the order has passed its cost by a margin, at `floor`, every other cell costs `floor`
    /// less its distance from the start at least. The smaller of both bounds is a bound again, and no motion drops it by
    /// more than it costs.
    pub fn new(table: &CostTable, ends: FieldEnds<'_>, patience: &Patience) -> Option<Self> {
        let layout = table.lattice().layout;
        let mut field = GoalField {
            complement: vec![0u32; layout.cells()],
            beyond: Beyond::Unreachable,
            units: table.units(),
            layout,
        };
        let home = ends.start.map_or(Home::ANYWHERE, |start| Home {
            row: start.row as f32,
            column: start.column as f32,
            rate: table.least_units_per_cell(),
        });
        let mut touched = vec![false; layout.tiles()];
        if let Some(floor) = field.grow(table, &ends, &home, &mut touched, patience)? {
            field.bound_rest(floor, home, &touched);
        }
        Some(field)
    }

    /// Lets the bound of unsettled cells stand in the tiles that were touched; elsewhere it is worked out when asked for.
    fn bound_rest(&mut self, floor: u32, home: Home, touched: &[bool]) {
        let layout = self.layout;
        let tiles = self.complement.chunks_exact_mut(TILE_CELLS).zip(touched).enumerate();
        for (tile, (cells, _)) in tiles.filter(|(_, (_, touched))| **touched) {
            let (tile_row, tile_column) = layout.tile_place(tile);
            for (row, cells) in cells.chunks_exact_mut(TILE).enumerate() {
                for (column, cell) in cells.iter_mut().enumerate() {
                    let away = home.away(tile_row * TILE + row, tile_column * TILE + column);
                    *cell = (*cell).max(!(floor - away.min(floor)));
                }
            }
        }
        self.beyond = Beyond::Towards { floor, home };
    }

    /// Bytes held, memory that was never touched included.
    pub fn bytes(&self) -> usize {
        self.complement.len() * size_of::<u32>()
    }

    /// Lower bound of the cost from a cell to the goal, in the objective's unit; infinite where no chain of motions leads
    /// there.
    pub fn at(&self, cell: Cell) -> f64 {
        match self.units_at(self.layout.pack(State { cell, heading: Heading::new(0) })) {
            UNREACHED => f64::INFINITY,
            units => f64::from(units) / self.units,
        }
    }

    /// The same in the table's units; the largest number where no chain of motions leads there.
    pub fn units(&self, cell: Cell) -> u32 {
        self.units_at(self.layout.pack(State { cell, heading: Heading::new(0) }))
    }

    /// The same in the table's units, for a packed state.
    #[inline(always)]
    pub(crate) fn units_at(&self, state: u32) -> u32 {
        match self.complement[Layout::cell(state)] {
            0 => self.beyond_at(state),
            complement => !complement,
        }
    }

    #[cold]
    fn beyond_at(&self, state: u32) -> u32 {
        match self.beyond {
            Beyond::Unreachable => UNREACHED,
            Beyond::Towards { floor, home } => {
                let (row, column) = self.layout.place(state);
                floor - home.away(row, column).min(floor)
            }
        }
    }
}
