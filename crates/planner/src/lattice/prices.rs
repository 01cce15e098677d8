//! What a user would rather avoid, priced.

use crate::error::Error;

/// Prices of manoeuvres: what they weigh in comparisons besides what they take. Those in joules count where energy is to be least,
/// those in seconds where time is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Prices {
    /// Of backing up [J/m].
    pub reverse_j_per_m: f64,
    /// Of backing up [s/m].
    pub reverse_s_per_m: f64,
    /// Of turning on the spot [J/rad].
    pub spin_j_per_rad: f64,
    /// Of turning on the spot [s/rad].
    pub spin_s_per_rad: f64,
    /// Of changing between driving ahead and backing up, with a turn on the spot between them or not [J].
    pub direction_change_j: f64,
    /// The same [s].
    pub direction_change_s: f64,
    /// Whether stops on the way weigh what they take by [`crate::stops_j`], at the speed asked for.
    pub stops: bool,
}

impl Prices {
    /// Largest price of either unit: what a heavy robot takes for kilometres.
    pub const LARGEST: f64 = 1e5;

    /// The prices with their names.
    pub fn named(&self) -> [(&'static str, f64); 6] {
        [
            ("prices.reverse_j_per_m", self.reverse_j_per_m),
            ("prices.reverse_s_per_m", self.reverse_s_per_m),
            ("prices.spin_j_per_rad", self.spin_j_per_rad),
            ("prices.spin_s_per_rad", self.spin_s_per_rad),
            ("prices.direction_change_j", self.direction_change_j),
            ("prices.direction_change_s", self.direction_change_s),
        ]
    }

    /// Refuses prices below nothing or beyond the largest.
    ///
    /// # Errors
    /// The first of them.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let (min, max) = (0.0, Self::LARGEST);
        match self.named().into_iter().find(|(_, price)| !(min..=max).contains(price)) {
            Some((field, value)) => Err(Error::OutOfRange { field, value, min, max }),
            None => Ok(()),
        }
    }
}
