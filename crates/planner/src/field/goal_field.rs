//! Least cost from every cell to the goal when headings need not join up.

use std::collections::BTreeMap;

use terrain::Cell;

use crate::{
    field::growth::Home,
    frontier::labels::UNREACHED,
    grid::{
        heading::{HEADINGS, Heading},
        layout::{HEADING_BITS, Layout, TILE, TILE_CELLS},
        state::State,
    },
    patience::{Patience, work},
    pose_field::near::Near,
    table::{cost_table::CostTable, step_costs::StepCosts},
};

/// A lower bound of the cost to the goal, cell by cell; about a goal with a heading pose by pose.
///
/// Every lattice motion, seen without its headings, is a step between cells; the field is the exact least cost over
/// these steps, each as cheap as its cheapest heading and shape. Where a goal asks for a heading, the poses from which it
/// costs least are worked out exactly and the field begins at their rim, so that it knows of the turn at the end. It never
/// exceeds the true cost and falls along every motion by no more than the motion costs, so A* expands hardly a state twice.
pub struct GoalField {
    /// Ones' complement of the bound in the table's units, by cell of the layout; 0, as fresh memory is, where the field
    /// did not come or no chain of motions leads to the goal. Memory that the field does not reach is never touched.
    pub(crate) complement: Vec<u32>,
    /// Bounds by heading of cells about the goal, whose complements are 0.
    pub(super) near: BTreeMap<u32, [u32; HEADINGS]>,
    pub(super) beyond: Beyond,
    pub(super) units: f64,
    pub(super) costs: StepCosts,
    pub(crate) layout: Layout,
    /// Tiles whose costs it was worked out from.
    pub(super) touched: Vec<bool>,
}

/// Where a field begins and how far it has to reach.
#[derive(Clone, Copy, Debug)]
pub struct FieldEnds<'a> {
    /// Goal poses with the cost that still follows there, in the table's own unit.
    pub goals: &'a [(State, f64)],
    /// The cell from which a search will start: the field grows towards it and ends soon after. `None`: it covers all.
    pub start: Option<Cell>,
}

/// What is known of cells that a field does not hold.
#[derive(Clone, Copy, Debug)]
pub(super) enum Beyond {
    /// No motions lead from there to the goal.
    Unreachable,
    /// Any way from the start to the goal by such a cell costs `floor` at least, of which reaching it takes at least its
    /// distance times the least cost per metre; none costs less than `least`, the rim about the goal.
    Towards { floor: u32, home: Home, least: u32 },
}

impl GoalField {
    /// Backward search from the goal cells, towards the start if there is one; `None` when patience ends first.
    ///
    /// Cells are settled in the order of their cost to the goal and the least that getting there from the start can cost.
    /// Once the start is settled and the order has passed its cost by a margin, at `floor`, every other cell costs `floor`
    /// less its distance from the start at least. The smaller of both bounds is a bound again, and no motion drops it by
    /// more than it costs.
    pub fn new(table: &CostTable, ends: FieldEnds<'_>, patience: &Patience) -> Option<Self> {
        Self::over(table, StepCosts::Least, ends, patience)
    }

    /// The same over what steps are taken to cost. Over bounds of their costs it is a lower bound too, a little less near to the true
    /// cost, in a small part of the time where the costs of motions are not at hand.
    pub(crate) fn over(
        table: &CostTable,
        costs: StepCosts,
        ends: FieldEnds<'_>,
        patience: &Patience,
    ) -> Option<Self> {
        let layout = table.lattice().layout;
        let mut field = GoalField {
            complement: vec![0u32; layout.cells()],
            near: BTreeMap::new(),
            beyond: Beyond::Unreachable,
            units: table.units(),
            costs,
            layout,
            touched: Vec::new(),
        };
        let home = ends.start.map_or(Home::ANYWHERE, |start| Home {
            row: start.row as f32,
            column: start.column as f32,
            rate: table.least_units_per_cell(),
        });
        let near = match Near::matters(ends.goals) {
            true => Some(Near::new(table, ends.goals, patience)?),
            false => None,
        };
        let seeds = match &near {
            Some(near) => near.rim.clone(),
            None => {
                let (mut seeds, mut pacer) = (Vec::with_capacity(ends.goals.len()), patience.pacer());
                for (goal, after) in ends.goals {
                    pacer.after(work::CELL)?;
                    seeds.push((Layout::cell(layout.pack(*goal)), (after * table.units()) as u32));
                }
                seeds
            }
        };
        let mut touched = vec![false; layout.tiles()];
        let start =
            ends.start.map(|cell| Layout::cell(layout.pack(State { cell, heading: Heading::new(0) })));
        if let Some(floor) = field.grow((table, costs), (&seeds, start), &home, &mut touched, patience)? {
            let least = seeds.iter().map(|(_, cost)| *cost).min().unwrap_or(0);
            field.bound_rest(Beyond::Towards { floor, home, least }, &touched, patience)?;
        }
        if let Some(near) = near {
            // Motions lead out of their tiles by no more than a tile.
            let tiles = near.costs.keys().map(|cell| *cell as usize / TILE_CELLS);
            tiles.flat_map(|tile| layout.tiles_around(tile)).for_each(|tile| touched[tile] = true);
            field.take_near(near);
        }
        field.touched = touched;
        Some(field)
    }

