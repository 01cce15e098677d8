//! What a battery can give.

use model::robot::Battery;

use crate::error::Error;

/// Energy that a battery gives from a state of charge down to its reserve [J].
///
/// ```text
/// E = 3600 · capacity · (charge − reserve)
/// ```
///
/// # Errors
/// A charge outside 0 to 1, or not above the reserve.
pub fn available_j(battery: &Battery, charge: f64) -> Result<f64, Error> {
    const JOULES_PER_WATT_HOUR: f64 = 3600.0;
    if !(0.0..=1.0).contains(&charge) {
        return Err(Error::Charge { charge });
    }
    let reserve_fraction = battery.reserve_fraction;
    if charge <= reserve_fraction {
        return Err(Error::ChargeWithinReserve { charge, reserve_fraction });
    }
    Ok(JOULES_PER_WATT_HOUR * battery.capacity_wh * (charge - reserve_fraction))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PACK: Battery = Battery { capacity_wh: 480.0, nominal_voltage_v: 24.0, reserve_fraction: 0.2 };

    #[test]
    fn half_a_husky_pack_above_a_reserve_of_a_fifth_gives_518_kilojoules() {
        assert!((available_j(&PACK, 0.5).unwrap() - 518_400.0).abs() < 1e-6);
    }

    #[test]
    fn charges_that_cannot_be_and_those_within_the_reserve_are_told_apart() {
        for charge in [-0.1, 1.1, f64::NAN] {
            assert!(matches!(available_j(&PACK, charge), Err(Error::Charge { .. })), "{charge}");
        }
        assert!(matches!(available_j(&PACK, 0.2), Err(Error::ChargeWithinReserve { .. })));
    }
}
