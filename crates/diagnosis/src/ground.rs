//! Where recorded drives went: headings, heights and speeds over ground.

use calibration::Drives;
use model::Robot;
use recording::{Channel, Recording};

/// Positions that move faster than the wheels can turn by this factor have jumped.
const JUMP: f64 = 2.0;

/// Heights by row above their mean; NaN where there are none [m].
pub(crate) fn heights_m(recording: &Recording) -> Vec<f64> {
    let Some(heights_m) = recording.channel(Channel::Z) else { return vec![f64::NAN; recording.rows()] };
    let known = || heights_m.iter().filter(|z| z.is_finite());
    let mean_m = known().sum::<f64>() / known().count().max(1) as f64;
    heights_m.iter().map(|z| z - mean_m).collect()
}

/// Headings by row: recorded, or from the yaw rate or the wheels, beginning at 0 [rad].
pub(crate) fn headings(recording: &Recording, drives: &Drives) -> Vec<f64> {
    if let Some(recorded) = recording.channel(Channel::Heading) {
        return recorded.to_vec();
    }
    let mut headings = vec![f64::NAN; drives.rows.len()];
    let (mut heading_rad, mut run) = (0.0, usize::MAX);
    for stretch in &drives.stretches {
        if stretch.run != run {
            heading_rad = 0.0;
        }
        run = stretch.run;
        for i in stretch.rows.clone() {
            let row = &drives.rows[i];
            if row.yaw_rate_radps.is_finite() {
                heading_rad += row.yaw_rate_radps * row.step_s;
            }
            headings[i] = heading_rad;
        }
    }
    headings
}

/// Speeds over ground by average, from the positions at its ends; NaN where there are none, or where they jump [m/s].
pub(crate) fn speeds_mps(robot: &Robot, recording: &Recording, drives: &Drives) -> Vec<f64> {
    let (Some(x_m), Some(y_m)) = (recording.channel(Channel::X), recording.channel(Channel::Y)) else {
        return vec![f64::NAN; drives.averages.len()];
    };
    let speed_mps = |average: &calibration::average::Average| {
        let known = |i: &usize| x_m[*i].is_finite() && y_m[*i].is_finite();
        let (first, last) = (average.rows.clone().find(known), average.rows.clone().rev().find(known));
        let (Some(first), Some(last)) = (first, last) else { return f64::NAN };
        let span_s = recording.t_s[last] - recording.t_s[first];
        // Ends of less than half a second tell of the receiver's noise.
        if span_s < 0.5 * average.duration_s || span_s <= 0.0 {
            return f64::NAN;
        }
        let speed_mps = (x_m[last] - x_m[first]).hypot(y_m[last] - y_m[first]) / span_s;
        if speed_mps > JUMP * robot.max_wheel_speed_mps { f64::NAN } else { speed_mps }
    };
    drives.averages.iter().map(speed_mps).collect()
}
