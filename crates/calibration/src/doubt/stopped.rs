//! Encoders of both sides that tell 0 for a while in which the robot turns and draws the power of it.

use model::Robot;
use recording::{Channel, Recording};

use super::{
    Doubt,
    driving::{ALIKE_S, TURNING_MPS},
    lifted::standing_w,
    second::{Second, mean, median, total_s},
};

/// Time for which both encoders stand at 0 \[s\], as for sensors of one side.
const LEAST_S: f64 = 10.0;
/// Share of the usual power of driving above that of standing from which a robot drives: one that is turned by hand draws what it draws while it
/// stands.
const DRIVES: f64 = 0.5;

/// Tells of wheels that do not count while gyroscope and power go on.
pub(super) fn stopped(robot: &Robot, recording: &Recording, seconds: &[Second]) -> Option<Doubt> {
    let resting_w = standing_w(robot, seconds);
    let turning = || seconds.iter().filter(|one| one.rim_mps > TURNING_MPS);
    let usual_w = median(turning().map(|one| one.predicted_w - resting_w).collect()).filter(|w| *w > 0.0)?;
    let drives = |one: &Second| {
        one.yaw_rate_radps.abs() * robot.track_m > TURNING_MPS
            && one.recorded_w - resting_w > DRIVES * usual_w
    };
    let pieces = seconds.chunk_by(|a, b| a.run == b.run && stands(a) == stands(b));
    let found = pieces.filter(|piece| stands(&piece[0])).find_map(|piece| {
        let driven: Vec<&Second> = piece.iter().filter(|one| drives(one)).collect();
        let all: Vec<&Second> = piece.iter().collect();
        (total_s(&all) >= LEAST_S && total_s(&driven) >= ALIKE_S).then_some((all, driven))
    });
    let (all, driven) = found?;
    let first = all.first()?;
    Some(Doubt {
        name: "wheels_stopped",
        statement: format!(
            "each of `{}` and `{}` stands at 0 for {:.0} s, from {:.0} s of run `{}` on, while the gyroscope turns by {:.2} rad/s and {:.0} W are drawn in {:.0} s of \
             these: the encoders do not count",
            Channel::LeftSpeed.name(),
            Channel::RightSpeed.name(),
            total_s(&all),
            first.t_s,
            recording.runs.get(first.run).map_or("", |run| run.name.as_str()),
            mean(&driven, |one| one.yaw_rate_radps.abs()),
            mean(&driven, |one| one.recorded_w),
            total_s(&driven),
        ),
        cure: "leave these cells empty, which makes gaps of them, or leave the runs out (`--runs` names those that are read)".to_owned(),
    })
}

fn stands(one: &Second) -> bool {
    one.rim_mps == 0.0
}
