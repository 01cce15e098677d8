//! Times in minutes, tenths of a second or row numbers, beside positions and what wheels can do.

use std::ops::Range;

use model::{Robot, STANDARD_GRAVITY_MPS2};
use recording::{Channel, Recording, Run};

use super::{Doubt, driving::STANDS_MPS, scale, second::median};

/// Times over seconds that logs are written with.
const UNITS: [(&str, f64); 5] = [
    ("hours", 3600.0),
    ("minutes", 60.0),
    ("tenths of a second", 0.1),
    ("hundredths of a second", 0.01),
    ("milliseconds", 1e-3),
];
/// Ways by positions over those by wheels that a unit of speeds or slipping wheels explain; beyond, times are wrong.
const BY_SPEED: [f64; 2] = [0.25, 4.0];
/// Way over ground of which a share is told \[m\]: farther than positions of satellites err from one second to the next.
const WAY_M: f64 = 1.0;
/// The same in standard deviations of positions: a share is then told to a seventh.
const WAY_SIGMAS: f64 = 10.0;
/// Median of |x1 - 2 x2 + x3| of positions with white noise of one sigma: 0.6745 √6.
const SECOND_DIFFERENCE: f64 = 1.652;
/// Fewer shares tell nothing.
const LEAST_WAYS: usize = 5;
/// Share of the range of a speed that counts as speeding up or slowing down.
const CHANGE: f64 = 0.3;
/// Part of a change that one row may bring: commands change from row to row, and wheels do not.
const MOST_AT_ONCE: f64 = 0.5;
/// Changes that no chance brings about.
const LEAST_CHANGES: usize = 3;
/// Share of all changes that are impossible where time is: elsewhere wheels slip once in a while.
const LEAST_SHARE: f64 = 0.5;
/// Time within which robots start, stop and turn \[s\].
const MANOEUVRE_S: f64 = 10.0;
/// Rows of a change that is seen as smoothly as in a log of ten rows a second; of rows a second apart one or two see it.
const SLOW_ROWS: usize = 10;
/// Steps from which times may be too long \[s\]: one, of row numbers and tenths of ten rows a second.
const SLOW_STEP_S: f64 = 0.99;

/// Tells of times in another unit than seconds, where wheel speeds are as they should be: what robot and gyroscope say of them has no times.
pub(super) fn times(robot: &Robot, recording: &Recording) -> Option<Doubt> {
    let turns_right = scale::slip_track_m(recording).is_none_or(|track_m| {
        (scale::SLIP_TRACKS[0]..=scale::SLIP_TRACKS[1]).contains(&(track_m / robot.track_m))
    });
    if !turns_right || !scale::is_possible(robot, recording) {
        return None;
    }
    by_positions(recording).or_else(|| by_acceleration(recording))
}

fn doubt(seconds_each: f64, shown: &str) -> Doubt {
    let off = |unit: f64| (seconds_each / unit).ln().abs();
    let near = UNITS.iter().filter(|(_, unit)| off(*unit) < scale::LIKE_UNIT.ln());
    let cure = match near.min_by(|a, b| off(a.1).total_cmp(&off(b.1))) {
        Some((name, unit)) => {
            format!(
                "are they in {name}? Give `t_s` its unit, or a \"scale\" of {unit}, in a map (row numbers need the time of a row)"
            )
        }
        None => {
            "give `t_s` in seconds (row numbers need the time of a row as the \"scale\" of `t_s` in a map)"
                .to_owned()
        }
    };
    Doubt {
        name: "time_scale",
        statement: format!("a second of `t_s` seems to last {seconds_each:.3} s: {shown}"),
        cure,
    }
}

/// Times by which the robot would go another way than its positions do.
fn by_positions(recording: &Recording) -> Option<Doubt> {
    let share = way_share(recording)?;
    (!(BY_SPEED[0]..=BY_SPEED[1]).contains(&share)).then(|| {
        doubt(
            share,
            &format!(
                "positions go {share:.3} times as far as wheel speeds would bring the robot in these times"
            ),
        )
    })
}

/// One sigma of the noise of positions \[m\].
pub(super) fn noise_m(values: &[f64]) -> f64 {
    let bent = values.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs()).filter(|m| m.is_finite());
    median(bent.collect()).unwrap_or(0.0) / SECOND_DIFFERENCE
}

/// Median of ways by positions over ways by wheels.
fn way_share(recording: &Recording) -> Option<f64> {
    let shares = way_shares(recording, |_| true)?;
    (shares.len() >= LEAST_WAYS).then(|| median(shares))?
}

