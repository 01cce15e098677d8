//! What repeats with every turn of a side's wheels, as a bent rim or a stone in a tyre does: spectra of what the model leaves of the
//! power over the angle that the wheels have turned.

use std::f64::consts::TAU;

use calibration::Drives;
use model::{Robot, Sides};
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

/// Turns of a window, the first of which a drive has enough windows. Encoders that are read ten times a second lose the angle over some
/// hundred turns.
const WINDOW_TURNS: [f64; 3] = [40.0, 30.0, 20.0];
/// Rates per turn at which wheels may show, on both sides of one: those of wheels a twentieth off the file's radius.
const OWN: f64 = 0.05;
/// How far beside one rates tell what there is without the wheels' turns.
const BESIDE: [f64; 2] = [0.1, 0.35];
/// Chance of as clear a line where nothing turns, over both sides and all drives.
const LEVEL: f64 = 1e-6;
/// Windows that a line takes at least: as many visits as any evidence.
const LEAST_WINDOWS: usize = 6;
/// Windows on each side whose phases tell that of one between them.
const NEIGHBOURS: usize = 3;
/// How many times as strong it has to be as in healthy drives: wheels are never quite round.
const MORE: f64 = 2.0;
/// Speeds below tell nothing of a turn [m/s].
const LEAST_MPS: f64 = 0.05;

/// A line at one turn of the wheels of one side.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Line {
    /// 0 left, 1 right.
    pub(crate) side: usize,
    /// Half of what the force changes by within a turn [N].
    pub(crate) force_n: f64,
    /// Chance of as clear a one where nothing turns, over all that was tried.
    pub(crate) p_value: f64,
    /// By row: how near the wheels are to where they take most, 0 to 1.
    pub(crate) nearness: Vec<f64>,
}

/// A window of many turns.
struct Window {
    rows: std::ops::Range<usize>,
    /// Cosine and sine part at each rate that may be the wheels' [N].
    own_n: Vec<[f64; 2]>,
    /// Mean of the squared sizes beside them [N²].
    beside_n2: f64,
}

/// Rates per turn at which spectra are looked at.
struct Rates {
    window_turns: f64,
    own: Vec<f64>,
    beside: Vec<f64>,
}

impl Rates {
    /// Half of what windows of so many turns tell apart lies between them.
    fn of(window_turns: f64) -> Rates {
        let step = 0.5 / window_turns;
        let steps = |of: f64| (of / step).round() as i32;
        let at = |n: i32| 1.0 + step * f64::from(n);
        let own = (-steps(OWN)..=steps(OWN)).map(at).collect();
        let beside = (steps(BESIDE[0])..=steps(BESIDE[1])).flat_map(|n| [at(-n), at(n)]).collect();
        Rates { window_turns, own, beside }
    }
}

fn squared([cos, sin]: [f64; 2]) -> f64 {
    cos * cos + sin * sin
}

/// Drives with what the model leaves of their power, by channel and row [W].
pub(crate) struct Left<'a> {
    pub(crate) drives: &'a Drives,
    pub(crate) errors_w: &'a [Vec<f64>],
}

/// The clearest line of the drives under suspicion that healthy ones do not have.
pub(crate) fn line(robot: &Robot, suspect: &Left<'_>, healthy: Option<&Left<'_>>) -> Option<Line> {
    let lines = [0, 1].into_iter().filter_map(|side| {
        let line = of_side(robot, suspect, side)?;
        let usual_n = healthy.and_then(|left| of_side(robot, left, side)).map_or(0.0, |line| line.force_n);
        (line.p_value < LEVEL && line.force_n > MORE * usual_n).then_some(line)
    });
    lines.min_by(|a, b| a.p_value.total_cmp(&b.p_value))
}

