//! The drive train of one side: driver, winding, magnets, gears.

use crate::{RobotFile, battery::nominal_v};

/// Share of the wheel's force that load presses into friction of gears and belt, driving. A part of what the robot
/// file's k2 stands for; what is left of k2 is lost in the conversion between magnets and bus.
const GEAR_FRICTION: f64 = 0.10;
/// What magnets induce at top speed over the battery's voltage, where the file does not tell the force per ampere: for a
/// Husky 9 V at 1 m/s, with which a spin takes some 18 A a side, as recorded (BorealTC, LaRocque et al. 2024).
const INDUCED_AT_TOP: f64 = 0.375;
/// Inductance of the winding over its resistance [s]; brushed motors of a few hundred watts have 1 to 5 ms.
const ELECTRIC_TIME_S: f64 = 0.003;
/// Voltage that switches and diodes of the driver take from every ampere [V].
const DRIVER_DROP_V: f64 = 0.05;

/// What belongs to one side's drive train.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DriveTrain {
    /// Resistance at the reference temperature [Ω].
    resistance_ohm: f64,
    /// Induced voltage per rim speed, which is force per ampere before the gears' friction [V s/m = N/A].
    magnets: f64,
    /// Power at the driver per power converted, driving [-].
    conversion: f64,
    /// Fraction of the power converted back that reaches the bus.
    regeneration: f64,
    resistance_per_k: f64,
    magnets_per_k: f64,
    reference_c: f64,
}

/// Powers of one side at one instant [W].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SidePower {
    /// Drawn at the driver.
    pub(crate) drawn_w: f64,
    /// Heat of the winding.
    pub(crate) copper_w: f64,
    /// Heat of conversion and driver.
    pub(crate) conversion_w: f64,
}

impl DriveTrain {
    /// The circuit whose steady state is that of the file's k1 and k2 when it drives.
    pub(crate) fn new(robot: &RobotFile, left: bool) -> Self {
        let motors = &robot.motors;
        let file = if left { motors.left } else { motors.right };
        let delivered = 1.0 - GEAR_FRICTION;
        let induced = INDUCED_AT_TOP * nominal_v(robot) / robot.max_wheel_speed_mps;
        let magnets = file.force_n_per_a.map_or(induced, |force_n_per_a| force_n_per_a / delivered);
        DriveTrain {
            // P = R i² with i = F / (K (1 − c)).
            resistance_ohm: file.k1_w_per_n2 * (magnets * delivered).powi(2),
            magnets,
            conversion: (file.k2 * delivered).max(1.0),
            regeneration: motors.regeneration,
            resistance_per_k: motors.resistance_per_k,
            magnets_per_k: motors.motor_constant_per_k,
            reference_c: motors.reference_temperature_c,
        }
    }

    /// Resistance and magnets at a winding temperature [Ω, V s/m].
    fn warm(&self, winding_c: f64) -> (f64, f64) {
        let rise_k = winding_c - self.reference_c;
        let resistance = self.resistance_ohm * (1.0 + self.resistance_per_k * rise_k).max(0.2);
        (resistance, self.magnets * (1.0 + self.magnets_per_k * rise_k).max(0.2))
    }

    /// The current a step later, implicit in the winding's own decay [A].
    pub(crate) fn current_a(
        &self,
        before_a: f64,
        applied_v: f64,
        rim_mps: f64,
        winding_c: f64,
        step_s: f64,
    ) -> f64 {
        let (resistance, magnets) = self.warm(winding_c);
        let inductance = self.resistance_ohm * ELECTRIC_TIME_S;
        (before_a + step_s / inductance * (applied_v - magnets * rim_mps))
            / (1.0 + step_s * resistance / inductance)
    }

    /// Force of the magnets at the rim and the dry friction that it presses into the gears [N].
    pub(crate) fn force_n(&self, current_a: f64, winding_c: f64) -> (f64, f64) {
        let (_, magnets) = self.warm(winding_c);
        let force_n = magnets * current_a;
        (force_n, GEAR_FRICTION * force_n.abs())
    }

