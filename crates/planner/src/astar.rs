//! A* over the lattice.

use std::collections::HashMap;

use crate::{
    cost::{FORBIDDEN, decode},
    heading::{HEADINGS, Heading},
    heuristic::{BUCKET_SHIFT, GoalField, UNREACHED},
    lattice::{Lattice, State},
    layout::{Layout, Shift},
    patience::Patience,
    prefetch::prefetch,
    queue::BucketQueue,
    table::{CostTable, TILE_STATES},
};

/// What to search for.
pub struct Search<'s> {
    /// Where the robot may start.
    pub starts: &'s [State],
    /// Where it may end, with the cost that is still to be added there, in the objective's unit.
    pub goals: &'s [(State, f64)],
    /// When to give up.
    pub patience: &'s Patience,
}

/// How a search ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The best path: its start and the motion taken at each state on the way.
    Found {
        /// The start that was best.
        start: State,
        /// Motions in order.
        motions: Vec<usize>,
        /// States expanded.
        expanded: u64,
    },
    /// No motion leads from a start to a goal.
    Unreachable,
    /// The deadline passed first.
    Timeout {
        /// States expanded.
        expanded: u64,
    },
}

/// Expansions between two looks at the clock.
const CLOCK_EVERY: u64 = 4096;
/// How many states before its turn a state is asked of memory. Asking for its successors too gained nothing measurable.
const CODES_AHEAD: usize = 3;

/// Least cost found so far of every state, in tiles that exist once they are touched.
struct Reached {
    tiles: Vec<Option<Box<[u32]>>>,
}

impl Reached {
    fn new(layout: &Layout) -> Self {
        Reached { tiles: vec![None; layout.tiles()] }
    }

    #[inline(always)]
    fn at(&mut self, state: u32) -> &mut u32 {
        let tile = self.tiles[Layout::tile(state)]
            .get_or_insert_with(|| vec![UNREACHED; TILE_STATES].into_boxed_slice());
        &mut tile[Layout::within(state)]
    }

    /// Hints that a state will be asked for; the packing of one beyond the map may name no tile.
    #[inline(always)]
    fn prefetch(&self, state: u32) {
        if let Some(Some(tile)) = self.tiles.get(Layout::tile(state)) {
            prefetch(tile, Layout::within(state));
        }
    }

    fn get(&self, state: u32) -> u32 {
        self.tiles[Layout::tile(state)].as_ref().map_or(UNREACHED, |tile| tile[Layout::within(state)])
    }
}

/// A motion as the search takes it.
#[derive(Clone, Copy, Default)]
struct Move {
    shift: Shift,
    heading: u32,
}

/// Finds the least-cost path from any start to any goal.
pub fn search(
    lattice: &Lattice<'_>,
    table: &CostTable<'_>,
    field: &GoalField,
    query: &Search<'_>,
) -> Outcome {
    let layout = &lattice.layout;
    let estimate = |state: u32| field.units_at(state);
    let moves = moves(lattice);
    let stride = table.stride();
    let mut reached = Reached::new(layout);
    let mut queue = BucketQueue::new(BUCKET_SHIFT);
    let units = |after: f64| (after * table.units()) as u32;
    let goals: HashMap<u32, u32> =
        query.goals.iter().map(|(state, after)| (layout.pack(*state), units(*after))).collect();
    let highest_after = goals.values().copied().max().unwrap_or(0);
    for &start in query.starts {
        let packed = layout.pack(start);
        let ahead = estimate(packed);
        if ahead != UNREACHED {
            *reached.at(packed) = 0;
            queue.push(ahead, (0, packed));
        }
    }
    let mut best: Option<(u32, u32)> = None;
    let mut expanded = 0u64;
    while let Some((cost, state)) = queue.pop() {
        if best.is_some_and(|(total, _)| queue.least_key() >= total) {
            break;
        }
        if cost > *reached.at(state) {
            continue;
        }
        if expanded.is_multiple_of(CLOCK_EVERY) && query.patience.is_over() {
            return Outcome::Timeout { expanded };
        }
        expanded += 1;
        // Only where the field is as low as at a goal is it worth looking the state up.
        if estimate(state) <= highest_after
            && let Some(&after) = goals.get(&state)
            && best.is_none_or(|(total, _)| cost + after < total)
        {
            best = Some((cost + after, state));
        }
        if let Some((_, soon)) = queue.peek(CODES_AHEAD) {
            prefetch(table.tile(Layout::tile(soon)), Layout::within(soon) * stride);
            reached.prefetch(soon);
        }
        let codes = &table.tile(Layout::tile(state))[Layout::within(state) * stride..][..stride];
        let moves = &moves[(state as usize & (HEADINGS - 1)) * stride..][..stride];
        for (code, step) in codes.iter().zip(moves) {
            if *code == FORBIDDEN {
                continue;
            }
            let next = layout.shift(state, step.shift) | step.heading;
            let total = cost.saturating_add(decode(*code));
            let known = reached.at(next);
            if total < *known {
                *known = total;
                let ahead = estimate(next);
                if ahead != UNREACHED {
                    queue.push(total.saturating_add(ahead), (total, next));
                }
            }
        }
    }
    let Some((_, goal)) = best else { return Outcome::Unreachable };
    let (start, motions) = walk_back(lattice, table, &reached, goal);
    Outcome::Found { start, motions, expanded }
}

/// All motions by heading, `stride` slots each.
fn moves(lattice: &Lattice<'_>) -> Vec<Move> {
    let stride = lattice.motions_per_state().next_multiple_of(4);
    let mut moves = vec![Move::default(); HEADINGS * stride];
    for (heading, motions) in lattice.motions.iter().enumerate() {
        for (i, motion) in motions.iter().enumerate() {
            let shift = lattice.layout.prepare(motion.columns, motion.rows);
            moves[heading * stride + i] = Move { shift, heading: motion.to.index() as u32 };
        }
    }
    moves
}

/// The start and the motions that led to a state: at each state the predecessor with the least cost through it.
fn walk_back(
    lattice: &Lattice<'_>,
    table: &CostTable<'_>,
    reached: &Reached,
    goal: u32,
) -> (State, Vec<usize>) {
    let layout = &lattice.layout;
    let mut motions = Vec::new();
    let mut state = layout.unpack(goal);
    let mut cost = reached.get(goal);
    while cost > 0 {
        let before = predecessors(lattice, state)
            .filter_map(|(before, motion)| {
                let packed = layout.pack(before);
                let known = reached.get(packed);
                let code = table.tile(Layout::tile(packed))[Layout::within(packed) * table.stride() + motion];
                (known != UNREACHED && code != FORBIDDEN)
                    .then(|| (known.saturating_add(decode(code)), known, before, motion))
            })
            .min_by_key(|(total, ..)| *total);
        // The cost of each state came from one of its predecessors, whose own can only have fallen since.
        let Some((total, known, before, motion)) = before else { break };
        debug_assert!(total <= cost, "a state's cost came from none of its predecessors");
        motions.push(motion);
        state = before;
        cost = known;
    }
    motions.reverse();
    (state, motions)
}

/// States from which a motion leads to a state.
fn predecessors<'a>(lattice: &'a Lattice<'_>, end: State) -> impl Iterator<Item = (State, usize)> + 'a {
    Heading::all().flat_map(move |from| {
        lattice.motions[from.index()].iter().enumerate().filter(move |(_, m)| m.to == end.heading).filter_map(
            move |(index, m)| {
                let cell = crate::footprint::shifted(lattice.terrain, end.cell, (-m.columns, -m.rows))?;
                Some((State { cell, heading: from }, index))
            },
        )
    })
}
