//! Which of several columns that may be one channel is taken.
//!
//! Wheels of one side are averaged where their names differ by the place of the wheel alone, motors of one side are added up so, and so are
//! packs whose names differ by a number alone. Other columns that may be the same channel are never mixed: the better-named is taken, and of
//! equally good ones none, which is said.

use serde_json::{Value, json};

use super::{
    InspectedField,
    name::Name,
    vocabulary::{LEFT, RIGHT},
};
use crate::{Channel, Quantity};

/// Words that tell where on a side something is.
const PLACES: &[&str] = &["front", "rear", "back", "mid", "middle", "f", "b", "m"];

/// Words that name what is meant, by quantity.
const BETTER: [(Quantity, &[&str]); 6] = [
    (Quantity::Speed, &["wheel", "rim"]),
    (Quantity::Power, &["battery", "bat", "batt", "total", "pack"]),
    (Quantity::Current, &["battery", "bat", "batt", "total", "pack", "discharge"]),
    (Quantity::Voltage, &["battery", "bat", "batt", "total", "pack"]),
    (Quantity::Angle, &["imu", "ahrs", "body", "base", "robot", "chassis"]),
    (Quantity::AngularRate, &["imu", "ahrs", "body", "base", "robot", "chassis"]),
];

/// Words that name something before a gear, a part of a whole, or a summary of it.
const WORSE: &[&str] = &["motor", "shaft", "cell", "raw", "min", "max", "avg", "mean"];

/// Words of what a battery feeds: its current or power is a part of the battery's.
const FED: &[&str] = &[
    "motor", "wheel", "drive", "driver", "servo", "mcu", "user", "port", "aux", "usb", "lidar", "logic",
    "computer", "pc", "jetson", "router", "fan",
];

/// Words of sensors that are held otherwise than the body.
const OTHER_SENSORS: &[&str] = &["camera", "cam", "lidar", "laser", "head", "radar", "gps"];

/// How several columns of one kind are one channel; `None` where they are not.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Together {
    /// The mean of what stands at places of one side.
    MeanOfPlaces,
    /// The sum of what stands at places of one side.
    SumOfPlaces,
    /// The sum of what is numbered.
    SumOfNumbers,
    /// The mean of what is numbered, as voltages of packs side by side, which are one.
    MeanOfNumbers,
}

impl Together {
    fn of(channel: Channel) -> Option<Together> {
        match channel {
            Channel::LeftSpeed | Channel::RightSpeed => Some(Together::MeanOfPlaces),
            Channel::LeftMotorTemperature | Channel::RightMotorTemperature => Some(Together::MeanOfPlaces),
            Channel::LeftPower | Channel::RightPower => Some(Together::SumOfPlaces),
            Channel::LeftMotorCurrent | Channel::RightMotorCurrent => Some(Together::SumOfPlaces),
            Channel::Power | Channel::Current => Some(Together::SumOfNumbers),
            Channel::Voltage => Some(Together::MeanOfNumbers),
            _ => None,
        }
    }

    fn is_sum(self) -> bool {
        matches!(self, Together::SumOfPlaces | Together::SumOfNumbers)
    }

    /// Whether two columns of one channel are of one kind.
    fn joins(self, one: &InspectedField, other: &InspectedField) -> bool {
        let are_alike = one.unit == other.unit && kind(&one.name) == kind(&other.name);
        let numbered = |field: &InspectedField| field.name.bytes().any(|byte| byte.is_ascii_digit());
        let is_rail = |field: &InspectedField| Name::new(&field.name).is_of_rail;
        let are_numbered = [one, other].into_iter().all(|field| numbered(field) && !is_rail(field));
        match self {
            Together::MeanOfPlaces | Together::SumOfPlaces => are_alike,
            Together::SumOfNumbers => are_alike && are_numbered,
            // In parallel they are one voltage.
            Together::MeanOfNumbers => {
                let meet = |a: [f64; 2], b: [f64; 2]| a[0] <= b[1] && b[0] <= a[1];
                are_alike && are_numbered && one.range.zip(other.range).is_some_and(|(a, b)| meet(a, b))
            }
        }
    }
}

