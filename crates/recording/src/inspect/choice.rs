//! Which of several columns that may be one channel is taken.
//!
//! Wheels of one side are averaged where their names differ by the place of the wheel alone, motors of one side are added up so. Other
//! columns that may be the same channel are never mixed: the better-named is taken, and the others are said.

use serde_json::{Value, json};

use super::{
    InspectedField,
    guess::{LEFT, RIGHT, words},
};
use crate::{Channel, Quantity};

/// Words that tell where on a side something is.
const PLACES: &[&str] = &["front", "rear", "back", "mid", "middle", "f", "b", "m"];

/// Words that name what is meant, by quantity.
const BETTER: [(Quantity, &[&str]); 4] = [
    (Quantity::Speed, &["wheel", "rim"]),
    (Quantity::Power, &["battery", "bat", "batt", "total", "pack"]),
    (Quantity::Current, &["battery", "bat", "batt", "total", "pack", "discharge"]),
    (Quantity::Voltage, &["battery", "bat", "batt", "total", "pack"]),
];

/// Words that name something before a gear, or a part of a whole.
const WORSE: &[&str] = &["motor", "shaft", "cell", "raw", "min", "max", "avg", "mean"];

/// How several columns of one kind are one channel; `None` where they are not.
fn combination(channel: Channel) -> Option<&'static str> {
    match channel {
        Channel::LeftSpeed | Channel::RightSpeed => Some("mean"),
        Channel::LeftMotorTemperature | Channel::RightMotorTemperature => Some("mean"),
        Channel::LeftPower | Channel::RightPower => Some("sum"),
        Channel::LeftMotorCurrent | Channel::RightMotorCurrent => Some("sum"),
        _ => None,
    }
}

/// Words of a name but for side and place: columns that share them are of one kind.
fn kind(name: &str) -> Vec<String> {
    let is_place = |word: &String| [LEFT, RIGHT, PLACES].iter().any(|any| any.contains(&word.as_str()));
    words(name).into_iter().filter(|word| !is_place(word)).collect()
}

/// How well a name says that it is a channel.
fn rank(channel: Channel, name: &str) -> (bool, i32) {
    let words = words(name);
    let of = |any: &[&str]| words.iter().filter(|word| any.contains(&word.as_str())).count().min(1) as i32;
    let better = BETTER.iter().find(|(quantity, _)| *quantity == channel.quantity());
    (name == channel.name(), better.map_or(0, |(_, any)| of(any)) - of(WORSE))
}

/// Settles which columns become which channel: those that are left out lose their channel and say why. Returns the sources of the map.
pub(super) fn sources(fields: &mut [InspectedField]) -> Vec<Value> {
    let mut sources = Vec::new();
    for channel in Channel::all() {
        let mut all: Vec<usize> =
            (0..fields.len()).filter(|at| fields[*at].channel.as_deref() == Some(channel.name())).collect();
        // Of equals the first in the file stays first.
        all.sort_by_key(|at| std::cmp::Reverse(rank(channel, &fields[*at].name)));
        let Some(&best) = all.first() else { continue };
        let (kind_of_best, unit) = (kind(&fields[best].name), fields[best].unit.clone());
        let combine = combination(channel);
        let is_like = |at: &usize| {
            combine.is_some() && fields[*at].unit == unit && kind(&fields[*at].name) == kind_of_best
        };
        let (mut taken, left): (Vec<usize>, Vec<usize>) =
            all.iter().partition(|at| **at == best || is_like(at));
        taken.sort_unstable();
        let names: Vec<String> = taken.iter().map(|at| fields[*at].name.clone()).collect();
        let mut source = json!({"channel": channel.name(), "columns": names, "unit": unit});
        if let Some(combine) = combine.filter(|_| names.len() > 1) {
            if combine != "mean" {
                source["combine"] = json!(combine);
            }
            let said = if combine == "sum" { "added up" } else { "averaged" };
            for at in taken {
                let field = &mut fields[at];
                field.reason = format!("{}; {said} over {}", field.reason, names.join(", "));
            }
        }
        let rank_of_best = rank(channel, &fields[best].name);
        for at in left {
            let is_better = rank_of_best > rank(channel, &fields[at].name);
            let why = if is_better { "which is named better" } else { "which comes first: choose" };
            fields[at].reason =
                format!("left out: it may be {channel} too, but `{}` was taken, {why}", names[0]);
            (fields[at].channel, fields[at].unit) = (None, None);
        }
        sources.push(source);
    }
    sources
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::guess::guess;

    fn chosen(names: &[&str]) -> (Vec<Value>, Vec<InspectedField>) {
        let field = |name: &&str| {
            let found = guess(name, 5.0);
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
        (sources(&mut fields), fields)
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
            (&["left_wheel_rpm", "left_wheel_radps"], r#""v_left_mps": ["left_wheel_rpm"]"#),
            (&["battery_current_1", "battery_current_2"], r#""current_a": ["battery_current_1"]"#),
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
