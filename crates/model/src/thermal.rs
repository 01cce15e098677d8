//! Motor temperature where none is measured: winding and case as two heat stores.

use crate::{Robot, Sides, motor::WarmMotor, power::Power};

/// Heat stores and paths of one motor with its gearbox.
///
/// ```text
/// C_w dT_w/dt = k1 F² − (T_w − T_c)/R_wc
/// C_c dT_c/dt = (T_w − T_c)/R_wc + gear loss − (T_c − T_a)/R_ca
/// ```
///
/// Copper loss heats the winding, gear loss `|P_el − k1 F² − P_mech|` the case. The case is what the paper's
/// thermistors measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalModel {
    /// C_w: heat capacity of the winding [J/K].
    pub winding_j_per_k: f64,
    /// C_c: heat capacity of the case and gearbox [J/K].
    pub case_j_per_k: f64,
    /// R_wc: resistance from winding to case [K/W].
    pub winding_to_case_k_per_w: f64,
    /// R_ca: resistance from case to air [K/W].
    pub case_to_air_k_per_w: f64,
}

impl Default for ThermalModel {
    /// A Husky A200 motor: about 0.4 kg of copper at 385 J/(kg K) and 2.5 kg of steel and aluminium at about
    /// 500 J/(kg K); R_wc typical of brushed motors of this size; R_ca such that 23 min of spinning at 1 rad/s warm
    /// the case from 20 °C to the 76 °C that the paper measured (§V-B, Fig. 9a).
    fn default() -> Self {
        ThermalModel {
            winding_j_per_k: 154.0,
            case_j_per_k: 1250.0,
            winding_to_case_k_per_w: 0.30,
            case_to_air_k_per_w: 0.65,
        }
    }
}

impl ThermalModel {
    /// Motors of a robot: as a Husky's, with stores that grow and resistances that fall with its mass, so that losses in proportion to it
    /// warm them alike.
    pub fn of(robot: &Robot) -> Self {
        let (size, husky) = (robot.size(), ThermalModel::default());
        ThermalModel {
            winding_j_per_k: size * husky.winding_j_per_k,
            case_j_per_k: size * husky.case_j_per_k,
            winding_to_case_k_per_w: husky.winding_to_case_k_per_w / size,
            case_to_air_k_per_w: husky.case_to_air_k_per_w / size,
        }
    }

    /// Time in which a motor without losses loses all but 1/e of its heat to the air, the winding through the case [s].
    ///
    /// ```text
    /// τ = (C_w + C_c) R_ca + C_w R_wc
    /// ```
    ///
    /// The sum of both time constants of the two stores, and so no less than the slower.
    pub fn time_constant_s(&self) -> f64 {
        (self.winding_j_per_k + self.case_j_per_k) * self.case_to_air_k_per_w
            + self.winding_j_per_k * self.winding_to_case_k_per_w
    }
}

/// Temperatures of one motor [°C].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorHeat {
    /// The copper, which eqs. 7-10 ask for.
    pub winding_c: f64,
    /// The case, which a thermistor sees.
    pub case_c: f64,
}

impl MotorHeat {
    /// A motor that has stood long enough to be as warm as the air.
    pub fn at_rest(ambient_c: f64) -> Self {
        MotorHeat { winding_c: ambient_c, case_c: ambient_c }
    }

