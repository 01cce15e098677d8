//! Wheels that turn while nothing moves and little is drawn: a robot on a stand, or lifted.

use model::Robot;
use recording::{Recording, SuspicionKind, suspicions};

use super::{
    Doubt,
    change::FOLLOWS,
    driving::TURNING_MPS,
    scale,
    second::{Second, mean, median, total_s},
};

/// Seconds in the air that are no chance \[s\]: longer than wheels slip in a manoeuvre.
const LEAST_S: f64 = 10.0;
/// Rims that turn \[m/s\]: a tenth of what a Husky drives at most.
const TURNS_MPS: f64 = 0.1;
/// Share of the motion that wheels mean below which nothing moves.
const STILL: f64 = 0.1;
/// Share of the predicted power that wheels draw at most in the air while nothing moves: wheels that dig in draw more than wheels that roll.
const LITTLE: f64 = 0.5;
/// The same where nothing tells whether the robot moves: on ice a real Husky draws 0.30 of what it draws on flooring.
const HARDLY: f64 = 0.1;

/// Tells of wheels that turn in the air.
pub(super) fn lifted(robot: &Robot, recording: &Recording, seconds: &[Second]) -> Option<Doubt> {
    // Signs and units that are wrong look like wheels without ground, and are told as what they are.
    let is_opposed = suspicions(recording).iter().any(|one| one.kind == SuspicionKind::Opposed);
    if is_opposed || !scale::is_possible(robot, recording) {
        return None;
    }
    let standing_w = standing_w(robot, seconds);
    let turning: Vec<&Second> = seconds.iter().filter(|one| one.rim_mps > TURNS_MPS).collect();
    let usual_w = median(turning.iter().map(|one| one.predicted_w - standing_w).collect())?;
    // Of ground that falls little is drawn as well.
    let is_loaded = |one: &&Second| one.predicted_w - standing_w > LITTLE * usual_w && usual_w > 0.0;
    let draws = |one: &Second| (one.recorded_w - standing_w) / (one.predicted_w - standing_w);
    let loaded: Vec<&Second> =
        turning.into_iter().filter(is_loaded).filter(|one| one.recorded_w.is_finite()).collect();
    let still: Vec<&Second> =
        loaded.iter().copied().filter(|one| is_still(robot, one) && draws(one) < LITTLE).collect();
    let idle: Vec<&Second> = longest(&loaded, |one| draws(one) < HARDLY && !is_moving(robot, one));
    let (air, by) = if total_s(&still) >= LEAST_S {
        (still, "gyroscope or positions say that the robot does not move")
    } else if total_s(&idle) > LITTLE * total_s(&loaded) {
        // Of all that was driven, power has another unit or robot.
        return None;
    } else {
        (idle, "that is what wheels take which turn freely")
    };
    let air_s = total_s(&air);
    if air_s < LEAST_S || !is_followed_outside(seconds, &air) {
        return None;
    }
    let first = air.first()?;
    Some(Doubt {
        name: "wheels_in_air",
        statement: format!(
            "for {air_s:.0} s, from {:.0} s of run `{}` on, the wheels turn at {:.2} m/s and draw {:.0} W where driving takes {:.0} W, and {by}: the robot seems to \
             be lifted or on a stand",
            first.t_s,
            recording.runs.get(first.run).map_or("", |run| run.name.as_str()),
            mean(&air, |one| one.rim_mps),
            mean(&air, |one| one.recorded_w),
            mean(&air, |one| one.predicted_w),
        ),
        cure: "leave out what was recorded off the ground (`--runs` names the runs that are read)".to_owned(),
    })
}

/// Whether power follows the model outside of some seconds: where it does not, it is no lack of ground that explains these.
fn is_followed_outside(seconds: &[Second], air: &[&Second]) -> bool {
    let is_outside = |one: &&Second| !air.iter().any(|other| std::ptr::eq(*other, *one));
    let outside: Vec<&Second> =
        seconds.iter().filter(is_outside).filter(|one| one.recorded_w.is_finite()).collect();
    let driven: Vec<&Second> = outside.iter().copied().filter(|one| one.rim_mps > TURNS_MPS).collect();
    // Of hardly any driving nothing is told.
    total_s(&driven) < LEAST_S || correlation(&outside) > FOLLOWS.sqrt()
}

/// Correlation of recorded and predicted power over some seconds.
fn correlation(seconds: &[&Second]) -> f64 {
    let [p0, r0] = [mean(seconds, |one| one.predicted_w), mean(seconds, |one| one.recorded_w)];
    let about = |one: &Second| [one.predicted_w - p0, one.recorded_w - r0];
    let both = mean(seconds, |one| about(one)[0] * about(one)[1]);
    let [pp, rr] = [0, 1].map(|i| mean(seconds, |one| about(one)[i].powi(2)));
    both / (pp * rr).sqrt()
}

/// Power while the robot stands: as recorded, or else as its file has it.
pub(super) fn standing_w(robot: &Robot, seconds: &[Second]) -> f64 {
    let stood = seconds.iter().filter(|one| one.rim_mps == 0.0 && one.recorded_w.is_finite());
    median(stood.map(|one| one.recorded_w).collect()).unwrap_or(robot.hotel_power_w)
}

/// The share of the motion meant by the wheels that gyroscope or positions show, the greater of both; NaN where neither tells.
fn share_moved(robot: &Robot, one: &Second) -> f64 {
    let turned = (one.yaw_rate_radps * robot.slip_track_m / one.difference_mps).abs();
    let turned = if one.difference_mps.abs() > TURNING_MPS { turned } else { f64::NAN };
    turned.max(one.way_share)
}

fn is_still(robot: &Robot, one: &Second) -> bool {
    share_moved(robot, one) < STILL
}

fn is_moving(robot: &Robot, one: &Second) -> bool {
    share_moved(robot, one) >= STILL
}

/// The longest piece of seconds behind one another of one run that satisfy a condition.
fn longest<'a>(seconds: &[&'a Second], holds: impl Fn(&Second) -> bool) -> Vec<&'a Second> {
    let mut pieces: Vec<Vec<&Second>> = vec![Vec::new()];
    for one in seconds {
        let last = pieces.len() - 1;
        let is_of_run = pieces[last].last().is_none_or(|before| before.run == one.run);
        match (holds(one), is_of_run) {
            (true, true) => pieces[last].push(one),
            (true, false) => pieces.push(vec![one]),
            (false, _) => pieces.push(Vec::new()),
        }
    }
    pieces.into_iter().max_by(|a, b| total_s(a).total_cmp(&total_s(b))).unwrap_or_default()
}