/// The line of one side, however faint; `None` where its wheels hardly turned.
fn of_side(robot: &Robot, Left { drives, errors_w }: &Left<'_>, side: usize) -> Option<Line> {
    let errors_w = errors_w.get(if errors_w.len() > 1 { side } else { 0 })?;
    let runs = used_rows(drives, errors_w);
    let angle_rad = angles_rad(drives, robot.wheel_radius_m, side, &runs);
    let all = |rates: &Rates| -> Vec<Window> {
        runs.iter().flat_map(|run| windows(drives, run, (side, rates), &angle_rad, errors_w)).collect()
    };
    let windows = WINDOW_TURNS.map(Rates::of).into_iter().map(|rates| (all(&rates), rates));
    let (windows, rates) = windows.into_iter().find(|(windows, _)| windows.len() >= LEAST_WINDOWS)?;
    // Either side could have shown one.
    let tried = (2 * rates.own.len()) as f64;
    let chances = (0..rates.own.len()).map(|own| chance(&windows, own, &rates) * tried);
    let (own, p_value) = chances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let beyond_n2 = |window: &Window| squared(window.own_n[own]) - window.beside_n2;
    let mean_n2 = windows.iter().map(beyond_n2).sum::<f64>() / windows.len() as f64;
    Some(Line {
        side,
        force_n: mean_n2.max(0.0).sqrt(),
        p_value: p_value.min(1.0),
        nearness: nearness(&windows, (own, rates.own[own]), &angle_rad),
    })
}

/// Rows that count, run by run.
fn used_rows(drives: &Drives, errors_w: &[f64]) -> Vec<Vec<usize>> {
    let mut runs = vec![Vec::new(); drives.runs.len()];
    for stretch in &drives.stretches {
        let is_used = |i: &usize| drives.rows[*i].used && errors_w[*i].is_finite();
        runs[stretch.run].extend(stretch.rows.clone().filter(is_used));
    }
    runs
}

/// How far the wheels of a side have turned since the run began, by row; over rows that are lost as about them [rad].
fn angles_rad(drives: &Drives, radius_m: f64, side: usize, runs: &[Vec<usize>]) -> Vec<f64> {
    let mut angle_rad = vec![0.0; drives.rows.len()];
    for run in runs {
        let mut turned_rad = 0.0;
        for pair in run.windows(2) {
            let [a, b] = [&drives.rows[pair[0]], &drives.rows[pair[1]]];
            let mean_mps = (of(side, a.rim_mps) + of(side, b.rim_mps)) / 2.0;
            turned_rad += mean_mps * (b.t_s - a.t_s) / radius_m;
            angle_rad[pair[1]] = turned_rad;
        }
    }
    angle_rad
}

fn of(side: usize, sides: Sides<f64>) -> f64 {
    if side == 0 { sides.left } else { sides.right }
}

/// The spectra of a run, window by window.
fn windows(
    drives: &Drives,
    run: &[usize],
    (side, rates): (usize, &Rates),
    angle_rad: &[f64],
    errors_w: &[f64],
) -> Vec<Window> {
    let mut windows = Vec::new();
    let (mut start, mut gone_rad) = (0, 0.0);
    for n in 1..run.len() {
        gone_rad += (angle_rad[run[n]] - angle_rad[run[n - 1]]).abs();
        if gone_rad >= rates.window_turns * TAU {
            windows.extend(window(drives, &run[start..n], (side, rates), angle_rad, errors_w));
            (start, gone_rad) = (n, 0.0);
        }
    }
    windows
}

/// The spectrum of one window: of the errors less their mean over the turn about each row, as a force at the rim.
fn window(
    drives: &Drives,
    rows: &[usize],
    (side, rates): (usize, &Rates),
    angle_rad: &[f64],
    errors_w: &[f64],
) -> Option<Window> {
    let moves = |i: &usize| of(side, drives.rows[*i].rim_mps).abs() > LEAST_MPS;
    let moving: Vec<usize> = rows.iter().copied().filter(moves).collect();
    let speeds_mps: Vec<f64> = moving.iter().map(|i| of(side, drives.rows[*i].rim_mps).abs()).collect();
    let left_w = less_mean_of_turn(&moving, angle_rad, errors_w);
    let at = |rate: f64| -> Option<[f64; 2]> {
        let (mut cos, mut sin, mut weight) = (0.0, 0.0, 0.0);
        for ((i, u), w) in moving.iter().zip(&speeds_mps).zip(&left_w) {
            let (s, c) = (rate * angle_rad[*i]).sin_cos();
            (cos, sin, weight) = (cos + u * c * w, sin + u * s * w, weight + u * u);
        }
        (weight > 0.0).then(|| [2.0 * cos / weight, 2.0 * sin / weight])
    };
    let own_n: Vec<[f64; 2]> = rates.own.iter().copied().map(at).collect::<Option<_>>()?;
    let beside: Vec<f64> = rates.beside.iter().map(|rate| at(*rate).map(squared)).collect::<Option<_>>()?;
    let beside_n2 = beside.iter().sum::<f64>() / beside.len() as f64;
    Some(Window { rows: *rows.first()?..*rows.last()? + 1, own_n, beside_n2 })
}