/// Words of a name but for side and place: columns that share them are of one kind.
fn kind(name: &str) -> Vec<String> {
    let is_place = |word: &String| [LEFT, RIGHT, PLACES].iter().any(|any| any.contains(&word.as_str()));
    Name::new(name).words.into_iter().filter(|word| !is_place(word)).collect()
}

/// Whether a column is of a part of what the battery gives.
fn is_fed(channel: Channel, name: &Name) -> bool {
    matches!(channel, Channel::Power | Channel::Current | Channel::Voltage)
        && (name.has(FED) || name.is_of_rail)
}

/// How well a name says that it is a channel.
fn rank(channel: Channel, name: &str) -> (bool, i32) {
    let is_contracts = name == channel.name();
    let name = Name::new(name);
    let better = BETTER.iter().find(|(quantity, _)| *quantity == channel.quantity());
    let is_angular = matches!(channel.quantity(), Quantity::Angle | Quantity::AngularRate);
    let is_worse = name.has(WORSE) || is_fed(channel, &name) || (is_angular && name.has(OTHER_SENSORS));
    (is_contracts, i32::from(better.is_some_and(|(_, any)| name.has(any))) - i32::from(is_worse))
}

/// The sources of a map, and what has to be said of them.
pub(super) struct Chosen {
    pub(super) sources: Vec<Value>,
    pub(super) notes: Vec<String>,
}

/// Settles which columns become which channel: those that are left out lose their channel and say why.
pub(super) fn sources(fields: &mut [InspectedField]) -> Chosen {
    let mut chosen = Chosen { sources: Vec::new(), notes: Vec::new() };
    for channel in Channel::all() {
        let all: Vec<usize> =
            (0..fields.len()).filter(|at| fields[*at].channel.as_deref() == Some(channel.name())).collect();
        let Some(best_rank) = all.iter().map(|at| rank(channel, &fields[*at].name)).max() else { continue };
        let is_best = |at: &usize| rank(channel, &fields[*at].name) == best_rank;
        let best: Vec<usize> = moving(fields, all.iter().copied().filter(is_best).collect());
        let together = Together::of(channel);
        let joins = |at: &usize| {
            *at == best[0] || together.is_some_and(|together| together.joins(&fields[best[0]], &fields[*at]))
        };
        let names: Vec<String> = best.iter().map(|at| fields[*at].name.clone()).collect();
        if !best.iter().all(joins) {
            leave_out(
                fields,
                &all,
                &format!("{} may be {channel}, each as well as the others: choose", quoted(&names)),
            );
            continue;
        }
        let better = format!("it may be {channel} too, but `{}` was taken, which is named better", names[0]);
        leave_out(fields, &all.iter().copied().filter(|at| !best.contains(at)).collect::<Vec<_>>(), &better);
        chosen.take(fields, channel, &best);
    }
    chosen
}

impl Chosen {
    /// Makes a source of columns that are one channel.
    fn take(&mut self, fields: &mut [InspectedField], channel: Channel, best: &[usize]) {
        let names: Vec<String> = best.iter().map(|at| fields[*at].name.clone()).collect();
        let mut source = json!({"channel": channel.name(), "columns": names, "unit": fields[best[0]].unit});
        let together = Together::of(channel).filter(|_| names.len() > 1);
        if let Some(together) = together {
            if together.is_sum() {
                source["combine"] = json!("sum");
            }
            let said = if together.is_sum() { "added up" } else { "averaged" };
            for at in best {
                let field = &mut fields[*at];
                field.reason = format!("{}; {said} over {}", field.reason, names.join(", "));
            }
            if matches!(together, Together::SumOfNumbers | Together::MeanOfNumbers) {
                self.notes.push(format!(
                    "{channel}: {} differ by a number alone: they are taken for parts side by side and {said}; take one if the same flows through all",
                    quoted(&names)
                ));
            }
        }
        if best.iter().all(|at| is_fed(channel, &Name::new(&fields[*at].name))) && channel != Channel::Voltage
        {
            let parts: Vec<String> =
                names.iter().map(|name| format!("`{name}` is of a part of what the battery feeds")).collect();
            self.notes.push(format!(
                "{channel}: {}, since no column is named as the battery's; what else it feeds is missing",
                parts.join(", ")
            ));
        }
        self.sources.push(source);
    }
}

