//! Costs of all motions from the cells of one tile, a row of cells side by side.

use model::PowerKernel;
use multiversion::multiversion;
use terrain::{Cell, Terrain, slope};

use crate::{
    cost::{FORBIDDEN, encode},
    displacement::Displacement,
    edge::Chain,
    footprint::first_blocked,
    heading::HEADINGS,
    lattice::Lattice,
    layout::TILE,
    patience::Patience,
    table::Weights,
    tile_builder::{Codes, Least, RowCodes, TileBuilder, lower},
};

/// Everything about the lattice that the evaluation of a tile needs, prepared once for all tiles.
pub(crate) struct TileKernel {
    chains: Vec<RowChain>,
    /// Slots per state.
    pub(crate) stride: usize,
    halo: usize,
    limits: RowLimits,
    per_j: f32,
    per_m: f32,
    per_s: f32,
    /// Units per joule, metre or second of the objective.
    units: f32,
    lift_j_per_m: f32,
}

#[derive(Clone, Copy)]
struct RowLimits {
    pitch_grade: f32,
    roll_grade: f32,
    side_force_n: f32,
}

/// A variant of a motion.
struct RowChain {
    heading: usize,
    motion: usize,
    reach: u8,
    sweep: Vec<(i32, i32)>,
    steps: Vec<RowStep>,
}

struct RowStep {
    /// Cells that interpolation reads, relative to the start cell, and their weights.
    taps: Vec<((i32, i32), f32)>,
    middle: (i32, i32),
    horizontal_m: f32,
    per_horizontal_m: f32,
    travel: (f32, f32),
    facing: f32,
    s_per_m: f32,
    on_the_spot_s: f32,
    kernels: Vec<PowerKernel<f32>>,
}

/// The ground of a tile and around it; unknown and outside are NaN.
pub(crate) struct Window {
    width: usize,
    halo: usize,
    height_m: Vec<f32>,
    east: Vec<f32>,
    north: Vec<f32>,
    surface: Vec<u8>,
    /// Surfaces that occur.
    present: Vec<u8>,
}

type Lanes = [f32; TILE];

impl TileKernel {
    pub(crate) fn new(lattice: &Lattice, weights: Weights, units: f64) -> Self {
        let mut chains = Vec::new();
        for (heading, motions) in lattice.chains.iter().enumerate() {
            for (motion, variants) in motions.iter().enumerate() {
                for chain in variants {
                    chains.push(RowChain::new(heading, motion, chain));
                }
            }
        }
        let reads = chains.iter().flat_map(|c| &c.steps).flat_map(RowStep::reads);
        let halo = reads.map(|(c, r)| c.abs().max(r.abs())).max().unwrap_or(0) as usize;
        let limits = &lattice.limits;
        TileKernel {
            chains,
            stride: lattice.motions_per_state().next_multiple_of(4),
            halo,
            limits: RowLimits {
                pitch_grade: limits.pitch_grade as f32,
                roll_grade: limits.roll_grade as f32,
                side_force_n: limits.side_force_n as f32,
            },
            per_j: weights.per_j as f32,
            per_m: weights.per_m as f32,
            per_s: weights.per_s as f32,
            units: units as f32,
            lift_j_per_m: lattice.lift_j_per_m() as f32,
        }
    }

    /// How far from a cell, in cells, lies the ground that its motions depend on; slopes look one further.
    pub(crate) fn reach(&self) -> usize {
        let swept = self.chains.iter().map(|chain| usize::from(chain.reach)).max().unwrap_or(0);
        swept.max(self.halo) + 1
    }

