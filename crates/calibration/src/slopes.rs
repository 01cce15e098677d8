//! Slopes along the way by heights, where no inclinometer was recorded.
//!
//! About every row a plane is laid through the heights of the way before and behind it, in the frame of the robot there; its slope ahead is
//! the pitch. The way is dead reckoning, which over some metres is as good as any position.

use model::Robot;
use recording::{Channel, Recording};

use crate::{Error, row::Row, watch::Watched};

/// Half lengths of the way that a plane may be laid through, the shortest first [m].
const REACHES_M: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
/// One sigma of slopes by which a reach is long enough [rad]: of a weight it is a fortieth of what rolling takes.
const ENOUGH_RAD: f64 = 0.0012;
/// One sigma of the slopes of ground that wheels can drive on [rad]; where the way tells none, the ground is level.
const USUAL_RAD: f64 = 0.15;
/// Longest part of a drive that a plane is laid through, before and behind [s].
const MOST_S: f64 = 60.0;
/// Time over which errors of positions are alike [s]: satellites tell one a second.
const ALIKE_S: f64 = 1.0;
/// Planes that are laid between two looks at the watch, each through up to some thousand heights.
const PLANES_A_LOOK: usize = 256;
/// Heights that a stretch has to have.
const LEAST_HEIGHTS: usize = 20;
/// Median of |z1 - 2 z2 + z3| of heights with white noise of one sigma: 0.6745 √6.
const SECOND_DIFFERENCE: f64 = 1.652;

/// What has to be said of drives without a pitch.
pub fn slopes_note(recording: &Recording) -> Option<&'static str> {
    let is_recorded = |channel: Channel| recording.channel(channel).is_some();
    match (is_recorded(Channel::Pitch), is_recorded(Channel::Z)) {
        (true, _) => None,
        (false, true) => {
            Some("no pitch was recorded: slopes along the way are those of the heights that were")
        }
        (false, false) => Some("neither pitch nor heights were recorded: the ground was taken for level"),
    }
}

/// Fills in the pitch of a stretch by its heights, row by row.
///
/// # Errors
/// [`Error::Stopped`] when the watch breaks.
pub(crate) fn fill(robot: &Robot, rows: &mut [Row], heights_m: &[f64], watch: &Watched) -> Result<(), Error> {
    if heights_m.iter().filter(|z_m| z_m.is_finite()).count() < LEAST_HEIGHTS {
        return Ok(());
    }
    watch.go_on()?;
    let way = way(robot, rows);
    watch.go_on()?;
    let noise = Noise::of(rows, heights_m);
    let reach_m = noise.reach_m(&way);
    let pitch_rad = watch.map(rows.len(), PLANES_A_LOOK, |i| {
        slope(&way, rows, heights_m, i, (reach_m, noise.sigma_m)).atan()
    })?;
    rows.iter_mut().zip(pitch_rad).for_each(|(row, pitch_rad)| row.pitch_rad = pitch_rad);
    Ok(())
}

/// Where a robot was, and how it was turned, since a stretch began.
#[derive(Clone, Copy)]
struct Pose {
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
    driven_m: f64,
}

/// The way by wheels and gyroscope.
fn way(robot: &Robot, rows: &[Row]) -> Vec<Pose> {
    let mut pose = Pose { x_m: 0.0, y_m: 0.0, heading_rad: 0.0, driven_m: 0.0 };
    let step = |row: &Row| {
        let motion = row.motion(robot);
        let yaw_rate_radps =
            if row.yaw_rate_radps.is_finite() { row.yaw_rate_radps } else { motion.yaw_rate_radps };
        let step_m = motion.speed_mps * row.step_s;
        let middle_rad = pose.heading_rad + 0.5 * yaw_rate_radps * row.step_s;
        pose.x_m += step_m * middle_rad.cos();
        pose.y_m += step_m * middle_rad.sin();
        pose.heading_rad += yaw_rate_radps * row.step_s;
        pose.driven_m += step_m.abs();
        pose
    };
    rows.iter().map(step).collect()
}

