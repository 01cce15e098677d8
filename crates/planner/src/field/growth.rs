//! How a goal field grows: tile by tile, in the order of the least cost at which anything in them may still fall.

use std::collections::BTreeSet;

use rayon::prelude::*;

use crate::{
    field::{front::Front, goal_field::GoalField, stencil::Stencil, sweep::Sweep},
    frontier::labels::UNREACHED,
    grid::{
        cost::ENDLESS,
        layout::{HEADING_BITS, TILE, TILE_CELLS},
    },
    patience::{Patience, work},
    table::{
        cost_table::CostTable,
        step_costs::{GrowingCosts, StepCosts},
    },
};

/// A start and the least cost of getting away from it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Home {
    pub(crate) row: f32,
    pub(crate) column: f32,
    /// Units per cell of distance.
    pub(crate) rate: f32,
}

impl Home {
    /// Nowhere in particular: everything is reached for nothing.
    pub(crate) const ANYWHERE: Home = Home { row: 0.0, column: 0.0, rate: 0.0 };

    /// Least cost from the start to a cell.
    #[inline(always)]
    pub(crate) fn away(&self, row: usize, column: usize) -> u32 {
        let (rows, columns) = (row as f32 - self.row, column as f32 - self.column);
        ((rows * rows + columns * columns).sqrt() * self.rate) as u32
    }
}

/// A field goes on beyond the start by a share of 1/`MARGIN` of its cost, which is about what turning adds to it.
const MARGIN: u32 = 32;
/// Tiles that are settled at the same time, each as if the others stayed as they were; what they change is looked at again
/// from tile to tile. The number is the same on every machine, so that a field is.
const ABREAST: usize = 6;

impl GoalField {
    /// Settles tiles from cells whose cost is known on, until the start is settled; `Some(None)` when all were, `Some(floor)`
    /// when it ended before.
    pub(crate) fn grow(
        &mut self,
        (table, costs): (&CostTable, StepCosts),
        (known, start): (&[(usize, u32)], Option<usize>),
        home: &Home,
        touched: &mut [bool],
        patience: &Patience,
    ) -> Option<Option<u32>> {
        let mut costs = GrowingCosts::new(table, costs);
        let mut front = Front::new(self.layout.tiles());
        let mut goals = BTreeSet::new();
        let mut pacer = patience.pacer();
        for &(at, cost) in known {
            pacer.after(work::STATE)?;
            if cost < ENDLESS && !cost > self.complement[at] {
                self.complement[at] = !cost;
                goals.insert(at);
                let (row, column) = self.layout.place((at << HEADING_BITS) as u32);
                let key = cost.saturating_add(home.away(row, column));
                front.note(at / TILE_CELLS, key, |change| change.seeded = true);
            }
        }
        drop(pacer);
        let mut sweeps: Vec<Sweep> =
            (0..ABREAST).map(|_| Sweep::new(Stencil::new(table.displacements()))).collect();
        loop {
            let farthest = start.map_or(UNREACHED, |at| !self.complement[at]);
            let taken = match front.pop_within(farthest.saturating_add(farthest / MARGIN), ABREAST) {
                Ok(taken) if taken.is_empty() => return Some(None),
                Ok(taken) => taken,
                Err(key) => return Some(Some(key)),
            };
            let tiles: Vec<usize> = taken.iter().map(|(tile, _)| *tile).collect();
            let least = costs.of(&tiles, patience)?;
            let field = &*self;
            taken.par_iter().zip(&mut sweeps).zip(least).try_for_each(
                |(((tile, change), sweep), least)| {
                    if patience.is_over() {
                        return None;
                    }
                    field.load(*tile, sweep);
                    sweep.take_up(change);
                    let cells = if change.seeded { tile * TILE_CELLS..(tile + 1) * TILE_CELLS } else { 0..0 };
                    goals.range(cells).for_each(|at| sweep.seed(at % TILE_CELLS / TILE, at % TILE));
                    sweep.settle(least);
                    patience.worked(sweep.take_work());
                    Some(())
                },
            )?;
            for ((tile, _), sweep) in taken.iter().zip(&mut sweeps) {
                touched[*tile] = true;
                self.store(*tile, sweep);
                self.pass_on(*tile, sweep, home, &mut front);
                sweep.fallen = [0; TILE];
            }
        }
    }

