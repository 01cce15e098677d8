//! Lower bounds of what steps between cells cost, for a tile: straights as they are, arcs by the heights of their ends.

use std::{
    iter::repeat_n,
    sync::{Arc, OnceLock},
};

use multiversion::multiversion;
use rayon::prelude::*;
use terrain::Cell;

use crate::{
    cost::{FORBIDDEN, encode},
    displacement::Displacement,
    edge::Chain,
    lattice::Lattice,
    layout::TILE,
    motion_bound::{Line, is_limited, lines, steepness_classes},
    objective::Weights,
    patience::{Patience, work},
    primitive::Kind,
    stance::Offset,
    steepness::{Steepness, Surroundings},
    tile::{Rows, TileKernel},
    tile_builder::{GROUPS, LANES, Lanes, Least, RowCodes, lower},
    window::Window,
};

/// What bounds of a tile's steps are worked out with.
pub(crate) struct BoundKernel {
    weights: Weights,
    units: f64,
    /// Units by which bounds lie lower for the rounding of single precision.
    slack: f64,
    /// Chains of straights, whose costs are evaluated, and the steps that they make.
    straights: Vec<(usize, usize)>,
    arcs: Vec<Arcs>,
    /// Steepness up to which bounds hold, by class.
    steepness: Vec<f64>,
    /// Whether the last class holds on all ground.
    is_limited: bool,
    /// Grade from which on limits may forbid motions.
    least_limit: f32,
    /// Lines by kind of ground, arcs and class of steepness.
    lines: Vec<OnceLock<Vec<Vec<Vec<Line>>>>>,
}

/// Arcs that make the same step.
struct Arcs {
    displacement: usize,
    offset: Offset,
    /// Height between its ends beyond which the limit of pitch forbids all of them [m].
    most_rise_m: f32,
    chains: Vec<usize>,
}

/// Share by which ground counts as steeper than it is, and grade, for rounding.
const ROUNDING: (f32, f32) = (1.001, 1e-4);
/// More than single precision makes of the difference of two heights of a map [m].
const RISE_ROUNDING_M: f32 = 0.01;

impl BoundKernel {
    pub(crate) fn new(
        lattice: &Lattice,
        weights: Weights,
        (kernel, displacements): (&TileKernel, &[Displacement]),
        (units, slack): (f64, f64),
    ) -> Self {
        let (mut straights, mut arcs) = (Vec::new(), Vec::new());
        for (displacement, step) in displacements.iter().enumerate() {
            let mut chains = Vec::new();
            for (i, (heading, motion)) in kernel.chain_motions().enumerate() {
                if !step.slots.contains(&(heading * kernel.stride + motion)) {
                    continue;
                }
                match lattice.motions[heading][motion].kind {
                    Kind::Straight => straights.push((i, displacement)),
                    _ => chains.push(i),
                }
            }
            if !chains.is_empty() {
                let longest_m = chains.iter().map(|i| kernel.length_m(*i)).fold(0.0, f64::max);
                let most_rise_m =
                    (longest_m * lattice.limits.pitch_grade) as f32 * ROUNDING.0 + RISE_ROUNDING_M;
                arcs.push(Arcs { displacement, offset: (step.columns, step.rows), most_rise_m, chains });
            }
        }
        BoundKernel {
            weights,
            units,
            slack,
            straights,
            arcs,
            steepness: steepness_classes(lattice),
            is_limited: is_limited(lattice),
            least_limit: lattice.limits.pitch_grade.min(lattice.limits.roll_grade) as f32,
            lines: lattice.classes.list.iter().map(|_| OnceLock::new()).collect(),
        }
    }

    /// Lines by arcs and class of steepness on a kind of ground, worked out when they are first asked for; `None` when patience
    /// ends first.
    pub(crate) fn lines(
        &self,
        lattice: &Lattice,
        class: usize,
        patience: &Patience,
    ) -> Option<&Vec<Vec<Vec<Line>>>> {
        if let Some(known) = self.lines[class].get() {
            return Some(known);
        }
        let chains: Vec<&Chain> = lattice.chains.iter().flatten().flatten().collect();
        let of_arcs = |arcs: &Arcs| {
            let chains: Vec<&Chain> = arcs.chains.iter().map(|i| chains[*i]).collect();
            patience.pacer().after(chains.len() as u64 * work::MOTION)?;
            Some(lines(lattice, &self.weights, class, &chains, &self.steepness, (self.units, self.slack)))
        };
        let lines = self.arcs.par_iter().map(of_arcs).collect::<Option<Vec<_>>>()?;
        Some(self.lines[class].get_or_init(|| lines))
    }

    /// The class of steepness of a group of cells; `None` where costs have to be evaluated.
    fn class(&self, around: &Surroundings) -> Option<(usize, usize)> {
        let (share, grade) = ROUNDING;
        let steepest = f64::from(around.steepest * share + grade);
        let last = self.steepness.len().saturating_sub(1);
        let class = match self.steepness.partition_point(|class| *class < steepest) {
            class if class > last && self.is_limited && steepest.is_finite() => last,
            class => class,
        };
        around.class.map(|kind| (usize::from(kind), class)).filter(|_| class < self.steepness.len())
    }

