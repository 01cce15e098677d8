//! What keeps the robot from a goal: the ground, or one of its own limits.

use std::fmt;

use crate::grid::cost::SINGLE_PRECISION;

/// A limit of the robot that can forbid a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// Largest force of either side [N].
    SideForce,
    /// Largest pitch [rad].
    Pitch,
    /// Largest roll [rad].
    Roll,
    /// Height of ground under the body above the plane of the wheels [m].
    Clearance,
}

/// Why no path leads to a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hindrance {
    /// It was not looked into, or patience ended first.
    Unexplained,
    /// Obstacles, unknown ground or want of room: without the robot's limits there is no path either.
    Ground,
    /// One limit: without it there is a path.
    OneLimit {
        /// Which.
        limit: Limit,
        /// Its value, in its own unit.
        allowed: f64,
        /// The largest value on the best path without it, in the same unit.
        needed: f64,
    },
    /// Several limits at once: there is a path without all of them, and none without any single one.
    SeveralLimits,
}

/// A limit of so many steps to its unit that holds a value, and what single precision in tables may add to it.
fn rounded_up(value: f64, steps_per_unit: f64) -> f64 {
    (value * (1.0 + SINGLE_PRECISION) * steps_per_unit).ceil() / steps_per_unit
}

impl fmt::Display for Hindrance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Hindrance::Unexplained => f.write_str(
                "look for a wall, unknown cells, or slopes and side forces beyond the robot's limits there",
            ),
            Hindrance::Ground => f.write_str(
                "look for a wall, unknown cells or ground that its body would touch there: without the robot's limits there is no path either",
            ),
            Hindrance::OneLimit { limit: Limit::SideForce, allowed, needed } => write!(
                f,
                "the robot's limits.max_side_force_n is {allowed:.1} N, and the best path without that limit needs {:.1} N: raise it",
                rounded_up(*needed, 10.0)
            ),
            Hindrance::OneLimit { limit: Limit::Clearance, allowed, needed } => write!(
                f,
                "the robot's ground_clearance_m is {allowed:.3} m (a third of the wheel radius where its file gives none), and the best path without that limit passes over ground {:.3} m above the plane of its wheels: raise it if the robot does",
                rounded_up(*needed, 1000.0)
            ),
            Hindrance::OneLimit { limit, allowed, needed } => write!(
                f,
                "the robot's limits.{limit} is {allowed:.3} rad, and the best path without that limit comes to {:.3} rad: raise it",
                rounded_up(*needed, 1000.0)
            ),
            Hindrance::SeveralLimits => f.write_str(
                "the robot's limits of pitch, roll, side force and ground clearance leave no path together, and without all of them there is one",
            ),
        }
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Limit::SideForce => "max_side_force_n",
            Limit::Pitch => "max_pitch_rad",
            Limit::Roll => "max_roll_rad",
            Limit::Clearance => "ground_clearance_m",
        })
    }
}
