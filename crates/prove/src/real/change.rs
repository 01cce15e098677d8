//! Known changes, and how each rewrites the rows of a drive.

use model::{Robot, Sides, rolling};
use recording::{Channel, Recording, Run};
use serde::{Deserialize, Serialize};
use world::Side;

use crate::{
    Error,
    real::{
        Onset,
        force::{CURRENTS, add_forces},
        reading::Reading,
    },
};

/// A kind of change that can be put into a recorded drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Change {
    /// Mass on board [kg]: its weight along the measured slope, and what it rolls and skids harder.
    Payload,
    /// Drag of one side's drive train against its rolling [N].
    Drag,
    /// Gain of both meters of current [-].
    Gain,
    /// Zero error of both meters of current [A].
    Offset,
    /// Currents recorded later than speeds [s].
    Delay,
    /// Pitch sensor mounted askew [rad].
    PitchBias,
    /// Wheel speeds recorded too high or too low by a share [-].
    WheelScale,
    /// No-load current of both motors while they turn [A].
    IdleCurrent,
    /// Something towed that takes so much force to roll, and has the mass for it [N].
    Tow,
}

/// Which way a change goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// More, or too high.
    Up,
    /// Less, or too low.
    Down,
}

/// One change of one size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Act {
    /// What kind.
    pub change: Change,
    /// How much of it, never negative, in [`Change::unit`].
    pub size: f64,
    /// Which way.
    pub direction: Direction,
    /// On which side, where it is on one.
    pub side: Side,
    /// From when on.
    pub onset: Onset,
}

/// Force that a trailer takes to roll over its weight [-]: assumed, as small wheels on soft ground take it.
const TRAILER_ROLLING: f64 = 0.1;
/// Distance of a trailer's axle behind the robot's middle, in track widths [-]: assumed, long enough for one as wide as the robot to fold.
const TRAILER_BEHIND_TRACKS: f64 = 2.0;
/// Standard gravity [m/s²].
const GRAVITY_MPS2: f64 = 9.806_65;

impl Change {
    /// All.
    pub const ALL: [Change; 9] = [
        Change::Payload,
        Change::Drag,
        Change::Gain,
        Change::Offset,
        Change::Delay,
        Change::PitchBias,
        Change::WheelScale,
        Change::IdleCurrent,
        Change::Tow,
    ];

    /// For people.
    pub fn words(self) -> &'static str {
        match self {
            Change::Payload => "payload",
            Change::Drag => "drag of one side",
            Change::Gain => "gain",
            Change::Offset => "offset",
            Change::Delay => "delay",
            Change::PitchBias => "pitch bias",
            Change::WheelScale => "wheel scale",
            Change::IdleCurrent => "idle current",
            Change::Tow => "towed load",
        }
    }

    /// Names of mechanisms that are right.
    ///
    /// A no-load current is in no list by itself: as a reading it is an offset, as a torque it is drag in the drive train.
    pub fn accepted(self) -> &'static [&'static str] {
        match self {
            Change::Payload => &["payload"],
            Change::Drag => &["drivetrain_drag"],
            Change::Gain => &["power_scale"],
            Change::Offset => &["power_offset"],
            Change::Delay => &["clock_offset"],
            Change::PitchBias => &["pitch_bias"],
            Change::WheelScale => &["wheel_radius"],
            Change::IdleCurrent => &["power_offset", "drivetrain_drag"],
            Change::Tow => &["towed_load"],
        }
    }

    /// Unit of its size.
    pub fn unit(self) -> &'static str {
        match self {
            Change::Payload => "kg",
            Change::Drag | Change::Tow => "N",
            Change::Offset | Change::IdleCurrent => "A",
            Change::Delay => "s",
            Change::PitchBias => "rad",
            Change::Gain | Change::WheelScale => "1",
        }
    }

    /// Largest size that a robot could still be driven with, or a log be taken for one.
    ///
    /// Its own mass on board; a quarter of its weight as a drag, a third as a pull; half of what is read; about the mean current of a
    /// Husky on real ground; two seconds; 11 degrees; tyres of another model.
    pub fn most(self, robot: &Robot) -> f64 {
        let weight_n = robot.mass_kg * GRAVITY_MPS2;
        match self {
            Change::Payload => robot.mass_kg,
            Change::Drag => weight_n / 4.0,
            Change::Tow => weight_n / 3.0,
            Change::Gain => 0.5,
            Change::Offset | Change::IdleCurrent => 5.0,
            Change::Delay => 2.0,
            Change::PitchBias => 0.2,
            Change::WheelScale => 0.3,
        }
    }

    /// Whether it can go either way: what is wrong with a sensor, not what weighs or rubs.
    pub fn goes_both_ways(self) -> bool {
        matches!(self, Change::Gain | Change::Offset | Change::PitchBias | Change::WheelScale)
    }
}

