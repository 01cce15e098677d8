//! Channels that a person should look at before trusting the numbers. Nothing here changes a recording.

use std::borrow::Cow;

use crate::{
    Channel, Recording, Run,
    report::{Suspicion, SuspicionKind as Kind},
};

/// Fewer rows than this say nothing about a channel.
const LEAST_ROWS: usize = 20;

/// A wheel whose rim is slower than this stands still \[m/s\]: twice the step of the Husky's encoder speeds (0.0079 m/s).
const STANDSTILL_MPS: f64 = 0.016;

/// A doubt about each channel, for every test that it fails.
pub(crate) fn find(recording: &Recording) -> Vec<Suspicion> {
    let mut doubts = Vec::new();
    for (&channel, values) in &recording.channels {
        let doubt = |kind, statement| Suspicion { channel, run: None, kind, statement };
        let present = present(values);
        if let Some(statement) = sparse(present.len(), values.len()) {
            doubts.push(doubt(Kind::Sparse, statement));
        }
        if present.len() < LEAST_ROWS {
            continue;
        }
        if let Some(statement) = constant(&present) {
            doubts.push(doubt(Kind::Constant, statement));
            continue;
        }
        doubts.extend(saturated(&present).map(|statement| doubt(Kind::Saturated, statement)));
        doubts.extend(magnitude(channel, &present).map(|statement| doubt(Kind::Unit, statement)));
    }
    for run in &recording.runs {
        doubts.extend(empty(recording, run));
        for channel in [Channel::LeftSpeed, Channel::RightSpeed, Channel::YawRate] {
            let values = recording.channel(channel).and_then(|values| values.get(run.rows.clone()));
            if let Some(statement) = values.and_then(lone_flips) {
                doubts.push(Suspicion { channel, run: Some(run.name.clone()), kind: Kind::Sign, statement });
            }
        }
        doubts.extend(turning(recording, run));
    }
    doubts.extend(units_of_runs(recording));
    doubts.extend(unsigned(recording));
    doubts
}

/// Values that are there, without a copy when all are.
fn present(values: &[f64]) -> Cow<'_, [f64]> {
    if values.iter().any(|value| value.is_nan()) {
        values.iter().copied().filter(|value| !value.is_nan()).collect()
    } else {
        Cow::Borrowed(values)
    }
}

fn sparse(present: usize, rows: usize) -> Option<String> {
    let missing = rows - present;
    // More gaps than values: what is fitted to the rest describes the minority of the drive.
    (missing > present).then(|| format!("{missing} of {rows} rows have no value"))
}

/// A run that tells nothing: of one of the channels that are needed it has no value.
fn empty(recording: &Recording, run: &Run) -> Option<Suspicion> {
    let power = recording.power_form()?.channels();
    let needed = [Channel::LeftSpeed, Channel::RightSpeed].into_iter().chain(power);
    let lacks = |channel: &Channel| {
        let values = recording.channel(*channel).and_then(|values| values.get(run.rows.clone()));
        values.is_some_and(|values| values.iter().all(|value| value.is_nan()))
    };
    let channel = needed.into_iter().find(lacks)?;
    let statement = format!("it has no value in {} rows, so that this run tells nothing", run.rows.len());
    Some(Suspicion { channel, run: Some(run.name.clone()), kind: Kind::Sparse, statement })
}

fn constant(present: &[f64]) -> Option<String> {
    let first = *present.first()?;
    present.iter().all(|value| *value == first).then(|| format!("it is {first} in every row"))
}

