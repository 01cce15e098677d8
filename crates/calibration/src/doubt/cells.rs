//! Single cells of a channel beside the ones around them.

use model::{Robot, Sides};
use recording::{Channel, PowerForm, Recording, Run};

use crate::{
    average::AVERAGE_S,
    power::{Ground, seen_w},
    row::Row,
};

/// Cells of one channel that cannot be what they say, by row in ascending order.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cells {
    pub(super) channel: Channel,
    pub(super) rows: Vec<usize>,
}

impl Cells {
    /// Where the first of them lies, in words.
    pub(super) fn first(&self, recording: &Recording) -> String {
        let Some(row) = self.rows.first().copied() else { return String::new() };
        let run = recording.runs.iter().find(|run| run.rows.contains(&row));
        let (name, start) = run.map_or(("", 0), |run| (run.name.as_str(), run.rows.start));
        format!("row {} of run `{name}` at {:.1} s", row - start + 1, recording.t_s[row])
    }

    /// How many they are, in words.
    pub(super) fn count(&self, recording: &Recording) -> String {
        let known = recording.channel(self.channel).map_or(0, |v| v.iter().filter(|x| x.is_finite()).count());
        format!("{} of {known} rows", self.rows.len())
    }
}

/// A recording in which some cells are gaps.
pub(super) fn without(recording: &Recording, cells: &[Cells]) -> Recording {
    let mut rest = recording.clone();
    for one in cells {
        if let Some(values) = rest.channels.get_mut(&one.channel) {
            one.rows.iter().for_each(|row| values[*row] = f64::NAN);
        }
    }
    rest
}

/// Recorded energy with gaps of single cells interpolated over \[J\].
pub(super) fn recorded_j(recording: &Recording) -> Option<f64> {
    let power_w = power_w(recording)?;
    let of_run = |run: &Run| {
        let known: Vec<usize> = run.rows.clone().filter(|row| power_w[*row].is_finite()).collect();
        let step_j = |pair: &[usize]| {
            let span_s = recording.t_s[pair[1]] - recording.t_s[pair[0]];
            let is_near = span_s <= near_s(run);
            if is_near { span_s * (power_w[pair[0]] + power_w[pair[1]]) / 2.0 } else { 0.0 }
        };
        known.windows(2).map(step_j).sum::<f64>()
    };
    Some(recording.runs.iter().map(of_run).sum())
}

/// Power of all sides by row as it was recorded; `None` of motor currents \[W\].
fn power_w(recording: &Recording) -> Option<Vec<f64>> {
    let form = recording.power_form().filter(|form| *form != PowerForm::MotorCurrents)?;
    let [first, second] = form.channels().map(|channel| recording.channel(channel).unwrap_or_default());
    let together = |(a, b): (&f64, &f64)| match form {
        PowerForm::Sides => a + b,
        PowerForm::CurrentAndVoltage => a * b,
        _ => *a,
    };
    Some(first.iter().zip(second).map(together).collect())
}

/// Time within which what lies on both sides of a cell tells what belongs in it \[s\].
pub(super) fn near_s(run: &Run) -> f64 {
    AVERAGE_S.max(run.gap_s)
}

/// What belongs in a cell by the nearest cells around it that are left, in a straight line; `None` where either is missing or far.
pub(super) fn between(
    recording: &Recording,
    run: &Run,
    values: &[f64],
    row: usize,
    is_left: impl Fn(f64) -> bool,
) -> Option<[f64; 3]> {
    let t_s = &recording.t_s;
    let is_near = |other: &usize| (t_s[*other] - t_s[row]).abs() <= near_s(run);
    let is_known = |other: &usize| values[*other].is_finite() && is_left(values[*other]);
    let before = (run.rows.start..row).rev().take_while(is_near).find(is_known)?;
    let after = (row + 1..run.rows.end).take_while(is_near).find(is_known)?;
    let share = (t_s[row] - t_s[before]) / (t_s[after] - t_s[before]);
    Some([values[before], values[before] + share * (values[after] - values[before]), values[after]])
}

/// Power that the robot's file expects of single rows by their wheel speeds and slopes, as its default ground carries it.
pub(super) struct Expected<'a> {
    robot: &'a Robot,
    recording: &'a Recording,
    ground: Ground<'a>,
    form: PowerForm,
}

impl<'a> Expected<'a> {
    pub(super) fn new(robot: &'a Robot, recording: &'a Recording) -> Option<Self> {
        let ground = Ground::new(robot, robot.surface(&robot.default_surface).ok()?);
        Some(Expected { robot, recording, ground, form: recording.power_form()? })
    }

    /// Left and right, or of the battery and nothing \[W\].
    pub(super) fn of_row(&self, row: usize) -> [f64; 2] {
        let at = |channel, absent: f64| self.recording.channel(channel).map_or(absent, |values| values[row]);
        let known = |x: f64| if x.is_finite() { x } else { 0.0 };
        let rim_mps =
            Sides { left: at(Channel::LeftSpeed, f64::NAN), right: at(Channel::RightSpeed, f64::NAN) };
        let row = Row {
            rim_mps,
            pitch_rad: known(at(Channel::Pitch, 0.0)),
            roll_rad: known(at(Channel::Roll, 0.0)),
            motor_c: Sides::both(self.robot.motors.reference_temperature_c),
            yaw_rate_radps: f64::NAN,
            heading_rad: f64::NAN,
            ..Row::default()
        };
        seen_w(self.robot, self.form, &row, &self.ground.power(self.robot, &row))
    }

    /// That of the meter behind a channel \[W\].
    pub(super) fn of_channel(&self, channel: Channel, row: usize) -> f64 {
        let second = matches!(channel, Channel::RightPower | Channel::RightMotorCurrent);
        self.of_row(row)[usize::from(second)]
    }
}

/// The channels that tell power in the form that a recording is read in, each once.
pub(super) fn power_channels(recording: &Recording) -> Vec<Channel> {
    let mut channels = recording.power_form().map_or(Vec::new(), |form| form.channels().to_vec());
    channels.dedup();
    channels
}
