//! What motors lose in their copper, and what of it they still feel: the heat that builds up in a drive.

use model::{Robot, Sides};

use crate::{Drives, Error, power, watch::ROWS_A_LOOK};

/// Copper loss of each side, averaged backwards with an exponential memory, by row \[W\]; every run begins with cold motors.
///
/// Ground that the robot does not know counts as standing still.
///
/// # Errors
/// [`Error::Stopped`] when the drives' watch breaks.
pub fn averaged(drives: &Drives, robot: &Robot, memory_s: f64) -> Result<Vec<Sides<f64>>, Error> {
    let mut averaged = vec![Sides::both(0.0); drives.rows.len()];
    let mut state = Sides::both(0.0);
    let (mut run, mut last_s) = (usize::MAX, 0.0);
    for stretch in &drives.stretches {
        let Ok(surface) = robot.surface(&drives.surfaces[stretch.surface]) else { continue };
        let ground = power::Ground::new(robot, surface);
        for i in stretch.rows.clone() {
            if i.is_multiple_of(ROWS_A_LOOK) {
                drives.go_on()?;
            }
            let row = &drives.rows[i];
            let step_s = if run == stretch.run { row.t_s - last_s } else { 0.0 };
            if run != stretch.run {
                state = Sides::both(0.0);
            }
            (run, last_s) = (stretch.run, row.t_s);
            let keep = (-step_s / memory_s).exp();
            let power = ground.power(robot, row);
            let lost_w = power.force_n.zip(k1_w_per_n2(robot, row)).map(|(f, k1)| k1 * f * f);
            state = state.zip(lost_w).map(|(old, new)| keep * old + (1.0 - keep) * new);
            averaged[i] = state;
        }
    }
    Ok(averaged)
}

/// k1 of both motors at the temperatures of a row \[W/N²\].
fn k1_w_per_n2(robot: &Robot, row: &crate::row::Row) -> Sides<f64> {
    let motors = robot.motor_sides().zip(row.motor_c);
    motors.map(|(motor, c)| motor.at_temperature(&robot.motors, c).k1_w_per_n2)
}
