//! One row of a recording: what the model is asked about.

use model::{Acceleration, Attitude, Motion, Robot, Sides};
use recording::{Channel, Recording};

use crate::{
    Error,
    meter::Window,
    watch::{ROWS_A_LOOK, Watched},
};

/// Rim speeds below this are standstill \[m/s\]: half of a Husky A200's encoder step of 0.008 m/s.
pub const STANDSTILL_MPS: f64 = 0.004;

/// The inputs of one row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time \[s\].
    pub t_s: f64,
    /// Time since the row before, 0 at the start of a stretch \[s\].
    pub step_s: f64,
    /// Rim speeds \[m/s\].
    pub rim_mps: Sides<f64>,
    /// Their rates of change, by central differences \[m/s²\].
    pub rim_mps2: Sides<f64>,
    /// Measured yaw rate; NaN where there is none \[rad/s\].
    pub yaw_rate_radps: f64,
    /// Pitch, 0 where the recording has no such channel \[rad\].
    pub pitch_rad: f64,
    /// Roll, 0 where the recording has no such channel \[rad\].
    pub roll_rad: f64,
    /// Heading; NaN where none was recorded \[rad\].
    pub heading_rad: f64,
    /// Copper loss of each motor, averaged backwards over the memory of the robot's own `motor_heating`, if it has one \[W\].
    pub loss_w: Sides<f64>,
    /// Motor temperatures \[°C\]: that of the air where the recording has none, and the robot's reference where it has neither.
    pub motor_c: Sides<f64>,
    /// Enters averages: everything needed is there and the wheels hold the ground.
    pub used: bool,
    /// Pitch or roll of the row is missing where the recording has the channel: the ground is taken for level.
    pub level: bool,
    /// The wheels turn against each other and the robot does not (`stuck`).
    pub stuck: bool,
    /// The reading of a slow power meter that it belongs to.
    pub window: Window,
}

impl Row {
    /// v: mean of the rim speeds \[m/s\].
    pub fn speed_mps(&self) -> f64 {
        self.rim_mps.sum() / 2.0
    }

    /// u_right − u_left \[m/s\].
    pub fn difference_mps(&self) -> f64 {
        self.rim_mps.right - self.rim_mps.left
    }

    /// dv/dt, dω/dt and v ω of a robot whose wheels move so.
    #[inline]
    pub fn acceleration(&self, robot: &Robot) -> Acceleration {
        let moved = 1.0 - robot.wheel_slip();
        let turned = moved * (1.0 - robot.turning_slip());
        let motion = self.motion(robot);
        Acceleration {
            forward_mps2: moved * self.rim_mps2.sum() / 2.0,
            yaw_radps2: turned * (self.rim_mps2.right - self.rim_mps2.left) / robot.slip_track_m,
            left_mps2: motion.speed_mps * motion.yaw_rate_radps,
        }
    }

    /// How the robot moves. Encoders dither about zero while it stands; rolling resistance would follow them.
    #[inline]
    pub fn motion(&self, robot: &Robot) -> Motion {
        Motion::of_wheels(robot, if self.stands() { Sides::both(0.0) } else { self.rim_mps })
    }

    /// How it stands on the ground.
    #[inline]
    pub fn attitude(&self) -> Attitude {
        Attitude { pitch_rad: self.pitch_rad, roll_rad: self.roll_rad }
    }

    /// Both sides stand.
    #[inline]
    pub fn stands(&self) -> bool {
        self.rim_mps.left.abs() < STANDSTILL_MPS && self.rim_mps.right.abs() < STANDSTILL_MPS
    }
}