    /// Advances by `step_s`, which may be of any length, with losses held constant.
    ///
    /// Long steps are cut into short ones. After [`SETTLED_TIME_CONSTANTS`] both stores have settled where losses and air hold them:
    ///
    /// ```text
    /// T_c = T_a + R_ca (k1 F² + gear loss)
    /// T_w = T_c + R_wc k1 F²
    /// ```
    pub fn advance(&mut self, model: &ThermalModel, copper_w: f64, gear_w: f64, ambient_c: f64, step_s: f64) {
        /// The explicit step of the case is stable below two of its time constants of 13 min, and accurate well below [s].
        const SHORT_S: f64 = 60.0;
        if step_s <= SHORT_S {
            return self.advance_shortly(model, copper_w, gear_w, ambient_c, step_s);
        }
        if step_s >= SETTLED_TIME_CONSTANTS * model.time_constant_s() {
            self.case_c = ambient_c + model.case_to_air_k_per_w * (copper_w + gear_w);
            self.winding_c = self.case_c + model.winding_to_case_k_per_w * copper_w;
            return;
        }
        let steps = (step_s / SHORT_S).ceil();
        for _ in 0..steps as usize {
            self.advance_shortly(model, copper_w, gear_w, ambient_c, step_s / steps);
        }
    }

    /// The same for a step that is short beside the time constant of the case; exact for the winding, which is the fast store.
    #[inline]
    fn advance_shortly(
        &mut self,
        model: &ThermalModel,
        copper_w: f64,
        gear_w: f64,
        ambient_c: f64,
        step_s: f64,
    ) {
        let settled_c = self.case_c + copper_w * model.winding_to_case_k_per_w;
        let decay = (-step_s / (model.winding_j_per_k * model.winding_to_case_k_per_w)).exp();
        let winding_c = settled_c + (self.winding_c - settled_c) * decay;
        let stored_j = model.winding_j_per_k * (winding_c - self.winding_c);
        let to_case_j = copper_w * step_s - stored_j;
        let to_air_w = (self.case_c - ambient_c) / model.case_to_air_k_per_w;
        self.case_c += (to_case_j + (gear_w - to_air_w) * step_s) / model.case_j_per_k;
        self.winding_c = winding_c;
    }
}

/// Time constants after which a store differs from where it settles by less than rounding: e⁻⁴⁰ is 4 · 10⁻¹⁸.
pub const SETTLED_TIME_CONSTANTS: f64 = 40.0;

