//! Drives second by second: what the robot did, what the model says that it draws, and what was recorded.

use model::Robot;
use recording::{Channel, PowerForm, Recording, Watch};

use crate::{
    Drives, Error,
    field::with_new_ground,
    power::{by_row, seen_w},
};

/// One average of drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Second {
    /// Which run.
    pub(super) run: usize,
    /// Its beginning \[s\].
    pub(super) t_s: f64,
    /// Its length \[s\].
    pub(super) duration_s: f64,
    /// Mean magnitude of both rim speeds \[m/s\].
    pub(super) rim_mps: f64,
    /// Mean of right less left rim speed \[m/s\].
    pub(super) difference_mps: f64,
    /// Mean rate of change of the speed \[m/s²\].
    pub(super) accel_mps2: f64,
    /// Mean pitch \[rad\].
    pub(super) pitch_rad: f64,
    /// Mean yaw rate; NaN where none was recorded \[rad/s\].
    pub(super) yaw_rate_radps: f64,
    /// Way by positions over the way by wheels; NaN where either is missing or the robot hardly moves ahead.
    pub(super) way_share: f64,
    /// Power as the robot's file has it \[W\].
    pub(super) predicted_w: f64,
    /// Power as recorded; NaN where motor currents were \[W\].
    pub(super) recorded_w: f64,
}

/// All seconds of drives whose wheels are known, stuck ones included.
///
/// # Errors
/// As [`Drives::watched`].
pub(super) fn seconds(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Vec<Second>, Error> {
    let drives = Drives::watched(robot, recording, watch)?.including_stuck();
    let robot = &with_new_ground(robot, &drives);
    let form = drives.form.unwrap_or(PowerForm::Battery);
    let predicted_w =
        by_row(&drives, robot, |i, power| seen_w(robot, form, &drives.rows[i], power).iter().sum::<f64>())?;
    let recorded_w = |i: usize| match form {
        PowerForm::MotorCurrents => f64::NAN,
        _ => drives.recorded.iter().map(|column| column[i]).sum(),
    };
    let rows = &drives.rows;
    let means = drives.means(|i| {
        let row = &rows[i];
        let rim_mps = (row.rim_mps.left.abs() + row.rim_mps.right.abs()) / 2.0;
        let motion = [rim_mps, row.difference_mps(), row.rim_mps2.sum() / 2.0];
        let [rim_mps, difference_mps, accel_mps2] = motion;
        [
            rim_mps,
            difference_mps,
            accel_mps2,
            row.pitch_rad,
            row.yaw_rate_radps,
            predicted_w[i],
            recorded_w(i),
        ]
    });
    let second = |(average, mean): (&crate::average::Average, [f64; 7])| {
        let [rim_mps, difference_mps, accel_mps2, pitch_rad, yaw_rate_radps, predicted_w, recorded_w] = mean;
        Second {
            run: average.run,
            t_s: average.t_s,
            duration_s: average.duration_s,
            rim_mps,
            difference_mps,
            accel_mps2,
            pitch_rad,
            yaw_rate_radps,
            way_share: way_share(recording, &drives, average.span.clone()),
            predicted_w,
            recorded_w,
        }
    };
    Ok(drives.averages.iter().zip(means).map(second).collect())
}

/// Energy that the robot's file predicts of drives \[J\].
///
/// # Errors
/// As [`seconds`].
pub(super) fn predicted_j(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<f64, Error> {
    let recording = recording.thinned_watched(watch)?;
    let seconds = seconds(robot, &recording, watch)?;
    Ok(seconds.iter().map(|one| one.duration_s * one.predicted_w).sum())
}

/// Way by positions over that by wheels between the first and the last of some rows.
fn way_share(recording: &Recording, drives: &Drives, rows: std::ops::Range<usize>) -> f64 {
    /// A way by wheels that positions can be compared with \[m\]: that of a tenth of a metre per second, in a second.
    const LEAST_M: f64 = 0.1;
    let (Some(x), Some(y)) = (recording.channel(Channel::X), recording.channel(Channel::Y)) else {
        return f64::NAN;
    };
    let (first, last) = (rows.start, rows.end.saturating_sub(1));
    let speed = |i: usize| drives.rows[i].speed_mps();
    let way_m: f64 =
        (first + 1..=last).map(|i| drives.rows[i].step_s * (speed(i) + speed(i - 1)) / 2.0).sum();
    if way_m.abs() < LEAST_M {
        return f64::NAN;
    }
    (x[last] - x[first]).hypot(y[last] - y[first]) / way_m.abs()
}

/// How long some seconds last together \[s\].
pub(super) fn total_s(seconds: &[&Second]) -> f64 {
    seconds.iter().map(|second| second.duration_s).sum()
}

/// Mean of a quantity over some seconds.
pub(super) fn mean(seconds: &[&Second], of: impl Fn(&Second) -> f64) -> f64 {
    seconds.iter().map(|second| of(second) * second.duration_s).sum::<f64>() / total_s(seconds)
}

/// The median; the upper one of an even number.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
