//! Where mechanisms of a robot's file may stand, and how much of them there may be.

use crate::{Error, KnownMechanism, Robot, known::OF_GROUND};

/// Checks what the mechanisms' own reading cannot: where they stand and what they make of the robot.
///
/// # Errors
/// [`Error::Mechanism`] names the place.
pub(crate) fn check(robot: &Robot) -> Result<(), Error> {
    for (name, surface) in &robot.surfaces {
        for (i, known) in surface.mechanisms.iter().enumerate() {
            if !KnownMechanism::is_of_ground(known.mechanism()) {
                let mechanism = known.mechanism().name();
                return Err(Error::Mechanism {
                    field: format!("surfaces.{name}.mechanisms[{i}]"),
                    message: format!(
                        "`{mechanism}` is not of the ground; put it into the robot's `mechanisms`, a surface may have {}",
                        OF_GROUND.join(", ")
                    ),
                });
            }
        }
    }
    let of_robot = robot.mechanisms.iter().enumerate().map(|(i, known)| (format!("mechanisms[{i}]"), known));
    let of_grounds = robot.surfaces.iter().flat_map(|(name, surface)| {
        let field = move |i| format!("surfaces.{name}.mechanisms[{i}]");
        surface.mechanisms.iter().enumerate().map(move |(i, known)| (field(i), known))
    });
    of_robot.chain(of_grounds).try_for_each(|(field, known)| within_bounds(robot, field, known))?;
    let (mass_kg, slip) = (robot.lifted_mass_kg(), robot.wheel_slip().max(robot.turning_slip()));
    let field = || "mechanisms".to_owned();
    if mass_kg <= 0.0 {
        let message =
            format!("the robot would weigh {mass_kg:.1} kg with its `payload`; give a smaller negative load");
        return Err(Error::Mechanism { field: field(), message });
    }
    if slip >= 1.0 {
        let message =
            format!("wheels that slip by {slip:.2} do not move or turn the robot; give less than 1 in all");
        return Err(Error::Mechanism { field: field(), message });
    }
    Ok(())
}

/// Refuses a mechanism with a value that a robot of this size cannot have.
fn within_bounds(robot: &Robot, field: String, known: &KnownMechanism) -> Result<(), Error> {
    for (p, value) in known.mechanism().parameters().iter().zip(known.values()) {
        let [low, high] = p.bounds_of(robot);
        let told = [low, high].map(|bound| (1000.0 * bound).round() / 1000.0);
        if !(low..=high).contains(value) {
            let hint = if p.unit == "1" { "give a ratio".to_owned() } else { format!("give {}", p.unit) };
            let (name, mechanism) = (p.name, known.mechanism().name());
            let message = format!(
                "`{name}` of `{mechanism}` is {value}, must be {} to {} on a robot of {} kg; {hint}",
                told[0], told[1], robot.mass_kg
            );
            return Err(Error::Mechanism { field, message });
        }
    }
    Ok(())
}
