//! Mechanisms as great as they can be: what asks for more of one is something else.

use model::Robot;

use crate::{search::State, series::Applied};

/// Whether a mechanism has a value at its limit. A share that has fallen to its least, such as of power returned, is gone, which may be.
pub(crate) fn is_reached(applied: &Applied, robot: &Robot) -> bool {
    let is_at_limit = |(parameter, value): (usize, &f64)| {
        let [low, high] = applied.mechanism.bounds(robot, parameter);
        let is_share = applied.mechanism.parameters()[parameter].unit == "1";
        *value != 0.0 && (*value == high || *value == low && !is_share)
    };
    applied.values.iter().enumerate().any(is_at_limit)
}

/// That one of several mechanisms would have to be more than it can be, in words.
pub(crate) fn doubt(robot: &Robot, state: &State, which: usize) -> Option<String> {
    let is_reached = is_reached(&state.found[which].applied, robot);
    is_reached.then(|| "there would have to be more of it than there can be".to_owned())
}

#[cfg(test)]
mod tests {
    use model::{builtin, mechanism};

    use super::*;
    use crate::span::Span;

    #[test]
    fn what_would_have_to_be_more_is_at_its_limit_and_what_is_nothing_or_gone_is_not() {
        let robot = builtin::husky_a200();
        let is_reached = |name: &str, values: &[f64]| {
            let mechanism = mechanism::by_name(name).unwrap();
            is_reached(&Applied { mechanism, values: values.to_vec(), span: Span::ALL }, &robot)
        };
        assert!(is_reached("load_transfer", &[3.0]) && is_reached("load_transfer", &[-1.0]));
        assert!(
            is_reached("drivetrain_drag", &[12.0, -10.0]) && !is_reached("drivetrain_drag", &[12.0, 0.0])
        );
        assert!(!is_reached("load_transfer", &[2.9]) && !is_reached("soft_soil", &[0.0]));
        assert!(!is_reached("regeneration", &[-1.0]), "nothing is returned");
        assert!(!is_reached("surface_change", &[0.2, -0.9]) && is_reached("surface_change", &[10.0, 0.0]));
    }
}
