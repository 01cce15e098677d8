//! Rows in which the wheels turn against each other and the robot does not.

use std::collections::BTreeMap;

use model::Robot;
use rayon::prelude::*;

use crate::{Drives, drives::Stretch, folds::BLOCK_S, row::Row};

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
    let turns = turns(drives);
    let mut track_m = robot.slip_track_m;
    if robot.slip_track_m == robot.track_m {
        for _ in 0..ROUNDS {
            let Some(found) = track_of(turns.iter().filter(|turn| !turn.is_stuck(track_m))) else { break };
            track_m = found.value_m.clamp(robot.track_m, 2.0 * robot.track_m);
        }
    }
    for turn in turns.iter().filter(|turn| turn.is_stuck(track_m)) {
        drives.rows[turn.row].stuck = true;
    }
}

/// A row around which a turn is meant: |⟨u_r − u_l⟩| > 0.08 m/s, ⟨⟩ means over 2 s.
struct Turn {
    row: usize,
    /// The run and which 15 s of it.
    block: (usize, i64),
    difference_mps: f64,
    yaw_rate_radps: f64,
}

impl Turn {
    /// Whether the row is stuck:
    ///
    /// ```text
    /// sgn⟨u_r − u_l⟩ ⟨ω⟩ b < ½ |⟨u_r − u_l⟩|
    /// ```
    ///
    /// ω measured yaw rate, b slip track. Only inputs are looked at, so the mark knows nothing of what it will be judged by.
    /// Rows without a measured yaw rate are never marked. The thresholds were chosen on all runs of BorealTC; shares of 0.3
    /// to 0.7 and differences of 0.05 to 0.12 m/s give the same verdicts there.
    fn is_stuck(&self, slip_track_m: f64) -> bool {
        let seen_mps = self.yaw_rate_radps * slip_track_m * self.difference_mps.signum();
        seen_mps < LEAST_SHARE * self.difference_mps.abs()
    }
}

/// The turns of all stretches, in order of rows.
fn turns(drives: &Drives) -> Vec<Turn> {
    let of_stretch = |stretch: &Stretch| {
        let (run, start) = (stretch.run, stretch.rows.start);
        let rows = &drives.rows[stretch.rows.clone()];
        let meant = mean_turns(rows).into_iter().enumerate().filter(|(_, turn)| turn.is_meant());
        meant.map(move |(i, MeanTurn { difference_mps, yaw_rate_radps })| Turn {
            row: start + i,
            block: (run, (rows[i].t_s / BLOCK_S).floor() as i64),
            difference_mps,
            yaw_rate_radps,
        })
    };
    drives.stretches.par_iter().flat_map_iter(of_stretch).collect()
}

/// Means over the rows around one that have a measured yaw rate; NaN where none has.
struct MeanTurn {
    difference_mps: f64,
    yaw_rate_radps: f64,
}

impl MeanTurn {
    fn is_meant(&self) -> bool {
        self.difference_mps.abs() > LEAST_DIFFERENCE_MPS
    }
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
    track_of(turns(drives).iter().filter(|turn| !drives.rows[turn.row].stuck))
}

fn track_of<'a>(turns: impl Iterator<Item = &'a Turn>) -> Option<SlipTrack> {
    let mut blocks: BTreeMap<(usize, i64), (f64, f64)> = BTreeMap::new();
    let mut turns = turns.peekable();
    while let Some(block) = turns.peek().map(|turn| turn.block) {
        let sums = blocks.entry(block).or_default();
        while let Some(turn) = turns.next_if(|turn| turn.block == block) {
            sums.0 += turn.difference_mps * turn.difference_mps;
            sums.1 += turn.yaw_rate_radps * turn.yaw_rate_radps;
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
