//! Least costs of all poses within one tile, given those around it: cells of a row side by side, rows upwards and downwards
//! until nothing falls.

use multiversion::multiversion;

use crate::{
    grid::{cost::decode_lanes, heading::HEADINGS, layout::TILE},
    patience::Patience,
    pose_field::{
        pose_codes::{CodesAround, PoseCodes},
        pose_stencil::PoseStencil,
    },
    table::tile_builder::{LANES, RowCodes},
};

/// The costs of a tile's poses and of those around it, and where they have fallen.
pub(crate) struct PoseSweep {
    pub(crate) stencil: PoseStencil,
    /// Costs, at most `ENDLESS`, by heading, of a square of cells that reaches beyond the tile by the stencil's reach.
    pub(crate) costs: Vec<u32>,
    codes: PoseCodes,
    /// By row: headings under which costs may fall.
    pub(crate) pending: [u16; TILE],
    /// Costs above are not passed on.
    limit: u32,
    /// By heading and row: cells whose cost has fallen and was passed on.
    pub(crate) fallen: Box<[[u64; TILE]; HEADINGS]>,
    /// Rows by heading in which any cost has fallen.
    pub(crate) lowered: [u64; HEADINGS],
    /// Rows of headings that were looked at since work was last reported.
    rows_relaxed: u64,
}

impl PoseSweep {
    pub(crate) fn new(stencil: PoseStencil, limit: u32) -> Self {
        PoseSweep {
            costs: vec![0; HEADINGS * stencil.width() * stencil.width()],
            codes: PoseCodes::new(&stencil),
            pending: [0; TILE],
            limit,
            fallen: Box::new([[0; TILE]; HEADINGS]),
            lowered: [0; HEADINGS],
            rows_relaxed: 0,
            stencil,
        }
    }

    /// Place among the costs of a row of a heading, counted from the southernmost, from its westernmost cell.
    #[inline(always)]
    pub(crate) fn row_place(&self, heading: usize, y: usize) -> usize {
        (heading * self.stencil.width() + y) * self.stencil.width()
    }

    /// Place among the costs of the first cell of a row of the tile.
    #[inline(always)]
    pub(crate) fn place(&self, heading: usize, row: usize) -> usize {
        self.row_place(heading, row + self.stencil.reach) + self.stencil.reach
    }

    /// Begins with another tile, where costs may fall under some headings by row.
    pub(crate) fn begin(&mut self, pending: &[u16; TILE]) {
        self.pending = *pending;
        *self.fallen = [[0; TILE]; HEADINGS];
        self.lowered = [0; HEADINGS];
        self.codes.clear();
    }

    /// Lowers the costs of the tile's poses until no motion lowers any; `None` when patience ends first.
    pub(crate) fn settle(&mut self, codes: &CodesAround<'_>, patience: &Patience) -> Option<()> {
        while self.pending.iter().any(|headings| *headings != 0) {
            for is_upwards in [true, false] {
                sweep(self, codes, is_upwards);
                // A row of a heading takes its motions sixteen cells at a time.
                let row = (TILE / LANES * self.stencil.motions) as u64;
                patience.worked(std::mem::take(&mut self.rows_relaxed) * row);
                if patience.is_over() {
                    return None;
                }
            }
        }
        Some(())
    }

    /// All headings of a row, one after the other and round again, until no cost in it falls.
    #[inline(always)]
    fn relax_row(&mut self, row: usize, codes: &CodesAround<'_>) {
        self.codes.make_ready(row, &self.stencil, codes);
        let mut first = 0;
        while self.pending[row] != 0 {
            let ahead = self.pending[row] & (u16::MAX << first);
            let heading = if ahead != 0 { ahead } else { self.pending[row] }.trailing_zeros() as usize;
            self.pending[row] &= !(1 << heading);
            first = (heading + 1) % HEADINGS;
            self.rows_relaxed += 1;
            let mut fallen = self.relax(heading, row);
            if fallen != 0 {
                fallen |= self.run_on(heading, row);
                self.lowered[heading] |= 1 << row;
                self.pass_on(heading, row, fallen);
            }
        }
    }

    /// All motions of a row of a heading; returns the cells that fell.
    #[inline(always)]
    fn relax(&mut self, heading: usize, row: usize) -> u64 {
        let at = self.place(heading, row);
        let Some(before) = self.costs[at..].first_chunk::<TILE>() else { return 0 };
        let mut best = *before;
        let codes = self.codes.of(row, heading, self.stencil.motions);
        for (pull, codes) in self.stencil.pulls[heading].iter().zip(codes) {
            if let Some(costs) = self.costs[at.wrapping_add_signed(pull.offset)..].first_chunk::<TILE>() {
                lower_by(&mut best, costs, codes);
            }
        }
        let fallen = below(&best, before);
        if fallen != 0 {
            self.costs[at..][..TILE].copy_from_slice(&best);
        }
        fallen
    }

    /// Motions that run on along the row: one cell after the other.
    #[inline(always)]
    fn run_on(&mut self, heading: usize, row: usize) -> u64 {
        let at = self.place(heading, row);
        let codes = self.codes.of(row, heading, self.stencil.motions);
        let mut fallen = 0;
        for (pull, codes) in self.stencil.pulls[heading].iter().zip(codes).filter(|(pull, _)| pull.runs_on) {
            let steps = decode_lanes(codes);
            for i in 0..TILE {
                let x = if pull.offset < 0 { i } else { TILE - 1 - i };
                let cost = self.costs[(at + x).wrapping_add_signed(pull.offset)] + steps[x];
                if cost < self.costs[at + x] {
                    self.costs[at + x] = cost;
                    fallen |= 1 << x;
                }
            }
        }
        fallen
    }

    /// Has those looked at that may take costs from some poses.
    #[inline(always)]
    fn pass_on(&mut self, heading: usize, row: usize, cells: u64) {
        let costs = self.costs[self.place(heading, row)..].first_chunk::<TILE>();
        let within = costs.map_or(0, |costs| cells & below(costs, &[self.limit + 1; TILE]));
        self.fallen[heading][row] |= within;
        // Costs that run on along the row have done so.
        for taker in self.stencil.takers[heading].iter().filter(|taker| !taker.runs_on) {
            let from = row.wrapping_add_signed(-taker.rows);
            if from < TILE {
                let [_, origins, _] = taker.origins(within);
                self.pending[from] |= u16::from(origins != 0) << taker.heading;
            }
        }
    }
}

/// Lowers costs to others with the steps from them.
///
/// Written over a whole row: the compiler unrolls shorter loops before it thinks of wide registers.
#[inline(always)]
fn lower_by(best: &mut [u32; TILE], costs: &[u32; TILE], codes: &RowCodes) {
    let steps = decode_lanes(codes);
    for x in 0..TILE {
        best[x] = best[x].min(costs[x] + steps[x]);
    }
}

/// Cells whose costs are below others.
#[inline(always)]
fn below(costs: &[u32; TILE], others: &[u32; TILE]) -> u64 {
    let mut below = 0;
    for x in 0..TILE {
        below |= u64::from(costs[x] < others[x]) << x;
    }
    below
}

/// Compiled for wider registers too, and chosen by what the machine has; whole numbers are the same on every machine.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2+fma", "aarch64+neon"))]
fn sweep(sweep: &mut PoseSweep, codes: &CodesAround<'_>, is_upwards: bool) {
    for i in 0..TILE {
        let row = if is_upwards { i } else { TILE - 1 - i };
        if sweep.pending[row] != 0 {
            sweep.relax_row(row, codes);
        }
    }
}
