//! Least costs within one tile, given those around it: rows of cells side by side, upwards and downwards until nothing falls.

use multiversion::multiversion;

use crate::{
    field::{
        front::Change,
        stencil::{RowSteps, Side, Stencil},
    },
    frontier::prefetch::prefetch,
    grid::{
        cost::{ENDLESS, decode_lanes},
        layout::TILE,
    },
    table::tile_builder::{GROUPS, LANES, Lanes},
};

/// The costs of a tile's cells and of those around it, and where they have fallen.
pub(crate) struct Sweep {
    pub(crate) stencil: Stencil,
    width: usize,
    /// Costs, at most [`ENDLESS`], of a square of cells that reaches beyond the tile by the stencil's reach.
    pub(crate) costs: Vec<u32>,
    /// By row and row of ends: groups of lanes whose ends have fallen since they were looked at.
    pending: Vec<u8>,
    /// The same for steps within the row.
    pending_along: [u8; TILE],
    /// Rows with anything pending.
    rows: u64,
    /// Cells that have fallen since the tile was taken up, by row.
    pub(crate) fallen: [u64; TILE],
    /// Rows that were looked at since work was last asked for.
    rows_relaxed: u64,
}

impl Sweep {
    pub(crate) fn new(stencil: Stencil) -> Self {
        let width = TILE + 2 * stencil.reach;
        Sweep {
            width,
            costs: vec![ENDLESS; width * width],
            pending: vec![0; TILE * stencil.across.len()],
            pending_along: [0; TILE],
            rows: 0,
            fallen: [0; TILE],
            rows_relaxed: 0,
            stencil,
        }
    }

    /// Work since it was last asked for: a row's steps, sixteen cells together, and copying costs to and fro.
    pub(crate) fn take_work(&mut self) -> u64 {
        let row = (TILE * self.stencil.count).div_ceil(LANES) as u64;
        std::mem::take(&mut self.rows_relaxed) * row + (self.width * self.width / 4) as u64
    }

    /// How far beyond the tile the costs reach.
    pub(crate) fn reach(&self) -> usize {
        self.stencil.reach
    }

    /// Cells along a side of the square of costs.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// Place of the first cell of a row of the tile among the costs.
    #[inline(always)]
    pub(crate) fn place(&self, row: usize) -> usize {
        (row + self.stencil.reach) * self.width + self.stencil.reach
    }

    /// Has the steps looked at that end in some cells of a row of the tile or beyond it.
    pub(crate) fn mark(&mut self, row: isize, ends: u64) {
        self.mark_origins(row, |steps| steps.origins(ends));
    }

    /// The same for all cells beyond a side of the tile.
    pub(crate) fn mark_beyond(&mut self, row: isize, side: Side) {
        self.mark_origins(row, |steps| steps.origins_beyond(side));
    }

    #[inline(always)]
    fn mark_origins(&mut self, row: isize, origins: impl Fn(&RowSteps) -> u64) {
        let count = self.stencil.across.len();
        for (i, steps) in self.stencil.across.iter().enumerate() {
            let from = row - steps.rows;
            if (0..TILE as isize).contains(&from) {
                let groups = groups_of(origins(steps));
                self.pending[from as usize * count + i] |= groups;
                self.rows |= u64::from(groups != 0) << from;
            }
        }
        if (0..TILE as isize).contains(&row) {
            let [west, east] = &self.stencil.along;
            let groups = groups_of(origins(west) | origins(east));
            self.pending_along[row as usize] |= groups;
            self.rows |= u64::from(groups != 0) << row;
        }
    }

    /// Has the steps looked at that end where something has changed around the tile.
    pub(crate) fn take_up(&mut self, change: &Change) {
        let (tile, reach) = (TILE as isize, self.stencil.reach as isize);
        if change.whole {
            for row in -reach..tile + reach {
                self.mark(row, u64::MAX);
                self.mark_beyond(row, Side::West);
                self.mark_beyond(row, Side::East);
            }
            return;
        }
        for (i, changed) in change.around.into_iter().enumerate().filter(|(_, changed)| *changed != 0) {
            let rows = match i / 3 {
                0 => -reach..0,
                1 => 0..tile,
                _ => tile..tile + reach,
            };
            for row in rows.filter(|row| i / 3 != 1 || changed >> row & 1 == 1) {
                match i % 3 {
                    0 => self.mark_beyond(row, Side::West),
                    1 => self.mark(row, changed),
                    _ => self.mark_beyond(row, Side::East),
                }
            }
        }
    }

