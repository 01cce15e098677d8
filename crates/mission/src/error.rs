//! What can be wrong with a question about range or a mission.

/// An error of the mission crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The robot's file has no battery.
    #[error("the robot has no battery: add `battery` with capacity_wh and nominal_voltage_v to its file")]
    NoBattery,
    /// A number that cannot be.
    #[error("{field} is {value}, but must lie in {min} to {max}: {hint}")]
    OutOfRange {
        /// The field, as `waypoints[3].service_s`.
        field: String,
        /// The value found.
        value: f64,
        /// Smallest accepted.
        min: f64,
        /// Largest accepted.
        max: f64,
        /// How to mend it.
        hint: &'static str,
    },
    /// A charge that the reserve already takes up.
    #[error(
        "the charge {charge} is not above the reserve {reserve} that must stay: charge the battery, or lower battery.reserve_fraction"
    )]
    ReserveAboveCharge {
        /// Charge when the robot sets out.
        charge: f64,
        /// Charge that must stay.
        reserve: f64,
    },
    /// No place at all that the charge reaches.
    #[error(
        "no other place can be reached from the start: look for obstacles, unknown ground or slopes about it"
    )]
    NowhereToGo,
    /// A goal that can be reached and not left for the start again.
    #[error(
        "the goal ({x_m:.2}, {y_m:.2}) can be reached, but no chain of motions leads from there back to the start: allow reverse, give more room to turn, or choose another goal"
    )]
    NoWayBack {
        /// Goal, x [m].
        x_m: f64,
        /// Goal, y [m].
        y_m: f64,
    },
    /// A way that the errors of the map are to change on too often.
    #[error(
        "elevation_scale_m is {scale_m}, which cuts the way of {length_m:.0} m into more than {most} stretches: give {least_m:.3} m or more"
    )]
    ScaleTooFine {
        /// The scale asked for [m].
        scale_m: f64,
        /// Length of the way [m].
        length_m: f64,
        /// Most stretches of one way.
        most: usize,
        /// Least scale that will do [m].
        least_m: f64,
    },
    /// Time that ran out after a path was found.
    #[error("time ran out while {step}: allow more time, or ask for fewer samples or stops")]
    Timeout {
        /// What was being done, as `drawing samples`.
        step: &'static str,
    },
    /// What the planner says.
    #[error(transparent)]
    Plan(#[from] planner::Error),
    /// What the model says.
    #[error(transparent)]
    Robot(#[from] model::Error),
}

/// Checks a number.
pub(crate) fn within(
    field: impl Into<String>,
    value: f64,
    [min, max]: [f64; 2],
    hint: &'static str,
) -> Result<(), Error> {
    // Written so that a NaN fails too.
    if value >= min && value <= max {
        return Ok(());
    }
    Err(Error::OutOfRange { field: field.into(), value, min, max, hint })
}
