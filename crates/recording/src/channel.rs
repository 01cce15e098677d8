//! The channels that a recording may hold, with their outside names.

use serde::{Deserialize, Serialize};

/// A rim slower than this stands still \[m/s\]: twice the step of a Husky's encoder speeds (0.0079 m/s).
pub const STANDS_MPS: f64 = 0.016;

/// What kind of quantity a channel is; decides which units it may come in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Time \[s\].
    Time,
    /// Speed \[m/s\].
    Speed,
    /// Angular rate \[rad/s\].
    AngularRate,
    /// Angle \[rad\].
    Angle,
    /// Acceleration \[m/s²\].
    Acceleration,
    /// Power \[W\].
    Power,
    /// Current \[A\].
    Current,
    /// Voltage \[V\].
    Voltage,
    /// Temperature \[°C\].
    Temperature,
    /// Length \[m\].
    Length,
}

/// A channel of a recording. Its name, unit included, is what files and reports call it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "&'static str")]
pub enum Channel {
    /// `v_left_mps`: rim speed of the left wheels, from encoders.
    LeftSpeed,
    /// `v_right_mps`: rim speed of the right wheels, from encoders.
    RightSpeed,
    /// `power_left_w`: power into the left motor driver.
    LeftPower,
    /// `power_right_w`: power into the right motor driver.
    RightPower,
    /// `power_w`: power drawn from the battery.
    Power,
    /// `current_a`: current drawn from the battery.
    Current,
    /// `voltage_v`: battery voltage.
    Voltage,
    /// `motor_current_left_a`: motor current of the left side, with or without a sign.
    LeftMotorCurrent,
    /// `motor_current_right_a`: motor current of the right side, with or without a sign.
    RightMotorCurrent,
    /// `yaw_rate_radps`: yaw rate, positive turning left.
    YawRate,
    /// `heading_rad`: heading, counter-clockwise from +x.
    Heading,
    /// `pitch_rad`: pitch, positive nose-up.
    Pitch,
    /// `roll_rad`: roll, positive left side up.
    Roll,
    /// `accel_forward_mps2`: forward acceleration.
    ForwardAcceleration,
    /// `motor_temp_left_c`: temperature of the left motor.
    LeftMotorTemperature,
    /// `motor_temp_right_c`: temperature of the right motor.
    RightMotorTemperature,
    /// `ambient_temp_c`: air temperature.
    AmbientTemperature,
    /// `x_m`: position east.
    X,
    /// `y_m`: position north.
    Y,
    /// `z_m`: position up.
    Z,
}

/// One line per channel: name, quantity, and the magnitudes between which the 99th percentile of a ground robot's
/// channel lies when its unit is right. A channel outside them is read all the same and reported.
///
/// The bounds separate a unit from its likely confusions (deg for rad, kW for W, mA for A, km/h for m/s), for robots of
/// 5 kg to 5 t: slower than 15 m/s, turning slower than 2π rad/s, drawing 1 W to 100 kW and up to 2 kA, at 3 V to 1 kV,
/// tilted by less than π/2. Zero as the lower bound: any small value is plausible.
const TABLE: [(Channel, &str, Quantity, [f64; 2]); 20] = {
    use std::f64::consts::{FRAC_PI_2, TAU};

    use Quantity as Q;
    [
        (Channel::LeftSpeed, "v_left_mps", Q::Speed, [0.0, 15.0]),
        (Channel::RightSpeed, "v_right_mps", Q::Speed, [0.0, 15.0]),
        (Channel::LeftPower, "power_left_w", Q::Power, [1.0, 1e5]),
        (Channel::RightPower, "power_right_w", Q::Power, [1.0, 1e5]),
        (Channel::Power, "power_w", Q::Power, [1.0, 1e5]),
        (Channel::Current, "current_a", Q::Current, [0.05, 2e3]),
        (Channel::Voltage, "voltage_v", Q::Voltage, [3.0, 1e3]),
        (Channel::LeftMotorCurrent, "motor_current_left_a", Q::Current, [0.05, 2e3]),
        (Channel::RightMotorCurrent, "motor_current_right_a", Q::Current, [0.05, 2e3]),
        (Channel::YawRate, "yaw_rate_radps", Q::AngularRate, [0.0, TAU]),
        // Unwrapped headings may turn many times.
        (Channel::Heading, "heading_rad", Q::Angle, [0.0, 100.0 * TAU]),
        (Channel::Pitch, "pitch_rad", Q::Angle, [0.0, FRAC_PI_2]),
        (Channel::Roll, "roll_rad", Q::Angle, [0.0, FRAC_PI_2]),
        (Channel::ForwardAcceleration, "accel_forward_mps2", Q::Acceleration, [0.0, 50.0]),
        // Above 200 °C windings burn; above 223 the number is a temperature in kelvin.
        (Channel::LeftMotorTemperature, "motor_temp_left_c", Q::Temperature, [0.0, 200.0]),
        (Channel::RightMotorTemperature, "motor_temp_right_c", Q::Temperature, [0.0, 200.0]),
        (Channel::AmbientTemperature, "ambient_temp_c", Q::Temperature, [0.0, 70.0]),
        // Projected coordinates reach 10 000 km.
        (Channel::X, "x_m", Q::Length, [0.0, 1e7]),
        (Channel::Y, "y_m", Q::Length, [0.0, 1e7]),
        (Channel::Z, "z_m", Q::Length, [0.0, 1e4]),
    ]
};

impl Channel {
    /// Every channel, required ones first.
    pub fn all() -> impl Iterator<Item = Channel> {
        TABLE.iter().map(|line| line.0)
    }

    /// The outside name, as `v_left_mps`.
    pub fn name(self) -> &'static str {
        self.line().1
    }

    /// What it measures.
    pub fn quantity(self) -> Quantity {
        self.line().2
    }

    /// Between which magnitudes its 99th percentile is plausible, in its own unit.
    pub fn plausible_magnitude(self) -> [f64; 2] {
        self.line().3
    }

    /// The channel of an outside name.
    pub fn from_name(name: &str) -> Option<Channel> {
        TABLE.iter().find(|line| line.1 == name).map(|line| line.0)
    }

    /// Whether it is one of those that power is computed from.
    pub fn tells_power(self) -> bool {
        matches!(self.quantity(), Quantity::Power | Quantity::Current | Quantity::Voltage)
    }

    fn line(self) -> &'static (Channel, &'static str, Quantity, [f64; 2]) {
        // The table stands in the order of the enum; a test holds them together.
        &TABLE[self as usize]
    }
}

impl From<Channel> for &'static str {
    fn from(channel: Channel) -> Self {
        channel.name()
    }
}

impl TryFrom<String> for Channel {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Channel::from_name(&name).ok_or_else(|| {
            let known: Vec<&str> = Channel::all().map(Channel::name).collect();
            format!("`{name}` is no channel; the channels are {}", known.join(", "))
        })
    }
}

impl std::fmt::Display for Channel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_channel_is_found_by_its_own_name() {
        for (position, channel) in Channel::all().enumerate() {
            assert_eq!(channel as usize, position);
            assert_eq!(Channel::from_name(channel.name()), Some(channel));
        }
        assert_eq!(Channel::from_name("v_left"), None);
    }
}
