//! Least cost to a goal from every state: from it any plan is only a walk.

use crate::{
    backward::Backward,
    cost::{FORBIDDEN, decode},
    field::UNREACHED,
    labels::Labels,
    lattice::State,
    patience::Patience,
    table::CostTable,
};

/// The exact cost to a goal from every cell and heading, for goals that are asked for again and again.
pub struct ExactField {
    labels: Labels,
}

impl ExactField {
    /// Backward Dijkstra over all states that lead to the goals; `None` when patience ends first.
    ///
    /// `goals` come with the cost that still follows there, in the objective's unit.
    pub fn new(table: &CostTable, goals: &[(State, f64)], patience: &Patience) -> Option<Self> {
        let mut search = Backward::new(table, goals, patience);
        search.settle(u64::MAX, |_| {})?;
        Some(ExactField { labels: search.labels })
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.labels.bytes()
    }

    /// The best start and the motions from it to the goal; `None` where no motions lead there.
    pub fn walk(&self, table: &CostTable, starts: &[State]) -> Option<(State, Vec<usize>)> {
        let lattice = table.lattice();
        let cost = |state: State| self.labels.cost(lattice.layout.pack(state));
        let start = starts.iter().copied().min_by_key(|start| cost(*start))?;
        if cost(start) == UNREACHED {
            return None;
        }
        let (mut state, mut motions) = (start, Vec::new());
        let mut ahead = cost(state);
        loop {
            let packed = lattice.layout.pack(state);
            let ways = (0..lattice.motions_per_state()).filter_map(|motion| {
                let code = table.code(packed, motion);
                let next = lattice.successor(state, motion).filter(|_| code != FORBIDDEN)?;
                let total = cost(next).saturating_add(decode(code));
                (total <= ahead && cost(next) < ahead).then_some((total, cost(next), next, motion))
            });
            // At a goal no motion gets any nearer.
            let Some((_, less, next, motion)) = ways.min_by_key(|(total, ..)| *total) else { break };
            motions.push(motion);
            (state, ahead) = (next, less);
        }
        Some((start, motions))
    }
}
