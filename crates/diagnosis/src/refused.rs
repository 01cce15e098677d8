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

/// Leaves out what is doubted, one by one, and fits the rest again each time, whose doubts may have been hidden by what was left out.
/// Later doubts come up only where earlier ones do not. Without healthy drives nothing is: the model's own error would pass for a reason.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn refuse(
    series: &Series,
    file: &Robot,
    state: &mut State,
    doubts: &[&Doubt<'_>],
) -> Result<Vec<Refused>, Error> {
    let mut refused = Vec::new();
    if !series.has_healthy() {
        return Ok(refused);
    }
    while let Some((which, why)) = first_doubted(state, doubts)? {
        let mechanism = state.found.remove(which).applied.mechanism.name();
        refused.push(Refused { mechanism, why });
        state.refit(series, file)?;
    }
    Ok(refused)
}

/// What is doubted first, and why.
fn first_doubted(state: &State, doubts: &[&Doubt<'_>]) -> Result<Option<(usize, String)>, Error> {
    for doubt in doubts {
        for which in 0..state.found.len() {
            if let Some(why) = doubt(state, which)? {
                return Ok(Some((which, why)));
            }
        }
    }
    Ok(None)
}