    /// Costs of all motions from all states of a tile; `None` when patience ends first.
    pub(crate) fn evaluate(
        &self,
        lattice: &Lattice,
        (tile_row, tile_column): (usize, usize),
        displacements: &[Displacement],
        patience: &Patience,
    ) -> Option<(Codes, Least)> {
        let origin = Cell { row: tile_row * TILE, column: tile_column * TILE };
        let rows = TILE.min(lattice.terrain.grid.rows - origin.row);
        let columns = TILE.min(lattice.terrain.grid.columns - origin.column);
        let mut tile = TileBuilder::new(self.stride, displacements);
        let window = Window::new(lattice, origin, self.halo);
        let mut offered = vec![[FORBIDDEN; TILE]; self.chains.len()];
        let mut slots = vec![[FORBIDDEN; TILE]; HEADINGS * self.stride];
        for row in 0..rows {
            if row.is_multiple_of(ROWS_BETWEEN_LOOKS) && patience.is_over() {
                return None;
            }
            evaluate_row(self, &window, row, &mut offered);
            self.forbid_blocked(lattice, Cell { row: origin.row + row, ..origin }, columns, &mut offered);
            take_cheapest(self, &offered, &mut slots);
            tile.store_row(row, &slots);
        }
        Some(tile.finish())
    }

    /// Forbids motions that would touch blocked ground or start beyond the map.
    fn forbid_blocked(&self, lattice: &Lattice, west: Cell, columns: usize, offered: &mut [RowCodes]) {
        let first = lattice.terrain.grid.index(west);
        let clearance = |x: usize| lattice.clearance.at(first + x);
        let least = (0..columns).map(clearance).min().unwrap_or(0);
        for (chain, codes) in self.chains.iter().zip(offered) {
            codes[columns..].fill(FORBIDDEN);
            if least > chain.reach {
                continue;
            }
            for (x, code) in codes.iter_mut().enumerate().take(columns) {
                let cell = Cell { column: west.column + x, ..west };
                let near = *code != FORBIDDEN && clearance(x) <= chain.reach;
                if near && first_blocked(&lattice.terrain, cell, &chain.sweep).is_some() {
                    *code = FORBIDDEN;
                }
            }
        }
    }
}

/// Rows between two looks at the clock: 4 of them take a third of a millisecond.
const ROWS_BETWEEN_LOOKS: usize = 4;

/// All chains over one row of cells. Compiled for wider registers too, and chosen by what the machine has; no operation
/// is contracted, so the result is the same on every machine.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2", "aarch64+neon"))]
fn evaluate_row(kernel: &TileKernel, window: &Window, row: usize, offered: &mut [RowCodes]) {
    for (chain, codes) in kernel.chains.iter().zip(offered) {
        let mut costs = [0.0; TILE];
        chain.evaluate(kernel, window, row, &mut costs);
        for (code, cost) in codes.iter_mut().zip(&costs) {
            *code = encode(cost * kernel.units);
        }
    }
}

/// The cheapest variant of each motion.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2", "aarch64+neon"))]
fn take_cheapest(kernel: &TileKernel, offered: &[RowCodes], slots: &mut [RowCodes]) {
    slots.fill([FORBIDDEN; TILE]);
    for (chain, codes) in kernel.chains.iter().zip(offered) {
        lower(&mut slots[chain.heading * kernel.stride + chain.motion], codes);
    }
}

impl RowChain {
    fn new(heading: usize, motion: usize, chain: &Chain) -> Self {
        let (sweep, reach) = chain.sweep();
        RowChain { heading, motion, reach, sweep: sweep.to_vec(), steps: chain.row_steps().collect() }
    }

    #[inline(always)]
    fn evaluate(&self, kernel: &TileKernel, window: &Window, row: usize, costs: &mut Lanes) {
        let mut height_m = *window.lanes(&window.height_m, row, (0, 0));
        *costs = [0.0; TILE];
        for step in &self.steps {
            step.evaluate(kernel, window, row, &mut height_m, costs);
        }
    }
}

