//! Mechanisms as great as they can be: what asks for more of one is something else.

use model::{Robot, mechanism::Parameter};

use crate::search::State;

/// That one of several mechanisms has a value at its limit, in words. A share that has fallen to its least, such as of power returned,
/// is gone, which may be.
pub(crate) fn doubt(robot: &Robot, state: &State, which: usize) -> Option<String> {
    let applied = &state.found[which].applied;
    let is_at_limit = |((i, parameter), value): ((usize, &Parameter), &f64)| {
        let [low, high] = applied.mechanism.bounds(robot, i);
        let is_share = parameter.unit == "1";
        *value != 0.0 && (*value == high || *value == low && !is_share)
    };
    let mut parameters = applied.mechanism.parameters().iter().enumerate().zip(&applied.values);
    parameters.any(is_at_limit).then(|| "there would have to be more of it than there can be".to_owned())
}
