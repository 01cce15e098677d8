//! Tiles whose surroundings have changed, in the order of the least cost at which anything in them may fall.

use std::{cmp::Reverse, collections::BinaryHeap};

/// What has changed around a tile since it was last taken up.
#[derive(Clone, Copy, Default)]
pub(crate) struct Change {
    /// Ones' complement of the least key of a cell that changed; 0 when there is none.
    key: u32,
    /// Cells of a goal in the tile itself.
    pub(crate) seeded: bool,
    /// Everything is to be looked at.
    pub(crate) whole: bool,
    /// By neighbour from south-west to north-east: rows that have changed in one to the west or east, columns in others;
    /// of the tile itself nothing.
    pub(crate) around: [u64; 9],
}

/// The tiles of a field that are still to be taken up.
pub(crate) struct Front {
    queue: BinaryHeap<Reverse<(u32, u32)>>,
    changes: Vec<Change>,
}

impl Front {
    pub(crate) fn new(tiles: usize) -> Self {
        Front { queue: BinaryHeap::new(), changes: vec![Change::default(); tiles] }
    }

    /// Notes a change that matters to a tile.
    pub(crate) fn note(&mut self, tile: usize, key: u32, change: impl FnOnce(&mut Change)) {
        let known = &mut self.changes[tile];
        change(known);
        if !key > known.key {
            known.key = !key;
            self.queue.push(Reverse((key, tile as u32)));
        }
    }

    /// Takes up to `most` tiles in the order of their keys; the least key there is when that is beyond a limit.
    pub(crate) fn pop_within(&mut self, limit: u32, most: usize) -> Result<Vec<(usize, Change)>, u32> {
        let mut taken = Vec::with_capacity(most);
        while taken.len() < most
            && let Some(&Reverse((key, tile))) = self.queue.peek()
        {
            let change = &mut self.changes[tile as usize];
            // A tile is queued again whenever its key falls; only the last entry counts.
            let is_last = change.key == !key;
            if is_last && key > limit {
                return if taken.is_empty() { Err(key) } else { Ok(taken) };
            }
            self.queue.pop();
            if is_last {
                taken.push((tile as usize, std::mem::take(change)));
            }
        }
        Ok(taken)
    }
}
