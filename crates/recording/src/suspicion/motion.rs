//! Channels that contradict how a robot moves.

use std::f64::consts::{PI, TAU};

use super::LEAST_ROWS;
use crate::{
    Channel, Recording, Run, STANDS_MPS,
    report::{Suspicion, SuspicionKind as Kind},
};

/// Rows whose sign is opposed to both neighbours of the same magnitude, which no body with inertia does.
pub(super) fn lone_flips(values: &[f64]) -> Option<String> {
    /// How nearly equal the magnitudes are.
    const LIKENESS: f64 = 0.2;
    let like = |a: f64, b: f64| (a + b).abs() < LIKENESS * b.abs() && a.abs() > 5.0 * STANDS_MPS;
    let flips = values.windows(3).filter(|w| like(w[0], w[1]) && like(w[2], w[1])).count();
    (flips > 0).then(|| format!("its sign flips for {flips} single rows"))
}

/// A heading that jumps by 360 where it comes round: it is in degrees. From one run to another a heading that is counted on jumps by anything.
pub(super) fn degrees(recording: &Recording, run: &Run) -> Option<Suspicion> {
    /// What a jump of one row to the next is at least and at most; a heading in radians jumps by 6.28.
    const JUMP: [f64; 2] = [300.0, 361.0];
    let values = recording.channel(Channel::Heading)?.get(run.rows.clone())?;
    let jumps = values.windows(2).filter(|w| (JUMP[0]..=JUMP[1]).contains(&(w[1] - w[0]).abs())).count();
    let statement = format!(
        "it jumps by 360 from one row to the next, {jumps} times: is it in degrees and not in radians?"
    );
    let (run, kind) = (Some(run.name.clone()), Kind::Unit);
    (jumps > 0).then_some(Suspicion { channel: Channel::Heading, run, kind, statement })
}

/// Wheels that turn the robot, moment by moment.
struct Turns {
    by: Channel,
    /// The difference of both speeds \[m/s\] and the rate at which the robot turns \[rad/s\].
    pairs: Vec<[f64; 2]>,
    /// The sum of both speeds beside the rate, which follows it where one side's sign is mirrored.
    sums: Vec<[f64; 2]>,
}

impl Turns {
    /// As a yaw rate tells it, or else the heading.
    fn of(recording: &Recording, run: &Run) -> Option<Turns> {
        let column = |channel| recording.channel(channel).and_then(|values| values.get(run.rows.clone()));
        let (left, right) = (column(Channel::LeftSpeed)?, column(Channel::RightSpeed)?);
        let difference: Vec<f64> = left.iter().zip(right).map(|(left, right)| right - left).collect();
        let sum: Vec<f64> = left.iter().zip(right).map(|(left, right)| right + left).collect();
        if let Some(rates) = column(Channel::YawRate) {
            let beside =
                |of: Vec<f64>| of.into_iter().zip(rates).map(|(speed, rate)| [speed, *rate]).collect();
            return Some(Turns { by: Channel::YawRate, pairs: beside(difference), sums: beside(sum) });
        }
        let (headings, t_s) = (column(Channel::Heading)?, recording.t_s.get(run.rows.clone())?);
        let [pairs, sums] = [difference, sum].map(|speeds| by_heading(t_s, &speeds, headings));
        Some(Turns { by: Channel::Heading, pairs, sums })
    }
}

/// What wheels and headings do from each moment to one a second later: over less, headings scatter more than they turn.
fn by_heading(t_s: &[f64], difference: &[f64], headings: &[f64]) -> Vec<[f64; 2]> {
    const STEP_S: f64 = 1.0;
    let (mut pairs, mut from) = (Vec::new(), 0);
    for to in 1..t_s.len() {
        let span_s = t_s[to] - t_s[from];
        if span_s < STEP_S {
            continue;
        }
        let turned = (headings[to] - headings[from] + PI).rem_euclid(TAU) - PI;
        let whole = span_s < 1.5 * STEP_S && turned.is_finite();
        let mean = difference[from..to].iter().sum::<f64>() / (to - from) as f64;
        if whole && mean.is_finite() {
            pairs.push([mean, turned / span_s]);
        }
        from = to;
    }
    pairs
}

/// Least share of the yaw rate's variance that turning wheels explain on firm ground.
const LEAST_R2: f64 = 0.5;