/// Copper and gear losses of both sides at one instant [W].
pub fn losses_w(robot: &Robot, power: &Power, winding_c: Sides<f64>) -> Sides<(f64, f64)> {
    let motors: Sides<WarmMotor> =
        robot.motor_sides().zip(winding_c).map(|(m, t)| m.at_temperature(&robot.motors, t));
    motors.zip(power.force_n).zip(power.side_w.zip(power.mechanical_w)).map(|((motor, f), (side, mech))| {
        let copper_w = motor.k1_w_per_n2 * f * f;
        (copper_w, (side - copper_w - mech).max(0.0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Attitude, Motion, PowerModel, builtin, power};

    /// Spins at 1 rad/s on marble and returns case temperatures and the side powers at the start and the end.
    fn spin(seconds: u32) -> (Sides<f64>, Power, Power) {
        let robot = builtin::husky_a200();
        let marble = &robot.surfaces["marble"];
        let model = ThermalModel::default();
        let mut heat = Sides::both(MotorHeat::at_rest(20.0));
        let watts = |heat: Sides<MotorHeat>| {
            let motion = Motion::of_body(&robot, 0.0, 1.0);
            power(
                PowerModel::ForceBalance,
                &robot,
                marble,
                motion,
                Attitude::LEVEL,
                heat.map(|h| h.winding_c),
            )
        };
        let first = watts(heat);
        for _ in 0..seconds {
            let losses = losses_w(&robot, &watts(heat), heat.map(|h| h.winding_c));
            for (motor, (copper_w, gear_w)) in
                [(&mut heat.left, losses.left), (&mut heat.right, losses.right)]
            {
                motor.advance(&model, copper_w, gear_w, 20.0, 1.0);
            }
        }
        (heat.map(|h| h.case_c), first, watts(heat))
    }

    #[test]
    fn twenty_three_minutes_of_spinning_warm_the_case_to_76_c() {
        let (case_c, _, _) = spin(23 * 60);
        assert!((case_c.left - 76.0).abs() < 6.0, "left {}", case_c.left);
        assert!((case_c.right - 76.0).abs() < 12.0, "right {}", case_c.right);
    }

    #[test]
    fn twice_the_losses_warm_motors_of_twice_the_robot_alike() {
        let mut twice = builtin::husky_a200();
        twice.mass_kg *= 2.0;
        let warmed = |model: ThermalModel, size: f64| {
            let mut heat = MotorHeat::at_rest(20.0);
            (0..1000).for_each(|_| heat.advance(&model, 40.0 * size, 45.0 * size, 20.0, 1.0));
            [heat.winding_c, heat.case_c]
        };
        let husky = ThermalModel::of(&builtin::husky_a200());
        assert_eq!(husky, ThermalModel::default());
        let pairs = warmed(husky, 1.0).into_iter().zip(warmed(ThermalModel::of(&twice), 2.0));
        pairs.for_each(|(one, two)| assert!((one - two).abs() < 1e-9 && one > 30.0, "{one} {two}"));
    }

    #[test]
    fn heat_raises_the_power_of_the_same_motion_by_at_least_a_fifth() {
        let (_, cold, hot) = spin(23 * 60);
        for ratio in [hot.side_w.left / cold.side_w.left, hot.side_w.right / cold.side_w.right] {
            // The paper saw 150/106 = 1.42 and 193/116 = 1.66.
            assert!((1.2..1.7).contains(&ratio), "{ratio}");
        }
    }

    #[test]
    fn a_motor_at_rest_stays_at_air_temperature_and_a_warm_one_cools_to_it() {
        let model = ThermalModel::default();
        let mut heat = MotorHeat::at_rest(20.0);
        heat.advance(&model, 0.0, 0.0, 20.0, 60.0);
        assert_eq!(heat, MotorHeat::at_rest(20.0));
        let mut warm = MotorHeat { winding_c: 90.0, case_c: 70.0 };
        for _ in 0..100_000 {
            warm.advance(&model, 0.0, 0.0, 20.0, 1.0);
        }
        assert!((warm.winding_c - 20.0).abs() < 0.01 && (warm.case_c - 20.0).abs() < 0.01);
    }

    #[test]
    fn a_step_of_any_length_warms_as_many_short_ones_do() {
        let model = ThermalModel::default();
        for minutes in [1_u32, 5, 60, 600, 6000] {
            let (mut long, mut short) = (MotorHeat::at_rest(20.0), MotorHeat::at_rest(20.0));
            long.advance(&model, 40.0, 15.0, 20.0, 60.0 * f64::from(minutes));
            (0..600 * minutes).for_each(|_| short.advance(&model, 40.0, 15.0, 20.0, 0.1));
            assert!((long.case_c - short.case_c).abs() < 1.5, "{minutes} min: {long:?} {short:?}");
            assert!((long.winding_c - short.winding_c).abs() < 1.5, "{minutes} min: {long:?} {short:?}");
        }
        // 55 W over 0.65 K/W, and 40 W over 0.3 K/W on top.
        for endless_s in [1e6, 1e300, f64::INFINITY] {
            let mut settled = MotorHeat::at_rest(20.0);
            settled.advance(&model, 40.0, 15.0, 20.0, endless_s);
            assert!((settled.case_c - 55.75).abs() < 1e-9 && (settled.winding_c - 67.75).abs() < 1e-9);
        }
    }

    #[test]
    fn the_time_constant_is_no_less_than_that_of_the_slow_store() {
        let model = ThermalModel::default();
        let mut warm = MotorHeat { winding_c: 90.0, case_c: 90.0 };
        for _ in 0..(SETTLED_TIME_CONSTANTS * model.time_constant_s()) as u32 {
            warm.advance(&model, 0.0, 0.0, 20.0, 1.0);
        }
        assert!((warm.case_c - 20.0).abs() < 1e-9 && (warm.winding_c - 20.0).abs() < 1e-9, "{warm:?}");
    }
}
