//! Units by name, and what turns them into SI.

use std::f64::consts::{PI, TAU};

use crate::Quantity;

/// `SI = factor · value + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conversion {
    /// What a value is multiplied with.
    pub factor: f64,
    /// What is added then; zero except for temperatures.
    pub offset: f64,
}

impl Conversion {
    /// No change.
    pub const IDENTITY: Conversion = Conversion { factor: 1.0, offset: 0.0 };

    /// The conversion of a named unit of a quantity.
    ///
    /// Speeds may come as angular rates of the wheel (`rad/s`, `deg/s`, `rpm`) where the wheel radius \[m\] is known.
    /// `None`: the quantity has no such unit, or the wheel radius is missing.
    pub fn from_unit(quantity: Quantity, unit: &str, wheel_radius_m: Option<f64>) -> Option<Conversion> {
        if let Some((_, factor, offset)) = units(quantity).iter().find(|(name, ..)| *name == unit) {
            return Some(Conversion { factor: *factor, offset: *offset });
        }
        if quantity != Quantity::Speed {
            return None;
        }
        let (_, factor, offset) = units(Quantity::AngularRate).iter().find(|(name, ..)| *name == unit)?;
        Some(Conversion { factor: factor * wheel_radius_m?, offset: *offset })
    }

    /// The conversion with its result multiplied.
    #[must_use]
    pub fn scaled(self, scale: f64) -> Conversion {
        Conversion { factor: self.factor * scale, offset: self.offset * scale }
    }

    /// Applies it.
    #[inline]
    pub fn apply(self, value: f64) -> f64 {
        self.factor * value + self.offset
    }
}

/// The unit that a quantity is kept in.
pub(crate) fn si_unit(quantity: Quantity) -> &'static str {
    units(quantity).first().map_or("", |(name, ..)| name)
}

/// The names of the units that a quantity may come in, the one it is kept in first.
pub fn unit_names(quantity: Quantity) -> Vec<&'static str> {
    let names = |quantity| units(quantity).iter().map(|(name, ..)| *name);
    match quantity {
        Quantity::Speed => names(quantity).chain(names(Quantity::AngularRate)).collect(),
        _ => names(quantity).collect(),
    }
}

/// Unit, factor, offset. Definitions by the BIPM's SI brochure (9th edition, tables 7 and 8); mile 1609.344 m, foot
/// 0.3048 m and standard gravity 9.80665 m/s² are exact by definition.
fn units(quantity: Quantity) -> &'static [(&'static str, f64, f64)] {
    match quantity {
        Quantity::Time => &[
            ("s", 1.0, 0.0),
            ("ms", 1e-3, 0.0),
            ("us", 1e-6, 0.0),
            ("ns", 1e-9, 0.0),
            ("min", 60.0, 0.0),
            ("h", 3600.0, 0.0),
            ("d", 86_400.0, 0.0),
        ],
        Quantity::Speed => &[
            ("m/s", 1.0, 0.0),
            ("mm/s", 1e-3, 0.0),
            ("cm/s", 1e-2, 0.0),
            ("km/h", 1.0 / 3.6, 0.0),
            ("mph", 1609.344 / 3600.0, 0.0),
        ],
        Quantity::AngularRate => &[("rad/s", 1.0, 0.0), ("deg/s", PI / 180.0, 0.0), ("rpm", TAU / 60.0, 0.0)],
        Quantity::Angle => &[("rad", 1.0, 0.0), ("deg", PI / 180.0, 0.0), ("mrad", 1e-3, 0.0)],
        Quantity::Acceleration => &[("m/s2", 1.0, 0.0), ("g", 9.80665, 0.0), ("mg", 9.80665e-3, 0.0)],
        Quantity::Power => &[("W", 1.0, 0.0), ("kW", 1e3, 0.0), ("dW", 1e-1, 0.0), ("mW", 1e-3, 0.0)],
        Quantity::Current => &[("A", 1.0, 0.0), ("dA", 1e-1, 0.0), ("cA", 1e-2, 0.0), ("mA", 1e-3, 0.0)],
        Quantity::Voltage => {
            &[("V", 1.0, 0.0), ("dV", 1e-1, 0.0), ("cV", 1e-2, 0.0), ("mV", 1e-3, 0.0), ("kV", 1e3, 0.0)]
        }
        Quantity::Temperature => &[
            ("degC", 1.0, 0.0),
            ("C", 1.0, 0.0),
            ("K", 1.0, -273.15),
            ("degF", 5.0 / 9.0, -32.0 * 5.0 / 9.0),
        ],
        Quantity::Length => {
            &[("m", 1.0, 0.0), ("mm", 1e-3, 0.0), ("cm", 1e-2, 0.0), ("km", 1e3, 0.0), ("ft", 0.3048, 0.0)]
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    fn si(quantity: Quantity, unit: &str, value: f64) -> f64 {
        Conversion::from_unit(quantity, unit, Some(0.165)).unwrap().apply(value)
    }

    #[test]
    fn known_quantities_come_out_in_si() {
        assert_relative_eq!(si(Quantity::Speed, "km/h", 3.6), 1.0);
        assert_relative_eq!(si(Quantity::Speed, "rad/s", 2.0), 0.33);
        assert_relative_eq!(si(Quantity::Speed, "rpm", 60.0), 0.165 * TAU);
        assert_relative_eq!(si(Quantity::Angle, "deg", 180.0), PI);
        assert_relative_eq!(si(Quantity::Temperature, "degF", 212.0), 100.0, epsilon = 1e-12);
        assert_relative_eq!(si(Quantity::Temperature, "K", 293.15), 20.0, epsilon = 1e-12);
        assert_relative_eq!(si(Quantity::Power, "kW", 0.2), 200.0);
    }

    #[test]
    fn a_unit_of_another_quantity_is_refused_and_wheel_rates_need_the_radius() {
        assert_eq!(Conversion::from_unit(Quantity::Power, "A", None), None);
        assert_eq!(Conversion::from_unit(Quantity::Speed, "rad/s", None), None);
        assert_eq!(Conversion::from_unit(Quantity::Angle, "rad/s", Some(1.0)), None);
    }
}
