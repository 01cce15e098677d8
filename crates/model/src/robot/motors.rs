//! The drive train of each side, as a robot file has it; `motor.rs` computes with it.

use serde::{Deserialize, Serialize};

/// Both sides' motors and what they share.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Motors {
    /// The left side's constants.
    pub left: Motor,
    /// The right side's constants.
    pub right: Motor,
    /// T0: temperature at which k1 and k2 hold [°C]. Default 20.
    #[serde(default = "reference_temperature_c")]
    pub reference_temperature_c: f64,
    /// α_R of eq. 7 [1/K]. Default 0.0039 (copper).
    #[serde(default = "resistance_per_k")]
    pub resistance_per_k: f64,
    /// α_M of eq. 8 [1/K]. Default −0.0012 (ferrite magnets lose torque when hot).
    #[serde(default = "motor_constant_per_k")]
    pub motor_constant_per_k: f64,
    /// Fraction of the back-driven power `u F / k2` that reaches the bus, 0 to 1. Default 1.
    #[serde(default = "regeneration")]
    pub regeneration: f64,
}

impl Motors {
    /// The same motor on both sides, of copper and ferrite.
    pub fn alike(motor: Motor) -> Self {
        Motors {
            left: motor,
            right: motor,
            reference_temperature_c: reference_temperature_c(),
            resistance_per_k: resistance_per_k(),
            motor_constant_per_k: motor_constant_per_k(),
            regeneration: regeneration(),
        }
    }
}

/// Equivalent motor constants of one side (eq. 2, Table I).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Motor {
    /// k1: copper loss per squared wheel force [W/N²].
    pub k1_w_per_n2: f64,
    /// k2: electrical per mechanical power, at least 1 (gears and belts only lose) [-].
    pub k2: f64,
    /// Wheel force per motor current [N/A]; needed only for recordings of motor current.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_n_per_a: Option<f64>,
    /// Motor current that is read while the robot stands, of recordings of motor current [A]. Default 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub idle_current_a: Option<f64>,
}

fn reference_temperature_c() -> f64 {
    20.0
}
fn resistance_per_k() -> f64 {
    0.0039
}
fn motor_constant_per_k() -> f64 {
    -0.0012
}
fn regeneration() -> f64 {
    1.0
}
