//! Memory of requests: reserved before it is taken, from the first byte of a body to the last byte of its answer.

mod account;
mod document;
mod held_body;
mod reserved;

use terrain::{MapFile, Terrain};

pub(crate) use account::{Account, accounted, hold};
pub(crate) use document::document_bytes;
pub(crate) use held_body::holding;
pub(crate) use reserved::{Memory, Reserved};

use crate::Engine;

/// Costs of all motions from a cell and the least of them, where a search comes by: `planner` measures 1.5 GB for 2048² cells.
const TABLE_BYTES_PER_CELL: u64 = 360;
/// Labels and queue of a search at most: `joulepath bench` measures 4 to 9 bytes for each of a cell's sixteen states.
const SEARCH_BYTES_PER_CELL: u64 = 16 * 9;
/// The least costs to a goal, four bytes a cell, and what making them takes.
const FIELD_BYTES_PER_CELL: u64 = 8;
/// The terrain that a map in a request becomes; the map itself is counted from when it was read.
const INLINE_BYTES_PER_CELL: u64 = 8;

/// Bytes that a plan may take beyond what is kept already, should it go all over the map.
pub(crate) fn estimated_bytes(
    engine: &Engine,
    map_id: Option<&str>,
    stored: Option<&Terrain>,
    inline: Option<&MapFile>,
) -> u64 {
    let own = SEARCH_BYTES_PER_CELL + FIELD_BYTES_PER_CELL;
    match (stored, inline) {
        (Some(terrain), _) => {
            let at_hand = map_id.is_some_and(|id| engine.planners().knows(id));
            let table = if at_hand { 0 } else { TABLE_BYTES_PER_CELL };
            terrain.grid.cells() as u64 * (own + table)
        }
        (None, Some(map)) => map.cells() as u64 * (own + TABLE_BYTES_PER_CELL + INLINE_BYTES_PER_CELL),
        (None, None) => 0,
    }
}
