//! A goal prepared for many starts: one field serves the search from each of them.

use crate::{
    error::{Error, Place},
    field::goal_field::{FieldEnds, GoalField},
    grid::state::State,
    lattice::objective::Objective,
    path::route::Route,
    patience::Patience,
    question::{
        ends::goals_with_potential,
        guided::nearest_connected,
        planner::{Planner, joins},
        snap::{Asked, snap},
    },
    search::astar::{Found, Outcome, Search, search},
};

/// Goal poses, any of which will do, with the field that leads there from everywhere.
pub struct Target {
    objective: Objective,
    goals: Vec<(State, f64)>,
    /// Height potential of the lowest goal [J].
    lowest_goal_j: f64,
    field: GoalField,
}

impl Planner {
    /// The poses that stand for a place: its cell, or the nearest within the snap radius where the robot can stand, under the
    /// heading asked for, or all headings that fit. `snap_radius_m` `None` means one cell.
    ///
    /// # Errors
    /// A place off the map or where the robot cannot stand, or patience that ended.
    pub fn states_at(
        &self,
        place: Place,
        [x_m, y_m]: [f64; 2],
        heading_rad: Option<f64>,
        snap_radius_m: Option<f64>,
        patience: &Patience,
    ) -> Result<Vec<State>, Error> {
        let lattice = self.lattice();
        let snap_radius_m = snap_radius_m.unwrap_or(lattice.terrain.grid.cell_size_m);
        let snapped = snap(
            lattice,
            &Asked { place, x_m, y_m, heading_rad, either_way: false, snap_radius_m },
            patience,
        )?;
        Ok(snapped.states().collect())
    }

    /// Prepares goal poses, any of which will do, for searches from anywhere.
    ///
    /// # Errors
    /// Patience that ended first.
    pub fn target(
        &self,
        goals: &[State],
        objective: Objective,
        patience: &Patience,
    ) -> Result<Target, Error> {
        let (goals, lowest_goal_j) = goals_with_potential(self.lattice(), goals, objective);
        let ends = FieldEnds { goals: &goals, start: None };
        let field =
            GoalField::new(self.table(objective), ends, patience).ok_or(Error::Timeout { expanded: 0 })?;
        Ok(Target { objective, goals, lowest_goal_j, field })
    }

    /// The path of least cost from any of the starts, which share a cell, to a target: the one that [`Planner::plan`] finds.
    ///
    /// # Errors
    /// No path, or patience that ended before the least was proven.
    pub fn path_to(&self, target: &Target, starts: &[State], patience: &Patience) -> Result<Found, Error> {
        let Some(first) = starts.first() else { return Err(Error::Timeout { expanded: 0 }) };
        let lattice = self.lattice();
        let besides = match target.objective {
            Objective::Energy => target.lowest_goal_j - lattice.potential_j(first.cell),
            Objective::Distance | Objective::Time => 0.0,
        };
        let question = Search { starts, goals: &target.goals, besides, bound: 1.0, patience };
        let outcome = self.with_workspace(|workspace| {
            search(self.table(target.objective), &target.field, &question, workspace)
        });
        match outcome {
            Outcome::Found(found) if found.late => Err(Error::Timeout { expanded: found.expanded }),
            Outcome::Found(found) => {
                let is_goal = |end: &State| target.goals.iter().any(|(goal, _)| goal == end);
                if joins(lattice, &found, starts, is_goal) { Ok(found) } else { Err(Error::Untraceable) }
            }
            Outcome::Timeout { expanded } => Err(Error::Timeout { expanded }),
            Outcome::Untraceable => Err(Error::Untraceable),
            Outcome::Unreachable => {
                let goal = target.goals.first().map_or(first.cell, |(goal, _)| goal.cell);
                Err(nearest_connected(lattice, &target.field, [first.cell, goal], patience))
            }
        }
    }

    /// Drives a path that was found under an objective.
    ///
    /// # Errors
    /// Patience that ends first on a long path.
    pub fn drive(&self, objective: Objective, found: &Found, patience: &Patience) -> Result<Route, Error> {
        Route::drive(self.lattice(), objective, (found.start, &found.motions), patience)
    }
}
