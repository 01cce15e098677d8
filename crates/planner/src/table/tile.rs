//! Costs of all motions from the cells of one tile, a row of cells side by side.

use std::{ops::Range, sync::Arc};

use multiversion::multiversion;
use rayon::prelude::*;
use terrain::Cell;

use crate::{
    grid::{
        cost::{FORBIDDEN, encode},
        heading::HEADINGS,
        layout::TILE,
    },
    ground::{
        blocked::Blocked,
        spans::Span,
        stance::{Offset, orientation},
    },
    lattice::{displacement::Displacement, edge::Chain, graph::Lattice, objective::Weights},
    patience::{Patience, work},
    table::{
        row_step::{Lanes, Pricing, RowStep},
        tile_builder::{Codes, Least, RowCodes, TileBuilder, TileRow, lower},
        window::Window,
    },
};

/// Everything about the lattice that the evaluation of a tile needs, prepared once for all tiles.
pub(crate) struct TileKernel {
    /// By heading, motion and variant.
    chains: Vec<RowChain>,
    /// Those of each heading.
    of_heading: [Range<usize>; HEADINGS],
    /// Slots per state.
    pub(crate) stride: usize,
    halo: usize,
    /// How far from a cell lie those that its motions sweep.
    swept: usize,
    /// How far from where the robot stands lies the ground that its stance depends on.
    beside: usize,
    /// Cells of the longest span that a motion sweeps.
    longest_span: u32,
    /// Chains in groups that are evaluated between two looks at the clock.
    groups: Vec<Group>,
    pricing: Pricing,
    /// Units per joule, metre or second of the objective.
    units: f32,
}

/// Chains that follow each other, and their steps.
struct Group {
    chains: Range<usize>,
    steps: usize,
}

/// A variant of a motion.
struct RowChain {
    heading: usize,
    motion: usize,
    sweep: Arc<[Span]>,
    steps: Vec<RowStep>,
    /// The pose in which it ends, where the robot's body might touch the ground.
    end: Option<(Offset, usize)>,
}

impl TileKernel {
    pub(crate) fn new(lattice: &Lattice, weights: Weights, units: f64) -> Self {
        let mut chains = Vec::new();
        let mut of_heading = [const { 0..0 }; HEADINGS];
        for (heading, motions) in lattice.chains.iter().enumerate() {
            of_heading[heading].start = chains.len();
            for (motion, variants) in motions.iter().enumerate() {
                for chain in variants {
                    let (offset, end) = chain.end();
                    let end = lattice.ground.has_body().then(|| (offset, orientation(end)));
                    chains.push(RowChain::new((heading, motion), chain, end, (lattice, &weights)));
                }
            }
            of_heading[heading].end = chains.len();
        }
        let beside = lattice.ground.reach();
        let reads = chains.iter().flat_map(|c| &c.steps).flat_map(RowStep::reads);
        let reads = reads.chain(chains.iter().filter_map(|c| c.end).map(|(offset, _)| offset));
        let halo = reads.map(|(c, r)| c.abs().max(r.abs())).max().unwrap_or(0) as usize;
        let spans = || chains.iter().flat_map(|c| c.sweep.iter());
        let swept = spans().map(Span::reach).max().unwrap_or(0) as usize;
        let longest_span = spans().map(Span::cells).max().unwrap_or(1);
        let limits = &lattice.limits;
        TileKernel {
            groups: groups(&chains),
            longest_span,
            chains,
            of_heading,
            stride: lattice.motions_per_state(),
            halo,
            swept,
            beside,
            pricing: Pricing {
                pitch_grade: limits.pitch_grade as f32,
                roll_grade: limits.roll_grade as f32,
                side_force_n: limits.side_force_n as f32,
                lift_j_per_m: lattice.lift_j_per_m() as f32,
            },
            units: units as f32,
        }
    }

    /// How far from a cell, in cells, lies the ground that its motions depend on.
    pub(crate) fn reach(&self) -> usize {
        self.swept.max(self.halo + self.beside)
    }

    /// The ground that a tile's motions depend on, and what is blocked of it.
    pub(crate) fn surroundings(&self, lattice: &Lattice, origin: Cell) -> (Window, Blocked) {
        let window = Window::new(lattice, origin, self.halo);
        (window, Blocked::new(&lattice.terrain, origin, self.swept, self.longest_span))
    }

    /// The only kind of ground that a tile's motions depend on; `None` where there are several.
    pub(crate) fn only_class(&self, lattice: &Lattice, origin: Cell) -> Option<u8> {
        Window::only_class(lattice, origin, self.halo)
    }

    /// Codes of one chain from a row of cells, those beyond the map included.
    pub(crate) fn chain_codes(
        &self,
        (window, blocked): (&Window, &Blocked),
        row: usize,
        chain: usize,
    ) -> RowCodes {
        let mut codes = [[FORBIDDEN; TILE]];
        evaluate_row(self, window, row, (chain..chain + 1, &mut codes));
        let [mut codes] = codes;
        forbid(&mut codes, self.touched(blocked, row, chain));
        codes
    }

    /// Cells of a row, bit by bit, from which a chain would touch blocked ground.
    fn touched(&self, blocked: &Blocked, row: usize, chain: usize) -> u64 {
        if blocked.is_near(row) { blocked.touched(row, &self.chains[chain].sweep) } else { 0 }
    }