    /// Tiles whose costs it was worked out from: where these stay as they are, it does.
    pub(crate) fn touched_tiles(&self) -> impl Iterator<Item = usize> + '_ {
        self.touched.iter().enumerate().filter(|(_, touched)| **touched).map(|(tile, _)| tile)
    }

    /// Lets exact costs stand for the poses that have one; others in the same cells have the field's.
    fn take_near(&mut self, mut near: Near) {
        for (cell, costs) in &mut near.costs {
            let outside = self.units_at(cell << HEADING_BITS);
            for cost in costs.iter_mut().filter(|cost| **cost == UNREACHED) {
                *cost = outside;
            }
            self.complement[*cell as usize] = 0;
        }
        self.near = near.costs;
    }

    /// Lets the bound of unsettled cells stand in the tiles that were touched; elsewhere it is worked out when asked for.
    fn bound_rest(&mut self, beyond: Beyond, touched: &[bool], patience: &Patience) -> Option<()> {
        let mut pacer = patience.pacer();
        let layout = self.layout;
        let tiles = self.complement.chunks_exact_mut(TILE_CELLS).zip(touched).enumerate();
        for (tile, (cells, _)) in tiles.filter(|(_, (_, touched))| **touched) {
            pacer.after(TILE_CELLS as u64 * work::CELL)?;
            let (tile_row, tile_column) = layout.tile_place(tile);
            for (row, cells) in cells.chunks_exact_mut(TILE).enumerate() {
                for (column, cell) in cells.iter_mut().enumerate() {
                    *cell = (*cell).max(!beyond.at(tile_row * TILE + row, tile_column * TILE + column));
                }
            }
        }
        self.beyond = beyond;
        Some(())
    }

    /// What steps cost in it.
    pub(crate) fn costs(&self) -> StepCosts {
        self.costs
    }

    /// Bytes held, memory that was never touched included.
    pub fn bytes(&self) -> usize {
        self.complement.len() * size_of::<u32>()
    }

    /// Lower bound of the cost from a pose to the goal, in the objective's unit; infinite where no chain of motions leads
    /// there.
    pub fn at(&self, state: State) -> f64 {
        match self.units(state) {
            UNREACHED => f64::INFINITY,
            units => f64::from(units) / self.units,
        }
    }

    /// The same in the table's units; the largest number where no chain of motions leads there.
    pub fn units(&self, state: State) -> u32 {
        self.units_at(self.layout.pack(state))
    }

    /// Whether a chain of motions leads to the goal from a cell under some heading.
    pub(crate) fn leads_from(&self, cell: Cell) -> bool {
        let at = Layout::cell(self.layout.pack(State { cell, heading: Heading::new(0) }));
        if self.complement[at] != 0 || matches!(self.beyond, Beyond::Towards { .. }) {
            return true;
        }
        !self.near.is_empty() && Heading::all().any(|heading| self.leads_from_pose(State { cell, heading }))
    }

    /// Whether a chain of motions, whose headings need not join up, leads to the goal from a pose.
    pub(crate) fn leads_from_pose(&self, pose: State) -> bool {
        self.units(pose) != UNREACHED
    }

    /// The same for a packed state.
    #[inline(always)]
    pub(crate) fn units_at(&self, state: u32) -> u32 {
        match self.complement[Layout::cell(state)] {
            0 => self.beyond_at(state),
            complement => !complement,
        }
    }

    #[cold]
    fn beyond_at(&self, state: u32) -> u32 {
        if let Some(costs) = self.near.get(&(Layout::cell(state) as u32)) {
            return costs[state as usize % HEADINGS];
        }
        let (row, column) = self.layout.place(state);
        self.beyond.at(row, column)
    }
}

impl Beyond {
    /// Lower bound of the cost from a cell.
    fn at(&self, row: usize, column: usize) -> u32 {
        match self {
            Beyond::Unreachable => UNREACHED,
            Beyond::Towards { floor, home, least } => {
                (floor - home.away(row, column).min(*floor)).max(*least)
            }
        }
    }
}
