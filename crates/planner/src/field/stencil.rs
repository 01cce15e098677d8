//! Steps of the lattice's motions in the order in which a field takes them.

use std::ops::Range;

use crate::lattice::displacement::Displacement;

/// Steps of the lattice's motions, by the row they end in.
pub(crate) struct Stencil {
    /// Farthest that a step leads, in cells along either axis.
    pub(crate) reach: usize,
    /// Steps into other rows.
    pub(crate) across: Vec<RowSteps>,
    /// Steps within the row, west and east.
    pub(crate) along: [RowSteps; 2],
    /// Number of all steps.
    pub(crate) count: usize,
}

/// Steps that end in the same row, as their place among all steps and the columns they lead by.
pub(crate) struct RowSteps {
    pub(crate) rows: isize,
    pub(crate) steps: Vec<(usize, isize)>,
    /// How far bits move, up or down, from the ends of a step to its origins, where both can lie in one tile.
    shifts: Vec<(u32, u32)>,
    /// Cells of the tile's row from which one of them ends west, and east, of the tile.
    beyond: [u64; 2],
}

impl Stencil {
    pub(crate) fn new(displacements: &[Displacement]) -> Self {
        let farthest = displacements.iter().map(|d| d.columns.abs().max(d.rows.abs())).max();
        let mut stencil = Stencil {
            reach: farthest.unwrap_or(0) as usize,
            across: Vec::new(),
            along: [(); 2].map(|()| RowSteps::new(0)),
            count: displacements.len(),
        };
        for (i, displacement) in displacements.iter().enumerate() {
            let (rows, step) = (displacement.rows as isize, (i, displacement.columns as isize));
            if rows == 0 {
                stencil.along[usize::from(displacement.columns > 0)].push(step);
                continue;
            }
            if stencil.across.last().is_none_or(|last| last.rows != rows) {
                stencil.across.push(RowSteps::new(rows));
            }
            if let Some(last) = stencil.across.last_mut() {
                last.push(step);
            }
        }
        stencil
    }
}

impl RowSteps {
    fn new(rows: isize) -> Self {
        RowSteps { rows, steps: Vec::new(), shifts: Vec::new(), beyond: [0; 2] }
    }

    fn push(&mut self, step: (usize, isize)) {
        let by = step.1.unsigned_abs() as u32;
        if by < u64::BITS {
            self.shifts.push(if step.1 > 0 { (0, by) } else { (by, 0) });
        }
        let lowest = u64::MAX.checked_shr(u64::BITS.saturating_sub(by)).unwrap_or(0);
        if step.1 < 0 {
            self.beyond[Side::West as usize] |= lowest;
        } else {
            self.beyond[Side::East as usize] |= lowest.reverse_bits();
        }
        self.steps.push(step);
    }

    /// Places among all steps; steps into the same other row follow one another.
    #[inline(always)]
    pub(crate) fn all(&self) -> Range<usize> {
        let first = self.steps.first().map_or(0, |(step, _)| *step);
        first..first + self.steps.len()
    }

    /// Cells of the tile's row from which one of the steps ends in a cell of a set.
    #[inline(always)]
    pub(crate) fn origins(&self, ends: u64) -> u64 {
        // One of the two shifts is by nothing.
        self.shifts.iter().fold(0, |origins, (up, down)| origins | ends.wrapping_shl(*up).wrapping_shr(*down))
    }

    /// Cells of the tile's row from which one of the steps ends west (east) of the tile.
    #[inline(always)]
    pub(crate) fn origins_beyond(&self, side: Side) -> u64 {
        self.beyond[side as usize]
    }
}

/// A side of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    West,
    East,
}