/// How heights scatter about the ground.
struct Noise {
    /// One sigma of a height, or of those of a second where they are alike for so long [m].
    sigma_m: f64,
    /// Heights a second that tell something of their own [1/s].
    per_s: f64,
}

impl Noise {
    fn of(rows: &[Row], heights_m: &[f64]) -> Self {
        let span_s = rows.last().map_or(0.0, |row| row.t_s) - rows.first().map_or(0.0, |row| row.t_s);
        let per_s = (rows.len() - 1) as f64 / span_s.max(1e-9);
        let second = ((ALIKE_S * per_s).round() as usize).max(1);
        let [next_m, later_m] = [1, second].map(|lag| scatter_m(heights_m, lag));
        // What is white scatters from row to row as it does from second to second.
        if next_m > 0.5 * later_m {
            Noise { sigma_m: next_m, per_s }
        } else {
            Noise { sigma_m: later_m, per_s: per_s.min(1.0 / ALIKE_S) }
        }
    }

    /// Half the way by which slopes are told well enough.
    fn reach_m(&self, way: &[Pose]) -> f64 {
        let moved_m = way.last().map_or(0.0, |pose| pose.driven_m);
        let speed_mps = moved_m * self.per_s / (way.len() as f64).max(1.0);
        let is_enough = |reach_m: &&f64| {
            let heights = 2.0 * **reach_m * self.per_s / speed_mps.max(1e-3);
            // One sigma of the slope of a line through heights that lie evenly between both ends.
            self.sigma_m * 3.0_f64.sqrt() / (**reach_m * heights.sqrt()) <= ENOUGH_RAD
        };
        *REACHES_M.iter().find(is_enough).unwrap_or(&REACHES_M[REACHES_M.len() - 1])
    }
}

/// One sigma of white noise that second differences some rows apart would come of [m].
fn scatter_m(heights_m: &[f64], lag: usize) -> f64 {
    let bent = |w: &[f64]| (w[0] - 2.0 * w[lag] + w[2 * lag]).abs();
    let mut bent: Vec<f64> = heights_m.windows(2 * lag + 1).map(bent).filter(|m| m.is_finite()).collect();
    if bent.is_empty() {
        return 0.0;
    }
    let middle = bent.len() / 2;
    *bent.select_nth_unstable_by(middle, f64::total_cmp).1 / SECOND_DIFFERENCE
}

/// Rise per metre ahead of the robot in a row.
fn slope(way: &[Pose], rows: &[Row], heights_m: &[f64], i: usize, (reach_m, sigma_m): (f64, f64)) -> f64 {
    let here = way[i];
    let (sin, cos) = here.heading_rad.sin_cos();
    let near = |j: &usize| {
        (way[*j].driven_m - here.driven_m).abs() <= reach_m && (rows[*j].t_s - rows[i].t_s).abs() <= MOST_S
    };
    let around = (0..=i).rev().take_while(near).chain((i + 1..rows.len()).take_while(near));
    let least_m = sigma_m.max(1e-3);
    // Normal equations of a plane, symmetric: with 1, ahead and to the left.
    let mut square = nalgebra::Matrix3::zeros();
    let mut right = nalgebra::Vector3::zeros();
    for j in around.filter(|j| heights_m[*j].is_finite()) {
        let [x_m, y_m] = [way[j].x_m - here.x_m, way[j].y_m - here.y_m];
        let column = nalgebra::Vector3::new(1.0, cos * x_m + sin * y_m, cos * y_m - sin * x_m);
        let share = (way[j].driven_m - here.driven_m).abs() / reach_m;
        // The tricube weight of local regression (Cleveland 1979).
        let weight = (1.0 - share.powi(3)).powi(3) / least_m.powi(2);
        square += weight * column * column.transpose();
        right += weight * heights_m[j] * column;
    }
    square[(1, 1)] += USUAL_RAD.powi(-2);
    square[(2, 2)] += USUAL_RAD.powi(-2);
    square.cholesky().map_or(0.0, |factor| factor.solve(&right)[1])
}

