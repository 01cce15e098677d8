//! A pose of the lattice.

use terrain::Cell;

use crate::grid::heading::Heading;

/// A pose of the lattice: a cell centre and a heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct State {
    /// The cell.
    pub cell: Cell,
    /// The heading.
    pub heading: Heading,
}
