//! Steps of the lattice's motions in the order in which a field takes them.

use crate::{displacement::Displacement, layout::TILE};

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
}

impl Stencil {
    pub(crate) fn new(displacements: &[Displacement]) -> Self {
        let farthest = displacements.iter().map(|d| d.columns.abs().max(d.rows.abs())).max();
        let mut stencil = Stencil {
            reach: farthest.unwrap_or(0) as usize,
            across: Vec::new(),
            along: [(); 2].map(|()| RowSteps { rows: 0, steps: Vec::new() }),
            count: displacements.len(),
        };
        for (i, displacement) in displacements.iter().enumerate() {
            let (rows, step) = (displacement.rows as isize, (i, displacement.columns as isize));
            if rows == 0 {
                stencil.along[usize::from(displacement.columns > 0)].steps.push(step);
                continue;
            }
            match stencil.across.last_mut().filter(|last| last.rows == rows) {
                Some(last) => last.steps.push(step),
                None => stencil.across.push(RowSteps { rows, steps: vec![step] }),
            }
        }
        stencil
    }
}

impl RowSteps {
    /// Cells of the tile's row from which one of the steps ends in a cell of a set.
    pub(crate) fn origins(&self, ends: u64) -> u64 {
        self.steps.iter().fold(0, |origins, (_, columns)| {
            let by = columns.unsigned_abs() as u32;
            let moved = if *columns > 0 { ends.checked_shr(by) } else { ends.checked_shl(by) };
            origins | moved.unwrap_or(0)
        })
    }

    /// Cells of the tile's row from which one of the steps ends west (east) of the tile.
    pub(crate) fn origins_beyond(&self, side: Side) -> u64 {
        let columns = self.steps.iter().map(|(_, columns)| columns);
        let by = match side {
            Side::West => columns.map(|c| -c).max(),
            Side::East => columns.copied().max(),
        };
        let cells = by.unwrap_or(0).clamp(0, TILE as isize) as u32;
        let lowest = 1u64.checked_shl(cells).unwrap_or(0).wrapping_sub(1);
        match side {
            Side::West => lowest,
            Side::East => lowest.reverse_bits(),
        }
    }
}

/// A side of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    West,
    East,
}
