//! Ways to one goal from wherever the robot is.

use crate::{
    ends::Ends, error::Error, exact::ExactField, lattice::State, objective::Objective, planner::Planner,
    query::Query, route::Route,
};

/// The least-cost way to a goal from every pose.
pub struct Ways<'p> {
    planner: &'p Planner,
    exact: ExactField,
    objective: Objective,
}

impl Planner {
    /// Works out the least-cost ways to the query's goal from every pose.
    ///
    /// # Errors
    /// As [`Planner::plan`].
    pub fn ways_to_goal(&self, query: &Query, objective: Objective) -> Result<Ways<'_>, Error> {
        let ends = Ends::find(self.lattice(), query)?;
        let goals = ends.goals_with_potential(self.lattice(), objective);
        let exact = ExactField::new(self.table(objective), &goals, &query.patience);
        let exact = exact.ok_or(Error::Timeout { expanded: 0 })?;
        Ok(Ways { planner: self, exact, objective })
    }
}

impl Ways<'_> {
    /// The way from a pose; `None` where none leads to the goal.
    pub fn from(&self, state: State) -> Option<Route> {
        let (start, motions) = self.exact.walk(self.planner.table(self.objective), &[state])?;
        Some(Route::drive(self.planner.lattice(), self.objective, start, &motions))
    }
}
