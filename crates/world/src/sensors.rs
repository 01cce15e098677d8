//! What the sensors of a recording are like.

use serde::{Deserialize, Serialize};

use crate::{Error, RobotFile, limits::within};

/// How a drive is recorded. Every field has a default, which is that of a good robot of the Husky's class.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Sensors {
    /// Rows per second, 1 to 50 [Hz]. Default 10.
    pub rate_hz: f64,
    /// Step of a wheel's encoder along the rim [m]. Default 0.00001282: 78 000 counts per metre of a Husky A200.
    pub encoder_step_m: f64,
    /// Noise of a rim speed [m/s]. Default 0.002.
    pub speed_noise_mps: f64,
    /// In which forms power is recorded. Default: sides and battery.
    pub power: PowerChannels,
    /// Noise of a power that does not depend on it, per reading [W]. Default 1.5.
    pub power_noise_w: f64,
    /// Noise of a power as a fraction of it. Default 0.01.
    pub power_gain_noise: f64,
    /// How long the noise of power remembers itself [s]. Default 0.1.
    pub power_noise_memory_s: f64,
    /// Step of a power reading [W]. Default 0.1.
    pub power_step_w: f64,
    /// Noise of the battery's voltage [V]. Default 0.01.
    pub voltage_noise_v: f64,
    /// Step of a temperature reading [K]. Default 0.5.
    pub temperature_step_k: f64,
    /// By how much power comes later than the wheels' speeds [s]. Default 0.
    pub power_delay_s: f64,
    /// Noise of the gyroscope [rad/s]. Default 0.003.
    pub yaw_rate_noise_radps: f64,
    /// Its bias at the start, one sigma [rad/s]. Default 0.001.
    pub yaw_rate_bias_radps: f64,
    /// How far its bias drifts in an hour, one sigma [rad/s]. Default 0.001.
    pub yaw_rate_drift_radps: f64,
    /// Noise of pitch and roll [rad]. Default 0.002.
    pub tilt_noise_rad: f64,
    /// Bias of pitch and roll, one sigma [rad]. Default 0.0005.
    pub tilt_bias_rad: f64,
    /// Noise of a position, remembered for half a minute [m]. Default 0.02, satellite navigation with corrections.
    pub position_noise_m: f64,
    /// Whether positions are recorded. Default true.
    pub position: bool,
    /// Whether motor temperatures are recorded. Default false.
    pub motor_temperature: bool,
    /// Whether the surface is named in the recording. Default true.
    pub surface: bool,
    /// Whether forward acceleration is recorded. Default false.
    pub acceleration: bool,
    /// Noise of the acceleration [m/s²]. Default 0.03.
    pub acceleration_noise_mps2: f64,
    /// Share of rows in which one sensor has nothing to say, 0 to 0.5. Default 0.002.
    pub dropouts: f64,
    /// How many rows a dropout lasts on average. Default 3.
    pub dropout_rows: f64,
}

/// In which forms power is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum PowerChannels {
    /// At both motor drivers and at the battery, with its voltage.
    SidesAndBattery,
    /// At both motor drivers.
    Sides,
    /// At the battery.
    Battery,
    /// Current and voltage of the battery.
    CurrentAndVoltage,
    /// Current of both motors, without sign.
    MotorCurrents,
}

impl Default for Sensors {
    fn default() -> Self {
        Sensors {
            rate_hz: 10.0,
            encoder_step_m: 1.0 / 78_000.0,
            speed_noise_mps: 0.002,
            power: PowerChannels::SidesAndBattery,
            power_noise_w: 1.5,
            power_gain_noise: 0.01,
            power_noise_memory_s: 0.1,
            power_step_w: 0.1,
            voltage_noise_v: 0.01,
            temperature_step_k: 0.5,
            power_delay_s: 0.0,
            yaw_rate_noise_radps: 0.003,
            yaw_rate_bias_radps: 0.001,
            yaw_rate_drift_radps: 0.001,
            tilt_noise_rad: 0.002,
            tilt_bias_rad: 0.0005,
            position_noise_m: 0.02,
            position: true,
            motor_temperature: false,
            surface: true,
            acceleration: false,
            acceleration_noise_mps2: 0.03,
            dropouts: 0.002,
            dropout_rows: 3.0,
        }
    }
}

impl Sensors {
    /// A good set of sensors for a robot: power is measured in proportion to what its weight takes at top speed, speed to that speed.
    pub fn of(robot: &RobotFile) -> Self {
        let fast = robot.fastness();
        let strong = robot.size() * fast;
        let usual = Sensors::default();
        Sensors {
            speed_noise_mps: fast * usual.speed_noise_mps,
            power_noise_w: strong * usual.power_noise_w,
            power_step_w: strong * usual.power_step_w,
            ..usual
        }
    }

    /// Sensors without noise, bias, steps, delays or gaps.
    pub fn perfect() -> Self {
        Sensors {
            encoder_step_m: 0.0,
            speed_noise_mps: 0.0,
            power_noise_w: 0.0,
            power_gain_noise: 0.0,
            power_step_w: 0.0,
            voltage_noise_v: 0.0,
            temperature_step_k: 0.0,
            yaw_rate_noise_radps: 0.0,
            yaw_rate_bias_radps: 0.0,
            yaw_rate_drift_radps: 0.0,
            tilt_noise_rad: 0.0,
            tilt_bias_rad: 0.0,
            position_noise_m: 0.0,
            acceleration_noise_mps2: 0.0,
            dropouts: 0.0,
            ..Sensors::default()
        }
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        let check =
            |field: &str, value: f64, range, hint| within(format!("sensors.{field}"), value, range, hint);
        check("rate_hz", self.rate_hz, [1.0, 50.0], "give rows per second")?;
        check("encoder_step_m", self.encoder_step_m, [0.0, 0.1], "give metres along the rim")?;
        check("speed_noise_mps", self.speed_noise_mps, [0.0, 1.0], "give metres per second")?;
        check("power_noise_w", self.power_noise_w, [0.0, 1e4], "give watts")?;
        check("power_gain_noise", self.power_gain_noise, [0.0, 1.0], "give a fraction")?;
        check("power_noise_memory_s", self.power_noise_memory_s, [0.0, 60.0], "give seconds")?;
        check("power_step_w", self.power_step_w, [0.0, 1e3], "give watts")?;
        check("voltage_noise_v", self.voltage_noise_v, [0.0, 100.0], "give volts")?;
        check("temperature_step_k", self.temperature_step_k, [0.0, 50.0], "give kelvins")?;
        check("power_delay_s", self.power_delay_s, [0.0, 5.0], "give seconds")?;
        check("yaw_rate_noise_radps", self.yaw_rate_noise_radps, [0.0, 1.0], "give radians per second")?;
        check("yaw_rate_bias_radps", self.yaw_rate_bias_radps, [0.0, 1.0], "give radians per second")?;
        check("yaw_rate_drift_radps", self.yaw_rate_drift_radps, [0.0, 1.0], "give radians per second")?;
        check("tilt_noise_rad", self.tilt_noise_rad, [0.0, 0.5], "give radians")?;
        check("tilt_bias_rad", self.tilt_bias_rad, [0.0, 0.5], "give radians")?;
        check("position_noise_m", self.position_noise_m, [0.0, 100.0], "give metres")?;
        check(
            "acceleration_noise_mps2",
            self.acceleration_noise_mps2,
            [0.0, 10.0],
            "give metres per squared second",
        )?;
        check("dropouts", self.dropouts, [0.0, 0.5], "give a fraction")?;
        check("dropout_rows", self.dropout_rows, [1.0, 1e4], "give a number of rows")
    }
}
