//! Costs of steps between cells as a field grows over them, tile by tile.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::{
    patience::Patience,
    table::{
        cost_table::CostTable,
        tile_builder::{Lanes, Least},
    },
};

/// What a field takes steps between cells to cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StepCosts {
    /// The least cost of any motion that makes them, which the table holds.
    Least,
    /// A lower bound of it, for which heights are enough on most ground.
    Bounds,
    /// What a field of another planner proves of it, which is tried before bounds.
    Related,
}

/// Bound from which on a field over bounds of costs serves the first search as well: with a smaller one a search expands so many more
/// states that, asked again, it takes several times as long.
const LOOSE_BOUND: f64 = 1.05;
/// Bound from which on it serves many searches, on steep ground too, where it is farthest from the true cost.
const LOOSE_BOUND_OF_MANY: f64 = 1.2;

impl StepCosts {
    /// What a search that is to prove a bound goes by, in the order in which it is tried.
    pub(crate) fn that_prove(bound: f64) -> &'static [Self] {
        const WITH_BOUNDS: [StepCosts; 2] = [StepCosts::Bounds, StepCosts::Least];
        if bound >= LOOSE_BOUND { &WITH_BOUNDS } else { &WITH_BOUNDS[1..] }
    }

    /// What a field grows over that is to serve many searches.
    pub(crate) fn for_many(self, bound: f64) -> Self {
        if bound >= LOOSE_BOUND_OF_MANY { self } else { StepCosts::Least }
    }
}

/// The costs that a field needs while it grows.
pub(crate) struct GrowingCosts<'t> {
    table: &'t CostTable,
    costs: StepCosts,
    /// Bounds of tiles, with when they were last taken up.
    bounds: BTreeMap<usize, (u64, Least)>,
    taken: u64,
}

/// Tiles whose bounds are held at a time, 40 MB: more than a front passes through at once on maps of 2000 by 2000 cells.
const TILES_HELD: usize = 128;

impl<'t> GrowingCosts<'t> {
    pub(crate) fn new(table: &'t CostTable, costs: StepCosts) -> Self {
        GrowingCosts { table, costs, bounds: BTreeMap::new(), taken: 0 }
    }

    /// The costs of steps from the cells of some tiles; `None` when patience ends first.
    pub(crate) fn of(&mut self, tiles: &[usize], patience: &Patience) -> Option<Vec<&[Lanes]>> {
        if self.costs == StepCosts::Least {
            return tiles.iter().map(|tile| self.table.least(*tile, patience)).collect();
        }
        self.taken += 1;
        let (table, taken) = (self.table, self.taken);
        let missing: Vec<usize> =
            tiles.iter().copied().filter(|tile| !self.bounds.contains_key(tile)).collect();
        let found =
            missing.par_iter().map(|tile| table.bounds(*tile, patience)).collect::<Option<Vec<_>>>()?;
        self.bounds.extend(missing.into_iter().zip(found.into_iter().map(|bounds| (taken, bounds))));
        for tile in tiles {
            if let Some((when, _)) = self.bounds.get_mut(tile) {
                *when = taken;
            }
        }
        while self.bounds.len() > TILES_HELD {
            let oldest = self.bounds.iter().min_by_key(|(_, (when, _))| *when).map(|(tile, _)| *tile);
            oldest.and_then(|tile| self.bounds.remove(&tile));
        }
        tiles.iter().map(|tile| self.bounds.get(tile).map(|(_, bounds)| &bounds[..])).collect()
    }
}