impl RowStep {
    fn reads(&self) -> impl Iterator<Item = (i32, i32)> + '_ {
        self.taps.iter().map(|(offset, _)| *offset).chain([self.middle])
    }

    #[inline(always)]
    fn evaluate(
        &self,
        kernel: &TileKernel,
        window: &Window,
        row: usize,
        height_m: &mut Lanes,
        costs: &mut Lanes,
    ) {
        let mut rise_m = [0.0f32; TILE];
        if !self.taps.is_empty() {
            let mut end_m = [0.0f32; TILE];
            for (offset, weight) in &self.taps {
                let z = window.lanes(&window.height_m, row, *offset);
                for x in 0..TILE {
                    end_m[x] += weight * z[x];
                }
            }
            for x in 0..TILE {
                rise_m[x] = end_m[x] - height_m[x];
            }
            *height_m = end_m;
        }
        let east = window.lanes(&window.east, row, self.middle);
        let north = window.lanes(&window.north, row, self.middle);
        let ground = self.ground(&rise_m, east, north);
        if let [only] = window.present[..] {
            let step = self.costs(kernel, &self.kernels[usize::from(only)], &ground, &rise_m);
            for x in 0..TILE {
                costs[x] += step[x];
            }
            return;
        }
        let surface = window.lanes(&window.surface, row, self.middle);
        for &class in &window.present {
            let step = self.costs(kernel, &self.kernels[usize::from(class)], &ground, &rise_m);
            for x in 0..TILE {
                costs[x] += if surface[x] == class { step[x] } else { 0.0 };
            }
        }
    }

    /// Grades along and across the heading, and their cosines; see `PreparedStep::drive` for the same in double.
    #[inline(always)]
    fn ground(&self, rise_m: &Lanes, east: &Lanes, north: &Lanes) -> Ground {
        let (cos, sin) = self.travel;
        let mut ground = Ground {
            grade: [0.0; TILE],
            side_grade: [0.0; TILE],
            cos_pitch: [0.0; TILE],
            cos_roll: [0.0; TILE],
        };
        for x in 0..TILE {
            ground.side_grade[x] = north[x] * cos - east[x] * sin;
        }
        if self.horizontal_m == 0.0 {
            for x in 0..TILE {
                ground.grade[x] = east[x] * cos + north[x] * sin;
            }
        } else {
            for x in 0..TILE {
                ground.grade[x] = rise_m[x] * self.per_horizontal_m;
            }
        }
        for x in 0..TILE {
            ground.cos_pitch[x] = inverse_sqrt(1.0 + ground.grade[x] * ground.grade[x]);
            ground.cos_roll[x] = inverse_sqrt(1.0 + ground.side_grade[x] * ground.side_grade[x]);
        }
        ground
    }

    /// The cost of the step on one surface, infinite where limits forbid it.
    #[inline(always)]
    fn costs(&self, kernel: &TileKernel, power: &PowerKernel<f32>, ground: &Ground, rise_m: &Lanes) -> Lanes {
        // Copies that the compiler can keep in registers.
        let (power, limits) = (*power, kernel.limits);
        let (per_j, per_m, per_s) = (kernel.per_j, kernel.per_m, kernel.per_s);
        let lift_j_per_m = if self.horizontal_m == 0.0 { 0.0 } else { kernel.lift_j_per_m };
        let mut costs = [0.0; TILE];
        for x in 0..TILE {
            let (grade, cos_pitch) = (ground.grade[x], ground.cos_pitch[x]);
            let (normal, along) = (cos_pitch * ground.cos_roll[x], self.facing * grade * cos_pitch);
            let length_m = self.horizontal_m * (1.0 + grade * grade) * cos_pitch;
            let duration_s = length_m * self.s_per_m + self.on_the_spot_s;
            let force_n = power.forces_n(normal, along);
            let bus_w = power.bus_w(power.side_w(force_n), along);
            let friction_j = bus_w * duration_s - lift_j_per_m * rise_m[x];
            let friction_j = if friction_j > 0.0 { friction_j } else { 0.0 };
            let cost = per_j * friction_j + per_m * length_m + per_s * duration_s;
            // Written so that a NaN of unknown ground fails too.
            let allowed = (grade.abs() <= limits.pitch_grade)
                & (ground.side_grade[x].abs() <= limits.roll_grade)
                & (force_n.left.abs() <= limits.side_force_n)
                & (force_n.right.abs() <= limits.side_force_n);
            costs[x] = if allowed { cost } else { f32::INFINITY };
        }
        costs
    }
}

/// The ground under a step for one row of start cells.
struct Ground {
    grade: Lanes,
    side_grade: Lanes,
    cos_pitch: Lanes,
    cos_roll: Lanes,
}

