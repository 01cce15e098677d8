//! Mechanisms as great as they can be: what asks for more of one is something else.

use model::Robot;

use crate::{
    average::Average,
    search::State,
    series::{Applied, Series},
};

/// Share from which what has fallen to its least has mostly gone.
const GONE: f64 = -0.5;

/// Whether a mechanism has a value at its limit. A share that has fallen to its least, such as of power returned, is gone, which may be.
pub(crate) fn is_reached(applied: &Applied, robot: &Robot) -> bool {
    let is_at_limit = |(parameter, value): (usize, &f64)| {
        let [low, high] = applied.mechanism.bounds(robot, parameter);
        let is_gone = applied.mechanism.parameters()[parameter].unit == "1" && low <= GONE;
        *value != 0.0 && (*value == high || *value == low && !is_gone)
    };
    applied.values.iter().enumerate().any(is_at_limit)
}

/// Share of the time for which a robot may seem to lean further than it does: attitudes are noisy, but who falls does so at once.
const RARELY: f64 = 0.001;

/// How much further than it did a robot could lean at least before it falls over: nobody drives at the edge of that, and the less weight is
/// left on two of its wheels the less a load that shifts is told from one that stands high.
const MARGIN: f64 = 1.25;

/// That one of several mechanisms would have to be more than it can be, in words.
pub(crate) fn doubt(robot: &Robot, series: &Series, state: &State, which: usize) -> Option<String> {
    let applied = &state.found[which].applied;
    if is_reached(applied, robot) {
        return Some("there would have to be more of it than there can be".to_owned());
    }
    let falls = applied.mechanism.name() == "load_transfer"
        && is_too_high(robot, &series.averages, robot.center_of_mass.height_m + applied.values[0]);
    falls.then(|| "so high the robot would have tipped over where it drove, or nearly so".to_owned())
}

/// Whether a robot with its centre of mass so high \[m\] would have fallen over where it drove, or nearly.
fn is_too_high(robot: &Robot, averages: &[Average], height_m: f64) -> bool {
    MARGIN * height_m > tips_from_m(robot, averages)
}

/// Height of the centre of mass from which the robot would have fallen over on the slopes that it stood on: the weight then lies outside
/// the wheels \[m\].
fn tips_from_m(robot: &Robot, averages: &[Average]) -> f64 {
    let from_m = |angle: fn(&Average) -> f64, arm_m: f64| {
        let suspects = averages.iter().filter(|a| a.suspect && a.channel == 0).map(|a| angle(a).abs());
        let mut leaning_rad: Vec<f64> = suspects.filter(|rad| rad.is_finite()).collect();
        leaning_rad.sort_by(f64::total_cmp);
        let at = ((1.0 - RARELY) * leaning_rad.len().saturating_sub(1) as f64) as usize;
        leaning_rad.get(at).map_or(f64::INFINITY, |rad| arm_m / rad.tan().max(1e-9))
    };
    let across_m = from_m(|a| a.input.roll_rad, robot.track_m / 2.0);
    across_m.min(from_m(|a| a.input.pitch_rad, robot.wheelbase_m / 2.0))
}

#[cfg(test)]
mod tests {
    use model::{builtin, mechanism};

    use super::*;
    use crate::{average::Input, span::Span};

    #[test]
    fn a_robot_that_leans_and_stands_is_not_higher_than_lets_it() {
        let robot = builtin::husky_a200();
        let leaning = |roll_rad: f64, pitch_rad: f64| {
            let input = Input { roll_rad, pitch_rad, ..Input::default() };
            Average { channel: 0, run: 0, suspect: true, t_s: 0.0, input }
        };
        let level = vec![leaning(0.0, 0.0); 400];
        let across = [level.clone(), vec![leaning(-0.3, 0.1); 40]].concat();
        // The lower wheels are half a track beside the middle: tan φ = b/2h.
        let expected_m = robot.track_m / 2.0 / 0.3_f64.tan();
        assert!((tips_from_m(&robot, &across) - expected_m).abs() < 1e-12);
        let along = [level.clone(), vec![leaning(0.0, 0.4); 40]].concat();
        assert!((tips_from_m(&robot, &along) - robot.wheelbase_m / 2.0 / 0.4_f64.tan()).abs() < 1e-12);
        let stray = [level, vec![leaning(1.2, 0.0)]].concat();
        assert!(tips_from_m(&robot, &stray) > 1e6, "a stray value is no slope");
        let heights_m = [0.7, 0.9, 1.1].map(|share| share * expected_m);
        assert_eq!(heights_m.map(|height_m| is_too_high(&robot, &across, height_m)), [false, true, true]);
    }

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
        assert!(is_reached("wheel_slip", &[-0.02, 0.0]), "no robot goes farther than its wheels");
        assert!(!is_reached("surface_change", &[0.2, -0.9]) && is_reached("surface_change", &[10.0, 0.0]));
    }
}
