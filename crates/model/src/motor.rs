//! The drive train of one side as a black box: electrical power from wheel force and rim speed.

use crate::robot::{Motor, Motors};

/// Motor constants at one temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarmMotor {
    /// k1(T): copper loss per squared wheel force [W/N²].
    pub k1_w_per_n2: f64,
    /// k2(T): electrical per mechanical power [-].
    pub k2: f64,
}

impl Motor {
    /// The constants at a motor temperature.
    ///
    /// ```text
    /// k1(T) = k1 (1 + α_R (T − T0)) (1 + α_M (T − T0))⁻²
    /// k2(T) = k2 (1 + α_M (T − T0))⁻²
    /// ```
    ///
    /// Dogru & Marques (2018), eqs. 7-10. Holds for moderate rises: the paper finds it good below 65 °C.
    /// k2 stays at least 1, since no gear train delivers more than it takes.
    #[inline(always)]
    pub fn at_temperature(&self, shared: &Motors, temperature_c: f64) -> WarmMotor {
        let rise_k = temperature_c - shared.reference_temperature_c;
        let resistance = 1.0 + shared.resistance_per_k * rise_k;
        let constant = 1.0 / square(1.0 + shared.motor_constant_per_k * rise_k);
        WarmMotor { k1_w_per_n2: self.k1_w_per_n2 * resistance * constant, k2: (self.k2 * constant).max(1.0) }
    }
}

fn square(x: f64) -> f64 {
    x * x
}

impl WarmMotor {
    /// Eq. 2 as printed, whichever way the power flows [W]; the paper's own measurements are read through it.
    pub fn printed_power_w(&self, force_n: f64, rim_speed_mps: f64) -> f64 {
        self.k1_w_per_n2 * force_n * force_n + self.k2 * rim_speed_mps * force_n
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use crate::builtin;

    #[test]
    fn copper_at_100_k_above_reference_loses_39_per_cent_more() {
        let mut motors = builtin::husky_a200().motors;
        motors.motor_constant_per_k = 0.0;
        let warm = motors.left.at_temperature(&motors, 120.0);
        assert_relative_eq!(warm.k1_w_per_n2 / motors.left.k1_w_per_n2, 1.39, epsilon = 1e-12);
        assert_eq!(warm.k2, motors.left.k2);
    }

    #[test]
    fn weaker_magnets_raise_both_constants_with_the_inverse_square() {
        let mut motors = builtin::husky_a200().motors;
        motors.resistance_per_k = 0.0;
        let warm = motors.right.at_temperature(&motors, 70.0);
        let factor = (1.0f64 - 0.0012 * 50.0).powi(-2);
        assert_relative_eq!(warm.k1_w_per_n2, motors.right.k1_w_per_n2 * factor, epsilon = 1e-15);
        assert_relative_eq!(warm.k2, motors.right.k2 * factor, epsilon = 1e-12);
    }
}
