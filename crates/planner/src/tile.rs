//! Costs of all motions from the cells of one tile, a row of cells side by side.

use std::{ops::Range, sync::Arc};

use multiversion::multiversion;
use rayon::prelude::*;
use terrain::Cell;

use crate::{
    blocked::Blocked,
    cost::{FORBIDDEN, encode},
    displacement::Displacement,
    edge::Chain,
    heading::HEADINGS,
    lattice::Lattice,
    layout::TILE,
    objective::Weights,
    patience::{Pacer, Patience, work},
    row_step::{Lanes, Pricing, RowStep},
    spans::Span,
    stance::{Offset, orientation},
    tile_bound::forbid,
    tile_builder::{Codes, Least, RowCodes, TileBuilder, lower},
    window::Window,
};

/// Everything about the lattice that the evaluation of a tile needs, prepared once for all tiles.
pub(crate) struct TileKernel {
    chains: Vec<RowChain>,
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
        for (heading, motions) in lattice.chains.iter().enumerate() {
            for (motion, variants) in motions.iter().enumerate() {
                for chain in variants {
                    let (offset, end) = chain.end();
                    let end = lattice.ground.has_body().then(|| (offset, orientation(end)));
                    chains.push(RowChain::new((heading, motion), chain, end, (lattice, &weights)));
                }
            }
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

    /// Heading and motion of each chain.
    pub(crate) fn chain_motions(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.chains.iter().map(|chain| (chain.heading, chain.motion))
    }

    /// Horizontal length of a chain [m].
    pub(crate) fn length_m(&self, chain: usize) -> f64 {
        self.chains[chain].steps.iter().map(RowStep::horizontal_m).sum()
    }

    /// The ground that a tile's motions depend on.
    pub(crate) fn window(&self, lattice: &Lattice, origin: Cell) -> Window {
        Window::new(lattice, origin, self.halo)
    }

    /// What is blocked of the ground that a tile's motions sweep.
    pub(crate) fn blocked(&self, lattice: &Lattice, origin: Cell) -> Blocked {
        Blocked::new(&lattice.terrain, origin, self.swept, self.longest_span)
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
        let (window, blocked) = (self.window(lattice, origin), self.blocked(lattice, origin));
        let mut parts = tile.rows();
        parts.truncate(rows);
        parts.par_chunks_mut(ROWS_TOGETHER).enumerate().try_for_each(|(i, part)| {
            let mut work = Rows::new(self, &window, &blocked, columns, patience);
            for (row, part) in (i * ROWS_TOGETHER..).zip(part) {
                part.store(work.slots(row)?, displacements);
            }
            Some(())
        })?;
        drop(parts);
        Some(tile.finish())
    }
}

/// Rows of a tile that one thread evaluates.
const ROWS_TOGETHER: usize = 16;

/// The rows of a tile as they are evaluated one after the other.
pub(crate) struct Rows<'t> {
    kernel: &'t TileKernel,
    pub(crate) window: &'t Window,
    blocked: &'t Blocked,
    /// Columns of the tile that the map has.
    columns: usize,
    pacer: Pacer<'t>,
    /// Codes by chain, and by slot of a state.
    offered: Vec<RowCodes>,
    slots: Vec<RowCodes>,
}

impl<'t> Rows<'t> {
    pub(crate) fn new(
        kernel: &'t TileKernel,
        window: &'t Window,
        blocked: &'t Blocked,
        columns: usize,
        patience: &'t Patience,
    ) -> Self {
        Rows {
            kernel,
            window,
            blocked,
            columns,
            pacer: patience.pacer(),
            offered: vec![[FORBIDDEN; TILE]; kernel.chains.len()],
            slots: Vec::new(),
        }
    }

    /// Codes of all motions from a row of cells, by slot; `None` when patience ends first.
    fn slots(&mut self, row: usize) -> Option<&[RowCodes]> {
        for group in &self.kernel.groups {
            self.pacer.after((group.steps * self.window.present.len()) as u64 * STEP_OF_A_ROW)?;
            let chains = group.chains.clone();
            evaluate_row(self.kernel, self.window, row, (chains.clone(), &mut self.offered[chains]));
        }
        for (i, codes) in self.offered.iter_mut().enumerate() {
            codes[self.columns..].fill(FORBIDDEN);
            forbid(codes, touched(self.kernel, self.blocked, row, i));
        }
        self.slots.resize(HEADINGS * self.kernel.stride, [FORBIDDEN; TILE]);
        take_cheapest(self.kernel, &self.offered, &mut self.slots);
        Some(&self.slots)
    }

    /// The least codes of steps from a row of cells; `None` when patience ends first.
    pub(crate) fn evaluate(
        &mut self,
        row: usize,
        displacements: &[Displacement],
        codes: &mut [RowCodes],
    ) -> Option<()> {
        let slots = self.slots(row)?;
        for (codes, displacement) in codes.iter_mut().zip(displacements) {
            displacement.slots.iter().for_each(|slot| lower(codes, &slots[*slot]));
        }
        Some(())
    }

    /// Codes of one chain from a row of cells; `None` when patience ends first.
    pub(crate) fn chain(&mut self, row: usize, chain: usize) -> Option<&RowCodes> {
        let steps = self.kernel.chains[chain].steps.len() * self.window.present.len();
        self.pacer.after(steps as u64 * STEP_OF_A_ROW)?;
        let codes = &mut self.offered[chain..chain + 1];
        evaluate_row(self.kernel, self.window, row, (chain..chain + 1, codes));
        codes[0][self.columns..].fill(FORBIDDEN);
        forbid(&mut codes[0], touched(self.kernel, self.blocked, row, chain));
        Some(&self.offered[chain])
    }

    /// Counts the work of bounds from a row of cells; `None` when patience ends first.
    pub(crate) fn worked(&mut self, bounds: usize) -> Option<()> {
        self.pacer.after(bounds as u64 * STEP_OF_A_ROW)
    }

    /// Cells of a row, bit by bit, from which each of some chains would touch blocked ground or, if asked, stand too steep half
    /// way, or that lie beyond the map.
    pub(crate) fn forbidden(&self, row: usize, chains: &[usize], steep: bool) -> u64 {
        let beyond = if self.columns < TILE { u64::MAX << self.columns } else { 0 };
        let mut all = u64::MAX;
        for chain in chains {
            let steps = &self.kernel.chains[*chain].steps;
            let half_way = steps.get(steps.len() / 2).filter(|_| steep);
            let too_steep = half_way.map_or(0, |step| step.too_steep(&self.kernel.pricing, self.window, row));
            all &= touched(self.kernel, self.blocked, row, *chain) | too_steep;
            if all == 0 {
                break;
            }
        }
        all | beyond
    }
}

/// Cells of a row, bit by bit, from which a chain would touch blocked ground.
fn touched(kernel: &TileKernel, blocked: &Blocked, row: usize, chain: usize) -> u64 {
    if blocked.is_near(row) { blocked.touched(row, &kernel.chains[chain].sweep) } else { 0 }
}
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