/// Errors less their mean over the rows within half a turn.
fn less_mean_of_turn(used: &[usize], angle_rad: &[f64], errors_w: &[f64]) -> Vec<f64> {
    // Turned without regard to direction, so that what is near comes one after the other.
    let mut gone_rad = Vec::with_capacity(used.len());
    let mut sums = vec![0.0];
    for (n, &i) in used.iter().enumerate() {
        let last = gone_rad.last().copied().unwrap_or(0.0);
        let step = if n > 0 { (angle_rad[i] - angle_rad[used[n - 1]]).abs() } else { 0.0 };
        gone_rad.push(last + step);
        sums.push(sums[n] + errors_w[i]);
    }
    let mean = |n: usize| {
        let from = gone_rad.partition_point(|g| *g < gone_rad[n] - TAU / 2.0);
        let to = gone_rad.partition_point(|g| *g <= gone_rad[n] + TAU / 2.0);
        (sums[to] - sums[from]) / (to - from) as f64
    };
    (0..used.len()).map(|n| errors_w[used[n]] - mean(n)).collect()
}

/// Chance of as much at a rate where it is as everywhere beside it, by Fisher's way of taking windows together
/// (Statistical Methods for Research Workers, 1925, §21.1).
fn chance(windows: &[Window], own: usize, rates: &Rates) -> f64 {
    let Ok(ratio) = FisherSnedecor::new(2.0, 2.0 * rates.beside.len() as f64) else { return 1.0 };
    let log = |window: &Window| {
        let times = squared(window.own_n[own]) / window.beside_n2.max(1e-300);
        -2.0 * ratio.sf(times).max(1e-300).ln()
    };
    let all = windows.iter().map(log).sum::<f64>();
    ChiSquared::new(2.0 * windows.len() as f64).map_or(1.0, |sum| sum.sf(all))
}

/// By row, how near the wheels are to where they take most; the phase of a window is that of its neighbours, so that its own noise
/// does not make it.
fn nearness(windows: &[Window], (own, rate): (usize, f64), angle_rad: &[f64]) -> Vec<f64> {
    let mut nearness = vec![0.5; angle_rad.len()];
    for (n, window) in windows.iter().enumerate() {
        let near = n.saturating_sub(NEIGHBOURS)..(n + NEIGHBOURS + 1).min(windows.len());
        let others = near.filter(|other| *other != n).map(|other| windows[other].own_n[own]);
        let [cos, sin] = others.fold([0.0; 2], |[c, s], [cos, sin]| [c + cos, s + sin]);
        let phase_rad = sin.atan2(cos);
        for i in window.rows.clone() {
            nearness[i] = 0.5 + 0.5 * (rate * angle_rad[i] - phase_rad).cos();
        }
    }
    nearness
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shorter_windows_look_at_the_same_rates_less_closely() {
        for turns in WINDOW_TURNS {
            let Rates { own, beside, .. } = Rates::of(turns);
            let [first, last] = [own[0], own[own.len() - 1]];
            assert!((first - 0.95).abs() < 0.01 && (last - 1.05).abs() < 0.01, "{own:?}");
            assert!(own.contains(&1.0) && beside.iter().all(|rate| (rate - 1.0).abs() > last - 1.0));
            assert!((own[1] - own[0] - 0.5 / turns).abs() < 1e-12);
        }
        assert_eq!((Rates::of(40.0).own.len(), Rates::of(40.0).beside.len()), (9, 42));
    }
}
