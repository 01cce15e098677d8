//! Both ends of a question on the lattice.

use crate::{
    error::{Error, Place},
    grid::{heading::Heading, state::State},
    lattice::{graph::Lattice, objective::Objective},
    patience::Patience,
    question::{
        query::{Goal, Query},
        rings::{farthest_ring, ring},
        snap::{Asked, STANDING_IN_A_CELL, Snapped, snap},
    },
};

/// Both ends on the lattice.
#[derive(Clone, Debug)]
pub struct Ends {
    pub(crate) start: Snapped,
    /// Of the first goal where the robot can stand.
    pub(crate) goal: Snapped,
    /// Poses that the robot may start in, all in one cell.
    pub starts: Vec<State>,
    /// Poses that it may end in.
    pub goals: Vec<State>,
    /// Which goal each of them is of, by its position in the question.
    pub(crate) goal_of: Vec<usize>,
}

impl Ends {
    /// The places where the robot can stand that are nearest to both ends of a question.
    pub(crate) fn find(lattice: &Lattice, query: &Query) -> Result<Self, Error> {
        check(query)?;
        let start = snap(lattice, &asked_start(lattice, query), &query.patience)?;
        let mut found: Option<Ends> = None;
        let mut blocked = None;
        for (index, goal) in query.goals().enumerate() {
            let place = match query.other_goals.is_empty() {
                true => Place::Goal,
                false => Place::Listed { list: "goals", index },
            };
            let asked = asked_goal(lattice, query, (place, goal));
            let snapped = match snap(lattice, &asked, &query.patience) {
                Ok(snapped) => snapped,
                // Of several goals those count where the robot can stand.
                Err(error @ Error::PlaceBlocked { .. }) => {
                    blocked.get_or_insert(error);
                    continue;
                }
                Err(error) => return Err(error),
            };
            let goals = goal_states(lattice, &snapped, goal, &query.patience)?;
            match &mut found {
                Some(ends) => ends.add(goals, index),
                None => {
                    let goal_of = vec![index; goals.len()];
                    let starts = start.states().collect();
                    found = Some(Ends { start: start.clone(), goal: snapped, starts, goals, goal_of });
                }
            }
        }
        match (found, blocked) {
            (Some(ends), _) => Ok(ends),
            (None, Some(error)) => Err(error),
            (None, None) => unreachable!("a question has a goal"),
        }
    }

    /// Adds the poses of another goal.
    fn add(&mut self, goals: Vec<State>, index: usize) {
        for goal in goals {
            if !self.goals.contains(&goal) {
                self.goals.push(goal);
                self.goal_of.push(index);
            }
        }
    }

    /// Which goal a pose is of, by its position in the question.
    pub(crate) fn goal_at(&self, end: &State) -> usize {
        self.goals.iter().zip(&self.goal_of).find(|(goal, _)| *goal == end).map_or(0, |(_, index)| *index)
    }

    /// The ends with chosen places, of a question with one goal.
    pub(crate) fn of(lattice: &Lattice, query: &Query, start: Snapped, goal: Snapped) -> Result<Self, Error> {
        let starts = start.states().collect();
        let goals = goal_states(lattice, &goal, &query.goal, &query.patience)?;
        let goal_of = vec![0; goals.len()];
        Ok(Ends { start, goal, starts, goals, goal_of })
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

/// The start as it is to be snapped.
pub(crate) fn asked_start(lattice: &Lattice, query: &Query) -> Asked {
    let start = &query.start;
    Asked {
        place: Place::Start,
        x_m: start.x_m,
        y_m: start.y_m,
        heading_rad: start.heading_rad,
        either_way: false,
        snap_radius_m: snap_radius_m(lattice, query),
    }
}

/// A goal as it is to be snapped.
pub(crate) fn asked_goal(lattice: &Lattice, query: &Query, (place, goal): (Place, &Goal)) -> Asked {
    Asked {
        place,
        x_m: goal.x_m,
        y_m: goal.y_m,
        heading_rad: goal.heading_rad,
        either_way: goal.either_way,
        snap_radius_m: snap_radius_m(lattice, query).max(goal.tolerance_m),
    }
}

/// How far an end may be moved: by default one cell [m].
fn snap_radius_m(lattice: &Lattice, query: &Query) -> f64 {
    query.snap_radius_m.unwrap_or(lattice.terrain.grid.cell_size_m)
}

/// The snapped goal and, within the tolerance, every other pose of an accepted heading where the robot can stand.
fn goal_states(
    lattice: &Lattice,
    snapped: &Snapped,
    goal: &Goal,
    patience: &Patience,
) -> Result<Vec<State>, Error> {
    let wanted = goal.headings();
    let mut states: Vec<State> = snapped.states().collect();
    if goal.tolerance_m <= 0.0 {
        return Ok(states);
    }
    let mut pacer = patience.pacer();
    let grid = &lattice.terrain.grid;
    let rings = (2.0 * goal.tolerance_m / grid.cell_size_m).ceil() as usize + 1;
    for distance in 1..=rings.min(farthest_ring(grid, snapped.cell)) {
        for cell in ring(grid, snapped.cell, distance) {
            pacer.after(STANDING_IN_A_CELL).ok_or(Error::Timeout { expanded: 0 })?;
            let [x, y] = grid.center_m(cell);
            if (x - goal.x_m).hypot(y - goal.y_m) > goal.tolerance_m {
                continue;
            }
            let headings = Heading::all().filter(|h| wanted.as_ref().is_none_or(|wanted| wanted.contains(h)));
            states.extend(
                headings.map(|heading| State { cell, heading }).filter(|s| lattice.stand(*s).is_ok()),
            );
        }
    }
    Ok(states)
}

/// Refuses numbers of a question that cannot be, whatever the ground.
///
/// # Errors
/// The first number out of its range, or a tolerance that snapping defeats.
pub(crate) fn check(query: &Query) -> Result<(), Error> {
    if let Some(snap_radius_m) = query.snap_radius_m {
        within("snap_radius_m", snap_radius_m, 0.0, 1000.0)?;
    }
    within("bound", query.bound, 1.0, Query::LOOSEST_BOUND)?;
    for Goal { tolerance_m, .. } in query.goals() {
        within("goal.tolerance_m", *tolerance_m, 0.0, 10_000.0)?;
        if let Some(snap_radius_m) = query.snap_radius_m.filter(|_| *tolerance_m > 0.0)
            && snap_radius_m > *tolerance_m
        {
            return Err(Error::ConflictingTolerance { tolerance_m: *tolerance_m, snap_radius_m });
        }
    }
    Ok(())
}

fn within(field: &'static str, value: f64, min: f64, max: f64) -> Result<(), Error> {
    if (min..=max).contains(&value) { Ok(()) } else { Err(Error::OutOfRange { field, value, min, max }) }
}
