//! Cells beyond what a robot of a file can draw or drive, alone among cells within.

use std::f64::consts::FRAC_PI_2;

use model::{Robot, STANDARD_GRAVITY_MPS2, Sides};
use recording::{Channel, PowerForm, Recording, Run};

use super::{
    Doubt,
    cells::{Cells, near_s, power_channels, recorded_j, without},
    scale::FASTEST,
};

/// Force that tyres hold over the weight on them: rubber on dry ground holds about as much as it carries (Wong, *Theory of Ground
/// Vehicles*, table 1.3: at most 0.9).
const GRIP: f64 = 1.0;
/// Share of the cells from which they are the rule, and another unit or robot the reason.
const MOST_SHARE: f64 = 0.5;
/// Share of the cells within that may be as large as half of what is possible.
const NEAR_SHARE: f64 = 0.1;
/// Voltages of a battery over its nominal one, from empty to charged: of lithium cells 0.68 to 1.17, of lead 0.85 to 1.25.
pub(super) const VOLTAGES: [f64; 2] = [0.6, 1.3];

/// Air that a robot drives in \[°C\]: the lowest and the highest that were measured on earth (WMO), and some sun.
pub(super) const AIR_C: [f64; 2] = [-90.0, 65.0];
/// Windings that are warmer burn \[°C\]: insulation of class H holds 180, and is rated for no more than 200.
pub(super) const MOST_MOTOR_C: f64 = 200.0;
/// What a motor or the air does not warm by from one reading to the next \[K\]: windings take minutes for it.
const MOST_JUMP_K: f64 = 20.0;

/// Least and greatest value that a channel can have, and how far beyond its neighbours no motion brings it.
struct Bounds {
    range: [f64; 2],
    jump: f64,
    /// Magnitude up to which a robot drives most of the time, where that is less than what it can do.
    usual: Option<f64>,
    words: String,
}

/// Cells that nothing explains but a glitch of the log.
pub(super) fn beyond(robot: &Robot, recording: &Recording) -> Vec<Cells> {
    use Channel::{AmbientTemperature, LeftMotorTemperature, LeftSpeed, RightMotorTemperature, RightSpeed};
    let others = [
        LeftSpeed,
        RightSpeed,
        AmbientTemperature,
        LeftMotorTemperature,
        RightMotorTemperature,
        Channel::Pitch,
        Channel::Roll,
    ];
    others
        .into_iter()
        .chain(power_channels(recording))
        .filter_map(|channel| of_channel(robot, recording, channel))
        .collect()
}

fn of_channel(robot: &Robot, recording: &Recording, channel: Channel) -> Option<Cells> {
    let values = recording.channel(channel)?;
    let bounds = bounds(robot, recording, channel)?;
    let rows: Vec<usize> = recording
        .runs
        .iter()
        .flat_map(|run| run.rows.clone().filter(|row| bounds.is_alone(recording, run, values, *row)))
        .collect();
    let known = values.iter().filter(|value| value.is_finite()).count();
    let is_rare = (rows.len() as f64) < MOST_SHARE * known as f64;
    (!rows.is_empty() && is_rare && !bounds.is_approached(values)).then_some(Cells { channel, rows })
}

impl Bounds {
    /// Whether a tenth of the cells within come near to the bounds, as of another unit or robot: nothing drives at them all the time.
    fn is_approached(&self, values: &[f64]) -> bool {
        let Some(usual) = self.usual else { return false };
        let within = || values.iter().filter(|value| self.is_within(**value));
        let near = within().filter(|value| value.abs() > usual).count();
        near as f64 > NEAR_SHARE * within().count() as f64
    }

    fn is_within(&self, value: f64) -> bool {
        (self.range[0]..=self.range[1]).contains(&value)
    }

    /// Whether a cell lies outside while cells before and behind it lie within, and far from them. A value that is repeated may last longer.
    fn is_alone(&self, recording: &Recording, run: &Run, values: &[f64], row: usize) -> bool {
        let value = values[row];
        if !value.is_finite() || self.is_within(value) {
            return false;
        }
        let is_repeated = |other: usize| run.rows.contains(&other) && values[other] == value;
        let lasts = is_repeated(row + 1) || row.checked_sub(1).is_some_and(is_repeated);
        let t_s = &recording.t_s;
        let is_near = |other: &usize| lasts || (t_s[*other] - t_s[row]).abs() <= near_s(run);
        let is_within = |other: &usize| self.is_within(values[*other]);
        let before = (run.rows.start..row).rev().take_while(is_near).find(is_within);
        let after = (row + 1..run.rows.end).take_while(is_near).find(is_within);
        let neighbours = [before, after].map(|other| other.map(|other| values[other]));
        // At an end of a drive one side tells.
        let is_end = row == run.rows.start || row + 1 == run.rows.end || lasts;
        let sides = neighbours.iter().flatten().count();
        (sides == 2 || sides == 1 && is_end)
            && neighbours.iter().flatten().all(|other| (value - other).abs() > self.jump)
    }
}

