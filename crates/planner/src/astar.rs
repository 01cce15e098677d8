//! A* over the lattice.

use std::{cmp::Reverse, collections::BinaryHeap, time::Instant};

use crate::{heading::HEADINGS, heuristic::GoalField, lattice::Lattice, ordered::Ordered, table::CostTable};

/// What to search for: states by their position in dense storage.
pub struct Search<'s> {
    /// Where the robot may start.
    pub starts: &'s [usize],
    /// Where it may end, with the cost that is still to be added there.
    pub goals: &'s [(usize, f64)],
    /// When to give up.
    pub deadline: Option<Instant>,
}

/// How a search ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The best path: its cost, its start, and the motion taken at each state on the way.
    Found {
        /// Sum of the costs, the goal's included.
        cost: f64,
        /// The start that was best.
        start: usize,
        /// Motions in order.
        motions: Vec<usize>,
        /// States expanded.
        expanded: u64,
    },
    /// No motion leads from a start to a goal.
    Unreachable,
    /// The deadline passed first.
    Timeout {
        /// States expanded.
        expanded: u64,
    },
}

/// Expansions between two looks at the clock.
const CLOCK_EVERY: u64 = 4096;
const NO_MOTION: u8 = u8::MAX;

/// Finds the least-cost path from any start to any goal.
pub fn search(lattice: &Lattice<'_>, table: &CostTable, field: &GoalField, query: &Search<'_>) -> Outcome {
    let mut best = vec![f64::INFINITY; lattice.states()];
    let mut came_by = vec![NO_MOTION; lattice.states()];
    // A last virtual state stands for "arrived", so that the cost at the goal is part of the search.
    let arrived = lattice.states();
    let mut arrival: Option<usize> = None;
    let mut queue = BinaryHeap::new();
    let goal_cost = |state: usize| query.goals.iter().find(|g| g.0 == state).map(|g| g.1);
    for &start in query.starts {
        let estimate = field.at(start / HEADINGS);
        if estimate.is_finite() {
            best[start] = 0.0;
            queue.push(Reverse((Ordered(estimate), start)));
        }
    }
    let mut least_arrival = f64::INFINITY;
    let mut expanded = 0u64;
    while let Some(Reverse((Ordered(estimate), index))) = queue.pop() {
        if index == arrived {
            let Some(goal) = arrival else { break };
            let (start, motions) = walk_back(lattice, &came_by, goal);
            return Outcome::Found { cost: estimate, start, motions, expanded };
        }
        let reached = best[index];
        if estimate > reached + field.at(index / HEADINGS) {
            continue;
        }
        if expanded.is_multiple_of(CLOCK_EVERY) && query.deadline.is_some_and(|d| Instant::now() >= d) {
            return Outcome::Timeout { expanded };
        }
        expanded += 1;
        if let Some(after) = goal_cost(index)
            && reached + after < least_arrival
        {
            least_arrival = reached + after;
            arrival = Some(index);
            queue.push(Reverse((Ordered(least_arrival), arrived)));
        }
        let state = lattice.state(index);
        for (motion, &cost) in table.costs(index).iter().enumerate() {
            if cost.is_infinite() {
                continue;
            }
            let Some(next) = lattice.successor(state, motion).map(|s| lattice.index(s)) else { continue };
            let total = reached + f64::from(cost);
            if total < best[next] {
                let estimate = total + field.at(next / HEADINGS);
                if estimate.is_finite() {
                    best[next] = total;
                    came_by[next] = motion as u8;
                    queue.push(Reverse((Ordered(estimate), next)));
                }
            }
        }
    }
    Outcome::Unreachable
}

/// The start and the motions that led to a state.
fn walk_back(lattice: &Lattice<'_>, came_by: &[u8], goal: usize) -> (usize, Vec<usize>) {
    let mut motions = Vec::new();
    let mut state = goal;
    while came_by[state] != NO_MOTION {
        let motion = usize::from(came_by[state]);
        let end = lattice.state(state);
        // Motions of one place in the list have the same end heading only from one start heading.
        let before = crate::heading::Heading::all().find_map(|from| {
            let m = &lattice.motions[from.index()][motion];
            let cell = crate::footprint::shifted(lattice.terrain, end.cell, (-m.columns, -m.rows))?;
            (m.to == end.heading).then(|| lattice.index(crate::lattice::State { cell, heading: from }))
        });
        let Some(before) = before else { break };
        motions.push(motion);
        state = before;
    }
    motions.reverse();
    (state, motions)
}
