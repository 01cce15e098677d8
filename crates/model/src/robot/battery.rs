//! What a robot file says of its battery. How it is drawn empty is worked out by who asks for range.

use serde::{Deserialize, Serialize};

/// The battery pack.
///
/// What a file leaves out is that of a sealed lead-acid pack (absorbent glass mat) of its size, as a Husky A200 carries; a
/// lithium pack has `peukert_exponent` 1 to 1.05, `charge_efficiency` 0.99 and `capacity_per_k` 0.005.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Battery {
    /// Nominal capacity when new, at `temperature_c` 25 and the rate of `rated_hours` [Wh].
    pub capacity_wh: f64,
    /// Nominal voltage [V].
    pub nominal_voltage_v: f64,
    /// Fraction of the capacity that must stay, 0 to 1. Default 0.2.
    #[serde(default = "reserve_fraction")]
    pub reserve_fraction: f64,
    /// k of Peukert's law, 1 for a capacity that no current lessens [-]. Default 1.16: from 20 h to 5 h for sealed lead-acid
    /// packs, whose 40 Ah at 2.0 A are 33 Ah at 6.6 A (data sheet of the Power-Sonic PS-12400).
    #[serde(default = "peukert_exponent")]
    pub peukert_exponent: f64,
    /// Hours of the discharge that the capacity is rated for [h]. Default 20.
    #[serde(default = "rated_hours")]
    pub rated_hours: f64,
    /// Capacity now over capacity when new [-]. Default 1.
    #[serde(default = "one")]
    pub ageing_factor: f64,
    /// Temperature of the cells [°C]. Default 25.
    #[serde(default = "temperature_c")]
    pub temperature_c: f64,
    /// Change of the capacity per kelvin from 25 °C, over the capacity there [1/K]. Default 0.01 (IEEE Std 485, Table 1: 0.90
    /// of the capacity at 15.6 °C).
    #[serde(default = "capacity_per_k")]
    pub capacity_per_k: f64,
    /// Voltage without load, full [V]. Default 1.07 of the nominal one: 2.14 V a cell, by the density of its acid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub full_voltage_v: Option<f64>,
    /// Voltage without load, empty [V]. Default 0.97 of the nominal one: 1.94 V a cell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub empty_voltage_v: Option<f64>,
    /// Below this the drives are switched off [V]. Default 0.875 of the nominal voltage: 1.75 V a cell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cutoff_voltage_v: Option<f64>,
    /// Resistance of the pack with its cables [Ω]. Default 0.045 Ω at 24 V and 480 Wh, with the square of the voltage over the
    /// capacity for others: two blocks of some 12 mΩ, and as much again for fuse, plugs and cable.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub internal_resistance_ohm: Option<f64>,
    /// Largest charging current over the capacity in ampere hours, up to 80 % of charge; from there it falls to nothing when
    /// full [1/h]. Default 0.3, as data sheets of sealed lead-acid packs allow.
    #[serde(default = "charge_acceptance_per_h")]
    pub charge_acceptance_per_h: f64,
    /// Charge that can be drawn again over charge put in, 0 to 1 [-]. Default 0.85.
    #[serde(default = "charge_efficiency")]
    pub charge_efficiency: f64,
    /// Relative one-sigma uncertainty of the capacity [-]. Default 0.05.
    #[serde(default = "capacity_sigma")]
    pub capacity_sigma: f64,
    /// One-sigma uncertainty of a charge that is told, as a fraction of the capacity [-]. Default 0.02.
    #[serde(default = "charge_sigma")]
    pub charge_sigma: f64,
}

/// Temperature that capacities are given for [°C].
const RATED_C: f64 = 25.0;
/// The change of the capacity with temperature is not followed beyond these factors.
const TEMPERATURE_FACTOR: [f64; 2] = [0.3, 1.1];

impl Battery {
    /// A sealed lead-acid pack in good health.
    pub fn lead_acid(capacity_wh: f64, nominal_voltage_v: f64, reserve_fraction: f64) -> Self {
        Battery {
            capacity_wh,
            nominal_voltage_v,
            reserve_fraction,
            peukert_exponent: peukert_exponent(),
            rated_hours: rated_hours(),
            ageing_factor: 1.0,
            temperature_c: temperature_c(),
            capacity_per_k: capacity_per_k(),
            full_voltage_v: None,
            empty_voltage_v: None,
            cutoff_voltage_v: None,
            internal_resistance_ohm: None,
            charge_acceptance_per_h: charge_acceptance_per_h(),
            charge_efficiency: charge_efficiency(),
            capacity_sigma: capacity_sigma(),
            charge_sigma: charge_sigma(),
        }
    }

    /// The same pack of lithium cells, between those of iron phosphate and those of cobalt: next to nothing is lost to strong
    /// currents and little to the cold, and all but a hundredth of what is charged comes back.
    #[must_use]
    pub fn of_lithium(self) -> Self {
        Battery {
            peukert_exponent: 1.03,
            rated_hours: 5.0,
            capacity_per_k: 0.005,
            full_voltage_v: Some(1.10 * self.nominal_voltage_v),
            empty_voltage_v: Some(0.90 * self.nominal_voltage_v),
            cutoff_voltage_v: Some(0.80 * self.nominal_voltage_v),
            charge_acceptance_per_h: 0.5,
            charge_efficiency: 0.99,
            ..self
        }
    }

    /// What a full pack gives at the rated current and the nominal voltage, as old and as warm as it is [J].
    pub fn capacity_j(&self) -> f64 {
        const JOULES_PER_WATT_HOUR: f64 = 3600.0;
        let warmth = 1.0 + self.capacity_per_k * (self.temperature_c - RATED_C);
        let warmth = warmth.clamp(TEMPERATURE_FACTOR[0], TEMPERATURE_FACTOR[1]);
        self.ageing_factor * warmth * self.capacity_wh * JOULES_PER_WATT_HOUR
    }

    /// Voltage without load, full [V].
    pub fn full_v(&self) -> f64 {
        self.full_voltage_v.unwrap_or(1.07 * self.nominal_voltage_v)
    }

    /// Voltage without load, empty [V].
    pub fn empty_v(&self) -> f64 {
        self.empty_voltage_v.unwrap_or(0.97 * self.nominal_voltage_v)
    }

    /// Voltage at which the drives are switched off [V].
    pub fn cutoff_v(&self) -> f64 {
        self.cutoff_voltage_v.unwrap_or(0.875 * self.nominal_voltage_v)
    }

    /// Resistance of the pack with its cables [Ω].
    pub fn resistance_ohm(&self) -> f64 {
        // A pack of twice the voltage or half the capacity has cells of more resistance in series.
        let by_size = (self.nominal_voltage_v / 24.0).powi(2) * 480.0 / self.capacity_wh;
        self.internal_resistance_ohm.unwrap_or(0.045 * by_size)
    }
}

fn reserve_fraction() -> f64 {
    0.2
}
fn peukert_exponent() -> f64 {
    1.16
}
fn rated_hours() -> f64 {
    20.0
}
fn one() -> f64 {
    1.0
}
fn temperature_c() -> f64 {
    25.0
}
fn capacity_per_k() -> f64 {
    0.01
}
fn charge_acceptance_per_h() -> f64 {
    0.3
}
fn charge_efficiency() -> f64 {
    0.85
}
fn capacity_sigma() -> f64 {
    0.05
}
fn charge_sigma() -> f64 {
    0.02
}
