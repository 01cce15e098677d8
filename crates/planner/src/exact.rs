//! Least cost to goals from every state, or from starts to every state.

use terrain::Cell;

use crate::{
    cost::{ENDLESS, FORBIDDEN, decode},
    dijkstra::{Dijkstra, Direction},
    field::UNREACHED,
    heading::Heading,
    labels::Labels,
    lattice::State,
    layout::Layout,
    patience::Patience,
    table::CostTable,
};

/// The exact least cost between some poses and every cell and heading: to goals, after which any plan is only a walk, or
/// from starts, which is what they can reach.
///
/// Costs are the table's. Of energy they are `E − Δφ` with the height potential φ of [`Lattice::potential_j`], so energies
/// follow from what the field holds and the potentials of both ends:
///
/// ```text
/// to goals given with φ(goal) + c:       E(state → goal)  = cost(state) − φ(state) − c
/// from starts given with c − φ(start):   E(start → state) = cost(state) + φ(state) − c
/// ```
///
/// The constant c is the same for all goals or starts, and such that none is given with less than nothing: minus the least
/// potential among goals, the highest among starts. With it the goal or start that is best for a state is that of least
/// energy, not of least friction. A budget B of energy is then the limit `B + φ + c` to goals, where φ is the highest
/// potential on the map, and `B + c` from starts, as no potential is negative; states near the limit are told apart by
/// their own energy.
///
/// [`Lattice::potential_j`]: crate::Lattice::potential_j
pub struct ExactField {
    labels: Labels,
    layout: Layout,
    units: f64,
    /// Costs beyond are not known to be the least.
    limit: u32,
}

impl ExactField {
    /// Least costs from every state to the nearest of some goals; `None` when patience ends first.
    ///
    /// `goals` come with the cost that still follows there, in the objective's unit, 0 or more. States that cost more than
    /// `limit` in the same unit are left out, which saves the time for them; infinity leaves out none.
    pub fn to_goals(
        table: &CostTable,
        goals: &[(State, f64)],
        limit: f64,
        patience: &Patience,
    ) -> Option<Self> {
        Self::grow(table, Direction::ToGoals, goals, limit, patience)
    }

    /// Least costs to every state from the nearest of some starts; `None` when patience ends first.
    ///
    /// `starts` come with the cost that went before, in the objective's unit, 0 or more. States that cost more than `limit`
    /// in the same unit are left out, which saves the time for them; infinity leaves out none.
    pub fn from_starts(
        table: &CostTable,
        starts: &[(State, f64)],
        limit: f64,
        patience: &Patience,
    ) -> Option<Self> {
        Self::grow(table, Direction::FromStarts, starts, limit, patience)
    }

    fn grow(
        table: &CostTable,
        direction: Direction,
        seeds: &[(State, f64)],
        limit: f64,
        patience: &Patience,
    ) -> Option<Self> {
        let limit = ((limit * table.units()) as u32).min(ENDLESS - 1);
        let mut search = Dijkstra::new(table, direction, seeds, patience);
        search.settle_within(limit)?;
        let layout = table.lattice().layout;
        Some(ExactField { labels: search.labels, layout, units: table.units(), limit })
    }

    /// Least cost of a state, in the objective's unit; `None` where no motions lead, or none within the limit.
    pub fn cost(&self, state: State) -> Option<f64> {
        let units = self.units_of(state);
        (units != UNREACHED).then(|| f64::from(units) / self.units)
    }

    /// The heading at a cell whose cost is least, with that cost in the objective's unit; `None` where no motions lead, or
    /// none within the limit.
    pub fn least_at(&self, cell: Cell) -> Option<(Heading, f64)> {
        let units = |heading: &Heading| self.units_of(State { cell, heading: *heading });
        let heading = Heading::all().min_by_key(units)?;
        self.cost(State { cell, heading }).map(|cost| (heading, cost))
    }

    /// The same as [`ExactField::cost`] in the table's units; [`UNREACHED`] where there is none.
    fn units_of(&self, state: State) -> u32 {
        let units = self.labels.cost(self.layout.pack(state));
        if units <= self.limit { units } else { UNREACHED }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.labels.bytes()
    }

    /// The best start and the motions from it to the nearest goal, in a field to goals; `None` where no motions lead there.
    pub fn walk(&self, table: &CostTable, starts: &[State]) -> Option<(State, Vec<usize>)> {
        let lattice = table.lattice();
        let cost = |state: State| self.units_of(state);
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