    /// Codes of all motions from a row of cells under one heading, motion by motion; `None` when patience ends first.
    pub(crate) fn strip_codes(
        &self,
        (window, blocked): (&Window, &Blocked),
        (row, heading): (usize, usize),
        columns: usize,
        patience: &Patience,
    ) -> Option<Box<[RowCodes]>> {
        let mut codes = vec![[FORBIDDEN; TILE]; self.stride];
        let mut pacer = patience.pacer();
        for at in self.of_heading[heading].clone() {
            let chain = &self.chains[at];
            pacer.after((chain.steps.len() * window.present.len()) as u64 * STEP_OF_A_ROW)?;
            lower(&mut codes[chain.motion], &self.chain_codes((window, blocked), row, at));
        }
        codes.iter_mut().for_each(|codes| codes[columns..].fill(FORBIDDEN));
        Some(codes.into_boxed_slice())
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
        let (window, blocked) = self.surroundings(lattice, origin);
        let mut parts = tile.rows();
        parts.truncate(rows);
        let part = |(i, part): (usize, &mut [TileRow<'_>])| {
            self.evaluate_rows((&window, &blocked), (i * ROWS_TOGETHER, columns), part, patience)
        };
        parts.par_chunks_mut(ROWS_TOGETHER).enumerate().try_for_each(part)?;
        drop(parts);
        Some(tile.finish())
    }

    /// Costs of all motions from rows of cells that follow each other; `None` when patience ends first.
    fn evaluate_rows(
        &self,
        (window, blocked): (&Window, &Blocked),
        (first, columns): (usize, usize),
        rows: &mut [TileRow<'_>],
        patience: &Patience,
    ) -> Option<()> {
        let mut offered = vec![[FORBIDDEN; TILE]; self.chains.len()];
        let mut slots = vec![[FORBIDDEN; TILE]; HEADINGS * self.stride];
        let mut pacer = patience.pacer();
        for (row, codes) in (first..).zip(rows) {
            for group in &self.groups {
                pacer.after((group.steps * window.present.len()) as u64 * STEP_OF_A_ROW)?;
                evaluate_row(self, window, row, (group.chains.clone(), &mut offered[group.chains.clone()]));
            }
            self.forbid_blocked(blocked, row, columns, &mut offered);
            take_cheapest(self, &offered, &mut slots);
            codes.store(&slots);
        }
        Some(())
    }

    /// Forbids motions that would touch blocked ground or start beyond the map.
    fn forbid_blocked(&self, blocked: &Blocked, row: usize, columns: usize, offered: &mut [RowCodes]) {
        for (chain, codes) in offered.iter_mut().enumerate() {
            codes[columns..].fill(FORBIDDEN);
            forbid(codes, self.touched(blocked, row, chain));
        }
    }
}

/// Forbids the cells of a row whose bits are set.
fn forbid(codes: &mut RowCodes, mut cells: u64) {
    while cells != 0 {
        codes[cells.trailing_zeros() as usize] = FORBIDDEN;
        cells &= cells - 1;
    }
}

/// Rows of a tile that one thread evaluates.
const ROWS_TOGETHER: usize = 16;
/// Work of one step from a row of cells on one surface: 80 ns.
const STEP_OF_A_ROW: u64 = 16 * work::CELL;
/// Most steps of a group of chains, which are evaluated between two chances to look at the clock.
const STEPS_OF_A_GROUP: usize = 4096;

/// Chains in groups of no more steps than lie between two looks, as far as single chains allow.
fn groups(chains: &[RowChain]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (at, chain) in chains.iter().enumerate() {
        match groups.last_mut() {
            Some(group) if group.steps + chain.steps.len() <= STEPS_OF_A_GROUP => {
                group.chains.end = at + 1;
                group.steps += chain.steps.len();
            }
            _ => groups.push(Group { chains: at..at + 1, steps: chain.steps.len() }),
        }
    }
    groups
}

/// A group of chains over one row of cells. Compiled for wider registers too, and chosen by what the machine has; no operation
/// is contracted but where the source says so, so the result is the same on every machine.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2+fma", "aarch64+neon"))]
fn evaluate_row(
    kernel: &TileKernel,
    window: &Window,
    row: usize,
    (chains, offered): (Range<usize>, &mut [RowCodes]),
) {
    for (chain, codes) in kernel.chains[chains].iter().zip(offered) {
        let mut costs = Lanes::ZERO;
        chain.evaluate(kernel, window, row, &mut costs);
        for (code, cost) in codes.iter_mut().zip(costs.iter()) {
            *code = encode(cost * kernel.units);
        }
    }
}

/// The cheapest variant of each motion.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2+fma", "aarch64+neon"))]
fn take_cheapest(kernel: &TileKernel, offered: &[RowCodes], slots: &mut [RowCodes]) {
    slots.fill([FORBIDDEN; TILE]);
    for (chain, codes) in kernel.chains.iter().zip(offered) {
        lower(&mut slots[chain.heading * kernel.stride + chain.motion], codes);
    }
}

impl RowChain {
    fn new(
        (heading, motion): (usize, usize),
        chain: &Chain,
        end: Option<(Offset, usize)>,
        (lattice, weights): (&Lattice, &Weights),
    ) -> Self {
        let (sweep, steps) = (Arc::clone(chain.sweep()), chain.row_steps(lattice, weights).collect());
        RowChain { heading, motion, sweep, steps, end }
    }

    #[inline(always)]
    fn evaluate(&self, kernel: &TileKernel, window: &Window, row: usize, costs: &mut Lanes) {
        let mut height_m = Lanes(*window.lanes(&window.height_m, row, (0, 0)));
        *costs = Lanes::ZERO;
        for step in &self.steps {
            step.evaluate(&kernel.pricing, window, row, &mut height_m, costs);
        }
        if let Some((offset, orientation)) = self.end {
            let [east, _] = &window.gradients[orientation];
            for (cost, east) in costs.iter_mut().zip(window.lanes(east, row, offset)) {
                *cost = if east.is_nan() { f32::INFINITY } else { *cost };
            }
        }
    }
}
