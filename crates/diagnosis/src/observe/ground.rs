//! Where recorded drives went: headings, heights and speeds over ground.

use calibration::Drives;
use model::Robot;
use recording::{Channel, Recording};

/// Positions that move faster than the wheels can turn by this factor have jumped.
const JUMP: f64 = 2.0;

/// Positions by row; NaN where there are none [m].
pub(crate) fn positions_m(recording: &Recording) -> Vec<[f64; 2]> {
    match (recording.channel(Channel::X), recording.channel(Channel::Y)) {
        (Some(x_m), Some(y_m)) => x_m.iter().zip(y_m).map(|(x_m, y_m)| [*x_m, *y_m]).collect(),
        _ => vec![[f64::NAN; 2]; recording.rows()],
    }
}

/// Headings by row: recorded, or from the yaw rate or the wheels, counted from east where positions tell it and else from where
/// each run begins [rad]. Positions also tell by how much a gyroscope drifts: a thousandth of a radian per second is half a turn in an hour.
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
    for run in &recording.runs {
        let steps = steps(recording, drives, &headings, run.rows.clone());
        let off_rad = off_rad(&steps, &recording.t_s[run.rows.clone()]);
        headings[run.rows.clone()].iter_mut().zip(off_rad).for_each(|(heading_rad, off)| *heading_rad += off);
    }
    headings
}

/// Steps along which positions tell a direction [m].
const STEP_M: f64 = 0.5;
/// Steps that a direction is told from at least.
const LEAST_STEPS: usize = 10;
/// Steps up to so long before or after tell a direction [s]: a gyroscope is off by the same for that long.
const NEAR_S: f64 = 60.0;

/// A step of a run: when it was, and by how much the direction in which positions went is turned against the heading.
struct Step {
    t_s: f64,
    turned_rad: f64,
}

/// The steps of a run, in order.
fn steps(
    recording: &Recording,
    drives: &Drives,
    headings_rad: &[f64],
    rows: std::ops::Range<usize>,
) -> Vec<Step> {
    let (Some(x_m), Some(y_m)) = (recording.channel(Channel::X), recording.channel(Channel::Y)) else {
        return Vec::new();
    };
    let mut steps = Vec::new();
    let mut last: Option<usize> = None;
    for i in rows.filter(|i| x_m[*i].is_finite() && y_m[*i].is_finite()) {
        let start = *last.get_or_insert(i);
        let (along_m, up_m) = (x_m[i] - x_m[start], y_m[i] - y_m[start]);
        if along_m.hypot(up_m) < STEP_M {
            continue;
        }
        last = Some(i);
        let between = (start + i) / 2;
        // Backwards, the robot goes against its heading.
        let sign = drives.rows[between].speed_mps().signum();
        let turned_rad = (sign * up_m).atan2(sign * along_m) - headings_rad[between];
        if turned_rad.is_finite() {
            steps.push(Step { t_s: recording.t_s[between], turned_rad });
        }
    }
    steps
}

/// By how much headings are off at some times, which are in order, by the steps that were near; nothing where there are too few in all.
fn off_rad(steps: &[Step], t_s: &[f64]) -> Vec<f64> {
    if steps.len() < LEAST_STEPS {
        return vec![0.0; t_s.len()];
    }
    // Sums up to each step.
    let mut sums = vec![[0.0; 2]];
    for step in steps {
        let (sin, cos) = step.turned_rad.sin_cos();
        let [sum_sin, sum_cos] = sums[sums.len() - 1];
        sums.push([sum_sin + sin, sum_cos + cos]);
    }
    let near = |t_s: f64| {
        let mut from = steps.partition_point(|step| step.t_s < t_s - NEAR_S);
        let mut to = steps.partition_point(|step| step.t_s <= t_s + NEAR_S);
        while to - from < LEAST_STEPS {
            let is_before_nearer =
                from > 0 && (to == steps.len() || t_s - steps[from - 1].t_s < steps[to].t_s - t_s);
            if is_before_nearer { from -= 1 } else { to += 1 }
        }
        (from, to)
    };
    let off = |t_s: &f64| {
        let (from, to) = near(*t_s);
        (sums[to][0] - sums[from][0]).atan2(sums[to][1] - sums[from][1])
    };
    t_s.iter().map(off).collect()
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn positions_tell_where_a_drive_headed_when_it_began() {
        // Forwards along an arc that begins towards north-west, at 10 Hz, then back along it.
        let began_rad = 2.4;
        let (turn_radps, speed_mps) = (0.05, 0.5);
        let rows = 600;
        let at = |i: usize| 0.1 * if i < rows / 2 { i as f64 } else { (rows - i) as f64 };
        let way = |f: fn(f64) -> f64, g: fn(f64) -> f64| -> Vec<f64> {
            let place = |i: usize| {
                let turned_rad = turn_radps * at(i);
                speed_mps / turn_radps * (f(began_rad + turned_rad) - f(began_rad)) * g(1.0)
            };
            (0..rows).map(place).collect()
        };
        let sign = |i: usize| if i < rows / 2 { 1.0 } else { -1.0 };
        let column = |value: f64| -> Vec<f64> { (0..rows).map(|i| sign(i) * value).collect() };
        let channels = BTreeMap::from([
            (Channel::X, way(f64::sin, |one| one)),
            (Channel::Y, way(f64::cos, |one| -one)),
            (Channel::LeftSpeed, column(speed_mps)),
            (Channel::RightSpeed, column(speed_mps)),
            (Channel::YawRate, column(turn_radps)),
            (Channel::LeftPower, vec![30.0; rows]),
            (Channel::RightPower, vec![30.0; rows]),
        ]);
        let t_s = (0..rows).map(|i| 0.1 * i as f64).collect();
        let runs = vec![recording::Run { name: "arc".into(), rows: 0..rows, gap_s: 0.5, start_unix_s: None }];
        let recording = Recording { t_s, channels, runs, ..Recording::default() };
        let drives = Drives::new(&model::builtin::husky_a200(), &recording).unwrap();
        let headings = headings(&recording, &drives);
        assert!((headings[0] - began_rad).abs() < 0.02, "{}", headings[0]);
        assert!((headings[300] - began_rad - turn_radps * 30.0).abs() < 0.02, "{}", headings[300]);
    }

    #[test]
    fn a_gyroscope_that_drifts_by_a_radian_leaves_headings_by_positions_as_they_are() {
        // Headings that run away by a milliradian a second, and a stand of five minutes with no steps.
        let drift_rad = |t_s: f64| 0.3 - 1e-3 * t_s;
        let moves = |t_s: f64| !(300.0..600.0).contains(&t_s);
        let steps: Vec<Step> = (0..900)
            .map(f64::from)
            .filter(|t_s| moves(*t_s))
            .map(|t_s| Step {
                t_s,
                turned_rad: drift_rad(t_s) + if t_s as i64 % 2 == 0 { 0.1 } else { -0.1 },
            })
            .collect();
        let t_s: Vec<f64> = (0..9000).map(|i| 0.1 * f64::from(i)).collect();
        for (t_s, off) in t_s.iter().zip(off_rad(&steps, &t_s)) {
            // Ends are told from one side.
            let most_rad = if moves(*t_s) { 0.035 } else { 0.16 };
            assert!((off - drift_rad(*t_s)).abs() < most_rad, "{t_s} s: {off}");
        }
        assert_eq!(off_rad(&steps[..9], &[0.0, 1.0]), [0.0, 0.0], "too few");
    }
}