    /// Notes that the cost of a cell of the tile itself has fallen.
    pub(crate) fn seed(&mut self, row: usize, column: usize) {
        self.fallen[row] |= 1 << column;
        self.mark(row as isize, 1 << column);
    }

    /// Lowers the costs of the tile's cells until no step from one of them lowers any, given the least codes of its steps.
    pub(crate) fn settle(&mut self, least: &[Lanes]) {
        settle(self, least);
    }

    #[inline(always)]
    fn relax_row(&mut self, row: usize, next_row: usize, least: &[Lanes]) {
        self.rows_relaxed += 1;
        let count = self.stencil.count;
        let next = &least[next_row * GROUPS * count..][..GROUPS * count];
        let least = &least[row * GROUPS * count..][..GROUPS * count];
        self.rows &= !(1 << row);
        let mut fallen = 0;
        let pending = row * self.stencil.across.len()..(row + 1) * self.stencil.across.len();
        let groups = self.pending[pending.clone()].iter().fold(0, |all, groups| all | groups);
        for group in (0..GROUPS).filter(|group| groups >> group & 1 == 1) {
            let soon = &next[group * count..][..count];
            fallen |= self.relax_across(row, group, &least[group * count..][..count], soon);
        }
        self.pending[pending].fill(0);
        let [west, east] = &self.stencil.along;
        let along = self.pending_along[row] | groups_of(west.origins(fallen) | east.origins(fallen));
        self.pending_along[row] = 0;
        fallen |= self.relax_along(row, along, least);
        if fallen != 0 {
            self.fallen[row] |= fallen;
            self.mark(row as isize, fallen);
            // Steps within the row have just been looked at.
            self.pending_along[row] = 0;
            let pending = &self.pending[row * self.stencil.across.len()..][..self.stencil.across.len()];
            if pending.iter().all(|groups| *groups == 0) {
                self.rows &= !(1 << row);
            }
        }
    }

    /// Steps from a group of lanes into other rows; returns the cells that fell.
    #[inline(always)]
    fn relax_across(&mut self, row: usize, group: usize, least: &[Lanes], soon: &[Lanes]) -> u64 {
        let at = self.place(row) + group * LANES;
        let Some(before) = self.costs[at..].first_chunk::<LANES>() else { return 0 };
        let (before, mut best) = (*before, *before);
        let pending = &self.pending[row * self.stencil.across.len()..][..self.stencil.across.len()];
        for (steps, groups) in self.stencil.across.iter().zip(pending) {
            if groups >> group & 1 == 0 {
                continue;
            }
            let to = at as isize + steps.rows * self.width as isize;
            let all = steps.all();
            for (((_, columns), codes), soon) in steps.steps.iter().zip(&least[all.clone()]).zip(&soon[all]) {
                prefetch(std::slice::from_ref(soon), 0);
                let Some(ends) = self.costs[(to + columns) as usize..].first_chunk::<LANES>() else {
                    continue;
                };
                let costs = decode_lanes(&codes.0);
                for x in 0..LANES {
                    best[x] = best[x].min(ends[x] + costs[x]);
                }
            }
        }
        self.costs[at..][..LANES].copy_from_slice(&best);
        let mut fallen = 0u32;
        for x in 0..LANES {
            fallen |= u32::from(best[x] < before[x]) << x;
        }
        u64::from(fallen) << (group * LANES)
    }
}

/// Compiled for wider registers too, and chosen by what the machine has; whole numbers are the same on every machine.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2+fma", "aarch64+neon"))]
fn settle(sweep: &mut Sweep, least: &[Lanes]) {
    while sweep.rows != 0 {
        let mut ahead = u64::MAX;
        while sweep.rows & ahead != 0 {
            let row = (sweep.rows & ahead).trailing_zeros() as usize;
            sweep.relax_row(row, (row + 1) % TILE, least);
            ahead = (u64::MAX << row) & !(1 << row);
        }
        let mut ahead = u64::MAX;
        while sweep.rows & ahead != 0 {
            let row = 63 - (sweep.rows & ahead).leading_zeros() as usize;
            sweep.relax_row(row, row.saturating_sub(1), least);
            ahead = (1 << row) - 1;
        }
    }
}

/// Groups of lanes that hold cells of a set.
#[inline(always)]
pub(crate) fn groups_of(cells: u64) -> u8 {
    let group = |i: usize| u8::from(cells >> (i * LANES) & ((1 << LANES) - 1) != 0) << i;
    (0..GROUPS).fold(0, |all, i| all | group(i))
}
