//! From a goal that was reached back to the start, by the labels alone.

use crate::{
    frontier::labels::{Labels, UNREACHED},
    grid::{
        cost::{FORBIDDEN, decode},
        heading::Heading,
        state::State,
    },
    ground::spans::shifted,
    lattice::graph::Lattice,
    patience::{Patience, work},
    table::cost_table::CostTable,
};

/// States that are looked at to find the one before, which lie all over memory.
const PREDECESSORS: u64 = 8 * work::STATE;

/// How a walk ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Walked {
    /// At a start, with the motions from there.
    Start(State, Vec<usize>),
    /// At a state that is no start and has no predecessor; costs that rise along every motion rule it out.
    Astray,
    /// On the way, because patience did.
    Late,
}

/// The start and the motions that led to a state: at each state the predecessor with the least cost through it.
///
/// Every motion costs at least one unit, so each predecessor costs less than the state: the walk takes as many steps as
/// the goal costs units at most, and comes to a state that costs nothing, which only starts do.
pub(crate) fn walk_back(
    table: &CostTable,
    labels: &Labels,
    (starts, goal): (&[State], u32),
    patience: &Patience,
) -> Walked {
    let lattice = table.lattice();
    let mut motions = Vec::new();
    let mut state = lattice.layout.unpack(goal);
    let mut cost = labels.cost(goal);
    let mut pacer = patience.pacer();
    while cost > 0 {
        // Memory is asked for the labels of all predecessors.
        if pacer.after(PREDECESSORS).is_none() {
            return Walked::Late;
        }
        // The cost of each state came from one of its predecessors, whose own can only have fallen since.
        let Some(found) = predecessor(table, labels, state, patience) else { return Walked::Late };
        let Some((before, motion, known)) = found.filter(|found| found.2 < cost) else {
            return Walked::Astray;
        };
        motions.push(motion);
        (state, cost) = (before, known);
    }
    if !starts.contains(&state) {
        return Walked::Astray;
    }
    motions.reverse();
    Walked::Start(state, motions)
}

/// The state through which another costs least, the motion between them and the cost of the former, if there is one; `None` when patience ends
/// first.
fn predecessor(
    table: &CostTable,
    labels: &Labels,
    state: State,
    patience: &Patience,
) -> Option<Option<(State, usize, u32)>> {
    let lattice = table.lattice();
    let mut best: Option<(u32, (State, usize, u32))> = None;
    for (before, motion) in predecessors(lattice, state) {
        let packed = lattice.layout.pack(before);
        let known = labels.cost(packed);
        if known == UNREACHED {
            continue;
        }
        // Also of states that were reached and not expanded: some lead there for less.
        let code = table.state_codes(packed, patience)?.of(motion).unwrap_or(FORBIDDEN);
        let total = known.saturating_add(decode(code));
        if code != FORBIDDEN && best.is_none_or(|(least, _)| total < least) {
            best = Some((total, (before, motion, known)));
        }
    }
    Some(best.map(|(_, found)| found))
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