/// Ways by positions over ways by wheels in rows that count, over a metre by positions each, or more where they are noisy.
pub(super) fn way_shares(recording: &Recording, counts: impl Fn(usize) -> bool) -> Option<Vec<f64>> {
    let [x, y, left, right] =
        [Channel::X, Channel::Y, Channel::LeftSpeed, Channel::RightSpeed].map(|c| recording.channel(c));
    let (x, y, left, right) = (x?, y?, left?, right?);
    let speed = |i: usize| (left[i] + right[i]) / 2.0;
    let least_m = (WAY_SIGMAS * noise_m(x).hypot(noise_m(y))).max(WAY_M);
    let mut shares = Vec::new();
    for run in &recording.runs {
        let (mut from, mut way_m) = (run.rows.start, 0.0);
        for i in run.rows.clone().skip(1) {
            let step_m = (recording.t_s[i] - recording.t_s[i - 1]) * (speed(i) + speed(i - 1)) / 2.0;
            let is_ahead = counts(i)
                && speed(i).abs() > STANDS_MPS
                && speed(i) * speed(i - 1) > 0.0
                && step_m.is_finite();
            if !is_ahead {
                // Robots that stand, turn round or leave gaps go no way.
                (from, way_m) = (i, 0.0);
                continue;
            }
            way_m += step_m.abs();
            let moved_m = (x[i] - x[from]).hypot(y[i] - y[from]);
            if moved_m >= least_m {
                shares.push(moved_m / way_m);
                (from, way_m) = (i, 0.0);
            }
        }
    }
    Some(shares)
}

/// Times in which wheels speed up and slow down faster than tyres hold, or more slowly than robots do.
fn by_acceleration(recording: &Recording) -> Option<Doubt> {
    let mut all: Vec<Change> = Vec::new();
    for side in [Channel::LeftSpeed, Channel::RightSpeed] {
        let values = recording.channel(side)?;
        let least_mps = CHANGE * range(values)?;
        recording.runs.iter().for_each(|run| all.extend(changes(recording, run, values, least_mps)));
    }
    let smooth: Vec<&Change> = all.iter().filter(|change| change.is_smooth).collect();
    let is_rule = |count: usize| count >= LEAST_CHANGES && count as f64 > LEAST_SHARE * all.len() as f64;
    let impossible = smooth.iter().filter(|change| change.rate_mps2 > STANDARD_GRAVITY_MPS2).count();
    if is_rule(impossible) {
        let middle_mps2 = median(smooth.iter().map(|change| change.rate_mps2).collect())?;
        return Some(Doubt {
            name: "time_scale",
            statement: format!(
                "wheels speed up and slow down by {middle_mps2:.0} m/s² in the middle of {} changes of their speed, and tyres hold no more than \
                 {STANDARD_GRAVITY_MPS2:.1} m/s²: a second of `t_s` seems to last longer",
                smooth.len()
            ),
            cure: "are times in minutes or hours? Give `t_s` its unit, or a \"scale\" (60 for minutes), in a map".to_owned(),
        });
    }
    let is_slow = |change: &&&Change| change.span_s >= MANOEUVRE_S && change.rows >= SLOW_ROWS;
    let slow = smooth.iter().filter(is_slow).count();
    let middle_s = median(smooth.iter().map(|change| change.span_s).collect())?;
    (is_rule(slow) && middle_step_s(recording)? >= SLOW_STEP_S).then(|| Doubt {
        name: "time_scale",
        statement: format!(
            "wheels take {middle_s:.0} s in the middle of {} changes of their speed, as smoothly as in logs of many rows a second, and robots start and stop within \
             seconds: a second of `t_s` seems to be shorter",
            smooth.len()
        ),
        cure: "are times tenths of a second or numbers of rows? Give `t_s` its \"scale\", the seconds that one lasts (0.1 for tenths), in a map".to_owned(),
    })
}

/// Median time from row to row \[s\].
fn middle_step_s(recording: &Recording) -> Option<f64> {
    let steps = recording.runs.iter().flat_map(|run| run.rows.clone().skip(1));
    median(steps.map(|row| recording.t_s[row] - recording.t_s[row - 1]).collect())
}

/// Range of a speed between the 5th and the 95th percentile \[m/s\].
fn range(values: &[f64]) -> Option<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    Some(sorted[last * 95 / 100] - sorted[last * 5 / 100]).filter(|range| *range > 2.0 * STANDS_MPS)
}

/// A change of a speed that goes on in one direction.
struct Change {
    rate_mps2: f64,
    span_s: f64,
    rows: usize,
    /// No row brings most of it.
    is_smooth: bool,
}

/// The changes of a speed, each counted once.
fn changes(recording: &Recording, run: &Run, values: &[f64], least_mps: f64) -> Vec<Change> {
    let mut found = Vec::new();
    let mut from = run.rows.start;
    for row in run.rows.clone().skip(1) {
        let goes_on = |a: usize| (values[row] - values[row - 1]) * (values[a + 1] - values[a]) > 0.0;
        if row - 1 > from && !goes_on(from) || !values[row].is_finite() {
            found.extend(change(recording, values, from..row, least_mps));
            from = if values[row].is_finite() { row - 1 } else { row };
        }
    }
    found.extend(change(recording, values, from..run.rows.end, least_mps));
    found
}

fn change(recording: &Recording, values: &[f64], rows: Range<usize>, least_mps: f64) -> Option<Change> {
    let (first, last) = (rows.start, rows.end.checked_sub(1)?);
    let change_mps = (values[last] - values[first]).abs();
    let count = rows.len();
    let at_once = values[rows].windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    let span_s = recording.t_s[last] - recording.t_s[first];
    let is_smooth = at_once < MOST_AT_ONCE * change_mps;
    (change_mps >= least_mps).then(|| Change {
        rate_mps2: change_mps / span_s,
        span_s,
        rows: count,
        is_smooth,
    })
}
