//! Words of the names of columns: those of quantities, and those that say that a column is of something else.

use crate::Channel;

/// Words that a channel's name may be made of; all groups must be met, and none of the last.
pub(super) struct Words {
    pub(super) channel: Channel,
    /// Words that name the quantity; a unit of it does too.
    pub(super) quantity: &'static [&'static str],
    /// Words that say of what it is; nothing has to be said where there are none.
    pub(super) of: &'static [&'static str],
    pub(super) none: &'static [&'static [&'static str]],
}

pub(super) const LEFT: &[&str] = &["left", "l", "fl", "rl", "lf", "lr", "lhs"];
pub(super) const RIGHT: &[&str] = &["right", "r", "fr", "rr", "rf", "rhs"];

const SPEED: &[&str] = &["speed", "vel", "velocity", "rpm", "v", "omega", "kph", "mph", "mps"];
const POWER: &[&str] = &["power", "watt", "watts", "w", "p", "pwr"];
const CURRENT: &[&str] = &["current", "amp", "amps", "ampere", "amperes", "a", "i"];
const VOLTAGE: &[&str] = &["voltage", "volt", "volts", "v"];
const TEMPERATURE: &[&str] = &["temp", "temperature"];
const SIDE_POWER: &[&str] = &["power", "watt", "watts", "pwr"];
const SIDE_CURRENT: &[&str] = &["current", "amp", "amps"];

/// What is asked for, and not what is.
const COMMANDS: &[&str] = &[
    "cmd",
    "command",
    "commanded",
    "ref",
    "reference",
    "target",
    "set",
    "setpoint",
    "sp",
    "desired",
    "goal",
    "demand",
    "req",
    "request",
    "requested",
    "limit",
    "error",
    "err",
];
/// What takes or gives power beside the battery of the drive.
const NO_BATTERY: &[&str] = &["left", "right", "cpu", "gpu", "solar", "charge", "charger", "charging"];
/// Quantities of a wheel that are no speed.
const NO_SPEED: &[&str] = &["temp", "temperature", "voltage", "volt", "volts", "accel", "acceleration"];
/// What moves against the body of the robot, so that its angles are none of the robot's.
const NOT_THE_BODY: &[&str] =
    &["gimbal", "ptu", "pan", "tilt", "arm", "mast", "turret", "gripper", "tool", "antenna"];
/// Axes of a gyroscope that are no yaw.
const NO_YAW: &[&str] = &["x", "y", "gx", "gy", "gyrox", "gyroy", "wx", "wy", "pitch", "roll"];
const RATE: &[&str] = &["rate", "gyro", "dps", "vel", "velocity", "speed"];

/// Words that name another quantity or a flag where no word of the channel's own follows: the last word of a name says what it is.
pub(super) const OTHER_QUANTITIES: &[&str] = &[
    "slip",
    "angle",
    "ang",
    "pos",
    "position",
    "odo",
    "dist",
    "distance",
    "travel",
    "effort",
    "torque",
    "accel",
    "acceleration",
    "temp",
    "temperature",
    "capacity",
    "percentage",
    "soc",
    "efficiency",
    "ratio",
    "ok",
    "status",
    "state",
    "health",
    "technology",
    "flag",
    "flags",
    "valid",
    "enable",
    "enabled",
    "active",
    "fault",
    "faults",
    "alarm",
    "warning",
    "mode",
    "type",
    "id",
    "index",
    "seq",
    "quality",
    "age",
    "std",
    "stddev",
    "var",
    "variance",
    "cov",
    "covariance",
    "gain",
    "direction",
    "dir",
];

/// Words that say where something is, and not what.
pub(super) const DEVICES: &[&str] =
    &["wheel", "wheels", "encoder", "enc", "motor", "joint", "track", "tread"];

/// Words that channels' names are made of; the first that fits is meant.
pub(super) const KNOWN: [Words; 16] = [
    side(Channel::LeftMotorTemperature, TEMPERATURE, LEFT, &[COMMANDS]),
    side(Channel::RightMotorTemperature, TEMPERATURE, RIGHT, &[COMMANDS]),
    side(Channel::LeftPower, SIDE_POWER, LEFT, &[COMMANDS, NO_SPEED]),
    side(Channel::RightPower, SIDE_POWER, RIGHT, &[COMMANDS, NO_SPEED]),
    side(Channel::LeftMotorCurrent, SIDE_CURRENT, LEFT, &[COMMANDS, NO_SPEED]),
    side(Channel::RightMotorCurrent, SIDE_CURRENT, RIGHT, &[COMMANDS, NO_SPEED]),
    side(Channel::LeftSpeed, SPEED, LEFT, &[COMMANDS, NO_SPEED]),
    side(Channel::RightSpeed, SPEED, RIGHT, &[COMMANDS, NO_SPEED]),
    Words {
        channel: Channel::YawRate,
        quantity: &["rate", "z", "gz", "gyroz", "wz", "dps", "rad"],
        of: &["yaw", "gyro", "angular", "gz", "gyroz", "wz"],
        none: &[COMMANDS, NO_YAW, NO_SPEED],
    },
    Words {
        channel: Channel::Heading,
        quantity: &["heading", "yaw", "bearing"],
        of: &[],
        none: &[COMMANDS, RATE, NOT_THE_BODY],
    },
    Words { channel: Channel::Pitch, quantity: &["pitch"], of: &[], none: &[COMMANDS, RATE, NOT_THE_BODY] },
    Words { channel: Channel::Roll, quantity: &["roll"], of: &[], none: &[COMMANDS, RATE, NOT_THE_BODY] },
    Words {
        channel: Channel::AmbientTemperature,
        quantity: &["temp", "temperature", "c"],
        of: &["ambient", "air"],
        none: &[],
    },
    Words {
        channel: Channel::Power,
        quantity: POWER,
        of: &["battery", "bat", "batt", "total", "power", "pack", "watt", "watts"],
        none: &[COMMANDS, NO_BATTERY],
    },
    Words {
        channel: Channel::Current,
        quantity: CURRENT,
        of: &["battery", "bat", "batt", "total", "current", "pack", "amps"],
        none: &[COMMANDS, NO_BATTERY],
    },
    Words {
        channel: Channel::Voltage,
        quantity: VOLTAGE,
        of: &["battery", "bat", "batt", "voltage", "pack", "volts", "volt"],
        none: &[COMMANDS],
    },
];

const fn side(
    channel: Channel,
    quantity: &'static [&'static str],
    of: &'static [&'static str],
    none: &'static [&'static [&'static str]],
) -> Words {
    Words { channel, quantity, of, none }
}