    /// Bounds of all steps from the cells of a tile; `None` when patience ends first.
    pub(crate) fn evaluate(
        &self,
        kernel: &TileKernel,
        lattice: &Lattice,
        (tile_row, tile_column): (usize, usize),
        displacements: &[Displacement],
        patience: &Patience,
    ) -> Option<Least> {
        let origin = Cell { row: tile_row * TILE, column: tile_column * TILE };
        let grid = &lattice.terrain.grid;
        let window = kernel.window(lattice, origin);
        let steepness = Steepness::new(&window, grid.cell_size_m as f32);
        let blocked = kernel.blocked(lattice, origin);
        let mut rows = Rows::new(kernel, &window, &blocked, TILE.min(grid.columns - origin.column), patience);
        let count = displacements.len();
        let mut bounds: Least = repeat_n(Lanes([FORBIDDEN; LANES]), TILE * GROUPS * count).collect();
        let Some(least) = Arc::get_mut(&mut bounds) else {
            unreachable!("bounds in the making are shared with nobody");
        };
        let mut codes = vec![[FORBIDDEN; TILE]; count];
        for class in &window.present {
            self.lines(lattice, usize::from(*class), patience)?;
        }
        for row in 0..TILE.min(grid.rows - origin.row) {
            let classes = steepness.row(row).each_ref().map(|around| self.class(around));
            let steep = steepness.row(row).iter().any(|around| around.steepest > self.least_limit);
            codes.fill([FORBIDDEN; TILE]);
            match classes.iter().all(Option::is_some) {
                true => self.bound_row(
                    &mut rows,
                    (row, steep),
                    classes.map(Option::unwrap_or_default),
                    &mut codes,
                )?,
                false => rows.evaluate(row, displacements, &mut codes)?,
            }
            let least = &mut least[row * GROUPS * count..][..GROUPS * count];
            for (group, least) in least.chunks_exact_mut(count).enumerate() {
                for (least, codes) in least.iter_mut().zip(&codes) {
                    least.0.copy_from_slice(&codes[group * LANES..][..LANES]);
                }
            }
        }
        Some(bounds)
    }

    /// Bounds from a row of cells whose ground is of one kind and not too steep, by group of cells.
    fn bound_row(
        &self,
        rows: &mut Rows<'_>,
        (row, steep): (usize, bool),
        classes: [(usize, usize); GROUPS],
        codes: &mut [RowCodes],
    ) -> Option<()> {
        for (chain, displacement) in &self.straights {
            let own = rows.chain(row, *chain)?;
            lower(&mut codes[*displacement], own);
        }
        rows.worked(self.arcs.len())?;
        let lines = classes.map(|(kind, _)| self.lines[kind].get());
        for (i, arcs) in self.arcs.iter().enumerate() {
            let forbidden = rows.forbidden(row, &arcs.chains, steep);
            if forbidden == u64::MAX {
                continue;
            }
            let lines: [&[Line]; GROUPS] = std::array::from_fn(|group| {
                lines[group].map_or(&[][..], |lines| &lines[i][classes[group].1])
            });
            let mut own = [FORBIDDEN; TILE];
            bound_row(rows.window, row, (arcs.offset, arcs.most_rise_m), lines, &mut own);
            forbid(&mut own, forbidden);
            lower(&mut codes[arcs.displacement], &own);
        }
        Some(())
    }
}

/// Forbids the cells of a row whose bits are set.
pub(crate) fn forbid(codes: &mut RowCodes, mut cells: u64) {
    while cells != 0 {
        codes[cells.trailing_zeros() as usize] = FORBIDDEN;
        cells &= cells - 1;
    }
}

/// The highest of lines at the rise from a row of cells to those at an offset.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2+fma", "aarch64+neon"))]
fn bound_row(
    window: &Window,
    row: usize,
    (offset, most_rise_m): (Offset, f32),
    lines: [&[Line]; GROUPS],
    codes: &mut RowCodes,
) {
    let from_m = window.lanes(&window.height_m, row, (0, 0));
    let to_m = window.lanes(&window.height_m, row, offset);
    for group in 0..GROUPS {
        if lines[group].is_empty() {
            continue;
        }
        let mut rise_m = [0.0f32; LANES];
        for x in 0..LANES {
            rise_m[x] = to_m[group * LANES + x] - from_m[group * LANES + x];
        }
        let mut least = [0.0f32; LANES];
        for line in lines[group] {
            for x in 0..LANES {
                let units = line.per_m.mul_add(rise_m[x], line.level);
                least[x] = if units > least[x] { units } else { least[x] };
            }
        }
        for x in 0..LANES {
            // A comparison that is false of unknown ground.
            let units = if rise_m[x].abs() <= most_rise_m { least[x] } else { f32::INFINITY };
            codes[group * LANES + x] = encode(units);
        }
    }
}
