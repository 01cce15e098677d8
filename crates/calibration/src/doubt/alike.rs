//! One measurement in the columns of two: the power of both sides, or pitch and roll.

use std::collections::BTreeSet;

use recording::{Channel, Recording};

use super::{Doubt, cells::recorded_j, driving::TURNING_MPS};

/// Share of such rows in which two meters are alike to the last digit: with noise of their own they never are.
const ALIKE: f64 = 0.99;
/// Different values, and rows of turning, that tell something.
const LEAST_ROWS: usize = 10;

/// Tells of two columns that hold one measurement.
pub(super) fn alike(recording: &Recording) -> Option<Doubt> {
    angles_alike(recording).or_else(|| sides_alike(recording))
}

/// The same angle in the columns of pitch and roll.
fn angles_alike(recording: &Recording) -> Option<Doubt> {
    let (pitch, roll) = (recording.channel(Channel::Pitch)?, recording.channel(Channel::Roll)?);
    let known = || pitch.iter().zip(roll).filter(|(p, r)| p.is_finite() && r.is_finite());
    let values: BTreeSet<u64> = known().filter(|(p, r)| p == r).map(|(p, _)| p.to_bits()).collect();
    let (rows, same) = (known().count(), known().filter(|(p, r)| p == r).count());
    (values.len() >= LEAST_ROWS && same as f64 >= ALIKE * rows as f64).then(|| Doubt {
        name: "angles_alike",
        statement: format!(
            "`pitch_rad` and `roll_rad` are the same to the last digit in {same} of {rows} rows: both columns seem to hold one angle"
        ),
        cure: "read pitch and roll from fields of their own; pitch is nose up, roll left side up".to_owned(),
    })
}

/// The same power, or motor current, in the columns of both sides.
fn sides_alike(recording: &Recording) -> Option<Doubt> {
    let pairs = [
        ([Channel::LeftPower, Channel::RightPower], "power"),
        ([Channel::LeftMotorCurrent, Channel::RightMotorCurrent], "motor current"),
    ];
    let form = recording.power_form()?.channels();
    let (sides, quantity) = pairs.into_iter().find(|(sides, _)| *sides == form)?;
    let [left, right, v_left, v_right] =
        [sides[0], sides[1], Channel::LeftSpeed, Channel::RightSpeed].map(|c| recording.channel(c));
    let (left, right, v_left, v_right) = (left?, right?, v_left?, v_right?);
    let turns = |row: &usize| (v_right[*row] - v_left[*row]).abs() > TURNING_MPS;
    let turned: Vec<usize> = (0..left.len())
        .filter(|row| left[*row].is_finite() && right[*row].is_finite())
        .filter(turns)
        .collect();
    let same: Vec<usize> = turned.iter().copied().filter(|row| left[*row] == right[*row]).collect();
    let values: BTreeSet<u64> = same.iter().map(|row| left[*row].to_bits()).collect();
    if values.len() < LEAST_ROWS || (same.len() as f64) < ALIKE * turned.len() as f64 {
        return None;
    }
    let total = recording.channel(Channel::Power).map(|power_w| {
        let of_total = same.iter().filter(|row| power_w[**row] == left[**row]).count();
        format!(", and so is `power_w` in {of_total} of them")
    });
    let energy = recorded_j(recording)
        .map(|joules| format!("; together they make {:.1} kJ, twice that of one", joules / 1e3));
    Some(Doubt {
        name: "sides_alike",
        statement: format!(
            "{quantity} of both sides is the same to the last digit in {} of {} rows in which the robot turns{}{}: both columns seem to hold one measurement",
            same.len(),
            turned.len(),
            total.unwrap_or_default(),
            energy.unwrap_or_default()
        ),
        cure: "give the power of the battery as `power_w` alone, or that of each side as its own driver tells it".to_owned(),
    })
}
