//! Friction measured through power: the roots of eq. 6.

use crate::{Error, gravity::STANDARD_GRAVITY_MPS2, motor::WarmMotor};

/// Which sign eq. 6 carries.
///
/// `Plus` holds while friction works against the motors: climbing, on the level, and on descents too gentle to
/// roll down alone. `Minus` holds when gravity overcomes friction and the motors hold the robot back (eq. 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlopeSign {
    /// F = gravity + friction.
    Plus,
    /// F = gravity − friction.
    Minus,
}

/// What stands around μ in eq. 6: one side of a robot on a slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideOnSlope {
    /// The side's motor constants.
    pub motor: WarmMotor,
    /// m: the mass that the side is charged with [kg].
    pub mass_kg: f64,
    /// γ: inclination of the ground [rad].
    pub inclination_rad: f64,
    /// β: angle of the heading from the contour line, positive uphill [rad].
    pub heading_from_contour_rad: f64,
    /// w: rim speed, positive [m/s].
    pub rim_speed_mps: f64,
}

/// Both roots of eq. 6.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionRoots {
    /// The friction that was at work.
    pub friction: f64,
    /// The root that algebra adds: it needs a motor current past the point of greatest regeneration.
    pub spurious: Option<f64>,
}

impl SideOnSlope {
    fn weight_n(&self) -> f64 {
        self.mass_kg * STANDARD_GRAVITY_MPS2
    }

    fn gravity_n(&self) -> f64 {
        self.weight_n() * self.inclination_rad.sin() * self.heading_from_contour_rad.sin()
    }

    /// Eq. 6 [W].
    ///
    /// ```text
    /// P = μ² k1 m² g² cos²γ ± μ (2 m g k1 sinγ sinβ + w k2) m g cosγ + m g sinγ sinβ (m g k1 sinγ sinβ + w k2)
    /// ```
    ///
    /// Dogru & Marques (2018), eq. 6.
    pub fn power_w(&self, friction: f64, sign: SlopeSign) -> f64 {
        let WarmMotor { k1_w_per_n2: k1, k2 } = self.motor;
        let normal_n = self.weight_n() * self.inclination_rad.cos();
        let (gravity_n, w) = (self.gravity_n(), self.rim_speed_mps);
        let signed = match sign {
            SlopeSign::Plus => friction,
            SlopeSign::Minus => -friction,
        };
        signed * signed * k1 * normal_n * normal_n
            + signed * (2.0 * gravity_n * k1 + w * k2) * normal_n
            + gravity_n * (gravity_n * k1 + w * k2)
    }

    /// Solves eq. 6 for the friction coefficient.
    ///
    /// The wheel force has two roots for one power, `F = (−k2 w ± √(k2² w² + 4 k1 P)) / 2 k1`. The larger is the one
    /// that a motor reaches from standstill; it gives the positive μ that the paper chooses whenever the motor
    /// drives, and the negative μ of Table II where the side brakes.
    ///
    /// # Errors
    /// [`Error::NoRealFriction`] when so much power flows back that no force explains it.
    pub fn friction_from_power(&self, power_w: f64, sign: SlopeSign) -> Result<FrictionRoots, Error> {
        let WarmMotor { k1_w_per_n2: k1, k2 } = self.motor;
        let back_emf = k2 * self.rim_speed_mps;
        let friction_of = |force_n: f64| {
            let normal_n = self.weight_n() * self.inclination_rad.cos();
            match sign {
                SlopeSign::Plus => (force_n - self.gravity_n()) / normal_n,
                SlopeSign::Minus => (self.gravity_n() - force_n) / normal_n,
            }
        };
        if k1 == 0.0 {
            return Ok(FrictionRoots { friction: friction_of(power_w / back_emf), spurious: None });
        }
        let discriminant = back_emf * back_emf + 4.0 * k1 * power_w;
        if discriminant < 0.0 {
            return Err(Error::NoRealFriction { power_w, least_w: -back_emf * back_emf / (4.0 * k1) });
        }
        let root = discriminant.sqrt();
        // Written so that neither root subtracts nearly equal numbers.
        let spurious_n = (-back_emf - root) / (2.0 * k1);
        let force_n = 2.0 * power_w / (back_emf + root);
        let force_n = if back_emf + root == 0.0 { 0.0 } else { force_n };
        Ok(FrictionRoots { friction: friction_of(force_n), spurious: Some(friction_of(spurious_n)) })
    }
}

