//! What can be wrong with a world, a robot or a drive.

/// An error of the world crate; the message names the field and says how to mend it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The text is not the JSON that is needed.
    #[error(transparent)]
    Json(#[from] document::Error),
    /// A value that cannot be right, most often because of its unit.
    #[error("{field} is {value}, but must lie in {min} to {max}: {hint}")]
    OutOfRange {
        /// The field, as `sensors.rate_hz`.
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
    /// A drive with more rows than fit in memory.
    #[error(
        "runs times duration_s of the drive, at sensors.rate_hz of the world, are {rows} rows, and {most_rows} at most are simulated: \
         drive for less time, or record less often"
    )]
    TooLong {
        /// Rows of the drive.
        rows: f64,
        /// Most that are simulated.
        most_rows: f64,
    },
    /// A surface is named that the robot has no friction for.
    #[error("{field} is `{name}`, but the robot knows only {}", known.join(", "))]
    UnknownSurface {
        /// The field that names it.
        field: String,
        /// The name.
        name: String,
        /// The names that exist.
        known: Vec<String>,
    },
    /// A field that this kind of drive or effect needs.
    #[error("{field} is missing: {hint}")]
    Missing {
        /// The field.
        field: String,
        /// What to give.
        hint: &'static str,
    },
    /// The map cannot be read.
    #[error("terrain.map: {0}")]
    Map(#[from] terrain::Error),
    /// The robot came onto ground that the map does not know.
    #[error(
        "after {t_s:.1} s the robot stands at ({x_m:.2}, {y_m:.2}) m, where the map's elevation is unknown: move the drive or fill the map"
    )]
    UnknownGround {
        /// When [s].
        t_s: f64,
        /// Where [m].
        x_m: f64,
        /// Where [m].
        y_m: f64,
    },
    /// The numbers ran away.
    #[error("after {t_s:.1} s the simulation is no longer finite: give a smaller step_s")]
    Diverged {
        /// When [s].
        t_s: f64,
    },
}

impl Error {
    /// The field at fault, as `effects[0].strength`, where the error lies in one.
    pub fn field(&self) -> Option<&str> {
        match self {
            Error::Json(error) => error.field(),
            Error::OutOfRange { field, .. }
            | Error::UnknownSurface { field, .. }
            | Error::Missing { field, .. } => Some(field),
            Error::Map(_) => Some("terrain.map"),
            _ => None,
        }
    }
}
