//! What a column is, guessed from its name and the range of its numbers.

use super::{
    name::Name,
    numbers::Seen,
    spelled_unit::{SpelledUnit, spelled_unit},
    vocabulary::{DEVICES, KNOWN, LEFT, OTHER_QUANTITIES, RIGHT, Words},
};
use crate::{Channel, Quantity, units::si_unit};

/// What a column may be.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Guess {
    pub(super) channel: Channel,
    pub(super) unit: &'static str,
    pub(super) reason: String,
}

/// How the words of a channel fit a name.
enum Fit {
    /// Not at all.
    Not,
    /// The channel is named, and so is what rules it out.
    Refused(String),
    /// With the unit that the name says, if it says one.
    Fits(Option<&'static str>),
}

/// What a column of a name and of numbers may be, or why it is none.
pub(super) fn guess(text: &str, seen: &Seen) -> Result<Guess, String> {
    if let Some(channel) = Channel::from_name(text) {
        let unit = si_unit(channel.quantity());
        return Ok(Guess { channel, unit, reason: "its name is that of the channel".into() });
    }
    let name = Name::new(text);
    let mut refused = None;
    for known in &KNOWN {
        match fit(known, text, &name) {
            Fit::Not => {}
            Fit::Refused(reason) => refused = refused.or(Some(reason)),
            Fit::Fits(unit) => return Ok(guessed(known.channel, unit, &name, seen)),
        }
    }
    Err(refused.unwrap_or_else(|| nothing(&name)))
}

fn fit(known: &Words, text: &str, name: &Name) -> Fit {
    let Words { channel, quantity: own, of, none } = known;
    if !(of.is_empty() || name.has(of)) || none.iter().any(|words| name.has(words)) {
        return Fit::Not;
    }
    let quantity = channel.quantity();
    let unit = spelled_unit(text, name, quantity);
    let at = name.last(own);
    let is_named = at.is_some()
        || match &unit {
            // A small letter at the end may be any symbol, as `w` an angular rate.
            SpelledUnit::Known(unit) if !of.is_empty() => {
                unit.len() > 1 || name.ending.len() > 1 || name.ending.chars().all(char::is_uppercase)
            }
            SpelledUnit::Unknown(_) => quantity == Quantity::Speed && name.has(DEVICES),
            _ => false,
        };
    if !is_named {
        return Fit::Not;
    }
    let is_angle =
        |word: &str| quantity == Quantity::Angle && ["angle", "ang", "pos", "position"].contains(&word);
    let behind = name.words.iter().skip(at.map_or(0, |at| at + 1));
    let other = behind.map(String::as_str).find(|word| OTHER_QUANTITIES.contains(word) && !is_angle(word));
    match (unit, other) {
        (SpelledUnit::Unknown(unit), _) => Fit::Refused(format!(
            "left out: its name says `{unit}`, which is no unit that maps know of {channel}; convert it, or name it with a `scale`"
        )),
        (SpelledUnit::Another(unit), _) => Fit::Refused(format!(
            "left out: its name ends in `{unit}`, which is the unit of another quantity than {channel}: choose"
        )),
        (_, Some(word)) => {
            Fit::Refused(format!("its name says `{word}`, which is another quantity than {channel}"))
        }
        (SpelledUnit::Known(unit), None) => Fit::Fits(Some(unit)),
        (SpelledUnit::Unsaid, None) => Fit::Fits(None),
    }
}

/// Why a name tells nothing.
fn nothing(name: &Name) -> String {
    let is_at_wheel = (name.has(LEFT) || name.has(RIGHT)) && name.has(DEVICES) && !name.has(OTHER_QUANTITIES);
    if is_at_wheel {
        "left out: its name says where it is and no quantity: name its channel and unit in the map".into()
    } else {
        "nothing in its name is known".into()
    }
}

fn guessed(channel: Channel, unit: Option<&'static str>, name: &Name, seen: &Seen) -> Guess {
    let quantity = channel.quantity();
    let (unit, why) = match unit {
        Some(unit) => (unit, "its unit stands in its name".to_owned()),
        None if quantity == Quantity::Current && is_mavlinks(name) && seen.is_whole => {
            ("cA", "it is MAVLink's field of that name, in whole hundredths of an ampere".to_owned())
        }
        None if quantity == Quantity::Speed && is_of_joint_states(name) => {
            ("rad/s", "it is of a `JointState`, whose wheels turn in rad/s".to_owned())
        }
        None => by_range(quantity, seen.greatest),
    };
    Guess { channel, unit, reason: format!("by its name; {why}") }
}

/// Whether a name is that of a field of `sensor_msgs/JointState`, which has velocities of joints that turn in rad/s.
fn is_of_joint_states(name: &Name) -> bool {
    name.words.windows(2).any(|pair| pair[0] == "joint" && ["states", "state"].contains(&pair[1].as_str()))
}

/// Whether a name is that of the current in MAVLink's `SYS_STATUS` and `BATTERY_STATUS` (`common.xml`: `current_battery`, cA).
fn is_mavlinks(name: &Name) -> bool {
    name.words.ends_with(&["current".to_owned(), "battery".to_owned()])
}

/// The unit that a range of numbers asks for.
fn by_range(quantity: Quantity, greatest: f64) -> (&'static str, String) {
    /// Faster than any skid-steered robot's rim, and farther over than any drives.
    const FASTEST_MPS: f64 = 6.0;
    let at_most = |unit| (unit, format!("numbers go to {greatest:.4}"));
    match quantity {
        Quantity::Speed if greatest > 60.0 => at_most("rpm"),
        Quantity::Speed if greatest > FASTEST_MPS => at_most("rad/s"),
        Quantity::Angle if greatest > 2.0 * std::f64::consts::PI + 0.1 => at_most("deg"),
        Quantity::AngularRate if greatest > 10.0 => at_most("deg/s"),
        Quantity::Voltage if greatest > 1000.0 => at_most("mV"),
        Quantity::Current if greatest > 1000.0 => at_most("mA"),
        Quantity::Power if greatest > 50_000.0 => at_most("mW"),
        _ => (si_unit(quantity), format!("numbers go to {greatest:.4}")),
    }
}

/// The unit of a column of time that its name says, where the name may be one of a time.
pub(crate) fn time_unit(name: &str) -> Option<Option<&'static str>> {
    let name = Name::new(name);
    let has = |any: &[&str]| name.has(any);
    if !has(&["t", "time", "stamp", "timestamp", "secs", "seconds", "elapsed", "clock"]) {
        return None;
    }
    let units = [
        ("ns", &["ns", "nsec", "nsecs", "nanosec", "nanos", "nanoseconds"][..]),
        ("us", &["us", "µs", "micros", "usec", "microseconds"]),
        ("ms", &["ms", "millis", "msec", "milliseconds"]),
        ("s", &["s", "sec", "secs", "seconds"]),
        ("min", &["min", "mins", "minutes"]),
        ("h", &["h", "hr", "hrs", "hours"]),
        ("d", &["days"]),
    ];
    Some(units.iter().find(|(_, any)| has(any)).map(|(unit, _)| *unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_ranges_tell_channels_and_units() {
        let of =
            |name: &str, greatest: f64| guess(name, &Seen::up_to(greatest)).ok().map(|g| (g.channel, g.unit));
        assert_eq!(of("Left wheel [rad/s]", 9.0), Some((Channel::LeftSpeed, "rad/s")));
        assert_eq!(of("fr_rpm", 80.0), Some((Channel::RightSpeed, "rpm")));
        assert_eq!(of("wheelSpeedLeft", 0.9), Some((Channel::LeftSpeed, "m/s")));
        assert_eq!(of("wheelSpeedLeft", 140.0), Some((Channel::LeftSpeed, "rpm")));
        assert_eq!(of("left_motor_current_mA", 9000.0), Some((Channel::LeftMotorCurrent, "mA")));
        assert_eq!(of("battery_voltage", 25_100.0), Some((Channel::Voltage, "mV")));
        assert_eq!(of("Pitch (deg)", 12.0), Some((Channel::Pitch, "deg")));
        assert_eq!(of("pitch", 0.2), Some((Channel::Pitch, "rad")));
        assert_eq!(of("P_bat [kW]", 0.4), Some((Channel::Power, "kW")));
        assert_eq!(of("power_left_w", 90.0), Some((Channel::LeftPower, "W")));
        assert_eq!(of("left_wheel_rad_s", 3.0), Some((Channel::LeftSpeed, "rad/s")));
        assert_eq!(of("wheel right m/s", 3.0), Some((Channel::RightSpeed, "m/s")));
        assert_eq!(of("V_bat", 25.0), Some((Channel::Voltage, "V")));
        assert_eq!(of("LeftMotorSpeed", 1.0), Some((Channel::LeftSpeed, "m/s")));
        assert_eq!([of("w_left", 1.0), of("left_w", 1.0), of("left_wheel_V", 1.0)], [None; 3]);
        assert_eq!(of("left_wheel_cmd", 1.0), None);
        assert_eq!(of("note", 1.0), None);
        assert_eq!(
            [time_unit("Stamp (ns)"), time_unit("stamp_ms"), time_unit("t_s"), time_unit("speed")],
            [Some(Some("ns")), Some(Some("ms")), Some(Some("s")), None]
        );
        assert_eq!([time_unit("time"), time_unit("time_min")], [Some(None), Some(Some("min"))]);
    }

    #[test]
    fn units_of_other_quantities_and_unknown_ones_are_left_out() {
        for name in [
            "power_Wh",
            "power_hp",
            "vel_left_kn",
            "left_wheel_ticks",
            "battery_current_Ah",
            "left wheel (fps)",
        ] {
            let refused = guess(name, &Seen::up_to(3.0)).unwrap_err();
            assert!(refused.contains("no unit that maps know"), "{name}: {refused}");
        }
        for name in ["cpu_power_W", "solar_power_W", "charge_current_A"] {
            assert!(guess(name, &Seen::up_to(3.0)).is_err(), "{name}");
        }
        assert_eq!(guess("motor_temp_left_F", &Seen::up_to(77.0)).unwrap().unit, "degF");
        assert_eq!(guess("ambient_temp_K", &Seen::up_to(290.0)).unwrap().unit, "K");
        assert_eq!(guess("discharge_current_A", &Seen::up_to(9.0)).unwrap().channel, Channel::Current);
    }
}
