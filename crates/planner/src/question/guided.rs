//! The search for a path and the field that leads it.

use std::sync::Arc;

use terrain::Cell;

use crate::{
    error::Error,
    field::{
        fields::{FieldKey, Towards},
        goal_field::GoalField,
    },
    hindrance::Hindrance,
    lattice::{graph::Lattice, objective::Objective},
    path::route::Route,
    patience::{Patience, work},
    question::{
        ends::Ends,
        planner::Planner,
        query::Query,
        rings::{farthest_ring, ring},
    },
    search::{
        astar::{Found, Outcome, Search, search_within},
        changes::Changes,
        changing::search_changing,
    },
    table::step_costs::StepCosts,
};

/// A search over what another planner's field proves is given up once it has expanded one state for so many cells of the map. A state's costs
/// may take ten times as long to work out as the field's of a cell, so that a search in vain takes a third of the time of the field that
/// follows.
const CELLS_FOR_A_STATE: usize = 32;
/// States that it may expand on the smallest maps.
const LEAST_EXPANDED: usize = 1024;

impl Planner {
    /// The field that leads to the goals of a question: for bounds of costs another planner's, where one proves anything.
    pub(super) fn guide(
        &self,
        ends: &Ends,
        (query, objective): (&Query, Objective),
        costs: StepCosts,
    ) -> Result<Arc<GoalField>, Error> {
        let key = FieldKey::new(objective, &ends.goals);
        let start = ends.start.cell;
        // Such a field knows nothing of changes.
        if costs == StepCosts::Bounds && Changes::of(self.lattice(), objective).is_none() {
            if let Some(field) = self.fields().at_hand(&key, start) {
                return Ok(field);
            }
            let goals = ends.goals_with_potential(self.lattice(), objective);
            if let Some(field) = self.related_field(&key, (start, &goals), objective, &query.patience) {
                self.fields().keep_related(key, start, &field);
                return Ok(field);
            }
        }
        self.own_guide(ends, (query, objective), costs)
    }

    /// The field that is worked out from the planner's own costs.
    fn own_guide(
        &self,
        ends: &Ends,
        (query, objective): (&Query, Objective),
        costs: StepCosts,
    ) -> Result<Arc<GoalField>, Error> {
        let goals = ends.goals_with_potential(self.lattice(), objective);
        let key = FieldKey::new(objective, &ends.goals);
        let towards = Towards { start: ends.start.cell, costs, bound: query.bound };
        let field = self.fields().field(key, self.table(objective), &goals, towards, &query.patience);
        field.ok_or(Error::Timeout { expanded: 0 })
    }

    /// A path between ends.
    pub(super) fn search(
        &self,
        ends: &Ends,
        (query, objective): (&Query, Objective),
        costs: StepCosts,
    ) -> Result<Found, Error> {
        let lattice = self.lattice();
        let mut field = self.guide(ends, (query, objective), costs)?;
        if field.costs() == StepCosts::Related {
            let most_expanded = (lattice.terrain.grid.cells() / CELLS_FOR_A_STATE).max(LEAST_EXPANDED);
            match self.search_by(&field, ends, (query, objective), most_expanded as u64) {
                Outcome::Found(found) if !found.late || query.patience.is_over() => return Ok(found),
                Outcome::Timeout { expanded } if query.patience.is_over() => {
                    return Err(Error::Timeout { expanded });
                }
                // What it proves was not enough.
                _ => field = self.own_guide(ends, (query, objective), costs)?,
            }
        }
        match self.search_by(&field, ends, (query, objective), u64::MAX) {
            Outcome::Found(found) => Ok(found),
            Outcome::Timeout { expanded } => Err(Error::Timeout { expanded }),
            Outcome::Untraceable => Err(Error::Untraceable),
            Outcome::Unreachable => {
                let cells = [ends.start.cell, ends.goal.cell];
                Err(nearest_connected(lattice, &field, cells, &query.patience))
            }
        }
    }

    fn search_by(
        &self,
        field: &GoalField,
        ends: &Ends,
        (query, objective): (&Query, Objective),
        most_expanded: u64,
    ) -> Outcome {
        let (lattice, table) = (self.lattice(), self.table(objective));
        let question = Search {
            starts: &ends.starts,
            goals: &ends.goals_with_potential(lattice, objective),
            besides: ends.besides(lattice, objective),
            bound: query.bound,
            patience: &query.patience,
        };
        let outcome = match Changes::of(lattice, objective) {
            Some(changes) => search_changing(table, field, &question, &changes),
            None => self
                .with_workspace(|workspace| search_within(table, field, &question, workspace, most_expanded)),
        };
        table.rest();
        outcome
    }

    /// The best path between given ends, not refined.
    pub(crate) fn best_between(
        &self,
        ends: &Ends,
        query: &Query,
        objective: Objective,
    ) -> Result<Route, Error> {
        let found = self.search(ends, (query, objective), StepCosts::Least)?;
        Route::drive(self.lattice(), objective, (found.start, &found.motions), &query.patience)
    }
}

/// Plans over what proves a bound with less work, and over the costs of what can be driven where there is no path: they alone know where
/// ways end.
pub(super) fn over_bounds_first<T>(
    bound: f64,
    plan: impl Fn(StepCosts) -> Result<T, Error>,
) -> Result<T, Error> {
    let mut outcome = Err(Error::Untraceable);
    for costs in StepCosts::that_prove(bound) {
        outcome = plan(*costs);
        if !matches!(outcome, Err(Error::NoPath { .. } | Error::NoRoomToTurn { .. })) {
            break;
        }
    }
    outcome
}

/// Where the ground that leads to the goal comes nearest to the start, as an error, or that patience ended first.
pub(crate) fn nearest_connected(
    lattice: &Lattice,
    field: &GoalField,
    [start, goal]: [Cell; 2],
    patience: &Patience,
) -> Error {
    let grid = &lattice.terrain.grid;
    let [sx, sy] = grid.center_m(start);
    let [gx, gy] = grid.center_m(goal);
    let mut nearest = ((gx - sx).hypot(gy - sy), gx, gy);
    let mut pacer = patience.pacer();
    for distance in 0..=farthest_ring(grid, start) {
        if distance as f64 * grid.cell_size_m > nearest.0 {
            break;
        }
        for cell in ring(grid, start, distance) {
            if pacer.after(work::CELL).is_none() {
                return Error::Timeout { expanded: 0 };
            }
            let [x, y] = grid.center_m(cell);
            let gap_m = (x - sx).hypot(y - sy);
            if gap_m < nearest.0 && field.leads_from(cell) {
                nearest = (gap_m, x, y);
            }
        }
    }
    let (gap_m, x_m, y_m) = nearest;
    match gap_m == 0.0 {
        true => Error::NoRoomToTurn { x_m, y_m },
        false => Error::NoPath { gap_m, x_m, y_m, hindrance: Hindrance::Unexplained },
    }
}
