//! The robot with what was found: its own numbers as fitted, and mechanisms in its fields or in its list of them.

use model::{KnownMechanism, Robot, mechanism::Kind, robot::Surface};

use crate::observe::span::Applied;

/// The corrected robot, and notes on what its file cannot hold.
///
/// `names` are those of the drives under suspicion.
pub(crate) fn corrected(
    fitted: &Robot,
    applied: &[Applied],
    surfaces: &[String],
    names: &[String],
) -> (Robot, Vec<String>) {
    let mut robot = fitted.clone();
    let mut notes = Vec::new();
    for one in applied {
        let name = one.mechanism.name();
        if one.mechanism.kind() == Kind::Measurement {
            notes.push(format!(
                "`{name}` is a fault of the recording, not of the robot: mend it there, the robot's file stays as it is"
            ));
            continue;
        }
        apply(&mut robot, one, surfaces);
        if !one.span.is_all() {
            let span = one.span.words(names);
            notes.push(format!("the corrected robot is as it is {span}, with `{name}`"));
        }
    }
    keep_possible(&mut robot);
    if let Err(error) = robot.validate() {
        notes
            .push(format!("the corrected robot cannot be ({error}): its file has only the refitted numbers"));
        robot = fitted.clone();
        keep_possible(&mut robot);
    }
    (robot, notes)
}

/// Puts a mechanism into the robot's fields, or into the list of mechanisms of the robot or of the ground that was driven on.
fn apply(robot: &mut Robot, one: &Applied, surfaces: &[String]) {
    if let Some(changed) = one.mechanism.filed(robot, &one.values, surfaces) {
        *robot = changed;
        return;
    }
    let known = KnownMechanism::new(one.mechanism, one.values.clone());
    // The ground is soft, the robot is not.
    if KnownMechanism::is_of_ground(one.mechanism) {
        on_ground(robot, surfaces, |surface| surface.mechanisms.push(known.clone()));
    } else {
        robot.mechanisms.push(known);
    }
}

/// Changes the surfaces that were driven on.
fn on_ground(robot: &mut Robot, surfaces: &[String], change: impl Fn(&mut Surface)) {
    for name in surfaces {
        if let Some(surface) = robot.surfaces.get_mut(name) {
            change(surface);
        }
    }
}

/// Fits may leave standing loads a little below nothing, and returns a little above all.
fn keep_possible(robot: &mut Robot) {
    robot.hotel_power_w = robot.hotel_power_w.max(0.0);
    robot.drive_electronics_w = robot.drive_electronics_w.max(0.0);
    robot.motors.regeneration = robot.motors.regeneration.clamp(0.0, 1.0);
    // What was polished may stand a rounding beyond its bounds, and a robot that became lighter has closer ones.
    let as_it_is = robot.clone();
    let bounded = |known: &mut KnownMechanism| {
        let mechanism = known.mechanism();
        let values = mechanism.parameters().iter().zip(known.values()).map(|(p, value)| {
            let [low, high] = p.bounds_of(&as_it_is);
            value.clamp(low, high)
        });
        *known = KnownMechanism::new(mechanism, values.collect());
    };
    let of_grounds = robot.surfaces.values_mut().flat_map(|surface| &mut surface.mechanisms);
    robot.mechanisms.iter_mut().chain(of_grounds).for_each(bounded);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Span;
    use model::{builtin, mechanism};

    fn applied(name: &str, values: Vec<f64>, from_s: f64) -> Applied {
        let span = Span::EachDrive(from_s);
        Applied { mechanism: mechanism::by_name(name).unwrap_or(mechanism::ALL[0]), values, span }
    }

    #[test]
    fn what_the_file_has_a_field_for_is_put_there_and_the_rest_into_its_list_or_its_grounds() {
        let husky = builtin::husky_a200();
        let all = [
            applied("payload", vec![12.0], 300.0),
            applied("surface_change", vec![0.5, 0.2], 0.0),
            applied("wind", vec![0.5, 3.0, 0.0], 0.0),
            applied("soft_soil", vec![0.2], 0.0),
            applied("pitch_bias", vec![0.02], 0.0),
        ];
        let (robot, notes) = corrected(&husky, &all, &["marble".into()], &["a".into()]);
        assert!((robot.mass_kg - husky.mass_kg - 12.0).abs() < 1e-9);
        let ratio = robot.surfaces["marble"].mu_roll / husky.surfaces["marble"].mu_roll;
        assert!((ratio - 1.5).abs() < 1e-9);
        assert_eq!(notes.len(), 2, "{notes:?}");
        assert!(
            notes[0].contains("from about 300 s") && notes[1].contains("fault of the recording"),
            "{notes:?}"
        );
        let names = |list: &[KnownMechanism]| list.iter().map(|k| k.mechanism().name()).collect::<Vec<_>>();
        assert_eq!(names(&robot.mechanisms), ["wind"]);
        assert_eq!(names(&robot.surfaces["marble"].mechanisms), ["soft_soil"]);
        assert!(robot.surfaces["sandy_loam"].mechanisms.is_empty());
        assert!(robot.validate().is_ok());
    }

    #[test]
    fn a_robot_that_cannot_be_is_not_written() {
        let husky = builtin::husky_a200();
        let (robot, notes) = corrected(&husky, &[applied("payload", vec![-500.0], 0.0)], &[], &[]);
        assert!(robot.validate().is_ok() && robot.mass_kg == husky.mass_kg);
        assert!(notes.iter().any(|note| note.contains("cannot be")), "{notes:?}");
    }
}