impl Act {
    /// Its size with its sign.
    pub fn signed(&self) -> f64 {
        match self.direction {
            Direction::Up => self.size,
            Direction::Down => -self.size,
        }
    }

    /// The drives of a robot as they would have been recorded with the change; rows before it sets in are untouched.
    ///
    /// # Errors
    /// A robot that does not say what an ampere stands for.
    pub fn put_into(&self, robot: &Robot, recording: &Recording) -> Result<Recording, Error> {
        let mut changed = recording.clone();
        let acts = self.onset.rows(recording);
        let signed = self.signed();
        match self.change {
            Change::Payload => {
                let heavier = Robot { mass_kg: robot.mass_kg + self.size, ..robot.clone() };
                let with = Reading::new(&heavier, recording)?;
                let extra = |own: &Reading, row: usize| {
                    with.needed_n[row].zip(own.needed_n[row]).map(|(with, without)| with - without)
                };
                add_forces(robot, &mut changed, |row| acts[row], extra)?;
            }
            Change::Drag => {
                let [left_n, right_n] = match self.side {
                    Side::Left => [self.size, 0.0],
                    Side::Right => [0.0, self.size],
                };
                let extra = |own: &Reading, row: usize| {
                    let direction = own.drives.rows[row].rim_mps.map(rolling::direction);
                    direction.zip(Sides { left: left_n, right: right_n }).map(|(sign, drag_n)| sign * drag_n)
                };
                add_forces(robot, &mut changed, |row| acts[row], extra)?;
            }
            Change::Tow => {
                add_forces(robot, &mut changed, |row| acts[row], |own, row| self.pull_n(robot, own, row))?;
            }
            Change::Gain => each(&mut changed, &CURRENTS, &acts, |_, current_a| (1.0 + signed) * current_a),
            // A meter of currents without a sign shows none below zero.
            Change::Offset => {
                each(&mut changed, &CURRENTS, &acts, |_, current_a| (current_a.abs() + signed).max(0.0));
            }
            Change::IdleCurrent => {
                let turns = turns(recording);
                each(&mut changed, &CURRENTS, &acts, |row, current_a| {
                    if turns[row] { current_a.abs() + self.size } else { current_a }
                });
            }
            Change::Delay => delay(recording, &mut changed, &acts, self.size),
            Change::PitchBias => {
                each(&mut changed, &[Channel::Pitch], &acts, |_, pitch_rad| pitch_rad + signed);
            }
            Change::WheelScale => {
                each(&mut changed, &[Channel::LeftSpeed, Channel::RightSpeed], &acts, |_, u| {
                    (1.0 + signed) * u
                });
            }
        }
        Ok(changed)
    }