/// The greatest power of each side: tyres that hold with the weight of the whole robot at its greatest speed (eq. 2) \[W\].
fn most_side_w(robot: &Robot) -> Sides<f64> {
    let force_n = GRIP * robot.mass_kg * STANDARD_GRAVITY_MPS2;
    let rim_mps = FASTEST * robot.max_wheel_speed_mps;
    let driving = |motor: &model::robot::Motor| {
        let motor = motor.at_temperature(&robot.motors, robot.motors.reference_temperature_c);
        motor.printed_power_w(force_n, rim_mps) + robot.drive_electronics_w
    };
    Sides { left: driving(&robot.motors.left), right: driving(&robot.motors.right) }
}

fn bounds(robot: &Robot, recording: &Recording, channel: Channel) -> Option<Bounds> {
    let about = |most: f64, words: String| Bounds {
        range: [-most, most],
        jump: most,
        usual: Some(most / 2.0),
        words,
    };
    let volts = robot.battery.as_ref().map(|battery| battery.nominal_voltage_v);
    let most_w = most_side_w(robot);
    let total_w = most_w.sum() + robot.hotel_power_w;
    let said_w = |watts: f64| {
        format!(
            "tyres that hold with the robot's whole weight at its greatest speed take {watts:.0} W at most"
        )
    };
    Some(match channel {
        Channel::LeftSpeed | Channel::RightSpeed => {
            let most_mps = FASTEST * robot.max_wheel_speed_mps;
            let words = format!("the robot's file has {:.2} m/s at most", robot.max_wheel_speed_mps);
            Bounds { usual: None, ..about(most_mps, words) }
        }
        Channel::LeftPower => about(most_w.left, said_w(most_w.left)),
        Channel::RightPower => about(most_w.right, said_w(most_w.right)),
        Channel::Power => about(total_w, said_w(total_w)),
        Channel::Current if recording.power_form() == Some(PowerForm::CurrentAndVoltage) => {
            let most_a = total_w / (VOLTAGES[0] * volts?);
            about(most_a, format!("{} or {most_a:.0} A", said_w(total_w)))
        }
        Channel::Voltage => {
            let volts = volts?;
            let [low_v, high_v] = VOLTAGES.map(|share| share * volts);
            let words = format!(
                "the battery of the robot's file has {volts:.0} V, {low_v:.1} to {high_v:.1} V from empty to charged"
            );
            Bounds { range: [low_v, high_v], jump: volts - low_v, usual: None, words }
        }
        Channel::AmbientTemperature | Channel::LeftMotorTemperature | Channel::RightMotorTemperature => {
            let words = format!("nothing drives outside {:.0} to {MOST_MOTOR_C:.0} °C", AIR_C[0]);
            Bounds { range: [AIR_C[0], MOST_MOTOR_C], jump: MOST_JUMP_K, usual: None, words }
        }
        Channel::Pitch | Channel::Roll => {
            about(FRAC_PI_2, "no robot drives with its nose or a side farther than upright".to_owned())
        }
        Channel::LeftMotorCurrent | Channel::RightMotorCurrent => {
            let motor =
                if channel == Channel::LeftMotorCurrent { &robot.motors.left } else { &robot.motors.right };
            let most_a = GRIP * robot.mass_kg * STANDARD_GRAVITY_MPS2 / motor.force_n_per_a?;
            about(most_a, format!("tyres that hold with the robot's whole weight take {most_a:.0} A at most"))
        }
        _ => return None,
    })
}

/// A number with as many decimals as a person reads.
fn digits(value: f64) -> f64 {
    (1e3 * value).round() / 1e3
}

/// A doubt about cells beyond the physics of the robot, with the energies with and without them.
pub(super) fn doubt(
    robot: &Robot,
    recording: &Recording,
    cells: &[Cells],
    predicted_j: impl Fn(&Recording) -> Option<f64>,
) -> Option<Doubt> {
    let of_cells = |one: &Cells| {
        let values = recording.channel(one.channel)?;
        let all = || one.rows.iter().map(|row| values[*row]);
        let first = all().next()?;
        let farthest = all().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        let reads = match all().all(|value| value == first) {
            true => format!("reads {}", digits(first)),
            false => format!("reads as far as {}", digits(farthest)),
        };
        let Bounds { words, .. } = bounds(robot, recording, one.channel)?;
        let (count, place) = (one.count(recording), one.first(recording));
        Some(format!("`{}` {reads} in {count}, first in {place}, and {words}", one.channel.name()))
    };
    let said: Vec<String> = cells.iter().filter_map(of_cells).collect();
    let rest = without(recording, cells);
    let is_power = |one: &Cells| power_channels(recording).contains(&one.channel);
    let recorded = cells.iter().any(is_power).then(|| recorded_j(recording).zip(recorded_j(&rest))).flatten();
    let predicted = cells
        .iter()
        .any(|one| !is_power(one))
        .then(|| predicted_j(recording).zip(predicted_j(&rest)))
        .flatten();
    let told =
        [("recorded", recorded), ("predicted", predicted)].into_iter().filter_map(|(which, energies)| {
            let [with, left] = <[f64; 2]>::from(energies?).map(|joules| joules / 1e3);
            Some(format!("; {which} energy is {with:.1} kJ with them and {left:.1} kJ without"))
        });
    let energies: String = told.collect();
    (!said.is_empty()).then(|| Doubt {
        name: "beyond_the_robot",
        statement: format!("{}{energies}", said.join("; ")),
        cure: "leave these cells empty, which makes gaps of them (a fill value, a lost byte or a counter that was reset is no measurement; a counter \
               that comes round needs `wraps_at` in a map)"
            .to_owned(),
    })
}