/// A spike of equal values at an extreme. A driven robot does reach its top speed often, but then values just below are
/// as frequent; a clipped signal has many times more at the limit itself.
fn saturated(present: &[f64]) -> Option<String> {
    /// Shares below this do little harm to a fit.
    const LEAST_SHARE: f64 = 0.01;
    /// How many times more frequent than the mean of its next neighbours an extreme must be.
    const SPIKE: f64 = 5.0;
    /// Neighbours that are looked at.
    const NEIGHBOURS: usize = 10;
    let (least, greatest) =
        present.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, g), v| (l.min(*v), g.max(*v)));
    let often = |value: f64| {
        let count = present.iter().filter(|v| **v == value).count();
        // Zero is where an unsigned channel rests, not where it is clipped.
        value != 0.0 && count >= LEAST_ROWS && count as f64 >= LEAST_SHARE * present.len() as f64
    };
    // Sorting a million rows takes longer than reading them, and hardly any channel needs it.
    if !often(least) && !often(greatest) {
        return None;
    }
    let mut sorted = present.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let counts: Vec<(f64, usize)> =
        sorted.chunk_by(|a, b| a == b).map(|equal| (equal[0], equal.len())).collect();
    if counts.len() <= NEIGHBOURS {
        return None;
    }
    let spike = |ends: &mut dyn Iterator<Item = &(f64, usize)>| {
        let (value, count) = *ends.next()?;
        let near: usize = ends.take(NEIGHBOURS).map(|(_, count)| count).sum();
        let clipped = often(value) && count as f64 >= SPIKE * near as f64 / NEIGHBOURS as f64;
        clipped.then(|| format!("it stands at its limit {value} in {count} of {} rows", present.len()))
    };
    spike(&mut counts.iter().rev()).or_else(|| spike(&mut counts.iter()))
}

fn magnitude(channel: Channel, present: &[f64]) -> Option<String> {
    let [least, greatest] = channel.plausible_magnitude();
    let high = high_magnitude(present)?;
    let unit = crate::units::si_unit(channel.quantity());
    (high < least || high > greatest).then(|| {
        format!(
            "its 99th percentile is {high:.4} {unit}, outside {least} to {greatest:.4}: is the unit right?"
        )
    })
}

/// The 99th percentile of the magnitude: the extreme would be the first outlier.
fn high_magnitude(present: &[f64]) -> Option<f64> {
    /// So many values, taken evenly, place a percentile to a thirtieth of a percent.
    const SAMPLE: usize = 100_000;
    let every = present.len().div_ceil(SAMPLE).max(1);
    let mut magnitudes: Vec<f64> = present.iter().step_by(every).map(|value| value.abs()).collect();
    let at = magnitudes.len().checked_sub(1)? * 99 / 100;
    Some(*magnitudes.select_nth_unstable_by(at, f64::total_cmp).1)
}

/// A run whose power is a thousandth or a thousand times that of the others was logged in another unit.
fn units_of_runs(recording: &Recording) -> Vec<Suspicion> {
    /// Between the largest honest ratio of two drives of a robot (about 20) and that of kW to W.
    const RATIO: f64 = 150.0;
    let mut doubts = Vec::new();
    for (&channel, values) in recording.channels.iter().filter(|(channel, _)| channel.tells_power()) {
        let high = |run: &Run| {
            let rows = values.get(run.rows.clone()).unwrap_or_default();
            let present = present(rows);
            if present.len() < LEAST_ROWS {
                None
            } else {
                high_magnitude(&present).filter(|high| *high > 0.0)
            }
        };
        let of_runs: Vec<(&Run, f64)> =
            recording.runs.iter().filter_map(|run| high(run).map(|high| (run, high))).collect();
        let mut sorted: Vec<f64> = of_runs.iter().map(|(_, high)| *high).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let Some(&median) = sorted.get(sorted.len() / 2) else { continue };
        for (run, high) in of_runs {
            if high / median > RATIO || median / high > RATIO {
                let statement = format!(
                    "its 99th percentile is {high:.4} here and {median:.4} in most runs: mixed units?"
                );
                doubts.push(Suspicion { channel, run: Some(run.name.clone()), kind: Kind::Unit, statement });
            }
        }
    }
    doubts
}

