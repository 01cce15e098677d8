//! What a column is, guessed from its name and the range of its numbers.

use crate::{Channel, Quantity, units::si_unit};

/// What a column may be.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Guess {
    pub(crate) channel: Channel,
    pub(crate) unit: &'static str,
    pub(crate) reason: String,
}

/// Words that a channel's name may be made of; all groups must be met, and none of the last.
struct Words {
    channel: Channel,
    all: &'static [&'static [&'static str]],
    none: &'static [&'static str],
}

pub(super) const LEFT: &[&str] = &["left", "l", "fl", "rl", "lf", "lr", "lhs"];
pub(super) const RIGHT: &[&str] = &["right", "r", "fr", "rr", "rf", "rhs"];
const SPEED: &[&str] = &["speed", "vel", "velocity", "rpm", "v", "wheel", "encoder"];
const POWER: &[&str] = &["power", "watt", "watts", "w", "p", "pwr"];
const CURRENT: &[&str] = &["current", "amp", "amps", "a", "ma", "i"];
/// What takes or gives power beside the battery of the drive, and what is asked of it.
const NO_BATTERY: &[&str] = &[
    "cmd", "command", "target", "setpoint", "desired", "limit", "left", "right", "cpu", "gpu", "solar",
    "charge", "charger", "charging",
];
const COMMAND: &[&str] = &[
    "cmd",
    "command",
    "target",
    "setpoint",
    "desired",
    "temp",
    "temperature",
    "voltage",
    "position",
    "accel",
];

const KNOWN: [Words; 16] = [
    Words { channel: Channel::LeftMotorTemperature, all: &[LEFT, &["temp", "temperature"]], none: &["cmd"] },
    Words {
        channel: Channel::RightMotorTemperature,
        all: &[RIGHT, &["temp", "temperature"]],
        none: &["cmd"],
    },
    Words { channel: Channel::LeftPower, all: &[LEFT, &["power", "watt", "watts", "pwr"]], none: COMMAND },
    Words { channel: Channel::RightPower, all: &[RIGHT, &["power", "watt", "watts", "pwr"]], none: COMMAND },
    Words {
        channel: Channel::LeftMotorCurrent,
        all: &[LEFT, &["current", "amp", "amps", "ma"]],
        none: COMMAND,
    },
    Words {
        channel: Channel::RightMotorCurrent,
        all: &[RIGHT, &["current", "amp", "amps", "ma"]],
        none: COMMAND,
    },
    Words { channel: Channel::LeftSpeed, all: &[LEFT, SPEED], none: COMMAND },
    Words { channel: Channel::RightSpeed, all: &[RIGHT, SPEED], none: COMMAND },
    Words {
        channel: Channel::YawRate,
        all: &[&["yaw", "gyro", "angular"], &["rate", "z", "gz", "dps", "rad"]],
        none: COMMAND,
    },
    Words { channel: Channel::Heading, all: &[&["heading", "yaw", "bearing"]], none: &["rate", "cmd"] },
    Words { channel: Channel::Pitch, all: &[&["pitch"]], none: &["rate", "cmd"] },
    Words { channel: Channel::Roll, all: &[&["roll"]], none: &["rate", "cmd"] },
    Words {
        channel: Channel::AmbientTemperature,
        all: &[&["ambient", "air"], &["temp", "temperature", "c"]],
        none: &[],
    },
    Words {
        channel: Channel::Power,
        all: &[POWER, &["battery", "bat", "batt", "total", "power", "pack", "watt", "watts"]],
        none: NO_BATTERY,
    },
    Words {
        channel: Channel::Current,
        all: &[CURRENT, &["battery", "bat", "batt", "total", "current", "pack", "amps"]],
        none: NO_BATTERY,
    },
    Words {
        channel: Channel::Voltage,
        all: &[
            &["voltage", "volt", "volts", "v", "mv"],
            &["battery", "bat", "batt", "voltage", "pack", "volts", "volt"],
        ],
        none: &["cmd"],
    },
];

/// Spellings of units, by quantity.
const SPELLED: [(Quantity, &str, &[&str]); 24] = [
    (Quantity::Speed, "rpm", &["rpm"]),
    (Quantity::Speed, "rad/s", &["rad/s", "radps", "rad_s", "rads", "rad_per_s", "radpersec"]),
    (Quantity::Speed, "deg/s", &["deg/s", "degps", "deg_s", "dps"]),
    (Quantity::Speed, "km/h", &["km/h", "kmh", "kph"]),
    (Quantity::Speed, "mph", &["mph"]),
    (Quantity::Speed, "mm/s", &["mm/s", "mmps", "mm_s"]),
    (Quantity::Speed, "cm/s", &["cm/s", "cmps", "cm_s"]),
    (Quantity::Speed, "m/s", &["m/s", "mps", "m_s"]),
    (Quantity::AngularRate, "deg/s", &["deg/s", "degps", "deg_s", "dps", "deg"]),
    (Quantity::AngularRate, "rad/s", &["rad/s", "radps", "rad_s", "rads"]),
    (Quantity::Angle, "deg", &["deg", "°", "degrees"]),
    (Quantity::Angle, "mrad", &["mrad"]),
    (Quantity::Angle, "rad", &["rad", "radians"]),
    (Quantity::Power, "kW", &["kw"]),
    (Quantity::Power, "mW", &["mw", "milliwatt", "milliwatts"]),
    (Quantity::Power, "W", &["w", "watt", "watts"]),
    (Quantity::Current, "mA", &["ma", "milliamp", "milliamps"]),
    (Quantity::Current, "A", &["a", "amp", "amps"]),
    (Quantity::Voltage, "mV", &["mv", "millivolt", "millivolts"]),
    (Quantity::Voltage, "V", &["volt", "volts"]),
    (Quantity::Temperature, "K", &["k", "kelvin"]),
    (Quantity::Temperature, "degF", &["f", "degf", "fahrenheit"]),
    (Quantity::Temperature, "degC", &["c", "degc", "celsius"]),
    (Quantity::Length, "m", &["m"]),
];

