//! Mechanisms that explain much and are not what is missing.

use model::Robot;

use crate::{Error, search::State, series::Series};

/// A mechanism that explains much and is not what is missing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// Its name.
    pub mechanism: &'static str,
    /// Why it is not, to follow on "would explain much of it, but".
    pub why: String,
}

/// Why one of what was found, by its number, is not what is missing; `None` if it may be.
pub(crate) type Doubt<'a> = dyn Fn(&State, usize) -> Result<Option<String>, Error> + 'a;

/// Leaves out what is doubted, one by one, and fits the rest again each time. Without healthy drives nothing is: the model's own
/// error would pass for a reason.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn refuse(
    series: &Series,
    file: &Robot,
    state: &mut State,
    doubt: &Doubt<'_>,
) -> Result<Vec<Refused>, Error> {
    let mut refused = Vec::new();
    let mut which = 0;
    while series.has_healthy() && which < state.found.len() {
        let Some(why) = doubt(state, which)? else {
            which += 1;
            continue;
        };
        let mechanism = state.found.remove(which).applied.mechanism.name();
        refused.push(Refused { mechanism, why });
        state.refit(series, file)?;
        which = 0;
    }
    Ok(refused)
}
