//! The battery: open voltage by charge, resistance, and what is left.

use crate::RobotFile;

/// A pack where the robot file has none: that of a Husky A200.
const CAPACITY_WH: f64 = 480.0;
const NOMINAL_V: f64 = 24.0;
/// Inner resistance of a pack of 24 V and 20 Ah with its cables [Ω].
const RESISTANCE_OHM: f64 = 0.045;
/// Open voltage over the nominal one, empty and full; lead and lithium packs fall by about so much.
const OPEN_VOLTAGE: [f64; 2] = [0.96, 1.06];

/// Nominal voltage of a robot's battery [V].
pub(crate) fn nominal_v(robot: &RobotFile) -> f64 {
    robot.battery.map_or(NOMINAL_V, |battery| battery.nominal_voltage_v)
}

/// A battery in use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Battery {
    capacity_j: f64,
    nominal_v: f64,
    resistance_ohm: f64,
    /// Charge left, 1 full.
    pub(crate) charge: f64,
    /// Voltage at the terminals [V].
    pub(crate) voltage_v: f64,
    /// Current drawn [A].
    pub(crate) current_a: f64,
}

impl Battery {
    /// A full battery.
    pub(crate) fn full(robot: &RobotFile) -> Self {
        let capacity_wh = robot.battery.map_or(CAPACITY_WH, |battery| battery.capacity_wh);
        let nominal_v = nominal_v(robot);
        Battery {
            capacity_j: capacity_wh * 3600.0,
            nominal_v,
            // A pack of twice the voltage or half the capacity has cells of more resistance in series.
            resistance_ohm: RESISTANCE_OHM * (nominal_v / NOMINAL_V).powi(2) * CAPACITY_WH / capacity_wh,
            charge: 1.0,
            voltage_v: nominal_v * OPEN_VOLTAGE[1],
            current_a: 0.0,
        }
    }

    /// Voltage over the nominal one at the terminals [-].
    pub(crate) fn relative_voltage(&self) -> f64 {
        self.voltage_v / self.nominal_v
    }

    /// Delivers a power for a step and returns the energy that the cells gave, own heat included [J].
    pub(crate) fn deliver_j(&mut self, power_w: f64, step_s: f64) -> f64 {
        let open_v = self.nominal_v * (OPEN_VOLTAGE[0] + (OPEN_VOLTAGE[1] - OPEN_VOLTAGE[0]) * self.charge);
        // V (V_o − V) / R = P has its larger root at the load that the pack was made for.
        let root = open_v * open_v - 4.0 * self.resistance_ohm * power_w;
        self.voltage_v = 0.5 * (open_v + root.max(0.0).sqrt());
        self.current_a = power_w / self.voltage_v;
        let given_j = open_v * self.current_a * step_s;
        self.charge = (self.charge - given_j / self.capacity_j).clamp(0.0, 1.0);
        given_j
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example_robot;

    #[test]
    fn load_lets_the_voltage_sag_and_braking_charges() {
        let mut battery = Battery::full(&example_robot());
        let given_j = battery.deliver_j(300.0, 1.0);
        assert!(battery.voltage_v < 25.2 && battery.voltage_v > 24.0, "{}", battery.voltage_v);
        let heat_w = RESISTANCE_OHM * battery.current_a.powi(2);
        assert!((given_j - 300.0 - heat_w).abs() < 1e-9, "what cells give is load and their own heat");
        let charge = battery.charge;
        battery.deliver_j(-50.0, 1.0);
        assert!(battery.charge > charge);
    }
}
