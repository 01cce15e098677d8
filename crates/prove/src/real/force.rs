//! Extra forces as extra current, and back, by the robot's own force per ampere.

use calibration::force_n_per_a;
use model::{Robot, Sides};
use recording::{Channel, Recording};

use crate::{Error, real::reading::Reading};

/// Channels of the motor currents, left and right.
pub(crate) const CURRENTS: [Channel; 2] = [Channel::LeftMotorCurrent, Channel::RightMotorCurrent];

/// Puts forces on top of those that the currents of some rows stand for.
///
/// ```text
/// I' = |F + ΔF| / c      where the motor drives,   F = ± c I with the sign of the force needed
///      |F + ΔF| / c k2²  where the ground drives it
/// ```
///
/// # Errors
/// A robot that does not say what an ampere stands for.
pub(crate) fn add_forces(
    robot: &Robot,
    recording: &mut Recording,
    acts: impl Fn(usize) -> bool,
    extra_n: impl Fn(&Reading, usize) -> Sides<f64>,
) -> Result<(), Error> {
    let reading = Reading::new(robot, recording)?;
    let rows: Vec<usize> = (0..recording.rows()).filter(|row| acts(*row)).collect();
    for row in rows {
        let force_n = reading.recorded_n[row].zip(extra_n(&reading, row)).map(|(own, extra)| own + extra);
        set(recording, row, reading.current_a(robot, &reading.drives.rows[row], force_n));
    }
    Ok(())
}

fn set(recording: &mut Recording, row: usize, current_a: Sides<f64>) {
    for (channel, current_a) in CURRENTS.into_iter().zip([current_a.left, current_a.right]) {
        if let Some(value) = recording.channels.get_mut(&channel).and_then(|values| values.get_mut(row)) {
            *value = current_a;
        }
    }
}

/// The same drives with the currents and yaw rates that the robot itself would have shown: no noise, and nothing that its model misses.
///
/// # Errors
/// A robot that does not say what an ampere stands for.
pub(crate) fn imitated(robot: &Robot, recording: &Recording) -> Result<Recording, Error> {
    force_n_per_a(robot)?;
    let reading = Reading::new(robot, recording)?;
    let mut ideal = recording.clone();
    for row in 0..recording.rows() {
        let wheels_radps = reading.drives.rows[row].difference_mps() / robot.slip_track_m;
        if let Some(yaw_rate) =
            ideal.channels.get_mut(&Channel::YawRate).and_then(|values| values.get_mut(row))
        {
            *yaw_rate = wheels_radps;
        }
        if reading.recorded_n[row].left.is_finite() && reading.recorded_n[row].right.is_finite() {
            set(&mut ideal, row, reading.current_a(robot, &reading.drives.rows[row], reading.needed_n[row]));
        }
    }
    Ok(ideal)
}
