//! Pitch beside the heights that a robot climbs to.

use model::Robot;
use recording::{Channel, Recording, Run};

use super::{
    Doubt,
    driving::{ALIKE_S, STANDS_MPS},
};

/// Standard errors that are no chance, and standard deviations of rolling friction by which it contradicts its file.
const SIGMAS: f64 = 3.0;
/// Share of the variance of slopes by heights from which the sign of pitch is told by them, as of the yaw rate by wheels.
const LEAST_R2: f64 = 0.5;
/// Fewer pieces of way tell nothing.
const LEAST_PIECES: usize = 20;

/// A piece of way: slope by heights and mean pitch \[rad\].
type Slopes = [f64; 2];

/// Tells of a pitch that is askew by a constant angle, or of another sign than heights.
pub(super) fn askew(robot: &Robot, recording: &Recording) -> Option<Doubt> {
    let pieces: Vec<Slopes> =
        recording.runs.iter().flat_map(|run| pieces(recording, run).unwrap_or_default()).collect();
    if pieces.len() < LEAST_PIECES {
        return None;
    }
    let count = pieces.len() as f64;
    let mean = |of: &dyn Fn(&Slopes) -> f64| pieces.iter().map(of).sum::<f64>() / count;
    let [by_height, by_pitch] = [mean(&|one| one[0]), mean(&|one| one[1])];
    let both = mean(&|one| (one[0] - by_height) * (one[1] - by_pitch));
    let [hh, pp] = [mean(&|one| (one[0] - by_height).powi(2)), mean(&|one| (one[1] - by_pitch).powi(2))];
    let r = both / (hh * pp).sqrt();
    if r * r.abs() < -LEAST_R2 {
        return Some(opposed(r));
    }
    let bias_rad = by_pitch - by_height;
    let sigma_rad = (mean(&|one| (one[1] - one[0] - bias_rad).powi(2)) / count).sqrt();
    // A slope that is not there is taken for rolling friction: m g sin θ for m g μ.
    // Ground is no better known from day to day than by default, however well one day told it.
    let uncertainty = robot.uncertainty.mu_roll.max(model::robot::Uncertainty::default().mu_roll);
    let least_rad = SIGMAS * uncertainty * friction(robot)?;
    let is_told = r * r > LEAST_R2 && bias_rad.abs() - SIGMAS * sigma_rad > least_rad;
    is_told.then(|| Doubt {
        name: "pitch_bias",
        statement: format!(
            "pitch is {:+.2} degrees from the slopes by heights on average over {count:.0} pieces of way (within {:.2}): the IMU seems mounted askew",
            bias_rad.to_degrees(),
            (SIGMAS * sigma_rad).to_degrees()
        ),
        cure: format!("take {bias_rad:+.4} rad off `pitch_rad` before it is logged, or leave it out, so that slopes come from `z_m`"),
    })
}

fn opposed(r: f64) -> Doubt {
    Doubt {
        name: "pitch_or_heights_sign",
        statement: format!("pitch rises where heights fall (correlation {r:.2})"),
        cure: "nose up is positive pitch and up is positive height: give the source of `pitch_rad` or of `z_m` \"scale\": -1 in a map, or leave `z_m` out"
            .to_owned(),
    }
}

/// Rolling friction of the robot's default ground.
fn friction(robot: &Robot) -> Option<f64> {
    robot.surface(&robot.default_surface).ok().map(|surface| surface.mu_roll)
}

/// Pieces of way of a run, each as long as a manoeuvre, in which the robot goes on in one direction.
fn pieces(recording: &Recording, run: &Run) -> Option<Vec<Slopes>> {
    let channels = [Channel::Z, Channel::Pitch, Channel::LeftSpeed, Channel::RightSpeed];
    let [z, pitch, left, right] = channels.map(|c| recording.channel(c));
    let (z, pitch, left, right) = (z?, pitch?, left?, right?);
    let speed = |row: usize| (left[row] + right[row]) / 2.0;
    let (mut all, mut from) = (Vec::new(), run.rows.start);
    let (mut way_m, mut climb) = (0.0, 0.0);
    for row in run.rows.clone().skip(1) {
        let step_m = speed(row) * recording.step_s(run, row - 1).unwrap_or(f64::NAN);
        let goes_on = speed(row).abs() > STANDS_MPS && speed(row) * speed(row - 1) > 0.0;
        (way_m, climb) = (way_m + step_m, climb + step_m * pitch[row]);
        if !goes_on || !climb.is_finite() {
            (from, way_m, climb) = (row, 0.0, 0.0);
        } else if recording.t_s[row] - recording.t_s[from] >= ALIKE_S {
            let slope = (z[row] - z[from]) / way_m;
            all.extend(Some([slope, climb / way_m]).filter(|piece| piece.iter().all(|x| x.is_finite())));
            (from, way_m, climb) = (row, 0.0, 0.0);
        }
    }
    Some(all)
}