/// Of several those that move, if any do: of two that are named alike one that stands still is no measurement.
fn moving(fields: &[InspectedField], all: Vec<usize>) -> Vec<usize> {
    let moves = |at: &usize| fields[*at].range.is_none_or(|[low, high]| low < high);
    let moving: Vec<usize> = all.iter().copied().filter(moves).collect();
    let alike = |at: &usize| kind(&fields[*at].name) == kind(&fields[all[0]].name);
    if moving.is_empty() || all.iter().all(alike) { all } else { moving }
}

fn leave_out(fields: &mut [InspectedField], at: &[usize], why: &str) {
    for at in at {
        let field = &mut fields[*at];
        field.reason = format!("left out: {why}");
        (field.channel, field.unit) = (None, None);
    }
}

fn quoted(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    quoted.join(" and ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::{guess::guess, numbers::Seen};

    fn chosen(names: &[&str]) -> (Vec<Value>, Vec<InspectedField>) {
        let field = |name: &&str| {
            let found = guess(name, &Seen::up_to(5.0));
            InspectedField {
                name: (*name).to_owned(),
                samples: 100,
                rate_hz: None,
                range: None,
                channel: found.as_ref().ok().map(|found| found.channel.name().to_owned()),
                unit: found.as_ref().ok().map(|found| found.unit.to_owned()),
                reason: found.map_or_else(|reason| reason, |found| found.reason),
            }
        };
        let mut fields: Vec<InspectedField> = names.iter().map(field).collect();
        (sources(&mut fields).sources, fields)
    }

    fn columns(names: &[&str]) -> Vec<String> {
        let (sources, _) = chosen(names);
        sources.iter().map(|source| format!("{}: {}", source["channel"], source["columns"])).collect()
    }

    #[test]
    fn unlike_columns_are_never_averaged() {
        for (names, taken) in [
            (&["power", "power_Wh"][..], r#""power_w": ["power"]"#),
            (
                &["cpu_power_W", "power_W", "battery_power_W", "solar_power_W"],
                r#""power_w": ["battery_power_W"]"#,
            ),
            (&["charge_current_A", "discharge_current_A"], r#""current_a": ["discharge_current_A"]"#),
            (&["motor_left_rpm", "wheel_left_rpm"], r#""v_left_mps": ["wheel_left_rpm"]"#),
            (&["v_left_mps", "left_wheel_speed"], r#""v_left_mps": ["v_left_mps"]"#),
        ] {
            assert_eq!(columns(names), [taken]);
            let (_, fields) = chosen(names);
            let left: Vec<_> = fields.iter().filter(|field| field.channel.is_none()).collect();
            assert!(left.len() == names.len() - 1, "{left:?}");
            assert!(left.iter().all(|field| field.reason != "by its name"), "{left:?}");
        }
    }

    #[test]
    fn of_equals_none_is_taken() {
        for names in [
            ["left_wheel_rpm", "left_wheel_radps"],
            ["left_speed", "left_velocity"],
            ["current_12v", "current_24v"],
        ] {
            let (sources, fields) = chosen(&names);
            assert!(sources.is_empty(), "{sources:?}");
            let both =
                |field: &InspectedField| names.iter().all(|name| field.reason.contains(&format!("`{name}`")));
            assert!(
                fields.iter().all(|field| field.reason.starts_with("left out") && both(field)),
                "{fields:?}"
            );
        }
    }

    #[test]
    fn wheels_of_a_side_are_averaged_and_motors_of_a_side_added_up() {
        assert_eq!(columns(&["FL_rpm", "RL_rpm"]), [r#""v_left_mps": ["FL_rpm","RL_rpm"]"#]);
        assert_eq!(
            columns(&["front_left_wheel_vel", "rear_left_wheel_vel", "left_motor_vel"]),
            [r#""v_left_mps": ["front_left_wheel_vel","rear_left_wheel_vel"]"#]
        );
        let (sources, _) = chosen(&["fl_motor_current_A", "rl_motor_current_A"]);
        assert_eq!(sources[0]["combine"], "sum");
    }
}
