//! Rows in which the wheels turn against each other and the robot does not.

use std::{collections::BTreeMap, ops::Range};

use crate::{Drives, drives::Row, folds::BLOCK_S};

/// Width of the centred means \[s\], longer than the clock of an inertial unit drifts from the encoders' (about 1 s).
const MEAN_S: f64 = 2.0;
/// Difference of the rim speeds from which on a turn is meant \[m/s\]; the slowest spins of a Husky are at 0.12 m/s.
const LEAST_DIFFERENCE_MPS: f64 = 0.08;
/// Share of the turn meant that must be seen.
const LEAST_SHARE: f64 = 0.5;

/// Marks rows as stuck:
///
/// ```text
/// |⟨u_r − u_l⟩| > 0.08 m/s   and   sgn⟨u_r − u_l⟩ ⟨ω⟩ b < ½ |⟨u_r − u_l⟩|
/// ```
///
/// ⟨⟩ means over 2 s, ω measured yaw rate, b slip track. Only inputs are looked at, so the mark knows nothing of what it will
/// be judged by. Rows without a measured yaw rate are never marked. The thresholds were chosen on all runs of BorealTC;
/// shares of 0.3 to 0.7 and differences of 0.05 to 0.12 m/s give the same verdicts there.
pub(crate) fn flag(drives: &mut Drives, slip_track_m: f64) {
    for stretch in drives.stretches.clone() {
        let rows = &mut drives.rows[stretch.rows];
        let marks: Vec<bool> = windows(rows).into_iter().map(|w| is_stuck(&rows[w], slip_track_m)).collect();
        for (row, stuck) in rows.iter_mut().zip(marks) {
            row.stuck = stuck;
        }
    }
}

/// For each row, the rows around it over which it is averaged.
fn windows(rows: &[Row]) -> Vec<Range<usize>> {
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Vec::new() };
    let step_s = (last.t_s - first.t_s) / (rows.len() - 1).max(1) as f64;
    let half = if step_s > 0.0 { (MEAN_S / 2.0 / step_s) as usize } else { 0 };
    (0..rows.len()).map(|i| i.saturating_sub(half)..(i + half + 1).min(rows.len())).collect()
}

fn is_stuck(around: &[Row], slip_track_m: f64) -> bool {
    let measured = || around.iter().filter(|row| row.yaw_rate_radps.is_finite());
    let count = measured().count() as f64;
    let difference_mps = measured().map(Row::difference_mps).sum::<f64>() / count;
    let turned_mps = measured().map(|row| row.yaw_rate_radps).sum::<f64>() / count * slip_track_m;
    difference_mps.abs() > LEAST_DIFFERENCE_MPS
        && turned_mps * difference_mps.signum() < LEAST_SHARE * difference_mps.abs()
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
/// turn and are not stuck; `None` where the robot turned in fewer than [`LEAST_BLOCKS`] stretches with a measured yaw rate.
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
        for (row, window) in rows.iter().zip(windows(rows)) {
            let around = &rows[window];
            let mean = |f: fn(&Row) -> f64| around.iter().map(f).sum::<f64>() / around.len() as f64;
            let (difference_mps, yaw_rate_radps) = (mean(Row::difference_mps), mean(|row| row.yaw_rate_radps));
            if !row.stuck && yaw_rate_radps.is_finite() && difference_mps.abs() > LEAST_DIFFERENCE_MPS {
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