    /// Pull of a trailer, half on each side: it rolls after the robot at an angle that grows with the turn (the end of a tractrix), and
    /// its mass hangs on the measured slope. The turn is the gyroscope's where there is one.
    fn pull_n(&self, robot: &Robot, own: &Reading, row: usize) -> Sides<f64> {
        let row = &own.drives.rows[row];
        let speed_mps = row.speed_mps();
        let turn_radps = match row.yaw_rate_radps {
            measured if measured.is_finite() => measured,
            _ => row.difference_mps() / robot.slip_track_m,
        };
        let across_mps = turn_radps * TRAILER_BEHIND_TRACKS * robot.track_m;
        let along = if across_mps == 0.0 { 1.0 } else { speed_mps.abs() / speed_mps.hypot(across_mps) };
        let mass_kg = self.size / (TRAILER_ROLLING * GRAVITY_MPS2);
        let rolling_n = self.size * rolling::direction(speed_mps);
        let lifting_n = mass_kg * GRAVITY_MPS2 * row.pitch_rad.sin();
        Sides::both(along * (rolling_n + lifting_n) / 2.0)
    }
}

/// Rewrites the values of some channels in some rows.
fn each(recording: &mut Recording, channels: &[Channel], acts: &[bool], new: impl Fn(usize, f64) -> f64) {
    for channel in channels {
        let values = recording.channels.get_mut(channel).map(Vec::as_mut_slice).unwrap_or_default();
        for (row, value) in values.iter_mut().enumerate().filter(|(row, _)| acts[*row]) {
            *value = new(row, *value);
        }
    }
}

/// Whether the wheels of a row turn.
fn turns(recording: &Recording) -> Vec<bool> {
    let [left, right] =
        [Channel::LeftSpeed, Channel::RightSpeed].map(|side| recording.channel(side).unwrap_or_default());
    let is_turning = |u: Option<&f64>| u.is_some_and(|u| u.abs() >= calibration::row::STANDSTILL_MPS);
    (0..recording.rows()).map(|row| is_turning(left.get(row)) || is_turning(right.get(row))).collect()
}

/// Currents of so long ago, between rows in proportion; what was before the beginning of a run reads as its first row.
fn delay(recording: &Recording, changed: &mut Recording, acts: &[bool], delay_s: f64) {
    for channel in CURRENTS {
        let (Some(from), Some(to)) = (recording.channel(channel), changed.channels.get_mut(&channel)) else {
            continue;
        };
        for run in &recording.runs {
            for row in run.rows.clone().filter(|row| acts[*row]) {
                to[row] = at(recording, from, run, recording.t_s[row] - delay_s);
            }
        }
    }
}

