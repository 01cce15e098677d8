//! Both ends of a question on the lattice.

use crate::{
    error::{Error, Place},
    heading::Heading,
    lattice::{Lattice, State},
    objective::Objective,
    query::{Goal, Query},
    snap::{Asked, Snapped, cells_within, snap},
};

/// Both ends on the lattice.
#[derive(Clone, Debug)]
pub(crate) struct Ends {
    pub(crate) start: Snapped,
    pub(crate) goal: Snapped,
    pub(crate) starts: Vec<State>,
    pub(crate) goals: Vec<State>,
}

impl Ends {
    pub(crate) fn find(lattice: &Lattice, query: &Query) -> Result<Self, Error> {
        let cell_m = lattice.terrain.grid.cell_size_m;
        let snap_radius_m = query.snap_radius_m.unwrap_or(cell_m);
        within("snap_radius_m", snap_radius_m, 0.0, 1000.0)?;
        let tolerance_m = query.goal.tolerance_m;
        within("goal.tolerance_m", tolerance_m, 0.0, 10_000.0)?;
        within("bound", query.bound, 1.0, Query::LOOSEST_BOUND)?;
        if let Some(snap_radius_m) =
            query.snap_radius_m.filter(|radius_m| tolerance_m > 0.0 && *radius_m > tolerance_m)
        {
            return Err(Error::ConflictingTolerance { tolerance_m, snap_radius_m });
        }
        let start = snap(
            lattice,
            &Asked {
                place: Place::Start,
                x_m: query.start.x_m,
                y_m: query.start.y_m,
                heading_rad: query.start.heading_rad,
                snap_radius_m,
            },
        )?;
        let goal = snap(
            lattice,
            &Asked {
                place: Place::Goal,
                x_m: query.goal.x_m,
                y_m: query.goal.y_m,
                heading_rad: query.goal.heading_rad,
                snap_radius_m: snap_radius_m.max(query.goal.tolerance_m),
            },
        )?;
        let starts = start.headings.iter().map(|&heading| State { cell: start.cell, heading }).collect();
        let goals = goal_states(lattice, &goal, &query.goal);
        Ok(Ends { start, goal, starts, goals })
    }

    /// Goals with what is to be added there: for energy, the height that the potential has left out.
    pub(crate) fn goals_with_potential(&self, lattice: &Lattice, objective: Objective) -> Vec<(State, f64)> {
        goals_with_potential(lattice, &self.goals, objective).0
    }

    /// What every path costs besides the costs of the table: for energy, the lowest goal's height above the start.
    pub(crate) fn besides(&self, lattice: &Lattice, objective: Objective) -> f64 {
        match objective {
            Objective::Energy => lowest_j(lattice, &self.goals) - lattice.potential_j(self.start.cell),
            Objective::Distance | Objective::Time => 0.0,
        }
    }
}

/// Goals with what is to be added there, for energy the height that the potential has left out, and the height potential of
/// the lowest of them [J].
pub(crate) fn goals_with_potential(
    lattice: &Lattice,
    goals: &[State],
    objective: Objective,
) -> (Vec<(State, f64)>, f64) {
    let lowest_j = lowest_j(lattice, goals);
    let after = |state: State| match objective {
        Objective::Energy => lattice.potential_j(state.cell) - lowest_j,
        Objective::Distance | Objective::Time => 0.0,
    };
    (goals.iter().map(|&state| (state, after(state))).collect(), lowest_j)
}

/// The lowest goal's height potential [J].
fn lowest_j(lattice: &Lattice, goals: &[State]) -> f64 {
    goals.iter().map(|s| lattice.potential_j(s.cell)).fold(f64::INFINITY, f64::min)
}

/// The snapped goal and, within the tolerance, every other pose of an accepted heading where the robot can stand.
fn goal_states(lattice: &Lattice, snapped: &Snapped, goal: &Goal) -> Vec<State> {
    let wanted = goal.heading_rad.map(Heading::nearest);
    let mut states: Vec<State> =
        snapped.headings.iter().map(|&heading| State { cell: snapped.cell, heading }).collect();
    if goal.tolerance_m > 0.0 {
        for cell in cells_within(lattice, snapped.cell, 2.0 * goal.tolerance_m) {
            let [x, y] = lattice.terrain.grid.center_m(cell);
            if cell == snapped.cell || (x - goal.x_m).hypot(y - goal.y_m) > goal.tolerance_m {
                continue;
            }
            let headings = Heading::all().filter(|h| wanted.is_none_or(|w| w == *h));
            states.extend(
                headings.map(|heading| State { cell, heading }).filter(|s| lattice.stand(*s).is_ok()),
            );
        }
    }
    states
}

fn within(field: &'static str, value: f64, min: f64, max: f64) -> Result<(), Error> {
    if (min..=max).contains(&value) { Ok(()) } else { Err(Error::OutOfRange { field, value, min, max }) }
}
