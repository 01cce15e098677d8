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
