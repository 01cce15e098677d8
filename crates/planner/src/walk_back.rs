//! From a goal that was reached back to the start, by the labels alone.

use crate::{
    cost::{FORBIDDEN, decode},
    field::UNREACHED,
    footprint::shifted,
    heading::Heading,
    labels::Labels,
    lattice::{Lattice, State},
    table::CostTable,
};

/// The start and the motions that led to a state: at each state the predecessor with the least cost through it.
pub(crate) fn walk_back(table: &CostTable, labels: &Labels, goal: u32) -> (State, Vec<usize>) {
    let lattice = table.lattice();
    let layout = &lattice.layout;
    let mut motions = Vec::new();
    let mut state = layout.unpack(goal);
    let mut cost = labels.cost(goal);
    while cost > 0 {
        let before = predecessors(lattice, state)
            .filter_map(|(before, motion)| {
                let packed = layout.pack(before);
                let known = labels.cost(packed);
                if known == UNREACHED {
                    return None;
                }
                let code = table.code(packed, motion);
                (code != FORBIDDEN).then(|| (known.saturating_add(decode(code)), known, before, motion))
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
fn predecessors(lattice: &Lattice, end: State) -> impl Iterator<Item = (State, usize)> + '_ {
    Heading::all().flat_map(move |from| {
        lattice.motions[from.index()].iter().enumerate().filter(move |(_, m)| m.to == end.heading).filter_map(
            move |(index, m)| {
                let cell = shifted(&lattice.terrain, end.cell, (-m.columns, -m.rows))?;
                Some((State { cell, heading: from }, index))
            },
        )
    })
}
