//! What can be wrong with a robot or with the data a parameter is fitted to.

/// An error of the model crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The text is not the JSON that a robot file needs.
    #[error(transparent)]
    Json(#[from] document::Error),
    /// A value lies outside what is physically sensible, most often because of its unit.
    #[error("{field} is {value}, but must lie in {min} to {max}: {hint}")]
    OutOfRange {
        /// The field, as `motors.left.k2`.
        field: String,
        /// The value found.
        value: f64,
        /// Smallest accepted value.
        min: f64,
        /// Largest accepted value.
        max: f64,
        /// How to mend it.
        hint: &'static str,
    },
    /// A name that is empty, too long to be shown, or more than one line.
    #[error(
        "{field} has {characters} characters, but must have 1 to {longest} on one line: give a short name"
    )]
    Name {
        /// The field, as `name`.
        field: String,
        /// Length of the name found.
        characters: usize,
        /// Most characters of a name.
        longest: usize,
    },
    /// A surface is named that the robot has no friction for.
    #[error("the robot has no surface `{name}`; it knows {}", known.join(", "))]
    UnknownSurface {
        /// The name asked for.
        name: String,
        /// The names that exist.
        known: Vec<String>,
    },
    /// A ground is named whose friction is not known of any robot.
    #[error(
        "no robot was measured on `{name}`; known are {}: name one of them, or give its friction, as in {name}=0.09,0.4 for mu_roll and mu_skid", known.join(", ")
    )]
    UnknownGround {
        /// The name asked for.
        name: String,
        /// The names that exist.
        known: Vec<String>,
    },
    /// A mechanism that the robot or its ground cannot have.
    #[error("{field}: {message}")]
    Mechanism {
        /// Where, as `mechanisms[0]`.
        field: String,
        /// What is wrong and how to mend it.
        message: String,
    },
    /// Something that the robot says of how well it is known, which cannot be.
    #[error("{field}: {message}")]
    Knowledge {
        /// Where, as `posterior.covariance`.
        field: String,
        /// What is wrong and how to mend it.
        message: String,
    },
    /// No built-in robot of this name.
    #[error("there is no built-in robot `{name}`; built in are {}", known.join(", "))]
    UnknownRobot {
        /// The name asked for.
        name: String,
        /// The names that exist.
        known: Vec<String>,
    },
    /// The measured power cannot be reached by any real friction (the root of eq. 6 is not real).
    #[error("{power_w} W is below {least_w} W, the most that a braking motor can return by eq. 2")]
    NoRealFriction {
        /// The measured power.
        power_w: f64,
        /// The lowest power that eq. 2 can take at this wheel speed.
        least_w: f64,
    },
    /// Too few samples, or samples that are too alike, to determine the parameters.
    #[error("{count} samples do not determine {parameters}: {hint}")]
    Undetermined {
        /// How many samples there were.
        count: usize,
        /// What was to be fitted.
        parameters: &'static str,
        /// What would determine it.
        hint: &'static str,
    },
}

impl Error {
    /// The field at fault, as `motors.left.k2`, where the error lies in one.
    pub fn field(&self) -> Option<&str> {
        match self {
            Error::Json(error) => error.field(),
            Error::OutOfRange { field, .. }
            | Error::Mechanism { field, .. }
            | Error::Knowledge { field, .. }
            | Error::Name { field, .. } => Some(field),
            Error::UnknownSurface { .. } => Some("default_surface"),
            Error::UnknownGround { .. } => Some("surface"),
            _ => None,
        }
    }
}
