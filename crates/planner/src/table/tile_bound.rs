//! Lower bounds of what steps between the cells of a tile cost: straights as they are, arcs by the heights along them.

use std::{iter::repeat_n, sync::Arc};

use multiversion::multiversion;
use terrain::Cell;

use crate::{
    grid::{
        cost::{FORBIDDEN, encode},
        layout::TILE,
    },
    ground::{blocked::Blocked, spans::Span},
    lattice::{displacement::Displacement, edge::Chain, graph::Lattice, objective::Weights, primitive::Kind},
    patience::{Patience, work},
    table::{
        piece_bound::PieceBound,
        roll_bound::{Directions, RollBounds},
        row_step,
        tile::TileKernel,
        tile_builder::{GROUPS, LANES, Lanes, Least, RowCodes, lower},
        window::Window,
    },
};

/// What the bounds of a tile's steps are worked out with.
pub(crate) struct BoundKernel {
    /// Chains of straights among those of the tile's kernel, whose costs are evaluated, and the steps that they make.
    straights: Vec<(usize, usize)>,
    /// Arcs by the step that they make.
    steps: Vec<Arcs>,
    directions: Directions,
    /// Steepest grade that limits allow, with room for rounding.
    steepest: f32,
    /// Units by which bounds lie lower for the rounding of single precision.
    slack: f32,
    /// Pieces of all arcs, with straights for as many as they take.
    pieces: u64,
}

/// Arcs that make the same step.
struct Arcs {
    displacement: usize,
    chains: Vec<ArcBound>,
}

/// A variant of an arc.
struct ArcBound {
    pieces: Vec<PieceBound>,
    sweep: Arc<[Span]>,
}

/// Bounds of a tile's steps.
pub(crate) enum Bounds {
    /// Laid out as the least codes of a tile are.
    Known(Least),
    /// None, on a tile about which there are several kinds of ground.
    Mixed,
}

/// Share by which the limit of grades is wider than it is, for rounding.
const ROUNDING: f64 = 1.0001;
/// Bounds and costs are rounded by as much each where lifting work is taken off energy.
const ROUNDED: f64 = 2.0;
/// Work of a bound of a piece from a row of cells: 20 ns.
const PIECE_OF_A_ROW: u64 = 4 * work::CELL;
/// Pieces that take as long as the two steps of a straight.
const PIECES_OF_A_STRAIGHT: u64 = 8;

impl BoundKernel {
    /// `Some(None)` where power has no such bound on some kind of ground, `None` when patience ends first; `cancellation` is the largest
    /// error of a cost, in units, that comes from taking lifting work off energy in single precision.
    pub(crate) fn prepare(
        lattice: &Lattice,
        weights: &Weights,
        displacements: &[Displacement],
        (units, cancellation): (f64, f64),
        patience: &Patience,
    ) -> Option<Option<Self>> {
        let stride = lattice.motions_per_state();
        let (mut straights, mut directions, mut chain) = (Vec::new(), Directions::default(), 0);
        let mut steps: Vec<Arcs> =
            (0..displacements.len()).map(|displacement| Arcs { displacement, chains: Vec::new() }).collect();
        let mut pacer = patience.pacer();
        for (heading, motions) in lattice.chains.iter().enumerate() {
            for (motion, variants) in motions.iter().enumerate() {
                let slot = heading * stride + motion;
                let step = displacements.iter().position(|step| step.slots.contains(&slot));
                for variant in variants {
                    match (step, lattice.motions[heading][motion].kind) {
                        (None, _) => {}
                        (Some(step), Kind::Straight) => straights.push((chain, step)),
                        (Some(step), _) => {
                            pacer.after(lattice.classes.list.len() as u64 * work::MOTION)?;
                            variant.steps_with_manoeuvres().for_each(|(step, ..)| directions.add(step));
                            let Some(bound) = ArcBound::new(lattice, weights, units, variant) else {
                                return Some(None);
                            };
                            steps[step].chains.push(bound);
                        }
                    }
                    chain += 1;
                }
            }
        }
        steps.retain(|arcs| !arcs.chains.is_empty());
        let pieces = || steps.iter().flat_map(|arcs| &arcs.chains).flat_map(|chain| &chain.pieces);
        Some(Some(BoundKernel {
            directions,
            steepest: (lattice.limits.pitch_grade * ROUNDING) as f32,
            slack: (ROUNDED * cancellation) as f32,
            pieces: pieces().count() as u64 + PIECES_OF_A_STRAIGHT * straights.len() as u64,
            straights,
            steps,
        }))
    }

