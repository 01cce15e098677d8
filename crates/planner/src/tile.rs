//! Costs of all motions from the cells of one tile, a row of cells side by side.

use std::{ops::Range, sync::Arc};

use multiversion::multiversion;
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
    patience::{Patience, work},
    row_step::{Lanes, Pricing, RowStep},
    spans::Span,
    stance::{Offset, orientation},
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
        let blocked = Blocked::new(&lattice.terrain, origin, self.swept, self.longest_span);
        let mut offered = vec![[FORBIDDEN; TILE]; self.chains.len()];
        let mut slots = vec![[FORBIDDEN; TILE]; HEADINGS * self.stride];
        let mut pacer = patience.pacer();
        for row in 0..rows {
            for group in &self.groups {
                pacer.after((group.steps * window.present.len()) as u64 * STEP_OF_A_ROW)?;
                evaluate_row(self, &window, row, (group.chains.clone(), &mut offered[group.chains.clone()]));
            }
            self.forbid_blocked(&blocked, row, columns, &mut offered);
            take_cheapest(self, &offered, &mut slots);
            tile.store_row(row, &slots);
        }
        Some(tile.finish())
    }

    /// Forbids motions that would touch blocked ground or start beyond the map.
    fn forbid_blocked(&self, blocked: &Blocked, row: usize, columns: usize, offered: &mut [RowCodes]) {
        let is_near = blocked.is_near(row);
        for (chain, codes) in self.chains.iter().zip(offered) {
            codes[columns..].fill(FORBIDDEN);
            let mut touched = if is_near { blocked.touched(row, &chain.sweep) } else { 0 };
            while touched != 0 {
                codes[touched.trailing_zeros() as usize] = FORBIDDEN;
                touched &= touched - 1;
            }
        }
    }
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
