//! A centre of mass ahead of the middle of the base or behind it, which show nearly alike.

use model::Robot;

use crate::{limit, series::Applied};

/// Where a search for one behind the middle begins \[m\]: on level ground it shows as one ahead of it does, on slopes and in bends not quite.
pub(crate) const BEHIND_M: f64 = -1e-6;
/// A file's centre of mass so near the middle is there for all that robot files know \[m\].
const AT_THE_MIDDLE_M: f64 = 0.02;

/// Where it may lie: on the side of the middle where the search began, since what it does turns round there \[m\].
pub(crate) fn range_m(applied: &Applied, robot: &Robot) -> [f64; 2] {
    let [low_m, high_m] = applied.mechanism.bounds(robot, 0);
    let filed_m = robot.center_of_mass.forward_m;
    match applied.values[0] < 0.0 {
        _ if filed_m.abs() >= AT_THE_MIDDLE_M => [low_m, high_m],
        true => [low_m, (-filed_m).min(0.0)],
        false => [(-filed_m).max(0.0), high_m],
    }
}

/// The same as far on the other side; `None` of anything else.
pub(crate) fn mirrored(applied: &Applied, robot: &Robot) -> Option<Applied> {
    let is_off = is_center_of_mass(applied) && applied.values[0] != 0.0;
    is_off.then(|| {
        let mut mirrored = applied.clone();
        mirrored.values[0] = -applied.values[0] - 2.0 * robot.center_of_mass.forward_m;
        mirrored
    })
}

/// Whether it lies as far off as one can.
pub(crate) fn is_at_its_limit(applied: &Applied, robot: &Robot) -> bool {
    is_center_of_mass(applied) && limit::is_reached(applied, robot)
}

fn is_center_of_mass(applied: &Applied) -> bool {
    applied.mechanism.name() == "center_of_mass"
}

#[cfg(test)]
mod tests {
    use model::{builtin, mechanism};

    use super::*;
    use crate::span::Span;

    fn at(forward_m: f64) -> Applied {
        let mechanism = mechanism::by_name("center_of_mass").unwrap();
        Applied { mechanism, values: vec![forward_m, 0.0], span: Span::ALL }
    }

    #[test]
    fn a_search_stays_on_its_side_and_looks_at_the_other_as_far_from_the_middle() {
        let mut robot = builtin::husky_a200();
        assert_eq!(range_m(&at(0.0), &robot), [0.0, 0.162]);
        assert_eq!(range_m(&at(BEHIND_M), &robot), [-0.162, 0.0]);
        assert_eq!(mirrored(&at(0.05), &robot).unwrap().values[0], -0.05);
        robot.center_of_mass.forward_m = -0.03;
        let mirrored_m = mirrored(&at(0.05), &robot).unwrap().values[0];
        assert!((mirrored_m - 0.01).abs() < 1e-12, "2 cm ahead, so 2 cm behind: {mirrored_m}");
    }

    #[test]
    fn nothing_lies_farther_off_than_where_an_axle_carries_four_fifths() {
        let robot = builtin::husky_a200();
        assert!(is_at_its_limit(&at(0.162), &robot) && is_at_its_limit(&at(-0.162), &robot));
        assert!(!is_at_its_limit(&at(0.155), &robot) && !is_at_its_limit(&at(0.0), &robot));
    }
}
