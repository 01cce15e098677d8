//! Motions as poses take their costs from each other, in the order in which an exact field looks at them.

use crate::{
    frontier::dijkstra::Direction,
    grid::{heading::HEADINGS, layout::TILE},
    lattice::graph::Lattice,
};

/// Motions by the heading of the pose whose cost they may lower, and by that of the pose they lower it from.
#[derive(Clone)]
pub(crate) struct PoseStencil {
    /// Farthest that a motion leads, in cells along either axis.
    pub(crate) reach: usize,
    /// Rows within which motions are driven from, on either side of a pose.
    pub(crate) driven_within: usize,
    /// Motions of every heading.
    pub(crate) motions: usize,
    pub(crate) pulls: [Vec<Pull>; HEADINGS],
    pub(crate) takers: [Vec<Taker>; HEADINGS],
}

/// How a pose may take its cost from another.
#[derive(Clone, Copy)]
pub(crate) struct Pull {
    /// Place of the other's cost, counted from the pose's, among those of a tile and around it.
    pub(crate) offset: isize,
    /// Whether it leads along the row and keeps the heading, so that costs run on from cell to cell.
    pub(crate) runs_on: bool,
    /// Rows and columns from the pose to where the motion between the two is driven from.
    pub(crate) driven_from: (isize, isize),
    /// The motion's slot among the codes of that cell.
    pub(crate) slot: usize,
}

/// The same seen from the other: poses of a heading from which it lies at some columns and rows may take its cost.
#[derive(Clone, Copy)]
pub(crate) struct Taker {
    pub(crate) heading: usize,
    pub(crate) columns: isize,
    pub(crate) rows: isize,
    pub(crate) runs_on: bool,
}

impl PoseStencil {
    /// The motions of a lattice whose codes take `stride` slots a state.
    pub(crate) fn new(lattice: &Lattice, stride: usize, direction: Direction) -> Self {
        let motions = lattice.motions.iter().flatten();
        let reach = motions.map(|m| m.columns.abs().max(m.rows.abs())).max().unwrap_or(0) as usize;
        let mut stencil = PoseStencil {
            reach,
            driven_within: if direction == Direction::ToGoals { 0 } else { reach },
            motions: lattice.motions_per_state(),
            pulls: [const { Vec::new() }; HEADINGS],
            takers: [const { Vec::new() }; HEADINGS],
        };
        let width = stencil.width() as isize;
        for (motion, m) in lattice.motions.iter().flat_map(|motions| motions.iter().enumerate()) {
            let (from, to) = (m.from.index(), m.to.index());
            let (at, other, sign) = match direction {
                Direction::ToGoals => (from, to, 1),
                Direction::FromStarts => (to, from, -1),
            };
            let (columns, rows) = (sign * m.columns as isize, sign * m.rows as isize);
            let runs_on = at == other && rows == 0;
            stencil.pulls[at].push(Pull {
                offset: ((other as isize - at as isize) * width + rows) * width + columns,
                runs_on,
                driven_from: if direction == Direction::ToGoals { (0, 0) } else { (rows, columns) },
                slot: from * stride + motion,
            });
            stencil.takers[other].push(Taker { heading: at, columns, rows, runs_on });
        }
        stencil
    }

    /// Cells along a side of a tile with those within reach around it.
    pub(crate) fn width(&self) -> usize {
        TILE + 2 * self.reach
    }
}

impl Taker {
    /// Cells of the tile to the west, of the same tile and of that to the east which may take costs from a set of cells.
    #[inline(always)]
    pub(crate) fn origins(&self, cells: u64) -> [u64; 3] {
        let by = self.columns.unsigned_abs() as u32;
        let west = |by| cells.checked_shr(by).unwrap_or(0);
        let east = |by| cells.checked_shl(by).unwrap_or(0);
        match self.columns {
            0 => [0, cells, 0],
            1.. => [east(u64::BITS - by), west(by), 0],
            _ => [0, east(by), west(u64::BITS - by)],
        }
    }
}