/// Rows whose sign is opposed to both neighbours of the same magnitude, which no body with inertia does.
fn lone_flips(values: &[f64]) -> Option<String> {
    /// How nearly equal the magnitudes are.
    const LIKENESS: f64 = 0.2;
    let like = |a: f64, b: f64| (a + b).abs() < LIKENESS * b.abs() && a.abs() > 5.0 * STANDSTILL_MPS;
    let flips = values.windows(3).filter(|w| like(w[0], w[1]) && like(w[2], w[1])).count();
    (flips > 0).then(|| format!("its sign flips for {flips} single rows"))
}

/// Wheel speeds against yaw rate: `ω = (v_right − v_left) / slip track`.
fn turning(recording: &Recording, run: &Run) -> Option<Suspicion> {
    /// Slip tracks \[m\] between which a skid-steered robot of 5 kg to 5 t turns, from half a small robot's track to three
    /// times a large one's.
    const SLIP_TRACK_M: [f64; 2] = [0.1, 6.0];
    /// Least share of the yaw rate's variance that turning wheels explain on firm ground.
    const LEAST_R2: f64 = 0.5;
    let column = |channel| recording.channel(channel).and_then(|values| values.get(run.rows.clone()));
    let (left, right) = (column(Channel::LeftSpeed)?, column(Channel::RightSpeed)?);
    let yaw_rate = column(Channel::YawRate)?;
    let (mut n, mut dd, mut dw, mut ww) = (0usize, 0.0, 0.0, 0.0);
    for ((left, right), yaw_rate) in left.iter().zip(right).zip(yaw_rate) {
        let difference = right - left;
        // Rows where the wheels do not turn the robot only add the gyroscope's noise.
        if difference.abs() > 2.0 * STANDSTILL_MPS && !yaw_rate.is_nan() {
            n += 1;
            dd += difference * difference;
            dw += difference * yaw_rate;
            ww += yaw_rate * yaw_rate;
        }
    }
    if n < LEAST_ROWS || ww == 0.0 {
        return None;
    }
    let (r2, slip_track_m) = (dw * dw / (dd * ww), dd / dw);
    let (kind, statement) = if dw < 0.0 && r2 > LEAST_R2 {
        (Kind::Sign, "it is opposed to the wheel speeds: left and right, or its sign, are swapped".into())
    } else if r2 < LEAST_R2 {
        let share = 100.0 * r2;
        (
            Kind::Slip,
            format!(
                "the wheels' difference in speed explains only {share:.0} % of it: the wheels slip, or it is not this drive's"
            ),
        )
    } else if !(SLIP_TRACK_M[0]..=SLIP_TRACK_M[1]).contains(&slip_track_m) {
        (
            Kind::Unit,
            format!(
                "with the wheel speeds it means a slip track of {slip_track_m:.3} m: is its unit or theirs right?"
            ),
        )
    } else {
        return None;
    };
    Some(Suspicion { channel: Channel::YawRate, run: Some(run.name.clone()), kind, statement })
}

