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
    /// Plans over what proves a bound with least work, over the next where that does not do, and over the costs of what can be driven where
    /// there is no path: they alone know where ways end.
    pub(super) fn over_bounds_first<T>(
        &self,
        bound: f64,
        plan: impl Fn(StepCosts) -> Result<Option<T>, Error>,
    ) -> Result<T, Error> {
        for costs in StepCosts::that_prove(bound) {
            match plan(*costs) {
                Ok(Some(found)) => return Ok(found),
                Ok(None) => {}
                Err(Error::NoPath { .. } | Error::NoRoomToTurn { .. }) if *costs != StepCosts::Least => {}
                Err(error) => return Err(error),
            }
        }
        Err(Error::Untraceable)
    }

    /// The field that leads to the goals of a question.
    pub(super) fn guide(
        &self,
        ends: &Ends,
        (query, objective): (&Query, Objective),
        costs: StepCosts,
    ) -> Result<Arc<GoalField>, Error> {
        let table = self.table(objective);
        let goals = ends.goals_with_potential(self.lattice(), objective);
        let key = FieldKey::new(objective, &ends.goals);
        let start = ends.start.cell;
        let late = Error::Timeout { expanded: 0 };
        let costs = match costs {
            StepCosts::Related => match self.fields().at_hand(&key, start) {
                Some(field) => return Ok(field),
                None => match self.related_field(&key, (start, &goals), objective, &query.patience) {
                    Some(field) => {
                        self.fields().keep_related(key, start, &field);
                        return Ok(field);
                    }
                    None => StepCosts::Bounds,
                },
            },
            costs => costs,
        };
        let towards = Towards { start, costs, bound: query.bound };
        self.fields().field(key, table, &goals, towards, &query.patience).ok_or(late)
    }

    /// A path between ends; `None` where what another planner's field proves does not prove the bound asked for.
    pub(super) fn search(
        &self,
        ends: &Ends,
        (query, objective): (&Query, Objective),
        costs: StepCosts,
    ) -> Result<Option<Found>, Error> {
        let (lattice, table) = (self.lattice(), self.table(objective));
        let goals = ends.goals_with_potential(lattice, objective);
        let field = self.guide(ends, (query, objective), costs)?;
        let question = Search {
            starts: &ends.starts,
            goals: &goals,
            besides: ends.besides(lattice, objective),
            bound: query.bound,
            patience: &query.patience,
        };
        let is_related = field.costs() == StepCosts::Related;
        let most_expanded = match is_related {
            true => (lattice.terrain.grid.cells() / CELLS_FOR_A_STATE).max(LEAST_EXPANDED) as u64,
            false => u64::MAX,
        };
        let outcome = match Changes::of(lattice, objective) {
            Some(_) if is_related => return Ok(None),
            Some(changes) => search_changing(table, &field, &question, &changes),
            None => self.with_workspace(|workspace| {
                search_within(table, &field, &question, workspace, most_expanded)
            }),
        };
        table.rest();
        match outcome {
            Outcome::Found(found) if !(is_related && found.late) => Ok(Some(found)),
            _ if is_related && !query.patience.is_over() => Ok(None),
            Outcome::Found(found) => Ok(Some(found)),
            Outcome::Timeout { expanded } => Err(Error::Timeout { expanded }),
            Outcome::Untraceable => Err(Error::Untraceable),
            Outcome::Unreachable => {
                let cells = [ends.start.cell, ends.goal.cell];
                Err(nearest_connected(lattice, &field, cells, &query.patience))
            }
        }
    }

    /// The best path between given ends, not refined.
    pub(crate) fn best_between(
        &self,
        ends: &Ends,
        query: &Query,
        objective: Objective,
    ) -> Result<Route, Error> {
        let found = self.search(ends, (query, objective), StepCosts::Least)?.ok_or(Error::Untraceable)?;
        Route::drive(self.lattice(), objective, (found.start, &found.motions), &query.patience)
    }
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
