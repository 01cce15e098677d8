//! A gyroscope that turns where the wheels do not: one speed in both columns, or encoders without a sign.

use model::Robot;
use recording::{Channel, Recording, SuspicionKind, suspicions};

use super::{
    Doubt,
    driving::TURNING_MPS,
    second::{Second, total_s},
};

/// Share of the turning that no wheels drive: moments of sliding and of delays are fewer. Of five real drives on asphalt to ice 0 to 3 %.
const MOST_SHARE: f64 = 0.1;
/// Share of the difference of speeds that a turn takes at least with which wheels may have driven it: encoders of unlike scales and gyroscopes
/// with an offset take off less.
const LEAST_DIFFERENCE: f64 = 0.5;
/// Seconds of turning that tell something \[s\].
const LEAST_S: f64 = 10.0;
/// Share of rows in which both columns are alike.
const ALIKE: f64 = 0.99;

/// Tells of turning that wheels cannot drive: wheels turn a robot by `ω = (v_right − v_left) / slip track`, and no slip track is less than
/// the track of the robot.
pub(super) fn turning(robot: &Robot, recording: &Recording, seconds: &[Second]) -> Option<Doubt> {
    // A sign that is turned round everywhere is told as such.
    if suspicions(recording).iter().any(|one| one.kind == SuspicionKind::Opposed) {
        return None;
    }
    let meant_mps = |one: &Second| one.yaw_rate_radps * robot.track_m;
    let turned: Vec<&Second> = seconds.iter().filter(|one| meant_mps(one).abs() > TURNING_MPS).collect();
    let is_undriven = |one: &&Second| {
        one.difference_mps * meant_mps(one).signum() < LEAST_DIFFERENCE * meant_mps(one).abs()
    };
    let undriven: Vec<&Second> = turned.iter().copied().filter(is_undriven).collect();
    let share = total_s(&undriven) / total_s(&turned);
    if total_s(&turned) < LEAST_S || share < MOST_SHARE {
        return None;
    }
    let first = undriven.first()?;
    let (why, cure) = why(recording);
    Some(Doubt {
        name: "turning",
        statement: format!(
            "in {:.0} of {:.0} s in which the gyroscope turns, from {:.0} s of run `{}` on, wheel speeds differ by less than such a turn takes: {why}",
            total_s(&undriven),
            total_s(&turned),
            first.t_s,
            recording.runs.get(first.run).map_or("", |run| run.name.as_str()),
        ),
        cure: cure.to_owned(),
    })
}

/// What wheel speeds look like that do not turn a robot, and what mends them.
fn why(recording: &Recording) -> (String, &'static str) {
    let [left, right] =
        [Channel::LeftSpeed, Channel::RightSpeed].map(|c| recording.channel(c).unwrap_or_default());
    let known = || left.iter().zip(right).filter(|(l, r)| l.is_finite() && r.is_finite());
    let (rows, alike) = (known().count(), known().filter(|(l, r)| l == r).count());
    if known().all(|(l, r)| *l == 0.0 && *r == 0.0) {
        return (
            format!("both are 0 in all of {rows} rows"),
            "read a field that is filled in; where wheels tell positions alone, name these with `derivative` in a map",
        );
    }
    if alike as f64 >= ALIKE * rows as f64 {
        return (
            format!("both columns hold one speed in {alike} of {rows} rows, as that of the chassis"),
            "read the encoders of each side, or make rim speeds of speed and yaw rate (`left_of_twist` and `right_of_twist` in a map)",
        );
    }
    if known().all(|(l, r)| *l >= 0.0 && *r >= 0.0) {
        return (
            "neither side is ever negative, as of encoders without a sign".to_owned(),
            "give wheel speeds the sign of the direction in which they turn",
        );
    }
    (
        "they are not those of this drive, or at other times".to_owned(),
        "look at the sources of wheel speeds and of the yaw rate, at their clocks and at the unit of the yaw rate",
    )
}