    /// Power at the driver; `returned` is the fraction of back-driven power that an effect lets through.
    pub(crate) fn power(&self, current_a: f64, rim_mps: f64, winding_c: f64, returned: f64) -> SidePower {
        let (resistance, magnets) = self.warm(winding_c);
        let copper_w = resistance * current_a * current_a;
        let converted_w = magnets * current_a * rim_mps;
        // Brushes and iron lose with the current, which weaker magnets need more of.
        let weakness = self.magnets / magnets;
        let bus_w = if converted_w >= 0.0 {
            converted_w * (1.0 + (self.conversion - 1.0) * weakness)
        } else {
            converted_w * self.regeneration * returned / self.conversion
        };
        let driver_w = DRIVER_DROP_V * current_a.abs();
        SidePower {
            drawn_w: copper_w + bus_w + driver_w,
            copper_w,
            conversion_w: bus_w - converted_w + driver_w,
        }
    }

    /// Voltage that holds a rim speed without load [V].
    pub(crate) fn open_voltage_v(&self, rim_mps: f64) -> f64 {
        self.magnets * rim_mps
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::example_robot;

    /// Power and rim force in steady state at a current.
    fn steady(current_a: f64, rim_mps: f64, winding_c: f64) -> (f64, f64) {
        let train = DriveTrain::new(&example_robot(), true);
        let (magnets_n, gears_n) = train.force_n(current_a, winding_c);
        let force_n = magnets_n - gears_n * rim_mps.signum();
        (train.power(current_a, rim_mps, winding_c, 1.0).drawn_w, force_n)
    }

    #[test]
    fn a_driving_side_draws_what_the_files_constants_say_within_three_per_cent() {
        for (current_a, rim_mps) in [(4.0, 0.5), (16.0, 0.3), (20.0, 0.8)] {
            let (drawn_w, force_n) = steady(current_a, rim_mps, 20.0);
            let file_w = 0.0023 * force_n.powi(2) + 1.7158 * rim_mps * force_n;
            assert!((drawn_w / file_w - 1.0).abs() < 0.03, "{drawn_w} W for {file_w} W");
        }
    }

    #[test]
    fn a_driven_side_returns_less_than_it_is_given() {
        for (current_a, rim_mps) in [(-4.0, 0.5), (-10.0, 0.8)] {
            let (drawn_w, force_n) = steady(current_a, rim_mps, 20.0);
            assert!(drawn_w > force_n * rim_mps, "{drawn_w} W of {} W", force_n * rim_mps);
        }
    }

    #[test]
    fn heat_raises_the_power_of_the_same_force_and_speed() {
        // 56 K raised the power of a spin by 42 and 66 % in Dogru & Marques (2018), §V-B.
        let cold = steady(16.0, 0.27, 20.0);
        let train = DriveTrain::new(&example_robot(), true);
        let warm_a = 16.0 * train.warm(20.0).1 / train.warm(76.0).1;
        let warm = steady(warm_a, 0.27, 76.0);
        assert!((warm.1 / cold.1 - 1.0).abs() < 1e-9, "the same force");
        assert!((1.1..1.6).contains(&(warm.0 / cold.0)), "{}", warm.0 / cold.0);
    }

    proptest! {
        #[test]
        fn a_side_draws_at_least_what_its_rim_delivers(
            current_a in -60.0f64..60.0, rim_mps in -1.5f64..1.5, winding_c in -20.0f64..150.0, returned in 0.0f64..=1.0,
        ) {
            let train = DriveTrain::new(&example_robot(), true);
            let (magnets_n, gears_n) = train.force_n(current_a, winding_c);
            let force_n = magnets_n - gears_n * rim_mps.signum();
            let drawn_w = train.power(current_a, rim_mps, winding_c, returned).drawn_w;
            prop_assert!(drawn_w >= force_n * rim_mps - 1e-9, "{} W drawn, {} W delivered", drawn_w, force_n * rim_mps);
        }
    }
}
