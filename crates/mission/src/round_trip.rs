//! Ways out and back that are joined in one pose.

use planner::{ExactField, Found, Objective, Patience, Place, Planner, Route, State};
use terrain::Cell;

use crate::Error;

/// Least energies to the start from every pose, in any heading there.
pub(crate) struct Homeward<'p> {
    planner: &'p Planner,
    field: ExactField,
    home: Cell,
}

impl<'p> Homeward<'p> {
    /// Works them out for a start in a cell where the robot can stand.
    ///
    /// # Errors
    /// Patience that ends first.
    pub(crate) fn new(planner: &'p Planner, home: Cell, patience: &Patience) -> Result<Self, Error> {
        let center_m = planner.lattice().terrain.grid.center_m(home);
        let states = planner.states_at(Place::Start, center_m, None, None, patience)?;
        // All in one cell, so that no height tells them apart.
        let goals: Vec<(State, f64)> = states.into_iter().map(|state| (state, 0.0)).collect();
        let table = planner.table(Objective::Energy);
        let field = ExactField::to_goals(table, &goals, f64::INFINITY, patience);
        let field = field.ok_or(planner::Error::Timeout { expanded: 0 })?;
        Ok(Homeward { planner, field, home })
    }

    /// Energy of the best way home from a pose; `None` where none leads there [J].
    pub(crate) fn energy_j(&self, state: State) -> Option<f64> {
        let lattice = self.planner.lattice();
        let fall_j = lattice.potential_j(self.home) - lattice.potential_j(state.cell);
        Some(self.field.cost(state)? + fall_j)
    }

    /// The best way home from a pose; `None` where none leads there.
    ///
    /// # Errors
    /// Patience that ends first.
    pub(crate) fn route(&self, state: State, patience: &Patience) -> Result<Option<Route>, Error> {
        let table = self.planner.table(Objective::Energy);
        let Some((start, motions)) = self.field.walk(table, &[state], patience)? else { return Ok(None) };
        Ok(Some(self.planner.drive(Objective::Energy, &Found::along(start, motions), patience)?))
    }
}

/// Least energies from the start to every pose.
pub(crate) struct Outward<'p> {
    planner: &'p Planner,
    field: ExactField,
    home: Cell,
}

impl<'p> Outward<'p> {
    /// Works them out for starts that share a cell.
    ///
    /// # Errors
    /// Patience that ends first.
    pub(crate) fn new(
        planner: &'p Planner,
        starts: &[State],
        home: Cell,
        patience: &Patience,
    ) -> Result<Self, Error> {
        let seeds: Vec<(State, f64)> = starts.iter().map(|state| (*state, 0.0)).collect();
        let table = planner.table(Objective::Energy);
        let field = ExactField::from_starts(table, &seeds, f64::INFINITY, patience);
        let field = field.ok_or(planner::Error::Timeout { expanded: 0 })?;
        Ok(Outward { planner, field, home })
    }

    /// Energy of the best way to a pose; `None` where none leads there [J].
    pub(crate) fn energy_j(&self, state: State) -> Option<f64> {
        let lattice = self.planner.lattice();
        let rise_j = lattice.potential_j(state.cell) - lattice.potential_j(self.home);
        Some(self.field.cost(state)? + rise_j)
    }

    /// The pose in which the ways out and back together take least, with that energy [J]; without a way back, the way out alone.
    ///
    /// The way home begins in the pose that the way out ends in. Two ways that are best each for itself may end and begin in
    /// different headings, and where there is no room to turn nothing joins them.
    pub(crate) fn best_of(
        &self,
        poses: impl Iterator<Item = State>,
        homeward: Option<&Homeward<'_>>,
    ) -> Option<(State, f64)> {
        let energy_j = |state: State| {
            let back_j = homeward.map_or(Some(0.0), |homeward| homeward.energy_j(state))?;
            Some((state, self.energy_j(state)? + back_j))
        };
        poses.filter_map(energy_j).min_by(|a, b| a.1.total_cmp(&b.1))
    }
}
