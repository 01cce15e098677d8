//! Rows in which the wheels turn against each other and the robot does not.

use std::collections::BTreeMap;

use model::Robot;

use crate::{Drives, drives::Row, folds::BLOCK_S};

/// Width of the centred means \[s\], longer than the clock of an inertial unit drifts from the encoders' (about 1 s).
const MEAN_S: f64 = 2.0;
/// Difference of the rim speeds from which on a turn is meant \[m/s\]; the slowest spins of a Husky are at 0.12 m/s.
const LEAST_DIFFERENCE_MPS: f64 = 0.08;
/// Share of the turn meant that must be seen.
const LEAST_SHARE: f64 = 0.5;

/// Marks stuck rows. A slip track of the robot file's own is believed; where the file has the plain track, that which the drives
/// themselves show is used, since on most ground the two differ by half.
///
/// Marks and measured track depend on each other; a few rounds settle both.
pub(crate) fn flag(drives: &mut Drives, robot: &Robot) {
    const ROUNDS: usize = 4;
    flag_by(drives, robot.slip_track_m);
    if robot.slip_track_m != robot.track_m {
        return;
    }
    for _ in 0..ROUNDS {
        let Some(track) = slip_track(drives) else { return };
        flag_by(drives, track.value_m.clamp(robot.track_m, 2.0 * robot.track_m));
    }
}

/// Marks rows as stuck:
///
/// ```text
/// |⟨u_r − u_l⟩| > 0.08 m/s   and   sgn⟨u_r − u_l⟩ ⟨ω⟩ b < ½ |⟨u_r − u_l⟩|
/// ```
///
/// ⟨⟩ means over 2 s, ω measured yaw rate, b slip track. Only inputs are looked at, so the mark knows nothing of what it will
/// be judged by. Rows without a measured yaw rate are never marked. The thresholds were chosen on all runs of BorealTC;
/// shares of 0.3 to 0.7 and differences of 0.05 to 0.12 m/s give the same verdicts there.
fn flag_by(drives: &mut Drives, slip_track_m: f64) {
    for stretch in &drives.stretches {
        let rows = &mut drives.rows[stretch.rows.clone()];
        let turns = mean_turns(rows);
        for (row, turn) in rows.iter_mut().zip(turns) {
            let meant_mps = turn.difference_mps.abs();
            let seen_mps = turn.yaw_rate_radps * slip_track_m * turn.difference_mps.signum();
            row.stuck = meant_mps > LEAST_DIFFERENCE_MPS && seen_mps < LEAST_SHARE * meant_mps;
        }
    }
}

/// Means over the rows around one that have a measured yaw rate; NaN where none has.
struct MeanTurn {
    difference_mps: f64,
    yaw_rate_radps: f64,
}

/// The mean turn around each row, by running sums; nothing where no yaw rate was measured.
fn mean_turns(rows: &[Row]) -> Vec<MeanTurn> {
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Vec::new() };
    if !rows.iter().any(|row| row.yaw_rate_radps.is_finite()) {
        return Vec::new();
    }
    let step_s = (last.t_s - first.t_s) / (rows.len() - 1).max(1) as f64;
    let half = if step_s > 0.0 { (MEAN_S / 2.0 / step_s) as usize } else { 0 };
    let mut sums = vec![[0.0; 3]];
    let mut sum = [0.0; 3];
    for row in rows {
        if row.yaw_rate_radps.is_finite() {
            sum = [sum[0] + 1.0, sum[1] + row.difference_mps(), sum[2] + row.yaw_rate_radps];
        }
        sums.push(sum);
    }
    let mean = |i: usize| {
        let (from, to) = (sums[i.saturating_sub(half)], sums[(i + half + 1).min(rows.len())]);
        let count = to[0] - from[0];
        MeanTurn { difference_mps: (to[1] - from[1]) / count, yaw_rate_radps: (to[2] - from[2]) / count }
    };
    (0..rows.len()).map(mean).collect()
}

/// A kinematic track that was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipTrack {
    /// b: `yaw_rate = (v_right − v_left) / b` \[m\].
    pub value_m: f64,
    /// One-sigma uncertainty \[m\].
    pub sigma_m: f64,
}

/// The slip track at which wheels and gyroscope agree, root mean square over 2 s against root mean square, over the rows that
/// turn and are not stuck; `None` where the robot turned in fewer than four stretches with a measured yaw rate.
///
/// ```text
/// b² = Σ⟨u_r − u_l⟩² / Σ⟨ω⟩²
/// ```
///
/// The ratio of the two spreads does not mind a delay between the clocks, as a regression would. Its uncertainty is that between
/// pieces of 15 s.
pub fn slip_track(drives: &Drives) -> Option<SlipTrack> {
    let mut blocks: BTreeMap<(usize, i64), (f64, f64)> = BTreeMap::new();
    for stretch in &drives.stretches {
        let rows = &drives.rows[stretch.rows.clone()];
        for (row, turn) in rows.iter().zip(mean_turns(rows)) {
            let MeanTurn { difference_mps, yaw_rate_radps } = turn;
            if !row.stuck && difference_mps.abs() > LEAST_DIFFERENCE_MPS {
                let sums = blocks.entry((stretch.run, (row.t_s / BLOCK_S).floor() as i64)).or_default();
                sums.0 += difference_mps * difference_mps;
                sums.1 += yaw_rate_radps * yaw_rate_radps;
            }
        }
    }
    let total = blocks.values().fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    if blocks.len() < LEAST_BLOCKS || total.1 == 0.0 {
        return None;
    }
    let square_m2 = total.0 / total.1;
    let scatter: f64 = blocks.values().map(|b| (b.0 - square_m2 * b.1).powi(2)).sum();
    let value_m = square_m2.sqrt();
    Some(SlipTrack { value_m, sigma_m: scatter.sqrt() / total.1 / (2.0 * value_m) })
}

/// Fewer pieces of a drive say nothing of how far they scatter.
const LEAST_BLOCKS: usize = 4;