/// A side whose sign is mirrored: the sum of the speeds turns the robot, to the side of the other. It is so in all drives of a recording: where
/// wheels spin on snow and one of them takes hold, their sum tells how the robot turns as well.
pub(super) fn mirrored(recording: &Recording) -> Option<Suspicion> {
    let all: Vec<Turns> = recording.runs.iter().filter_map(|run| Turns::of(recording, run)).collect();
    let together = |of: fn(&Turns) -> &Vec<[f64; 2]>| {
        let moves = |turn: &Turns, i: usize| turns(turn.pairs[i][0]) || turns(turn.sums[i][0]);
        let rows = all.iter().flat_map(|turn| {
            of(turn).iter().enumerate().filter(|(i, _)| moves(turn, *i)).map(|(_, pair)| pair)
        });
        share_and_track(rows)
    };
    let [of_difference, _] = together(|turn| &turn.pairs)?;
    let [of_sum, track_m] = together(|turn| &turn.sums)?;
    // Of a side that stands nothing is explained, and its share is no number.
    if of_sum.is_nan() || of_sum < LEAST_R2 || of_difference > LEAST_R2 {
        return None;
    }
    let (channel, side) = match track_m > 0.0 {
        true => (Channel::LeftSpeed, "left"),
        false => (Channel::RightSpeed, "right"),
    };
    let statement = format!(
        "the sign of the {side} side seems mirrored: the sum of both wheel speeds explains {:.0} % of how the robot turns, and their \
         difference {:.0} %; give its source \"scale\": -1 in a map",
        100.0 * of_sum,
        100.0 * of_difference
    );
    Some(Suspicion { channel, run: None, kind: Kind::Opposed, statement })
}

/// Wheel speeds against yaw rate, or the change of heading: `ω = (v_right − v_left) / slip track`.
pub(super) fn turning(recording: &Recording, run: &Run) -> Option<Suspicion> {
    /// Slip tracks \[m\] between which a skid-steered robot of 5 kg to 5 t turns, from half a small robot's track to three
    /// times a large one's.
    const SLIP_TRACK_M: [f64; 2] = [0.1, 6.0];
    let Turns { by, pairs, .. } = Turns::of(recording, run)?;
    let [r2, slip_track_m] = share_and_track(pairs.iter().filter(|pair| turns(pair[0])))?;
    let (kind, statement) = if slip_track_m < 0.0 && r2 > LEAST_R2 {
        (Kind::Opposed, "it is opposed to the wheel speeds: left and right, or its sign, are swapped".into())
    } else if r2 < LEAST_R2 {
        // A compass beside motors wanders more than robots turn.
        if by == Channel::Heading {
            return None;
        }
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
    Some(Suspicion { channel: by, run: Some(run.name.clone()), kind, statement })
}

/// Whether a sum or difference of two rims is more than that of rims that stand, which only adds the sensor's noise.
fn turns(speed_mps: f64) -> bool {
    speed_mps.abs() > 2.0 * STANDS_MPS
}

/// The share of the variance of rates that speeds explain, and the track that they mean \[m\].
fn share_and_track<'a>(pairs: impl Iterator<Item = &'a [f64; 2]>) -> Option<[f64; 2]> {
    let (mut n, mut dd, mut dw, mut ww) = (0usize, 0.0, 0.0, 0.0);
    for [speed, rate] in pairs.filter(|[_, rate]| !rate.is_nan()) {
        n += 1;
        dd += speed * speed;
        dw += speed * rate;
        ww += rate * rate;
    }
    (n >= LEAST_ROWS && ww > 0.0).then(|| [dw * dw / (dd * ww), dd / dw])
}

/// Motor currents that are never negative although the wheels turn both ways.
pub(super) fn unsigned(recording: &Recording) -> Vec<Suspicion> {
    let pairs =
        [(Channel::LeftMotorCurrent, Channel::LeftSpeed), (Channel::RightMotorCurrent, Channel::RightSpeed)];
    let mut doubts = Vec::new();
    for (channel, wheel) in pairs {
        let (Some(current_a), Some(speed_mps)) = (recording.channel(channel), recording.channel(wheel))
        else {
            continue;
        };
        let backwards = speed_mps.iter().filter(|v| **v < -STANDS_MPS).count();
        let forwards = speed_mps.iter().filter(|v| **v > STANDS_MPS).count();
        if backwards >= LEAST_ROWS && forwards >= LEAST_ROWS && !current_a.iter().any(|i| *i < 0.0) {
            let statement =
                format!("it is never negative, although the wheels turn backwards in {backwards} rows");
            doubts.push(Suspicion { channel, run: None, kind: Kind::Unsigned, statement });
        }
    }
    doubts
}
