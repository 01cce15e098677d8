//! Energy, time and length of the best paths between many poses.
//!
//! One field per target serves the searches from all sources; targets and sources are spread over all cores.

use planner::{Objective, Patience, Planner, State, Target};
use rayon::prelude::*;

use crate::{
    error::Error,
    waypoint::{Waypoint, states_of},
};

/// What the paths of a matrix are to have least of, and how places are taken.
#[derive(Clone, Debug, Default)]
pub struct Question {
    /// What each path has least of.
    pub objective: Objective,
    /// How far a place may be moved to ground where the robot can stand; `None` means one cell [m].
    pub snap_radius_m: Option<f64>,
    /// When to give up.
    pub patience: Patience,
}

/// What the best paths from sources (rows) to targets (columns) take; `None` where no path leads.
///
/// Each entry is that of the plan between these two places alone. Where a place leaves its heading open, every entry takes
/// whichever heading suits it, so the sum of entries along a chain of such places is a lower bound of what driving the chain
/// takes: the legs need not join up. With headings given legs join exactly; [`joints`](crate::joints) opens places into all
/// their headings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matrix {
    /// Energy drawn from the battery, negative where descents return more than is drawn [J].
    pub energy_j: Vec<Vec<Option<f64>>>,
    /// Time [s].
    pub duration_s: Vec<Vec<Option<f64>>>,
    /// Length along the ground [m].
    pub distance_m: Vec<Vec<Option<f64>>>,
    /// Why entries are missing, by source and target.
    pub gaps: Vec<Gap>,
}

/// Why an entry of a matrix is missing.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// Position of the source.
    pub source: usize,
    /// Position of the target.
    pub target: usize,
    /// Why no path leads.
    pub reason: planner::Error,
}

/// Totals of a path: energy [J], time [s], length [m].
type Totals = [f64; 3];

/// The matrix from sources to targets.
///
/// # Errors
/// A place off the map or where the robot cannot stand, named by list (`sources` or `targets`) and position, or patience that
/// ended before every entry was proven.
pub fn matrix(
    planner: &Planner,
    sources: &[Waypoint],
    targets: &[Waypoint],
    question: &Question,
) -> Result<Matrix, Error> {
    let starts = states_of(planner, "sources", sources, question.snap_radius_m, &question.patience)?;
    let goals = states_of(planner, "targets", targets, question.snap_radius_m, &question.patience)?;
    let columns: Vec<Vec<Result<Totals, planner::Error>>> =
        goals.par_iter().map(|goals| column(planner, &starts, goals, question)).collect::<Result<_, _>>()?;
    Ok(Matrix::of(sources.len(), &columns))
}

/// The entries from all sources to one target.
fn column(
    planner: &Planner,
    starts: &[Vec<State>],
    goals: &[State],
    question: &Question,
) -> Result<Vec<Result<Totals, planner::Error>>, Error> {
    let target = planner.target(goals, question.objective, &question.patience)?;
    starts.par_iter().map(|starts| entry(planner, &target, starts, question)).collect()
}

/// The totals of one path, or why there is none.
fn entry(
    planner: &Planner,
    target: &Target,
    starts: &[State],
    question: &Question,
) -> Result<Result<Totals, planner::Error>, Error> {
    use planner::Error as E;
    match planner.path_to(target, starts, &question.patience) {
        Ok(found) => {
            let total = planner.drive(question.objective, &found, &question.patience)?.total;
            Ok(Ok([total.energy_j, total.duration_s, total.length_m]))
        }
        Err(reason @ (E::NoPath { .. } | E::NoRoomToTurn { .. })) => Ok(Err(reason)),
        Err(other) => Err(other.into()),
    }
}

impl Matrix {
    fn of(sources: usize, columns: &[Vec<Result<Totals, planner::Error>>]) -> Self {
        let part = |i: usize| -> Vec<Vec<Option<f64>>> {
            let row =
                |source: usize| columns.iter().map(|column| Some(column[source].as_ref().ok()?[i])).collect();
            (0..sources).map(row).collect()
        };
        let gap = |source: usize, target: usize| {
            let reason = columns[target][source].as_ref().err()?.clone();
            Some(Gap { source, target, reason })
        };
        let pairs = (0..sources).flat_map(|source| (0..columns.len()).map(move |target| (source, target)));
        Matrix {
            energy_j: part(0),
            duration_s: part(1),
            distance_m: part(2),
            gaps: pairs.filter_map(|(source, target)| gap(source, target)).collect(),
        }
    }
}