/// Normalised error of a prediction [%], `100 |predicted − measured| / measured`; Dogru & Marques (2018), eq. 17.
pub fn normalized_error_percent(predicted: f64, measured: f64) -> f64 {
    100.0 * (predicted - measured).abs() / measured.abs()
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    use super::*;

    fn side(inclination_rad: f64, heading_from_contour_rad: f64, rim_speed_mps: f64) -> SideOnSlope {
        SideOnSlope {
            motor: WarmMotor { k1_w_per_n2: 0.0023, k2: 1.7158 },
            mass_kg: 90.0,
            inclination_rad,
            heading_from_contour_rad,
            rim_speed_mps,
        }
    }

    #[test]
    fn the_spin_of_106_w_on_marble_means_a_friction_of_0_16() {
        // §V-B: 1 rad/s on the spot, 106 W on one side; the paper's friction starts at 0.16.
        let roots = side(0.0, 0.0, 0.27).friction_from_power(106.0, SlopeSign::Plus).unwrap();
        assert_relative_eq!(roots.friction, 0.16, epsilon = 0.008);
        assert!(roots.spurious.unwrap() < 0.0);
    }

    #[test]
    fn a_side_that_returns_power_has_negative_friction_as_in_table_ii() {
        let roots = side(0.0, 0.0, 0.5).friction_from_power(-40.0, SlopeSign::Plus).unwrap();
        assert!(roots.friction < 0.0 && roots.friction > -0.1, "{}", roots.friction);
    }

    #[test]
    fn more_power_than_a_brake_can_return_is_refused_with_the_bound() {
        let error = side(0.0, 0.0, 0.1).friction_from_power(-10.0, SlopeSign::Plus).unwrap_err();
        let Error::NoRealFriction { least_w, .. } = error else { panic!("{error}") };
        assert_relative_eq!(least_w, -(1.7158f64 * 0.1).powi(2) / (4.0 * 0.0023), epsilon = 1e-12);
    }

    #[test]
    fn eq_17_of_three_per_cent_is_three() {
        assert_relative_eq!(normalized_error_percent(103.0, 100.0), 3.0, epsilon = 1e-12);
    }

    proptest! {
        #[test]
        fn the_root_returns_the_friction_that_made_the_power(
            mu in -0.05f64..0.6, gamma in 0.0f64..0.3, beta in -1.5f64..1.5, speed in 0.3f64..1.0, minus: bool,
        ) {
            let sign = if minus { SlopeSign::Minus } else { SlopeSign::Plus };
            let side = side(gamma, beta, speed);
            // Only forces that a motor reaches before its regeneration falls again have one answer.
            let signed = if minus { -mu } else { mu };
            let force = 90.0 * STANDARD_GRAVITY_MPS2 * (gamma.sin() * beta.sin() + signed * gamma.cos());
            prop_assume!(force > -0.95 * 1.7158 * speed / (2.0 * 0.0023));
            let power = side.power_w(mu, sign);
            let found = side.friction_from_power(power, sign).unwrap();
            prop_assert!((found.friction - mu).abs() < 1e-9, "{} for {mu}", found.friction);
            let other = side.power_w(found.spurious.unwrap(), sign);
            prop_assert!((other - power).abs() < 1e-6 * power.abs().max(1.0));
        }

        #[test]
        fn eq_6_is_eq_2_with_the_force_of_eqs_3_to_5(
            mu in 0.0f64..0.6, gamma in 0.0f64..0.4, beta in -1.5f64..1.5, speed in 0.0f64..1.0,
        ) {
            let side = side(gamma, beta, speed);
            let weight = 90.0 * STANDARD_GRAVITY_MPS2;
            let force = weight * (gamma.sin() * beta.sin() + mu * gamma.cos());
            let expected = side.motor.printed_power_w(force, speed);
            prop_assert!((side.power_w(mu, SlopeSign::Plus) - expected).abs() < 1e-9 * expected.abs().max(1.0));
        }
    }
}