/// 1/√x to single precision for positive x, by Newton's method: several times the speed of a square root and a division,
/// which registers share.
#[inline(always)]
fn inverse_sqrt(x: f32) -> f32 {
    // Halving and negating the exponent is a first guess within 3.5 %; each step squares the error.
    const GUESS: u32 = 0x5f37_59df;
    let half = 0.5 * x;
    let mut y = f32::from_bits(GUESS.wrapping_sub(x.to_bits() >> 1));
    y *= 1.5 - half * y * y;
    y *= 1.5 - half * y * y;
    y * (1.5 - half * y * y)
}

impl Chain {
    /// Its steps in the form that rows are evaluated with.
    fn row_steps(&self) -> impl Iterator<Item = RowStep> + '_ {
        self.steps_with_manoeuvres().map(|(step, manoeuvres, reverse)| {
            let motion = manoeuvres.first().map(|m| *m.motion());
            let speed_mps = motion.map_or(1.0, |m| m.speed_mps.abs());
            let yaw_radps = motion.map_or(1.0, |m| m.yaw_rate_radps);
            let turning = step.horizontal_m == 0.0;
            RowStep {
                taps: if turning { Vec::new() } else { step.end.taps().collect() },
                middle: step.middle,
                horizontal_m: step.horizontal_m as f32,
                per_horizontal_m: if turning { 0.0 } else { (1.0 / step.horizontal_m) as f32 },
                travel: (step.travel.0 as f32, step.travel.1 as f32),
                facing: if reverse { -1.0 } else { 1.0 },
                s_per_m: if turning { 0.0 } else { (1.0 / speed_mps) as f32 },
                on_the_spot_s: if turning { (step.turn_rad / yaw_radps) as f32 } else { 0.0 },
                kernels: manoeuvres.iter().map(|m| m.kernel().single()).collect(),
            }
        })
    }
}

impl Window {
    fn new(lattice: &Lattice, origin: Cell, halo: usize) -> Self {
        let terrain = &lattice.terrain;
        // A row of lanes may start anywhere in the halo and is as long as the tile.
        let width = TILE + 2 * halo;
        let cells = width * width;
        let mut window = Window {
            width,
            halo,
            height_m: vec![f32::NAN; cells],
            east: vec![f32::NAN; cells],
            north: vec![f32::NAN; cells],
            surface: vec![0; cells],
            present: Vec::new(),
        };
        for y in 0..width {
            let Some(row) = (origin.row + y).checked_sub(halo).filter(|r| *r < terrain.grid.rows) else {
                continue;
            };
            let west = origin.column.saturating_sub(halo);
            let east = (origin.column + TILE + halo).min(terrain.grid.columns);
            let at = y * width + west + halo - origin.column;
            let from = terrain.grid.index(Cell { row, column: west });
            let count = east - west;
            window.height_m[at..at + count].copy_from_slice(&terrain.relative_m()[from..from + count]);
            let (east_out, north_out) = (&mut window.east[at..at + count], &mut window.north[at..at + count]);
            slope::row(terrain, row, west, east_out, north_out);
            for (i, surface) in window.surface[at..at + count].iter_mut().enumerate() {
                *surface = surface_of(lattice, terrain, Cell { row, column: west + i });
            }
        }
        window.present = window.surface.clone();
        window.present.sort_unstable();
        window.present.dedup();
        window
    }

    /// The values under a row of the tile's cells, moved by an offset (columns, rows).
    #[inline(always)]
    fn lanes<'w, T>(&self, values: &'w [T], row: usize, (columns, rows): (i32, i32)) -> &'w [T; TILE] {
        let y = (row + self.halo) as isize + rows as isize;
        let x = self.halo as isize + columns as isize;
        let start = (y * self.width as isize + x) as usize;
        match values[start..].first_chunk::<TILE>() {
            Some(lanes) => lanes,
            None => unreachable!("the halo holds every cell that a motion reads"),
        }
    }
}

fn surface_of(lattice: &Lattice, terrain: &Terrain, cell: Cell) -> u8 {
    if terrain.surfaces().is_none() { 0 } else { lattice.surface_index(cell) as u8 }
}
