//! From the lattice's best path to a smooth one near it.

use std::time::Instant;

use crate::{
    lattice::{graph::Lattice, objective::Objective},
    path::{route::Route, uncertainty::energy_interval_j},
    patience::Patience,
    refinement::{
        course::Course,
        free::FreeGround,
        polish::polish,
        rates::{LevelRates, Radii},
        shortcut::{best_link, shortcut},
    },
    search::changes::Changes,
};

/// Part of the time that is left that refinement may take: what follows it needs far less than the other half.
const PART_OF_TIME: f64 = 0.5;

/// A route freed from the lattice.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined {
    /// The path; the lattice's own where none was found that has less of the objective.
    pub route: Route,
    /// Whether it was refined to the end, not only until patience was over.
    pub finished: bool,
}

/// A refined route as a plan has it, with how far its energy may be off.
#[derive(Clone, Debug, PartialEq)]
pub struct RefinedPath {
    /// Totals, poses and steps.
    pub route: Route,
    /// Central 95 % interval of the energy, from the robot's parameter uncertainty [J].
    pub energy_interval_j: [f64; 2],
    /// Whether it was refined to the end; else the time for it was over first, and it is the best until then.
    pub finished: bool,
}

impl RefinedPath {
    /// Refines a route within half of the time that patience leaves, so that what follows has the other half.
    ///
    /// `None` where patience ends before the interval of a long path is known.
    pub fn of(lattice: &Lattice, objective: Objective, route: &Route, patience: &Patience) -> Option<Self> {
        let own = patience.no_later_than(patience.deadline.map(|deadline| {
            let now = Instant::now();
            now + deadline.saturating_duration_since(now).mul_f64(PART_OF_TIME)
        }));
        let Refined { route, finished } = refine(lattice, objective, route, &own);
        let energy_interval_j = energy_interval_j(&route, lattice, patience)?;
        Some(RefinedPath { route, energy_interval_j, finished })
    }
}

/// Frees a route from the lattice: the same ends, less of the objective or as much.
///
/// Shortcuts of an arc, a straight and an arc replace stretches of the route, then waypoints and radii move as long as
/// that pays. Arcs have half the slip track as their smallest radius; turns on the spot remain. Everything is driven
/// by the evaluation that the lattice's motions are driven by, in steps of at most a cell, and keeps to the same
/// limits of pitch, roll and side force. The robot's outline stays off obstacles and unknown ground.
///
/// The result is a local optimum, the same on every run unless patience ends; then it is the best so far.
pub fn refine(lattice: &Lattice, objective: Objective, route: &Route, patience: &Patience) -> Refined {
    if patience.is_over() {
        return Refined { route: route.clone(), finished: false };
    }
    let ground = FreeGround::new(lattice, objective);
    let changes = Changes::of(lattice, objective);
    let rates = LevelRates::new(&ground);
    let given = Course::of(&ground, route);
    let direct = direct(&ground, &rates, &given);
    let mut courses: Vec<Course> =
        direct.into_iter().chain([shortcut(&ground, &rates, &given, patience)]).collect();
    for course in &mut courses {
        polish(&ground, &rates, course, patience);
    }
    let better = courses
        .iter()
        .filter_map(|course| course.drive(&ground, route))
        .map(|mut refined| {
            if let Some(changes) = &changes {
                changes.charge(&mut refined);
            }
            refined
        })
        .filter(|refined| ground.weighed(&refined.total) < ground.weighed(&route.total))
        .min_by(|a, b| ground.weighed(&a.total).total_cmp(&ground.weighed(&b.total)));
    Refined { route: better.unwrap_or_else(|| route.clone()), finished: !patience.is_over() }
}

/// The best single curve from end to end, where it costs no more than the route.
fn direct(ground: &FreeGround<'_>, rates: &LevelRates, given: &Course) -> Option<Course> {
    let (from, to) = (given.waypoints.first()?, given.waypoints.last()?);
    let most = given.links.iter().map(|link| link.cost).sum();
    let link = best_link(ground, rates, [from, to], Radii::EveryPair, most)?;
    Some(Course { waypoints: vec![*from, *to], links: vec![link] })
}
