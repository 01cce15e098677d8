//! Channels that contradict how a robot moves.

use super::LEAST_ROWS;
use crate::{
    Channel, Recording, Run,
    report::{Suspicion, SuspicionKind as Kind},
};

/// A wheel whose rim is slower than this stands still \[m/s\]: twice the step of the Husky's encoder speeds (0.0079 m/s).
const STANDSTILL_MPS: f64 = 0.016;

/// Rows whose sign is opposed to both neighbours of the same magnitude, which no body with inertia does.
pub(super) fn lone_flips(values: &[f64]) -> Option<String> {
    /// How nearly equal the magnitudes are.
    const LIKENESS: f64 = 0.2;
    let like = |a: f64, b: f64| (a + b).abs() < LIKENESS * b.abs() && a.abs() > 5.0 * STANDSTILL_MPS;
    let flips = values.windows(3).filter(|w| like(w[0], w[1]) && like(w[2], w[1])).count();
    (flips > 0).then(|| format!("its sign flips for {flips} single rows"))
}

/// Wheel speeds against yaw rate: `ω = (v_right − v_left) / slip track`.
pub(super) fn turning(recording: &Recording, run: &Run) -> Option<Suspicion> {
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
        (Kind::Opposed, "it is opposed to the wheel speeds: left and right, or its sign, are swapped".into())
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
pub(super) fn unsigned(recording: &Recording) -> Vec<Suspicion> {
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