    /// Copies the costs of a tile and around it.
    fn load(&self, tile: usize, sweep: &mut Sweep) {
        let (tile_row, tile_column) = self.layout.tile_place(tile);
        let (reach, width) = (sweep.reach(), sweep.width());
        sweep.costs.fill(ENDLESS);
        let (first_row, first_column) = (tile_row * TILE, tile_column * TILE);
        let columns = first_column.saturating_sub(reach)
            ..(first_column + TILE + reach).min(self.layout.tile_columns * TILE);
        for row in
            first_row.saturating_sub(reach)..(first_row + TILE + reach).min(self.layout.tile_rows * TILE)
        {
            let mut column = columns.start;
            while column < columns.end {
                let end = (column / TILE + 1) * TILE;
                let count = end.min(columns.end) - column;
                let from = self.layout.tile_at(row / TILE, column / TILE) * TILE_CELLS
                    + row % TILE * TILE
                    + column % TILE;
                let to = (row + reach - first_row) * width + column + reach - first_column;
                let (known, costs) = (&self.complement[from..from + count], &mut sweep.costs[to..to + count]);
                for (cost, known) in costs.iter_mut().zip(known) {
                    *cost = (!known).min(ENDLESS);
                }
                column += count;
            }
        }
    }

    /// Copies back what has fallen.
    fn store(&mut self, tile: usize, sweep: &Sweep) {
        let cells = &mut self.complement[tile * TILE_CELLS..][..TILE_CELLS];
        for (row, cells) in
            cells.chunks_exact_mut(TILE).enumerate().filter(|(row, _)| sweep.fallen[*row] != 0)
        {
            let costs = &sweep.costs[sweep.place(row)..][..TILE];
            for (cell, cost) in cells.iter_mut().zip(costs) {
                *cell = if *cost < ENDLESS { !cost } else { *cell };
            }
        }
    }

    /// Has tiles around looked at as far as they depend on what has fallen.
    fn pass_on(&self, tile: usize, sweep: &Sweep, home: &Home, front: &mut Front) {
        let layout = &self.layout;
        let place = layout.tile_place(tile);
        let far = sweep.reach().div_ceil(TILE) as isize;
        for (rows, columns) in (-far..=far).flat_map(|rows| (-far..=far).map(move |columns| (rows, columns)))
        {
            let row = place.0.checked_add_signed(rows).filter(|row| *row < layout.tile_rows);
            let column = place.1.checked_add_signed(columns).filter(|column| *column < layout.tile_columns);
            let (Some(row), Some(column)) = (row, column) else { continue };
            if (rows, columns) == (0, 0) {
                continue;
            }
            let (changed, key) = fallen_towards((rows, columns), place, sweep, home);
            if changed != 0 {
                front.note(layout.tile_at(row, column), key, |change| {
                    if far > 1 {
                        change.whole = true;
                    } else {
                        // Seen from there, this tile lies the other way.
                        change.around[(4 - 3 * rows - columns) as usize] |= changed;
                    }
                });
            }
        }
    }
}

/// Rows or, towards another row of tiles, columns of a tile that have fallen within reach of a neighbour, and their least key.
fn fallen_towards(
    (rows, columns): (isize, isize),
    (tile_row, tile_column): (usize, usize),
    sweep: &Sweep,
    home: &Home,
) -> (u64, u32) {
    let reach = sweep.reach().min(TILE);
    let near_rows = [0..reach, 0..TILE, TILE - reach..TILE][(rows.signum() + 1) as usize].clone();
    let cells = u64::MAX;
    let near_columns = match columns.signum() {
        -1 => cells.checked_shr((TILE - reach) as u32),
        0 => Some(cells),
        _ => cells.checked_shl((TILE - reach) as u32),
    }
    .unwrap_or(0);
    let (mut changed, mut key) = (0, UNREACHED);
    for row in near_rows {
        let mut fallen = sweep.fallen[row] & near_columns;
        changed |= if rows == 0 { u64::from(fallen != 0) << row } else { fallen };
        let costs = &sweep.costs[sweep.place(row)..][..TILE];
        while fallen != 0 {
            let column = fallen.trailing_zeros() as usize;
            fallen &= fallen - 1;
            let away = home.away(tile_row * TILE + row, tile_column * TILE + column);
            key = key.min(costs[column].saturating_add(away));
        }
    }
    (changed, key)
}
