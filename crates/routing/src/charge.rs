//! What a battery can give.

use model::robot::Battery;

use crate::error::Error;

/// Energy that a battery gives from a state of charge down to its reserve, drawn slowly and at its nominal voltage [J].
///
/// ```text
/// E = capacity · (charge − reserve)
/// ```
///
/// What it gives to a drive, faster and at the voltage of the moment, is a question of range.
///
/// # Errors
/// A charge outside 0 to 1, or not above the reserve.
pub fn available_j(battery: &Battery, charge: f64) -> Result<f64, Error> {
    if !(0.0..=1.0).contains(&charge) {
        return Err(Error::Charge { charge });
    }
    let reserve_fraction = battery.reserve_fraction;
    if charge <= reserve_fraction {
        return Err(Error::ChargeWithinReserve { charge, reserve_fraction });
    }
    Ok(battery.capacity_j() * (charge - reserve_fraction))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pack() -> Battery {
        Battery::lead_acid(480.0, 24.0, 0.2)
    }

    #[test]
    fn half_a_husky_pack_above_a_reserve_of_a_fifth_gives_518_kilojoules() {
        assert!((available_j(&pack(), 0.5).unwrap() - 518_400.0).abs() < 1e-6);
    }

    #[test]
    fn an_old_and_cold_pack_gives_less() {
        let old = Battery { ageing_factor: 0.8, temperature_c: 5.0, ..pack() };
        assert!((available_j(&old, 1.0).unwrap() - 0.8 * 0.8 * 480.0 * 3600.0 * 0.8).abs() < 1e-6);
    }

    #[test]
    fn charges_that_cannot_be_and_those_within_the_reserve_are_told_apart() {
        for charge in [-0.1, 1.1, f64::NAN] {
            assert!(matches!(available_j(&pack(), charge), Err(Error::Charge { .. })), "{charge}");
        }
        assert!(matches!(available_j(&pack(), 0.2), Err(Error::ChargeWithinReserve { .. })));
    }
}