/// A value of a run at a time.
fn at(recording: &Recording, values: &[f64], run: &Run, t_s: f64) -> f64 {
    let times_s = &recording.t_s[run.rows.clone()];
    let values = &values[run.rows.clone()];
    let after = times_s.partition_point(|time_s| *time_s <= t_s);
    match after {
        0 => values[0],
        after if after == times_s.len() => values[after - 1],
        after => {
            let share = (t_s - times_s[after - 1]) / (times_s[after] - times_s[after - 1]);
            values[after - 1] + share * (values[after] - values[after - 1])
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use approx::assert_relative_eq;
    use model::{builtin, robot::Motors};

    use super::*;
    use crate::real::ground::tests::drives;

    /// The built-in robot with 30 N to the ampere.
    pub(crate) fn robot() -> Robot {
        let robot = builtin::husky_a200();
        let mut motors: Motors = robot.motors;
        motors.left.force_n_per_a = Some(30.0);
        motors.right.force_n_per_a = Some(30.0);
        Robot { motors, ..robot }
    }

    pub(crate) fn act(change: Change, size: f64) -> Act {
        Act { change, size, direction: Direction::Up, side: Side::Left, onset: Onset::START }
    }

    fn currents(recording: &Recording, row: usize) -> [f64; 2] {
        CURRENTS.map(|side| recording.channel(side).unwrap()[row])
    }

    #[test]
    fn a_payload_on_a_known_slope_takes_the_current_that_lifts_and_rolls_it() {
        // 18 kg up sin γ = 0.1 at μ = 0.063, half on each side, 30 N to the ampere:
        // 18 · 9.80665 · (0.1 + 0.063 · √0.99) / 2 / 30 = 0.4786 A on top of 4 A.
        let before = drives(&[40], 0.1_f64.asin());
        let after = act(Change::Payload, 18.0).put_into(&robot(), &before).unwrap();
        let expected_a = 4.0 + 18.0 * 9.80665 * (0.1 + 0.063 * 0.99_f64.sqrt()) / 60.0;
        for current_a in currents(&after, 20) {
            assert_relative_eq!(current_a, expected_a, epsilon = 1e-3);
        }
    }

    #[test]
    fn drag_is_on_its_side_alone_and_a_tow_is_half_on_each() {
        let before = drives(&[40], 0.0);
        let dragged = act(Change::Drag, 15.0).put_into(&robot(), &before).unwrap();
        assert_relative_eq!(currents(&dragged, 20)[..], [4.5, 4.0][..], epsilon = 1e-9);
        let towing = act(Change::Tow, 60.0).put_into(&robot(), &before).unwrap();
        assert_relative_eq!(currents(&towing, 20)[..], [5.0, 5.0][..], epsilon = 1e-9);
        // On a slope of one in a hundred its 61 kg hang on the robot with 6 N.
        let uphill = drives(&[40], 0.01_f64.asin());
        let towing = act(Change::Tow, 60.0).put_into(&robot(), &uphill).unwrap();
        assert_relative_eq!(currents(&towing, 20)[0], 5.1, epsilon = 1e-9);
    }

    #[test]
    fn faults_of_meters_change_what_they_read_and_nothing_else() {
        let before = drives(&[40], 0.0);
        let put = |change, size| act(change, size).put_into(&robot(), &before).unwrap();
        assert_relative_eq!(currents(&put(Change::Gain, 0.1), 9)[..], [4.4, 4.4][..], epsilon = 1e-12);
        assert_relative_eq!(currents(&put(Change::Offset, 0.3), 9)[..], [4.3, 4.3][..], epsilon = 1e-12);
        assert_relative_eq!(currents(&put(Change::IdleCurrent, 0.3), 9)[..], [4.3, 4.3][..], epsilon = 1e-12);
        let askew = put(Change::PitchBias, 0.02);
        assert_relative_eq!(askew.channel(Channel::Pitch).unwrap()[9], 0.02, epsilon = 1e-12);
        assert_eq!(currents(&askew, 9), [4.0, 4.0]);
        let fast = put(Change::WheelScale, 0.1);
        assert_relative_eq!(fast.channel(Channel::RightSpeed).unwrap()[9], 0.55, epsilon = 1e-12);
        let low = Act { direction: Direction::Down, ..act(Change::Offset, 5.0) };
        assert_eq!(currents(&low.put_into(&robot(), &before).unwrap(), 9), [0.0, 0.0]);
    }

    #[test]
    fn what_is_late_is_what_was_before_within_the_run() {
        let mut before = drives(&[10, 10], 0.0);
        let ramp: Vec<f64> = (0..20).map(f64::from).collect();
        before.channels.insert(Channel::LeftMotorCurrent, ramp);
        let late = act(Change::Delay, 0.25).put_into(&robot(), &before).unwrap();
        let left_a = late.channel(Channel::LeftMotorCurrent).unwrap();
        assert_relative_eq!(left_a[6], 3.5, epsilon = 1e-9);
        assert_eq!([left_a[0], left_a[10]], [0.0, 10.0]);
    }

    #[test]
    fn nothing_is_touched_before_it_sets_in() {
        let before = drives(&[30, 30], 0.05);
        let onset = Onset { run: 1, t_s: 1.0 };
        for change in Change::ALL {
            let late = Act { onset, ..act(change, change.most(&robot()) / 5.0) };
            let after = late.put_into(&robot(), &before).unwrap();
            for (channel, values) in &before.channels {
                let now = after.channel(*channel).unwrap();
                assert_eq!(now[..40], values[..40], "{change:?} {channel:?}");
            }
            assert!(change == Change::Delay || after != before, "{change:?}");
        }
    }
}
