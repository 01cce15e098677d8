//! Recordings as the model itself would make them: what the wheels did is kept, what was measured of it is made anew.

use model::{Robot, mechanism::Kind};
use recording::{Channel, PowerForm, Recording, unwatched};

use crate::{
    Error,
    observe::{
        average::Meter,
        part::{Part, Seen},
        span::Applied,
    },
};

/// Makes a recording's powers, yaw rates and positions anew, as a robot with mechanisms would show them, without noise.
///
/// Speeds of the wheels, slopes and times stay; rows that nothing can be said of have gaps. Trials in a world that is the model's
/// own are made of it: they show how well the method does where no model errs.
///
/// # Errors
/// As [`crate::Series::new`].
pub fn imitate(robot: &Robot, recording: &Recording, applied: &[Applied]) -> Result<Recording, Error> {
    let part = Part::new(robot, recording, true, &unwatched())?;
    let form = part.drives.form.filter(|form| *form != PowerForm::MotorCurrents).ok_or(Error::Form)?;
    let seen = part.predict(robot, applied, &Meter::of(form))?;
    let mut told = vec![false; seen.len()];
    part.drives.stretches.iter().for_each(|stretch| told[stretch.rows.clone()].fill(true));
    let made_v = voltages(robot, recording, (&part, form), applied)?;
    let column = |value: &dyn Fn(&Seen) -> f64| -> Vec<f64> {
        seen.iter().zip(&told).map(|(seen, told)| if *told { value(seen) } else { f64::NAN }).collect()
    };
    let mut made = recording.clone();
    made.channels.retain(|channel, _| !matches!(channel, Channel::Current | Channel::Heading));
    if form == PowerForm::Sides {
        made.channels.insert(Channel::LeftPower, column(&|seen| seen[0]));
        made.channels.insert(Channel::RightPower, column(&|seen| seen[1]));
        if recording.channel(Channel::Power).is_some() {
            made.channels.insert(Channel::Power, column(&|seen| seen[0] + seen[1] + seen[2]));
        }
    } else {
        made.channels.insert(Channel::Power, column(&|seen| seen[0]));
    }
    made.channels.insert(Channel::YawRate, column(&|seen| seen[5]));
    if let Some(height_m) = recording.channel(Channel::Z) {
        let plain = part.predict(robot, &[], &Meter::of(form))?;
        made.channels.insert(Channel::Z, heights(&part, recording, (height_m, &plain, &seen)));
    }
    match made_v {
        Some(made_v) => made.channels.insert(Channel::Voltage, made_v),
        None => made.channels.remove(&Channel::Voltage),
    };
    if recording.channel(Channel::X).is_some() && recording.channel(Channel::Y).is_some() {
        let [x_m, y_m] = places(&part, recording, &seen);
        made.channels.insert(Channel::X, x_m);
        made.channels.insert(Channel::Y, y_m);
    }
    Ok(made)
}

/// Voltages that sag with the power that is truly drawn, as those that were recorded did; `None` where they tell nothing.
fn voltages(
    robot: &Robot,
    recording: &Recording,
    (part, form): (&Part, PowerForm),
    applied: &[Applied],
) -> Result<Option<Vec<f64>>, Error> {
    let (Some(source), Some(volts)) = (part.source(), recording.channel(Channel::Voltage)) else {
        return Ok(None);
    };
    let physics: Vec<Applied> =
        applied.iter().filter(|a| a.mechanism.kind() == Kind::Physics).cloned().collect();
    let drawn = part.predict(robot, &physics, &Meter::of(form))?;
    let beyond_a = |(row, seen): (usize, &Seen)| seen[0..3].iter().sum::<f64>() / volts[row] - seen[6];
    let sagged = drawn.iter().enumerate().map(|row| -source.resistance_ohm * beyond_a(row));
    Ok(Some(volts.iter().zip(sagged).map(|(volts, by)| volts + by).collect()))
}

/// Heights to which slopes lead that are not as they were recorded.
fn heights(
    part: &Part,
    recording: &Recording,
    (height_m, plain, seen): (&[f64], &[Seen], &[Seen]),
) -> Vec<f64> {
    let mut made_m = height_m.to_vec();
    for run in &recording.runs {
        let mut higher_m = 0.0;
        for row in run.rows.clone() {
            let by_m = (seen[row][7] - plain[row][7]) * part.drives.rows[row].step_s;
            higher_m += if by_m.is_finite() { by_m } else { 0.0 };
            made_m[row] += higher_m;
        }
    }
    made_m
}

/// Where yaw rates and speeds lead from where each run began.
fn places(part: &Part, recording: &Recording, seen: &[Seen]) -> [Vec<f64>; 2] {
    let (mut x_m, mut y_m) = (vec![f64::NAN; seen.len()], vec![f64::NAN; seen.len()]);
    let began = |channel, row: usize| {
        recording.channel(channel).map(|values| values[row]).filter(|m| m.is_finite()).unwrap_or(0.0)
    };
    for run in &recording.runs {
        let Some(first) = run.rows.clone().next() else { continue };
        let mut at_m = [began(Channel::X, first), began(Channel::Y, first)];
        let mut heading_rad = part.heading_rad[first];
        for row in run.rows.clone() {
            let step_s = part.drives.rows[row].step_s;
            let [_, _, _, along_mps, across_mps, yaw_rate_radps, ..] = seen[row];
            let (sin, cos) = part.heading_rad[row].sin_cos();
            let speed_mps = along_mps * cos + across_mps * sin;
            if (speed_mps * yaw_rate_radps * step_s).is_finite() {
                heading_rad += yaw_rate_radps * step_s;
                at_m[0] += speed_mps * step_s * heading_rad.cos();
                at_m[1] += speed_mps * step_s * heading_rad.sin();
            }
            [x_m[row], y_m[row]] = at_m;
        }
    }
    [x_m, y_m]
}