/// Words of names that say a unit of which no quantity here is measured: energies, charges, counts, and units that maps do not know.
const UNKNOWN_UNITS: [&str; 35] = [
    "wh", "kwh", "mwh", "j", "kj", "joule", "joules", "energy", "ah", "mah", "coulomb", "hp", "bhp", "ps",
    "cv", "va", "dbm", "kn", "kt", "kts", "knot", "knots", "fps", "ftps", "ips", "ua", "percent", "pct",
    "adc", "count", "counts", "tick", "ticks", "pwm", "duty",
];

/// A side of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Left,
    Right,
}

impl Side {
    /// The side that a name says; `None` where it says none or both.
    pub(crate) fn of_name(name: &str) -> Option<Side> {
        let words = words(name);
        let has = |any: &[&str]| words.iter().any(|word| any.contains(&word.as_str()));
        match (has(LEFT), has(RIGHT)) {
            (true, false) => Some(Side::Left),
            (false, true) => Some(Side::Right),
            _ => None,
        }
    }
}

/// Lower-case words of a name, cut at signs, digits and changes of case.
pub(super) fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before_lower = false;
    let mut characters = name.chars().peekable();
    while let Some(character) = characters.next() {
        // A hump of `wheelSpeed`, and no `kW`.
        let is_hump = character.is_uppercase()
            && before_lower
            && characters.peek().is_some_and(|next| next.is_lowercase());
        if !character.is_alphabetic() || is_hump {
            words.push(String::new());
        }
        if let (true, Some(word)) = (character.is_alphabetic(), words.last_mut()) {
            word.extend(character.to_lowercase());
        }
        before_lower = character.is_lowercase();
    }
    words.retain(|word| !word.is_empty());
    words
}

/// What a column of a name and a greatest magnitude may be, or why it is none.
pub(crate) fn guess(name: &str, greatest: f64) -> Result<Guess, String> {
    if let Some(channel) = Channel::from_name(name) {
        let unit = si_unit(channel.quantity());
        return Ok(Guess { channel, unit, reason: "its name is that of the channel".into() });
    }
    let words = words(name);
    let has = |any: &[&str]| words.iter().any(|word| any.contains(&word.as_str()));
    let known = KNOWN.iter().find(|known| known.all.iter().all(|any| has(any)) && !has(known.none));
    let Some(known) = known else { return Err("nothing in its name is known".into()) };
    if let Some(unit) = words.iter().find(|word| UNKNOWN_UNITS.contains(&word.as_str())) {
        return Err(format!(
            "left out: its name says `{unit}`, which is no unit that maps know of {}; convert it, or name it with a `scale`",
            known.channel
        ));
    }
    let quantity = known.channel.quantity();
    let lower = name.to_lowercase();
    // The longer spelling first: `mrad` holds `rad`, and a word of a name is no unit within another.
    let spelled = SPELLED.iter().find(|(of, _, spellings)| {
        *of == quantity
            && spellings.iter().any(|s| {
                if s.len() == 1 {
                    // An `f` before the end is as likely the front.
                    words.last().is_some_and(|last| last == s)
                } else if s.chars().all(char::is_alphabetic) {
                    words.iter().any(|w| w == s)
                } else {
                    lower.contains(s)
                }
            })
    });
    let (unit, why) = match spelled {
        Some((_, unit, _)) => (*unit, "its unit stands in its name".to_owned()),
        None => by_range(quantity, greatest),
    };
    Ok(Guess { channel: known.channel, unit, reason: format!("by its name; {why}") })
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
    let words = words(name);
    let has = |any: &[&str]| words.iter().any(|word| any.contains(&word.as_str()));
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
        let of = |name: &str, greatest: f64| guess(name, greatest).ok().map(|g| (g.channel, g.unit));
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
            let refused = guess(name, 3.0).unwrap_err();
            assert!(refused.contains("no unit that maps know"), "{name}: {refused}");
        }
        for name in ["cpu_power_W", "solar_power_W", "charge_current_A"] {
            assert!(guess(name, 3.0).is_err(), "{name}");
        }
        assert_eq!(guess("motor_temp_left_F", 77.0).unwrap().unit, "degF");
        assert_eq!(guess("ambient_temp_K", 290.0).unwrap().unit, "K");
        assert_eq!(guess("discharge_current_A", 9.0).unwrap().channel, Channel::Current);
    }
}
