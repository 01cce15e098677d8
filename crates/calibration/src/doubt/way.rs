//! Positions that go another way than wheels that drive straight on.

use model::Robot;
use recording::{Channel, Recording};

use super::{Doubt, driving::TURNING_MPS, time_scale::way_shares};

/// Slip at which tyres hold the most on firm ground (Wong, *Theory of Ground Vehicles*, 1.3: 15 to 20 %): what drives straight on slips less.
const MOST_SLIP: f64 = 0.15;
/// Fewer pieces of way tell nothing.
const LEAST_WAYS: usize = 20;

/// Tells of wheel speeds whose factor is wrong: half of all pieces of way have the same share, as of a factor and not of slip, which grows uphill.
pub(super) fn way(robot: &Robot, recording: &Recording) -> Option<Doubt> {
    let (left, right) = (recording.channel(Channel::LeftSpeed)?, recording.channel(Channel::RightSpeed)?);
    let mut shares = way_shares(recording, |row| (right[row] - left[row]).abs() < TURNING_MPS)?;
    if shares.len() < LEAST_WAYS {
        return None;
    }
    shares.sort_by(f64::total_cmp);
    let [low, share, high] = [1, 2, 3].map(|quarter| shares[quarter * shares.len() / 4]);
    let is_slip =
        ((1.0 - MOST_SLIP)..=1.0 / (1.0 - MOST_SLIP)).contains(&share) || high - low > MOST_SLIP * share;
    (!is_slip).then(|| Doubt {
        name: "way_by_positions",
        statement: format!(
            "where the robot drives straight on, positions go {share:.2} times as far as its wheels ({low:.2} to {high:.2} in the middle half of {} pieces of way)",
            shares.len()
        ),
        cure: format!(
            "look at the wheel radius that rim speeds are made with ({:.4} m would agree), at the encoders' scale and at the \
             unit of positions",
            share * recording.wheel_radius_m.unwrap_or(robot.wheel_radius_m)
        ),
    })
}
