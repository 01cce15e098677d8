//! Voltages and temperatures that are those of another battery, or on another scale.

use model::Robot;
use recording::{Channel, PowerForm, Recording};

use super::{
    Doubt,
    beyond::{AIR_C, MOST_MOTOR_C, VOLTAGES},
    follow::Followed,
    second::median,
};

/// A correction is believed when it leaves less than this share of what recorded and predicted power differ by.
const CLEARLY_BETTER: f64 = 0.5;
/// Zero of the scale of Celsius on that of Kelvin.
const KELVIN: f64 = 273.15;
/// Motors hardly warm or cool where their temperatures stay within so much \[K\]: what 5 K do to power is 2 %.
const STEADY_K: f64 = 5.0;
/// Motors at rest are as warm as air in which robots drive \[°C\].
const COOL_C: [f64; 2] = [-20.0, 40.0];

/// What the rolling radius of a wheel differs by from the one that is written on its tyre: air and load flatten it by so much at most.
const TYRE: f64 = 0.05;

/// A wheel radius of the map that is not that of the robot's file.
pub(super) fn wheel_radius(robot: &Robot, recording: &Recording) -> Option<Doubt> {
    let (used_m, file_m) = (recording.wheel_radius_m?, robot.wheel_radius_m);
    let ratio = used_m / file_m;
    ((ratio - 1.0).abs() > TYRE).then(|| Doubt {
        name: "wheel_radius",
        statement: format!(
            "rim speeds were made with wheels of {used_m} m, and the robot's file has {file_m} m: speeds are {ratio:.2} times what its wheels turn at"
        ),
        cure: format!("give \"wheel_radius_m\": {file_m} in the map, or correct `wheel_radius_m` of the robot's file"),
    })
}

/// A voltage that is not that of the robot's battery while power shows that it should be.
pub(super) fn voltage(robot: &Robot, recording: &Recording, followed: &Followed) -> Option<Doubt> {
    if recording.power_form() != Some(PowerForm::CurrentAndVoltage) {
        return None;
    }
    let known = recording.channel(Channel::Voltage)?.iter().copied().filter(|v| v.is_finite());
    let (found_v, file_v) = (median(known.collect())?, robot.battery.as_ref()?.nominal_voltage_v);
    let ratio = followed.ratio.filter(|ratio| *ratio > 0.0 && found_v > 0.0)?;
    let mended = ratio * file_v / found_v;
    let is_better = mended.ln().abs() < CLEARLY_BETTER * ratio.ln().abs();
    (!(VOLTAGES[0]..=VOLTAGES[1]).contains(&(found_v / file_v)) && is_better).then(|| Doubt {
        name: "voltage",
        statement: format!(
            "the battery has {found_v:.1} V, {:.2} times the {file_v:.0} V of the robot's file, and recorded power is {ratio:.2} times what the file predicts, with {file_v:.0} V {mended:.2} times",
            found_v / file_v
        ),
        cure: "is it the voltage of one cell or of one battery of several, or in another unit? Give that of the whole battery, or its \"scale\" in a map".to_owned(),
    })
}

/// Temperatures in kelvin or degrees Fahrenheit.
pub(super) fn temperatures(
    recording: &Recording,
    ratio_at: impl Fn(&Recording) -> Option<f64>,
) -> Vec<Doubt> {
    let middle = |channel: Channel| {
        let known = recording.channel(channel)?.iter().copied().filter(|c| c.is_finite());
        median(known.collect())
    };
    let channels =
        [Channel::AmbientTemperature, Channel::LeftMotorTemperature, Channel::RightMotorTemperature];
    let of = |channel: Channel| {
        let found_c = middle(channel)?;
        let most_c = if channel == Channel::AmbientTemperature { AIR_C[1] } else { MOST_MOTOR_C };
        (!(AIR_C[0]..=most_c).contains(&found_c)).then(|| unit(channel, found_c))
    };
    let impossible: Vec<Doubt> = channels.into_iter().filter_map(of).collect();
    // A hundred degrees Fahrenheit are a warm day.
    if impossible.is_empty() { fahrenheit(recording, ratio_at).into_iter().collect() } else { impossible }
}

fn unit(channel: Channel, found_c: f64) -> Doubt {
    let (kelvin_c, fahrenheit_c) = (found_c - KELVIN, celsius(found_c));
    let (name, there_c, unit) = match (AIR_C[0]..=MOST_MOTOR_C).contains(&kelvin_c) {
        true => ("kelvin", kelvin_c, "K"),
        false => ("degrees Fahrenheit", fahrenheit_c, "degF"),
    };
    Doubt {
        name: "temperature_unit",
        statement: format!(
            "`{}` is {found_c:.0} °C in the middle of its values, where nothing drives",
            channel.name()
        ),
        cure: format!(
            "is it in {name}, which would be {there_c:.0} °C? Give its source the unit `{unit}` in a map"
        ),
    }
}

/// Degrees Celsius of degrees Fahrenheit.
fn celsius(fahrenheit: f64) -> f64 {
    (fahrenheit - 32.0) / 1.8
}

/// Motors that are as warm all the time as motors at rest would be in degrees Fahrenheit, where power says so.
fn fahrenheit(recording: &Recording, ratio_at: impl Fn(&Recording) -> Option<f64>) -> Option<Doubt> {
    let motors = [Channel::LeftMotorTemperature, Channel::RightMotorTemperature];
    let mut found_c = Vec::new();
    for channel in motors {
        let mut known: Vec<f64> =
            recording.channel(channel)?.iter().copied().filter(|c| c.is_finite()).collect();
        known.sort_by(f64::total_cmp);
        let at = |share: f64| known.get((share * known.len() as f64) as usize).copied();
        if (at(0.95)? - at(0.05)?) / 1.8 > STEADY_K {
            return None;
        }
        found_c.push(at(0.5)?);
    }
    let is_cool = |c: &f64| (COOL_C[0]..=COOL_C[1]).contains(&celsius(*c)) && *c > COOL_C[1];
    if !found_c.iter().all(is_cool) {
        return None;
    }
    let mut mended = recording.clone();
    for channel in motors {
        mended.channels.get_mut(&channel)?.iter_mut().for_each(|c| *c = celsius(*c));
    }
    let [given, other] = [ratio_at(recording)?, ratio_at(&mended)?];
    let is_better = given > 0.0 && other > 0.0 && other.ln().abs() < CLEARLY_BETTER * given.ln().abs();
    is_better.then(|| Doubt {
        name: "temperature_unit",
        statement: format!(
            "motors stay at {:.0} and {:.0} °C all the time, and recorded power is {given:.2} times what the robot's file predicts of motors so warm; of {:.0} °C, which these are in \
             degrees Fahrenheit, it is {other:.2} times",
            found_c[0],
            found_c[1],
            celsius(found_c[0])
        ),
        cure: "are they in degrees Fahrenheit? Give their sources the unit `degF` in a map".to_owned(),
    })
}
