//! The best part of the way to a goal that cannot be reached.

use terrain::Cell;

use crate::{
    error::Error,
    grid::state::State,
    lattice::objective::Objective,
    patience::work,
    pose_field::exact::ExactField,
    question::{
        planner::Planner,
        query::{Goal, Plan, Query},
    },
};

impl Planner {
    /// Finds a path as [`Planner::plan`] does, or, where none leads to the goal, to the place nearest to it in a straight line that can
    /// be reached, by the cheapest way there. [`Plan::short_of_goal_m`] says how far from the goal that is.
    ///
    /// # Errors
    /// As [`Planner::plan`], but for a goal without a path or where the robot cannot stand.
    pub fn plan_partly(&self, query: &Query, objective: Objective) -> Result<Plan, Error> {
        match self.plan(query, objective) {
            Err(Error::NoPath { .. } | Error::NoRoomToTurn { .. } | Error::PlaceBlocked { .. }) => {}
            other => return other,
        }
        // The start by itself is a question with an answer; whatever is wrong with it is the answer to this one too.
        let start = &query.start;
        let here =
            Goal { x_m: start.x_m, y_m: start.y_m, heading_rad: None, either_way: false, tolerance_m: 0.0 };
        let home = Query { goal: here, other_goals: Vec::new(), refine: false, ..query.clone() };
        let ends = self.ends(&home, objective)?;
        let (cell, short_of_goal_m, goal) = self.nearest_reached(&ends.starts, query, objective)?;
        let [x_m, y_m] = self.lattice().terrain.grid.center_m(cell);
        let there = Goal { x_m, y_m, heading_rad: None, either_way: false, tolerance_m: 0.0 };
        let query = Query { goal: there, other_goals: Vec::new(), snap_radius_m: None, ..query.clone() };
        let plan = self.plan(&query, objective)?;
        Ok(Plan { short_of_goal_m: Some(short_of_goal_m), goal, ..plan })
    }

    /// The cell nearest to any of the goals that motions from the starts lead to, how far it is [m], and from which goal.
    fn nearest_reached(
        &self,
        starts: &[State],
        query: &Query,
        objective: Objective,
    ) -> Result<(Cell, f64, usize), Error> {
        let late = Error::Timeout { expanded: 0 };
        let starts: Vec<(State, f64)> = starts.iter().map(|start| (*start, 0.0)).collect();
        let reached = ExactField::from_starts(self.table(objective), &starts, f64::INFINITY, &query.patience)
            .ok_or(late.clone())?;
        let grid = &self.lattice().terrain.grid;
        let mut pacer = query.patience.pacer();
        let mut best: Option<(f64, Cell, usize)> = None;
        for index in 0..grid.cells() {
            pacer.after(work::CELL).ok_or(late.clone())?;
            let cell = grid.cell(index);
            let [x_m, y_m] = grid.center_m(cell);
            for (goal, Goal { x_m: gx_m, y_m: gy_m, .. }) in query.goals().enumerate() {
                let away_m = (x_m - gx_m).hypot(y_m - gy_m);
                if best.is_none_or(|(least_m, ..)| away_m < least_m) && reached.least_at(cell).is_some() {
                    best = Some((away_m, cell, goal));
                }
            }
        }
        // A start that leads nowhere is itself what is reached.
        best.map(|(away_m, cell, goal)| (cell, away_m, goal)).ok_or(Error::Untraceable)
    }
}
