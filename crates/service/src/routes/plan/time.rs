//! How long a request may take.

use std::time::{Duration, Instant};

use planner::Patience;

use super::PlanRequest;
use crate::problem::{Problem, ProblemType};

/// A time that a request allows; `None` where no clock counts that far, which is no limit.
///
/// # Errors
/// A time that is not above 0.
fn allowed_time(field: &str, time_s: f64) -> Result<Option<Duration>, Problem> {
    /// The shortest time there is: it is over at once.
    const LEAST: Duration = Duration::from_nanos(1);
    if time_s.is_nan() || time_s <= 0.0 {
        let detail =
            format!("{field} is {time_s}, but must be above 0: leave it out for the service's limit");
        return Err(Problem::new(ProblemType::InvalidRequest, detail).at(format!("/{field}")));
    }
    Ok(Duration::try_from_secs_f64(time_s).ok().map(|allowed| allowed.max(LEAST)))
}

impl PlanRequest {
    /// When the request's own time is over; `None` where it gives itself none.
    ///
    /// # Errors
    /// A time that is not above 0.
    pub(crate) fn deadline(&self) -> Result<Option<Instant>, Problem> {
        let allowed = self.timeout_s.map(|timeout_s| allowed_time("timeout_s", timeout_s)).transpose()?;
        Ok(allowed.flatten().and_then(|allowed| Instant::now().checked_add(allowed)))
    }

    /// What patience there is, shortened to the request's own.
    ///
    /// # Errors
    /// A time that is not above 0.
    pub fn patience(&self, patience: &Patience) -> Result<Patience, Problem> {
        Ok(patience.no_later_than(self.deadline()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_time_above_nothing_is_allowed_however_long_or_short() {
        for short_s in [f64::MIN_POSITIVE, 1e-300, 1e-12, 1e-10] {
            assert_eq!(
                allowed_time("timeout_s", short_s).unwrap(),
                Some(Duration::from_nanos(1)),
                "{short_s}"
            );
        }
        assert_eq!(allowed_time("timeout_s", 0.5).unwrap(), Some(Duration::from_millis(500)));
        for long_s in [1e20, 1e300, f64::MAX, f64::INFINITY] {
            assert_eq!(allowed_time("timeout_s", long_s).unwrap(), None, "no limit but the service's");
        }
        for wrong in [0.0, -0.0, -1e-300, -1.0, f64::NEG_INFINITY, f64::NAN] {
            let refused = allowed_time("timeout_s", wrong).unwrap_err();
            assert_eq!(refused.errors[0].pointer, "/timeout_s");
            assert!(refused.detail.contains("must be above 0"), "{}", refused.detail);
        }
    }
}
