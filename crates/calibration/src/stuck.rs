//! Rows in which the wheels turn against each other and the robot does not.

use std::collections::BTreeMap;

use model::Robot;
use rayon::prelude::*;

use crate::{Drives, Error, drives::Stretch, folds::BLOCK_S, row::Row};

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
///
/// # Errors
/// [`Error::Stopped`] when the drives' watch breaks.
pub(crate) fn flag(drives: &mut Drives, robot: &Robot) -> Result<(), Error> {
    const ROUNDS: usize = 4;
    let pieces = turns(drives)?;
    let mut track_m = robot.slip_track_m;
    if robot.slip_track_m == robot.track_m {
        for _ in 0..ROUNDS {
            drives.go_on()?;
            let Some(found) = track_of(&pieces, |turn| !turn.is_stuck(track_m)) else { break };
            track_m = found.value_m.clamp(robot.track_m, 2.0 * robot.track_m);
        }
    }
    for turn in pieces.iter().flat_map(|piece| &piece.turns).filter(|turn| turn.is_stuck(track_m)) {
        drives.rows[turn.row].stuck = true;
    }
    Ok(())
}

/// A row around which a turn is meant: |⟨u_r − u_l⟩| > 0.08 m/s, ⟨⟩ means over 2 s.
struct Turn {
    row: usize,
    difference_mps: f64,
    yaw_rate_radps: f64,
}

/// The turns of some 15 s of a stretch.
struct Piece {
    /// The run and which 15 s of it.
    block: (usize, i64),
    turns: Vec<Turn>,
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
fn turns(drives: &Drives) -> Result<Vec<Piece>, Error> {
    let of_stretch = |stretch: &Stretch| {
        drives.go_on()?;
        let (run, start) = (stretch.run, stretch.rows.start);
        let rows = &drives.rows[stretch.rows.clone()];
        let sums = sums_of_turns(rows);
        let half = rows_in(rows, MEAN_S / 2.0);
        let block_of = |row: &Row| (row.t_s / BLOCK_S).floor() as i64;
        let mut first = 0;
        let of_block = |block: &[Row]| {
            drives.go_on()?;
            let here = first..first + block.len();
            first = here.end;
            let turns = here.filter_map(|i| mean_turn(&sums, i, half, start + i)).collect();
            Ok(Piece { block: (run, block_of(&block[0])), turns })
        };
        let blocks = if sums.is_empty() { &[] } else { rows };
        blocks
            .chunk_by(|a, b| block_of(a) == block_of(b))
            .map(of_block)
            .collect::<Result<Vec<Piece>, Error>>()
    };
    let of_stretches = drives.stretches.par_iter().map(of_stretch).collect::<Result<Vec<_>, Error>>()?;
    Ok(of_stretches.into_iter().flatten().collect())
}

/// Rows that a time is long.
fn rows_in(rows: &[Row], time_s: f64) -> usize {
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return 0 };
    let step_s = (last.t_s - first.t_s) / (rows.len() - 1).max(1) as f64;
    if step_s > 0.0 { (time_s / step_s) as usize } else { 0 }
}

/// Sums of count, difference and yaw rate over the rows before each that have a measured yaw rate; empty where none has.
fn sums_of_turns(rows: &[Row]) -> Vec<[f64; 3]> {
    if !rows.iter().any(|row| row.yaw_rate_radps.is_finite()) {
        return Vec::new();
    }
    let mut sum = [0.0; 3];
    let mut sums = Vec::with_capacity(rows.len() + 1);
    sums.push(sum);
    for row in rows {
        if row.yaw_rate_radps.is_finite() {
            sum = [sum[0] + 1.0, sum[1] + row.difference_mps(), sum[2] + row.yaw_rate_radps];
        }
        sums.push(sum);
    }
    sums
}

/// The mean turn around a row, if one is meant.
fn mean_turn(sums: &[[f64; 3]], i: usize, half: usize, row: usize) -> Option<Turn> {
    let (from, to) = (sums[i.saturating_sub(half)], sums[(i + half + 1).min(sums.len() - 1)]);
    let count = to[0] - from[0];
    let (difference_mps, yaw_rate_radps) = ((to[1] - from[1]) / count, (to[2] - from[2]) / count);
    (difference_mps.abs() > LEAST_DIFFERENCE_MPS).then_some(Turn { row, difference_mps, yaw_rate_radps })
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
///
/// # Errors
/// [`Error::Stopped`] when the drives' watch breaks.
pub fn slip_track(drives: &Drives) -> Result<Option<SlipTrack>, Error> {
    Ok(track_of(&turns(drives)?, |turn| !drives.rows[turn.row].stuck))
}

fn track_of(pieces: &[Piece], counts: impl Fn(&Turn) -> bool + Sync) -> Option<SlipTrack> {
    let of_piece = |piece: &Piece| {
        piece.turns.iter().filter(|turn| counts(turn)).fold(None, |sums, turn| {
            let (differences, rates) = sums.unwrap_or((0.0, 0.0));
            let (difference_mps, radps) = (turn.difference_mps, turn.yaw_rate_radps);
            Some((differences + difference_mps * difference_mps, rates + radps * radps))
        })
    };
    let of_pieces: Vec<Option<(f64, f64)>> = pieces.par_iter().map(of_piece).collect();
    let mut blocks: BTreeMap<(usize, i64), (f64, f64)> = BTreeMap::new();
    for (piece, sums) in pieces.iter().zip(of_pieces) {
        if let Some((differences, rates)) = sums {
            let block = blocks.entry(piece.block).or_default();
            *block = (block.0 + differences, block.1 + rates);
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
