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
    pub fn at_temperature(&self, shared: &Motors, temperature_c: f64) -> WarmMotor {
        let rise_k = temperature_c - shared.reference_temperature_c;
        let resistance = 1.0 + shared.resistance_per_k * rise_k;
        let constant = (1.0 + shared.motor_constant_per_k * rise_k).powi(-2);
        WarmMotor { k1_w_per_n2: self.k1_w_per_n2 * resistance * constant, k2: (self.k2 * constant).max(1.0) }
    }
}

impl WarmMotor {
    /// Electrical power of one side [W].
    ///
    /// ```text
    /// P = k1 F² + k2 u F        driving, u F ≥ 0 (eq. 2)
    /// P = k1 F² + r u F / k2    back-driven, u F < 0
    /// ```
    ///
    /// F wheel force of the side [N], u rim speed [m/s], r fraction of the back-driven power that reaches the bus.
    /// Back-driven, the same gears lose on the way back, so k2 divides; a cycle can then never create energy.
    pub fn power_w(&self, force_n: f64, rim_speed_mps: f64, regeneration: f64) -> f64 {
        let mechanical_w = force_n * rim_speed_mps;
        let copper_w = self.k1_w_per_n2 * force_n * force_n;
        if mechanical_w >= 0.0 {
            copper_w + self.k2 * mechanical_w
        } else {
            copper_w + regeneration * mechanical_w / self.k2
        }
    }

    /// Eq. 2 as printed, whichever way the power flows [W]. Only the paper's own form and the inversion of
    /// eq. 6 use it.
    pub fn printed_power_w(&self, force_n: f64, rim_speed_mps: f64) -> f64 {
        self.k1_w_per_n2 * force_n * force_n + self.k2 * rim_speed_mps * force_n
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    use super::*;
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

    proptest! {
        #[test]
        fn power_never_falls_below_the_mechanical_power_it_could_come_from(
            force in -1000.0f64..1000.0, speed in -2.0f64..2.0, r in 0.0f64..=1.0, k2 in 1.0f64..4.0,
        ) {
            let motor = WarmMotor { k1_w_per_n2: 0.002, k2 };
            prop_assert!(motor.power_w(force, speed, r) >= force * speed - 1e-9);
        }

        #[test]
        fn power_is_continuous_where_the_flow_turns_round(speed in -2.0f64..2.0, r in 0.0f64..=1.0) {
            let motor = WarmMotor { k1_w_per_n2: 0.002, k2: 1.7 };
            let (a, b) = (motor.power_w(1e-9, speed, r), motor.power_w(-1e-9, speed, r));
            prop_assert!((a - b).abs() < 1e-7);
        }
    }
}