/// The inputs of every row; accelerations are still to come.
pub(crate) fn inputs(
    robot: &Robot,
    recording: &Recording,
    recorded: &[Vec<f64>],
    watch: &Watched,
) -> Result<Vec<Row>, Error> {
    let channel = |channel| recording.channel(channel);
    let at = |values: Option<&[f64]>, row: usize, absent: f64| values.map_or(absent, |v| v[row]);
    let (left, right) = (channel(Channel::LeftSpeed), channel(Channel::RightSpeed));
    let (yaw, pitch, roll) = (channel(Channel::YawRate), channel(Channel::Pitch), channel(Channel::Roll));
    let heading = channel(Channel::Heading);
    let reference_c = robot.motors.reference_temperature_c;
    // What motors are warmer than the air is told by nothing then, but from a day to another they follow it.
    let air = channel(Channel::AmbientTemperature).map(|values_c| nearest(values_c, recording));
    let warm = [Channel::LeftMotorTemperature, Channel::RightMotorTemperature]
        .map(|side| channel(side).map(|values_c| nearest(values_c, recording)));
    let [left_c, right_c] = warm.each_ref().map(Option::as_deref);
    let row = |i: usize| {
        let rim_mps = Sides { left: at(left, i, f64::NAN), right: at(right, i, f64::NAN) };
        let (pitch_rad, roll_rad) = (at(pitch, i, 0.0), at(roll, i, 0.0));
        let air_c = Some(at(air.as_deref(), i, reference_c)).filter(|c| c.is_finite()).unwrap_or(reference_c);
        let motor_c = Sides { left: at(left_c, i, air_c), right: at(right_c, i, air_c) };
        let level = !(pitch_rad.is_finite() && roll_rad.is_finite());
        let whole = recorded.iter().all(|column| column[i].is_finite())
            && [rim_mps.left, rim_mps.right].iter().all(|x| x.is_finite());
        let or = |x: f64, other: f64| if x.is_finite() { x } else { other };
        Row {
            t_s: recording.t_s[i],
            rim_mps,
            yaw_rate_radps: at(yaw, i, f64::NAN),
            heading_rad: at(heading, i, f64::NAN),
            pitch_rad: or(pitch_rad, 0.0),
            roll_rad: or(roll_rad, 0.0),
            motor_c: motor_c.map(|c| or(c, air_c)),
            used: whole && !level,
            level: whole && level,
            ..Row::default()
        }
    };
    watch.map(recording.rows(), ROWS_A_LOOK, row)
}

/// Gaps filled with the nearest value of the same run: a motor warms over minutes, and its sensor may be read once a second.
fn nearest(values: &[f64], recording: &Recording) -> Vec<f64> {
    let mut filled = values.to_vec();
    for run in &recording.runs {
        let measured: Vec<usize> = run.rows.clone().filter(|&i| values[i].is_finite()).collect();
        let mut next = 0;
        for i in run.rows.clone() {
            while next + 1 < measured.len() && measured[next + 1].abs_diff(i) <= measured[next].abs_diff(i) {
                next += 1;
            }
            filled[i] = measured.get(next).map_or(f64::NAN, |&at| values[at]);
        }
    }
    filled
}

/// Fills in the accelerations of a stretch, by central differences.
pub(crate) fn accelerations(rows: &mut [Row]) {
    let last = rows.len() - 1;
    for i in 0..rows.len() {
        let (before, after) = (rows[i.saturating_sub(1)], rows[(i + 1).min(last)]);
        let span_s = after.t_s - before.t_s;
        if span_s > 0.0 {
            rows[i].rim_mps2 = after.rim_mps.zip(before.rim_mps).map(|(b, a)| (b - a) / span_s);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use model::builtin;
    use recording::Run;

    use super::*;

    #[test]
    fn motors_without_a_sensor_are_as_warm_as_the_air_and_those_with_one_are_not() {
        let robot = builtin::husky_a200();
        let reference_c = robot.motors.reference_temperature_c;
        let of = |more: &[(Channel, [f64; 3])]| {
            let moving = [Channel::LeftSpeed, Channel::RightSpeed].map(|side| (side, [0.5; 3]));
            let channels = moving.iter().chain(more).map(|(channel, values)| (*channel, values.to_vec()));
            let run = Run { name: "one".into(), rows: 0..3, gap_s: 5.0, start_unix_s: None };
            let recording = Recording {
                t_s: vec![0.0, 0.1, 0.2],
                channels: channels.collect::<BTreeMap<_, _>>(),
                runs: vec![run],
                ..Recording::default()
            };
            inputs(&robot, &recording, &[], &Watched::default())
                .unwrap()
                .iter()
                .map(|row| row.motor_c)
                .collect::<Vec<_>>()
        };
        assert_eq!(of(&[]), [Sides::both(reference_c); 3]);
        let air = (Channel::AmbientTemperature, [2.0, f64::NAN, f64::NAN]);
        assert_eq!(of(&[air]), [Sides::both(2.0); 3], "a reading holds until the next");
        let left = (Channel::LeftMotorTemperature, [40.0; 3]);
        assert_eq!(of(&[air, left]), [Sides { left: 40.0, right: 2.0 }; 3]);
        let none = (Channel::AmbientTemperature, [f64::NAN; 3]);
        assert_eq!(of(&[none]), [Sides::both(reference_c); 3]);
    }
}
