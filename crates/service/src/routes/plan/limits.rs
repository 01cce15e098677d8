//! Limits that a path must keep, and what is said where none does.

use std::time::{Duration, Instant};

use model::Robot;
use planner::{Objective, Patience, Planner};
use routing::Limits;

use super::PlanRequest;
use crate::problem::{Problem, ProblemType};

/// Largest limit on slopes: π/2, a vertical wall, rounded up [rad]. Degrees are nearly always beyond it.
const MAX_SLOPE_RAD: f64 = 1.571;

/// Longest search for the path that a slope limit forbids [s].
const STEEP_TIME: Duration = Duration::from_secs(5);

impl PlanRequest {
    /// The limits on the path's totals.
    ///
    /// # Errors
    /// A time or length that is not above 0, or an energy that is no number.
    pub(crate) fn limits(&self) -> Result<Limits, Problem> {
        let refuse = |field: &str, value: f64| {
            let detail = format!("{field} is {value}, but must be above 0: leave it out for no limit");
            Problem::new(ProblemType::InvalidRequest, detail).at(format!("/{field}"))
        };
        for (field, value) in [("max_time_s", self.max_time_s), ("max_distance_m", self.max_distance_m)] {
            if let Some(value) = value.filter(|value| value.is_nan() || *value <= 0.0) {
                return Err(refuse(field, value));
            }
        }
        Ok(Limits {
            max_energy_j: self.max_energy_j,
            max_time_s: self.max_time_s,
            max_distance_m: self.max_distance_m,
        })
    }

    /// The robot, held to slopes no steeper than the request's limit.
    ///
    /// # Errors
    /// An unusable robot, or a limit out of range.
    pub(super) fn limited_robot(&self) -> Result<Robot, Problem> {
        let mut robot = self.robot.robot()?;
        if let Some(max_slope_rad) = self.max_slope_rad {
            if !(max_slope_rad > 0.0 && max_slope_rad <= MAX_SLOPE_RAD) {
                let detail = format!(
                    "max_slope_rad is {max_slope_rad}, but must be above 0 and at most {MAX_SLOPE_RAD} (pi/2): give radians, 0.35 for 20 degrees"
                );
                return Err(Problem::new(ProblemType::InvalidRequest, detail).at("/max_slope_rad"));
            }
            let limits = &mut robot.limits;
            limits.max_pitch_rad = limits.max_pitch_rad.min(max_slope_rad);
            limits.max_roll_rad = limits.max_roll_rad.min(max_slope_rad);
        }
        Ok(robot)
    }

    /// Tells a path that only the slope limit forbids from one that there is not, with the slope that would do.
    pub(super) fn too_steep(&self, planner: &Planner, problem: Problem, patience: &Patience) -> Problem {
        let Some(max_slope_rad) = self.max_slope_rad.filter(|_| problem.kind == ProblemType::NoPath) else {
            return problem;
        };
        let free = PlanRequest { max_slope_rad: None, refine: false, ..self.clone() };
        let patience = patience.no_later_than(Some(Instant::now() + STEEP_TIME));
        let Ok(free_planner) = free.planner(&planner.lattice().terrain, &patience) else { return problem };
        let query = free.query(&free_planner, &patience);
        let Ok(path) = free_planner.plan(&query, Objective::Energy) else { return problem };
        let tilts_rad = path.route.poses.iter().flat_map(|pose| [pose.pitch_rad.abs(), pose.roll_rad.abs()]);
        let steepest_rad = tilts_rad.fold(0.0, f64::max);
        let detail = format!(
            "no path keeps within a slope of {max_slope_rad:.3} rad; the best path without that limit comes to {steepest_rad:.3} rad: raise max_slope_rad"
        );
        Problem::new(ProblemType::LimitsContradict, detail).at("/max_slope_rad")
    }
}
