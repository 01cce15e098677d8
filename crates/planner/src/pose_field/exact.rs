//! Least cost to goals from every state, or from starts to every state.

use terrain::Cell;

use crate::{
    error::Error,
    frontier::{dijkstra::Direction, labels::UNREACHED},
    grid::{
        cost::{ENDLESS, FORBIDDEN, decode},
        heading::Heading,
        layout::Layout,
        state::State,
    },
    patience::{Patience, work},
    pose_field::{pose_costs::PoseCosts, pose_growth::grow},
    table::{
        cost_table::CostTable,
        tile_builder::{QUAD, code_place},
    },
};

/// Work of a step of a walk, which asks memory for all successors.
const STEP_OF_A_WALK: u64 = 4 * work::STATE;

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
    costs: PoseCosts,
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
        limit_cost: f64,
        patience: &Patience,
    ) -> Option<Self> {
        let limit = ((limit_cost * table.units()) as u32).min(ENDLESS - 1);
        let within = seeds.iter().filter(|(_, beyond)| *beyond <= limit_cost);
        let seeds: Vec<(State, u32)> =
            within.map(|(seed, beyond)| (*seed, (beyond * table.units()) as u32)).collect();
        let costs = grow(table, direction, &seeds, limit, patience)?;
        Some(ExactField { costs, layout: table.lattice().layout, units: table.units(), limit })
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
        let units = self.costs.cost(self.layout.pack(state));
        if units <= self.limit { units } else { UNREACHED }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.costs.bytes()
    }

    /// The cost of a state in the table's units, see [`ExactField::cost`].
    pub(crate) fn units_at(&self, state: State) -> Option<u32> {
        Some(self.units_of(state)).filter(|units| *units != UNREACHED)
    }

    /// The best start and the motions from it to the nearest goal, in a field to goals; `None` where no motions lead there.
    ///
    /// Every motion costs at least one unit, so the cost ahead falls from state to state, and the walk ends.
    ///
    /// # Errors
    /// Patience that ended first.
    pub fn walk(
        &self,
        table: &CostTable,
        starts: &[State],
        patience: &Patience,
    ) -> Result<Option<(State, Vec<usize>)>, Error> {
        let late = Error::Timeout { expanded: 0 };
        let Some(start) = starts.iter().copied().min_by_key(|start| self.units_of(*start)) else {
            return Ok(None);
        };
        let (mut state, mut motions, mut ahead) = (start, Vec::new(), self.units_of(start));
        if ahead == UNREACHED {
            return Ok(None);
        }
        let mut pacer = patience.pacer();
        loop {
            pacer.after(STEP_OF_A_WALK).ok_or(late.clone())?;
            // At a goal no motion gets any nearer.
            let Some((motion, next)) = self.step(table, (state, ahead), patience).ok_or(late.clone())? else {
                return Ok(Some((start, motions)));
            };
            motions.push(motion);
            (state, ahead) = (next, self.units_of(next));
        }
    }

    /// The motion from a state with the least cost by it; outside `None` where patience ends first, inside at a goal.
    fn step(
        &self,
        table: &CostTable,
        (state, ahead): (State, u32),
        patience: &Patience,
    ) -> Option<Option<(usize, State)>> {
        let lattice = table.lattice();
        let packed = lattice.layout.pack(state);
        let codes = table.codes(Layout::tile(packed), patience)?;
        let place = code_place(Layout::within(packed), table.stride());
        let ways = (0..lattice.motions_per_state()).filter_map(|motion| {
            let code = codes.get(place + motion * QUAD).copied().unwrap_or(FORBIDDEN);
            let next = lattice.successor(state, motion).filter(|_| code != FORBIDDEN)?;
            let cost = self.units_of(next);
            let total = cost.saturating_add(decode(code));
            (total <= ahead && cost < ahead).then_some((total, (motion, next)))
        });
        Some(ways.min_by_key(|(total, _)| *total).map(|(_, way)| way))
    }
}