    /// Bounds of all steps from the cells of a tile; `None` when patience ends first.
    pub(crate) fn evaluate(
        &self,
        (kernel, displacements): (&TileKernel, &[Displacement]),
        lattice: &Lattice,
        (tile_row, tile_column): (usize, usize),
        patience: &Patience,
    ) -> Option<Bounds> {
        let origin = Cell { row: tile_row * TILE, column: tile_column * TILE };
        let grid = &lattice.terrain.grid;
        let Some(class) = kernel.only_class(lattice, origin) else { return Some(Bounds::Mixed) };
        let (window, blocked) = kernel.surroundings(lattice, origin);
        let rolls = RollBounds::new(&window, &self.directions, lattice);
        let columns = TILE.min(grid.columns - origin.column);
        let count = displacements.len();
        let mut bounds: Least = repeat_n(Lanes([FORBIDDEN; LANES]), TILE * GROUPS * count).collect();
        let Some(least) = Arc::get_mut(&mut bounds) else {
            unreachable!("bounds in the making are shared with nobody");
        };
        let mut codes = vec![[FORBIDDEN; TILE]; count];
        let mut pacer = patience.pacer();
        for row in 0..TILE.min(grid.rows - origin.row) {
            pacer.after(self.pieces * PIECE_OF_A_ROW)?;
            codes.fill([FORBIDDEN; TILE]);
            for (chain, displacement) in &self.straights {
                lower(&mut codes[*displacement], &kernel.chain_codes((&window, &blocked), row, *chain));
            }
            bound_row(self, (&window, &rolls, &blocked), (row, usize::from(class)), &mut codes);
            let least = &mut least[row * GROUPS * count..][..GROUPS * count];
            for (group, least) in least.chunks_exact_mut(count).enumerate() {
                for (least, codes) in least.iter_mut().zip(&mut codes) {
                    codes[columns..].fill(FORBIDDEN);
                    least.0.copy_from_slice(&codes[group * LANES..][..LANES]);
                }
            }
        }
        Some(Bounds::Known(bounds))
    }
}

impl ArcBound {
    fn new(lattice: &Lattice, weights: &Weights, units: f64, chain: &Chain) -> Option<Self> {
        let steps: Vec<_> = chain.steps_with_manoeuvres().collect();
        // Steps that skid stay alone.
        let alike = steps.chunk_by(|(_, a, _), (_, b, _)| {
            let kernels = a.iter().zip(*b).map(|(a, b)| (a.kernel(), b.kernel()));
            kernels.into_iter().all(|(a, b)| a == b && a.skid_n == 0.0)
        });
        let pieces = alike.map(|steps| PieceBound::new(lattice, weights, units, steps));
        Some(ArcBound { pieces: pieces.collect::<Option<_>>()?, sweep: Arc::clone(chain.sweep()) })
    }
}

/// Lowers codes of a row to the bounds of arcs. Compiled for wider registers too; see [`crate::table::tile`].
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2+fma", "aarch64+neon"))]
fn bound_row(
    kernel: &BoundKernel,
    (window, rolls, blocked): (&Window, &RollBounds, &Blocked),
    (row, class): (usize, usize),
    codes: &mut [RowCodes],
) {
    let from_m = window.lanes(&window.height_m, row, (0, 0));
    let is_near = blocked.is_near(row);
    for arcs in &kernel.steps {
        let mut least = row_step::Lanes([f32::INFINITY; TILE]);
        for chain in &arcs.chains {
            let touched = if is_near { blocked.touched(row, &chain.sweep) } else { 0 };
            let (mut height_m, mut units) = (*from_m, [0.0f32; TILE]);
            for piece in &chain.pieces {
                piece.add((window, rolls), row, (class, kernel.steepest), &mut height_m, &mut units);
            }
            for x in 0..TILE {
                let is_free = touched >> x & 1 == 0;
                least[x] = if is_free & (units[x] < least[x]) { units[x] } else { least[x] };
            }
        }
        let mut own = [FORBIDDEN; TILE];
        for (code, units) in own.iter_mut().zip(least.iter()) {
            let units = units - kernel.slack;
            *code = encode(if units > 0.0 { units } else { 0.0 });
        }
        lower(&mut codes[arcs.displacement], &own);
    }
}