#[cfg(test)]
mod tests {
    use model::{Sides, builtin};

    use super::*;

    /// A drive of 200 s at 0.5 m/s, ahead or back, turning a little, over a hill of a wave of 20 m, with heights of so much noise, and its pitch.
    fn drive(speed_mps: f64, noise_m: f64) -> (Vec<Row>, Vec<f64>, Vec<f64>) {
        let robot = builtin::husky_a200();
        let row = |i: usize| Row {
            t_s: 0.1 * i as f64,
            step_s: if i > 0 { 0.1 } else { 0.0 },
            rim_mps: Sides::both(speed_mps),
            yaw_rate_radps: 0.02,
            ..Row::default()
        };
        let rows: Vec<Row> = (0..2000).map(row).collect();
        let wave = std::f64::consts::TAU / 20.0;
        let way = way(&robot, &rows);
        let noise = |i: usize| noise_m * ((i * 7919 % 1000) as f64 / 1000.0 - 0.5) * 12.0_f64.sqrt();
        let height = |(i, pose): (usize, &Pose)| 0.3 * (wave * pose.x_m).sin() + noise(i);
        let heights_m = way.iter().enumerate().map(height).collect();
        let pitch = |pose: &Pose| (0.3 * wave * (wave * pose.x_m).cos() * pose.heading_rad.cos()).atan();
        (rows, heights_m, way.iter().map(pitch).collect())
    }

    fn off_rad(rows: &[Row], pitch_rad: &[f64]) -> f64 {
        let squares: f64 = rows.iter().zip(pitch_rad).map(|(row, p)| (row.pitch_rad - p).powi(2)).sum();
        (squares / rows.len() as f64).sqrt()
    }

    #[test]
    fn heights_tell_the_pitch_ahead_and_back_and_with_noise() {
        for (speed_mps, noise_m, most_rad) in [(0.5, 0.0, 0.003), (-0.5, 0.0, 0.003), (0.5, 0.02, 0.008)] {
            let (mut rows, heights_m, pitch_rad) = drive(speed_mps, noise_m);
            let level_rad = off_rad(&rows, &pitch_rad);
            fill(&builtin::husky_a200(), &mut rows, &heights_m, &Watched::default()).unwrap();
            let off = off_rad(&rows, &pitch_rad);
            assert!(off < most_rad && level_rad > 0.04, "{speed_mps} {noise_m}: {off} of {level_rad}");
        }
    }

    #[test]
    fn heights_once_a_second_or_with_gaps_tell_it_as_well_and_none_tell_nothing() {
        let (mut rows, heights_m, pitch_rad) = drive(0.5, 0.01);
        let held: Vec<f64> = (0..heights_m.len()).map(|i| heights_m[i / 10 * 10]).collect();
        fill(&builtin::husky_a200(), &mut rows, &held, &Watched::default()).unwrap();
        assert!(off_rad(&rows, &pitch_rad) < 0.02, "{}", off_rad(&rows, &pitch_rad));
        let gaps: Vec<f64> =
            (0..heights_m.len()).map(|i| if i % 10 == 0 { heights_m[i] } else { f64::NAN }).collect();
        let (mut rows, ..) = drive(0.5, 0.01);
        fill(&builtin::husky_a200(), &mut rows, &gaps, &Watched::default()).unwrap();
        assert!(off_rad(&rows, &pitch_rad) < 0.02, "{}", off_rad(&rows, &pitch_rad));
        let (mut rows, ..) = drive(0.5, 0.01);
        fill(&builtin::husky_a200(), &mut rows, &vec![f64::NAN; 2000], &Watched::default()).unwrap();
        assert!(rows.iter().all(|row| row.pitch_rad == 0.0));
    }

    #[test]
    fn a_robot_that_stands_is_level_as_far_as_its_way_tells() {
        let (mut rows, heights_m, _) = drive(0.0, 0.01);
        fill(&builtin::husky_a200(), &mut rows, &heights_m, &Watched::default()).unwrap();
        assert!(rows.iter().all(|row| row.pitch_rad.abs() < 1e-6));
    }
}
