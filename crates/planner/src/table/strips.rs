//! Costs of a tile for a search that looks at little of it: a row of cells under one heading at a time.

use std::sync::{
    Arc, Mutex, MutexGuard, OnceLock, PoisonError,
    atomic::{AtomicUsize, Ordering},
};

use terrain::Cell;

use crate::{
    grid::{
        heading::HEADINGS,
        layout::{HEADING_BITS, Layout, TILE},
    },
    ground::blocked::Blocked,
    lattice::graph::Lattice,
    patience::Patience,
    table::{
        tile::TileKernel,
        tile_builder::{QUAD, RowCodes, code_place},
        window::Window,
    },
};

/// A tile of which some strips have been evaluated.
pub(crate) struct Strips {
    /// South-western cell of the tile.
    origin: Cell,
    /// Columns of the tile that the map has.
    columns: usize,
    /// The ground about the tile, while it is needed.
    surroundings: Mutex<Option<Arc<(Window, Blocked)>>>,
    /// Codes by row and heading, motion by motion.
    strips: Box<[OnceLock<Box<[RowCodes]>>]>,
    evaluated: AtomicUsize,
}

/// Strips of a tile.
const STRIPS: usize = TILE * HEADINGS;
/// Strips after which all of the tile is evaluated at once, which its rows can share cores for: until then at most a quarter of that work
/// has been done in vain.
const MOST_STRIPS: usize = STRIPS / 4;

/// Codes of all motions from one state.
#[derive(Clone, Copy)]
pub(crate) struct StateCodes<'t> {
    codes: &'t [u16],
    /// From one motion to the next.
    apart: usize,
}

impl<'t> StateCodes<'t> {
    /// Of a state of a tile whose codes are held.
    #[inline(always)]
    pub(crate) fn of_tile(codes: &'t [u16], state: u32, stride: usize) -> Self {
        StateCodes { codes: &codes[code_place(Layout::within(state), stride)..], apart: QUAD }
    }

    /// Motion by motion; there may be more of them than the state has motions.
    #[inline(always)]
    pub(crate) fn iter(self) -> impl Iterator<Item = u16> + 't {
        self.codes.iter().step_by(self.apart).copied()
    }

    /// That of one motion.
    #[inline(always)]
    pub(crate) fn of(self, motion: usize) -> Option<u16> {
        self.codes.get(motion * self.apart).copied()
    }
}

impl Strips {
    /// A tile of which nothing is known.
    pub(crate) fn new(lattice: &Lattice, tile: usize) -> Self {
        let (tile_row, tile_column) = lattice.layout.tile_place(tile);
        let origin = Cell { row: tile_row * TILE, column: tile_column * TILE };
        Strips {
            origin,
            columns: TILE.min(lattice.terrain.grid.columns - origin.column),
            surroundings: Mutex::default(),
            strips: (0..STRIPS).map(|_| OnceLock::new()).collect(),
            evaluated: AtomicUsize::new(0),
        }
    }

    /// Whether it is time to evaluate all of the tile.
    pub(crate) fn are_many(&self) -> bool {
        self.evaluated.load(Ordering::Relaxed) >= MOST_STRIPS
    }

    /// Codes of a state of the tile, evaluated when its strip is first asked for; `None` when patience ends first.
    #[inline]
    pub(crate) fn codes(
        &self,
        (kernel, lattice): (&TileKernel, &Lattice),
        state: u32,
        patience: &Patience,
    ) -> Option<StateCodes<'_>> {
        let strip = &self.strips[strip_of(state)];
        if strip.get().is_none() {
            let within = Layout::within(state) >> HEADING_BITS;
            let place = (within / TILE, state as usize % HEADINGS);
            let surroundings = self.surroundings(kernel, lattice);
            let (window, blocked) = &*surroundings;
            let codes = kernel.strip_codes((window, blocked), place, self.columns, patience)?;
            if strip.set(codes).is_ok() {
                self.evaluated.fetch_add(1, Ordering::Relaxed);
            }
            // A strip takes some microseconds, and a search asks for many.
            if patience.is_over() {
                return None;
            }
        }
        self.codes_at_hand(state)
    }

    fn surroundings(&self, kernel: &TileKernel, lattice: &Lattice) -> Arc<(Window, Blocked)> {
        let mut known = self.lock();
        Arc::clone(known.get_or_insert_with(|| Arc::new(kernel.surroundings(lattice, self.origin))))
    }

    /// Lets go of what only further strips need.
    pub(crate) fn rest(&self) {
        *self.lock() = None;
    }

    fn lock(&self) -> MutexGuard<'_, Option<Arc<(Window, Blocked)>>> {
        self.surroundings.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Codes of a state if its strip has been evaluated.
    #[inline]
    pub(crate) fn codes_at_hand(&self, state: u32) -> Option<StateCodes<'_>> {
        let codes = self.strips[strip_of(state)].get()?.as_flattened();
        let column = (Layout::within(state) >> HEADING_BITS) % TILE;
        Some(StateCodes { codes: &codes[column..], apart: TILE })
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        let codes = self.strips.iter().filter_map(OnceLock::get).map(|codes| size_of_val(&codes[..]));
        let ground = self.lock().as_ref().map_or(0, |ground| ground.0.bytes() + ground.1.bytes());
        size_of_val(&self.strips[..]) + ground + codes.sum::<usize>()
    }
}

/// Position of a state's strip in its tile.
#[inline(always)]
fn strip_of(state: u32) -> usize {
    let within = Layout::within(state);
    (within >> HEADING_BITS) / TILE * HEADINGS + (within & (HEADINGS - 1))
}
