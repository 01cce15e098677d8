//! Why a question cannot be answered.

/// An error of the routing crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// What the planner says of a place or a path.
    #[error(transparent)]
    Planner(#[from] planner::Error),
    /// A state of charge that no battery has.
    #[error("the charge is {charge}, but must lie in 0 to 1")]
    Charge {
        /// The value found.
        charge: f64,
    },
    /// Nothing to drive on.
    #[error(
        "the charge {charge} is not above the battery's reserve of {reserve_fraction}: charge further, or lower reserve_fraction"
    )]
    ChargeWithinReserve {
        /// State of charge, 0 to 1.
        charge: f64,
        /// Fraction of the capacity that must stay.
        reserve_fraction: f64,
    },
    /// An amount that must be above nothing.
    #[error("{field} is {value}, but must be above 0")]
    NotPositive {
        /// The field, as `energies_j[2]`.
        field: String,
        /// The value found.
        value: f64,
    },
    /// Limits that no path keeps.
    #[error("{0}")]
    Contradiction(Box<Contradiction>),
}

/// Limits that no path keeps, with the least of each that any path takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contradiction {
    /// Least energy of any path between these ends [J].
    pub least_energy_j: f64,
    /// Least time of any path between these ends [s].
    pub least_duration_s: f64,
    /// Least length of any path between these ends [m].
    pub least_distance_m: f64,
    /// Whether each limit could be kept without the others.
    pub each_alone: bool,
}

impl std::fmt::Display for Contradiction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Contradiction { least_energy_j, least_duration_s, least_distance_m, each_alone } = self;
        let what = if *each_alone {
            "no path keeps all limits at once, though each alone can be kept"
        } else {
            "no path keeps the limits"
        };
        write!(
            f,
            "{what}: the least energy between these ends is {least_energy_j:.1} J, the least time {least_duration_s:.1} s, the least length {least_distance_m:.1} m; raise a limit"
        )
    }
}