/// Motor currents that are never negative although the wheels turn both ways.
fn unsigned(recording: &Recording) -> Vec<Suspicion> {
    let pairs =
        [(Channel::LeftMotorCurrent, Channel::LeftSpeed), (Channel::RightMotorCurrent, Channel::RightSpeed)];
    let mut doubts = Vec::new();
    for (channel, wheel) in pairs {
        let (Some(current_a), Some(speed_mps)) = (recording.channel(channel), recording.channel(wheel))
        else {
            continue;
        };
        let backwards = speed_mps.iter().filter(|v| **v < -STANDSTILL_MPS).count();
        let forwards = speed_mps.iter().filter(|v| **v > STANDSTILL_MPS).count();
        if backwards >= LEAST_ROWS && forwards >= LEAST_ROWS && !current_a.iter().any(|i| *i < 0.0) {
            let statement =
                format!("it is never negative, although the wheels turn backwards in {backwards} rows");
            doubts.push(Suspicion { channel, run: None, kind: Kind::Unsigned, statement });
        }
    }
    doubts
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    const ROWS: usize = 400;

    /// A healthy drive of weaving, with one channel replaced.
    fn drive(channel: Channel, of: impl Fn(usize, f64) -> f64) -> Vec<(Channel, Kind)> {
        let t_s: Vec<f64> = (0..ROWS).map(|row| row as f64 * 0.1).collect();
        let weave = |phase: f64| -> Vec<f64> { t_s.iter().map(|t| 0.5 + 0.3 * (t + phase).sin()).collect() };
        let (left, right) = (weave(0.0), weave(1.0));
        let yaw_rate = left.iter().zip(&right).map(|(l, r)| (r - l) / 0.9).collect();
        let power_w = left.iter().map(|v| 40.0 + 100.0 * v).collect();
        let mut channels = BTreeMap::from([
            (Channel::LeftSpeed, left),
            (Channel::RightSpeed, right),
            (Channel::YawRate, yaw_rate),
            (Channel::Power, power_w),
        ]);
        let values = channels.entry(channel).or_insert_with(|| t_s.iter().map(|t| t.sin()).collect());
        for (row, value) in values.iter_mut().enumerate() {
            *value = of(row, *value);
        }
        let runs = vec![Run::new("drive".into(), 0..ROWS, &t_s, None)];
        let recording = Recording { t_s, channels, runs, ..Recording::default() };
        find(&recording).into_iter().map(|doubt| (doubt.channel, doubt.kind)).collect()
    }

    #[test]
    fn a_healthy_drive_raises_no_doubt() {
        assert_eq!(drive(Channel::Power, |_, p| p), []);
    }

    #[test]
    fn each_fault_is_named_by_channel_and_kind() {
        use Channel as C;
        assert_eq!(drive(C::Power, |_, _| 7.0), [(C::Power, Kind::Constant)]);
        assert_eq!(drive(C::Power, |_, p| p / 1000.0), [(C::Power, Kind::Unit)]);
        assert_eq!(drive(C::Power, |_, p| p.min(100.0)), [(C::Power, Kind::Saturated)]);
        assert_eq!(drive(C::Power, |r, p| if r < 300 { f64::NAN } else { p }), [(C::Power, Kind::Sparse)]);
        assert_eq!(drive(C::YawRate, |_, w| -w), [(C::YawRate, Kind::Sign)]);
        assert_eq!(drive(C::YawRate, |r, _| (r as f64).sin()), [(C::YawRate, Kind::Slip)]);
        assert_eq!(drive(C::YawRate, |_, w| w.to_degrees()), [(C::YawRate, Kind::Unit); 2]);
        assert_eq!(drive(C::LeftSpeed, |r, v| if r == 200 { -v } else { v }), [(C::LeftSpeed, Kind::Sign)]);
        assert_eq!(drive(C::Pitch, |_, p| 10.0 * p), [(C::Pitch, Kind::Unit)]);
    }

    #[test]
    fn currents_without_a_sign_are_named_when_the_wheels_turn_both_ways() {
        let t_s: Vec<f64> = (0..ROWS).map(|row| row as f64 * 0.1).collect();
        let speed_mps: Vec<f64> = t_s.iter().map(|t| 0.5 * t.sin()).collect();
        let find = |current: fn(&f64) -> f64| {
            let current_a: Vec<f64> = speed_mps.iter().map(current).collect();
            let channels = BTreeMap::from([
                (Channel::LeftSpeed, speed_mps.clone()),
                (Channel::RightSpeed, speed_mps.clone()),
                (Channel::LeftMotorCurrent, current_a.clone()),
                (Channel::RightMotorCurrent, current_a),
            ]);
            let runs = vec![Run::new("drive".into(), 0..ROWS, &t_s, None)];
            let recording = Recording { t_s: t_s.clone(), channels, runs, ..Recording::default() };
            find(&recording).into_iter().filter(|doubt| doubt.kind == Kind::Unsigned).count()
        };
        assert_eq!((find(|v| 8.0 * v.abs() + 0.5), find(|v| 8.0 * v)), (2, 0));
    }
}
