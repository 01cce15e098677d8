//! Meters that cannot read what is given back.

use model::Robot;
use recording::{Channel, Recording};

use super::cells::{Expected, power_channels};

/// Share of the rows that is worth a word, as for seconds that are left out.
const WORTH: f64 = 0.01;

/// A note on meters of power that rest at zero where the model gives power back.
pub(crate) fn clipped_note(robot: &Robot, recording: &Recording) -> Option<String> {
    let expected = Expected::new(robot, recording)?;
    let told = power_channels(recording).into_iter().filter_map(|channel| {
        // Motor currents come without a sign.
        if matches!(channel, Channel::Voltage | Channel::LeftMotorCurrent | Channel::RightMotorCurrent) {
            return None;
        }
        let values = recording.channel(channel)?;
        if values.iter().any(|value| *value < 0.0) {
            return None;
        }
        let resting = (0..values.len()).filter(|row| values[*row] == 0.0);
        let given_back = resting.filter(|row| expected.of_channel(channel, *row) < 0.0).count();
        (given_back as f64 > WORTH * values.len() as f64)
            .then(|| format!("`{}` in {given_back} of {} rows", channel.name(), values.len()))
    });
    let told: Vec<String> = told.collect();
    (!told.is_empty()).then(|| {
        format!(
            "meters rest at 0 where the model gives power back, and are never below: {}; what is given back there is not in the recorded energy",
            told.join(", ")
        )
    })
}
