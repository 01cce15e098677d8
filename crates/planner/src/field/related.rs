//! A field of a related planner as a lower bound for this one, so that a change of speed, load or standing power needs no new field.

use std::collections::BTreeMap;

use rayon::prelude::*;
use terrain::Cell;

use crate::{
    field::{
        goal_field::{Beyond, GoalField},
        growth::Home,
    },
    frontier::labels::UNREACHED,
    grid::{
        cost::{ENDLESS, SINGLE_PRECISION},
        layout::{HEADING_BITS, TILE, TILE_CELLS},
        state::State,
    },
    lattice::objective::Objective,
    patience::{Patience, work},
    table::{cost_table::CostTable, relation::Relation, step_costs::StepCosts},
};

/// Lower bounds in one table's units from those in another's.
pub(crate) struct Related<'t> {
    known: &'t CostTable,
    wanted: &'t CostTable,
    relation: Relation,
    /// Box about the goals' cells: first and last row, first and last column.
    goals: [[f32; 2]; 2],
}

/// Units by which whole numbers of them differ from what they stand for, two of them.
const ROUNDED: u32 = 2;

impl<'t> Related<'t> {
    /// Of fields of some goals; `None` where costs of one prove nothing of the other.
    pub(crate) fn new(
        (known, wanted): (&'t CostTable, &'t CostTable),
        objective: Objective,
        goals: &[(State, f64)],
    ) -> Option<Self> {
        let relation = Relation::between(known.lattice(), wanted.lattice(), objective)?;
        let within = |of: fn(Cell) -> usize| {
            let all = || goals.iter().map(|(goal, _)| of(goal.cell) as f32);
            [all().fold(f32::INFINITY, f32::min), all().fold(f32::NEG_INFINITY, f32::max)]
        };
        Some(Related {
            known,
            wanted,
            relation,
            goals: [within(|cell| cell.row), within(|cell| cell.column)],
        })
    }

    /// The bound of a state, in units, from a field of the known table.
    pub(crate) fn units(&self, field: &GoalField, state: State) -> u32 {
        let away_cells = self.away_cells(state.cell.row, state.cell.column);
        self.carried(field.units(state), away_cells)
    }

    /// A field of the known table as one of the wanted; `None` when patience ends first.
    pub(crate) fn field(&self, field: &GoalField, patience: &Patience) -> Option<GoalField> {
        let layout = field.layout;
        let mut complement = vec![0u32; layout.cells()];
        let tiles =
            complement.par_chunks_exact_mut(TILE_CELLS).zip(field.complement.par_chunks_exact(TILE_CELLS));
        tiles.enumerate().filter(|(tile, _)| layout.holds(*tile)).try_for_each(|(tile, (to, from))| {
            if patience.is_over() {
                return None;
            }
            patience.worked(TILE_CELLS as u64 * work::CELL);
            let (tile_row, tile_column) = layout.tile_place(tile);
            for (at, (to, from)) in to.iter_mut().zip(from).enumerate().filter(|(_, (_, from))| **from != 0) {
                let (row, column) = (tile_row * TILE + at / TILE, tile_column * TILE + at % TILE);
                *to = !self.carried(!*from, self.away_cells(row, column));
            }
            Some(())
        })?;
        let near = field.near.iter().map(|(cell, costs)| {
            let (row, column) = layout.place(cell << HEADING_BITS);
            (*cell, costs.map(|units| self.carried(units, self.away_cells(row, column))))
        });
        Some(GoalField {
            complement,
            near: near.collect::<BTreeMap<_, _>>(),
            beyond: self.beyond(&field.beyond),
            units: self.wanted.units(),
            costs: StepCosts::Related,
            layout,
            touched: Vec::new(),
        })
    }

    fn beyond(&self, known: &Beyond) -> Beyond {
        match *known {
            Beyond::Unreachable => Beyond::Unreachable,
            Beyond::Towards { floor, home, least } => {
                // Falls with the distance from the start by no less than the known one does, roundings included.
                let units = self.wanted.fewest_units(self.relation.share * self.known.proven_per_unit());
                let home =
                    Home { rate: (f64::from(home.rate) * units * (1.0 + SINGLE_PRECISION)) as f32, ..home };
                let floor = self.carried(floor, 0.0).saturating_sub(ROUNDED);
                Beyond::Towards { floor, home, least: self.carried(least, 0.0) }
            }
        }
    }

    /// Units of a bound that is so many units in the known table, so far from the goals.
    #[inline(always)]
    fn carried(&self, units: u32, away_cells: f32) -> u32 {
        if units == UNREACHED {
            return UNREACHED;
        }
        let Relation { share, per_m } = self.relation;
        let away_m = f64::from(away_cells) * self.wanted.lattice().terrain.grid.cell_size_m;
        let amount = share * self.known.proven(f64::from(units)) + per_m * away_m;
        (self.wanted.fewest_units(amount) as u32).min(ENDLESS - 1)
    }

    /// Distance of a cell from the goals at least.
    #[inline(always)]
    fn away_cells(&self, row: usize, column: usize) -> f32 {
        let outside = |at: usize, [first, last]: [f32; 2]| (first - at as f32).max(at as f32 - last).max(0.0);
        let [rows, columns] = self.goals;
        let (rows, columns) = (outside(row, rows), outside(column, columns));
        (rows * rows + columns * columns).sqrt() * (1.0 - f32::EPSILON)
    }
}
