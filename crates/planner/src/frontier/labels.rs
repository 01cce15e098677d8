//! Least cost found so far of every state a search has reached, in memory that is kept from one search to the next.

use crate::{
    frontier::{prefetch::prefetch, queue::BucketQueue},
    grid::layout::Layout,
    patience::Patience,
    table::tile_builder::TILE_STATES,
};

/// Cost of what was not reached.
pub(crate) const UNREACHED: u32 = u32::MAX;

/// What a search works with; keep it for the next search over the same lattice, which then starts at once.
pub struct Workspace {
    pub(crate) labels: Labels,
    pub(crate) queue: BucketQueue,
}

impl Workspace {
    pub(crate) fn new(layout: &Layout, bucket_shift: u32) -> Self {
        Workspace { labels: Labels::new(layout), queue: BucketQueue::new(bucket_shift) }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.labels.bytes() + self.queue.bytes()
    }

    /// Bytes held for each state of the tiles that the last search touched.
    pub fn bytes_per_state(&self) -> f64 {
        let states = self.labels.tiles.iter().flatten().count() * TILE_STATES;
        self.bytes() as f64 / states.max(1) as f64
    }

    /// Forgets the last search; where patience ends first, `None`, and the next search goes on with it.
    pub(crate) fn clear(&mut self, patience: &Patience) -> Option<()> {
        self.labels.clear(patience)?;
        self.queue.clear();
        Some(())
    }
}

/// Costs in tiles that exist once they are touched.
///
/// A label is the ones' complement of a cost, so that 0, as fresh memory is, stands for a state that was not reached, and
/// memory that no state touches is never written.
pub(crate) struct Labels {
    tiles: Vec<Option<Box<[u32]>>>,
    /// States that have a label, up to `log_limit`.
    log: Vec<u32>,
    log_limit: usize,
}

/// Work of giving the 64 pages of a tile back.
const FREEING_A_TILE: u64 = TILE_STATES as u64 / 16;
/// Up to so many labels are taken back one by one; beyond, their tiles are given back, which costs less.
const LOG_LIMIT: usize = 1 << 14;

impl Labels {
    fn new(layout: &Layout) -> Self {
        Labels { tiles: vec![None; layout.tiles()], log: Vec::new(), log_limit: LOG_LIMIT }
    }

    /// Labels that are not meant to be cleared.
    pub(crate) fn unlogged(layout: &Layout) -> Self {
        Labels { tiles: vec![None; layout.tiles()], log: Vec::new(), log_limit: 0 }
    }

    /// Lowers a state's cost; `false` when it was as low before.
    #[inline(always)]
    pub(crate) fn lower(&mut self, state: u32, cost: u32) -> bool {
        let tile =
            self.tiles[Layout::tile(state)].get_or_insert_with(|| vec![0; TILE_STATES].into_boxed_slice());
        let label = &mut tile[Layout::within(state)];
        if !cost <= *label {
            return false;
        }
        if *label == 0 && self.log.len() <= self.log_limit {
            self.log.push(state);
        }
        *label = !cost;
        true
    }

    /// The cost of a state; the largest number where it was not reached.
    #[inline(always)]
    pub(crate) fn cost(&self, state: u32) -> u32 {
        self.tiles[Layout::tile(state)].as_ref().map_or(u32::MAX, |tile| !tile[Layout::within(state)])
    }

    /// Whether a tile has any labels.
    pub(crate) fn holds(&self, tile: usize) -> bool {
        self.tiles[tile].is_some()
    }

    /// Hints that a state will be asked for; the packing of one beyond the map may name no tile.
    #[inline(always)]
    pub(crate) fn prefetch(&self, state: u32) {
        if let Some(Some(tile)) = self.tiles.get(Layout::tile(state)) {
            prefetch(tile, Layout::within(state));
        }
    }

    fn clear(&mut self, patience: &Patience) -> Option<()> {
        if self.log.len() > self.log_limit {
            let mut pacer = patience.pacer();
            for tile in self.tiles.iter_mut().filter(|tile| tile.is_some()) {
                // The log stays over its limit meanwhile.
                pacer.after(FREEING_A_TILE)?;
                *tile = None;
            }
        }
        for state in self.log.drain(..) {
            if let Some(tile) = &mut self.tiles[Layout::tile(state)] {
                tile[Layout::within(state)] = 0;
            }
        }
        Some(())
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        let tiles = self.tiles.iter().flatten().count();
        tiles * TILE_STATES * size_of::<u32>() + self.log.capacity() * size_of::<u32>()
    }
}
