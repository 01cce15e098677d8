//! Controllers, motors and battery as they run.

use super::{Plant, SideState};
use crate::{RobotFile, effect::Conditions};

/// Gains of the speed controller over what the magnets induce [- and 1/s].
const PROPORTIONAL: f64 = 2.2;
const INTEGRAL_PER_S: f64 = 18.0;
/// A side that is told to stand is held by its brake from this rim speed down [m/s].
const BRAKE_HOLDS_MPS: f64 = 0.01;
/// Rim speed from which on a side's driver is awake [m/s].
const AWAKE_MPS: f64 = 0.004;

impl Plant<'_> {
    /// Controller and winding of one side; returns the force of its magnets at the rim and the gears' dry friction [N].
    pub(super) fn drive(&mut self, side: usize, command_mps: f64) -> (f64, f64) {
        let s = &mut self.sides[side];
        s.braked = command_mps == 0.0 && s.rim_mps.abs() < BRAKE_HOLDS_MPS;
        if s.braked {
            (s.current_a, s.integral_v, s.duty) = (0.0, 0.0, 0.0);
            return (0.0, 0.0);
        }
        let error_mps = command_mps - s.rim_mps;
        let wanted_v = s.train.open_voltage_v(command_mps + PROPORTIONAL * error_mps) + s.integral_v;
        let limit_v = self.battery.voltage_v;
        let applied_v = wanted_v.clamp(-limit_v, limit_v);
        if applied_v == wanted_v {
            s.integral_v += s.train.open_voltage_v(INTEGRAL_PER_S * error_mps) * self.step_s;
        }
        s.duty = applied_v / limit_v;
        let winding_c = warmed(s, &self.conditions, self.robot);
        s.current_a = s.train.current_a(s.current_a, applied_v, s.rim_mps, winding_c, self.step_s);
        s.train.force_n(s.current_a, winding_c)
    }

    /// What motors, electronics and battery draw and how they warm.
    pub(super) fn draw(&mut self) {
        let mut bus_w = self.robot.hotel_power_w + self.conditions.hotel_w;
        self.ledger.electronics_j += bus_w * self.step_s;
        for i in 0..2 {
            let s = &mut self.sides[i];
            let winding_c = warmed(s, &self.conditions, self.robot);
            let power = s.train.power(s.current_a, s.rim_mps, winding_c, self.conditions.returned);
            let awake_w = if s.rim_mps.abs() > AWAKE_MPS { self.robot.drive_electronics_w } else { 0.0 };
            let own_w = awake_w + self.conditions.driver_w[i];
            s.heat.advance(
                power.copper_w,
                0.4 * power.conversion_w.abs(),
                self.ambient_c,
                self.speed[0],
                self.step_s,
            );
            self.drawn_j[i] += (power.drawn_w + own_w) * self.step_s;
            self.motor_as[i] += s.current_a.abs() * self.step_s;
            self.ledger.copper_j += power.copper_w * self.step_s;
            self.ledger.conversion_j += power.conversion_w * self.step_s;
            self.ledger.electronics_j += own_w * self.step_s;
            bus_w += power.drawn_w + own_w;
        }
        let given_j = self.battery.deliver_j(bus_w, self.step_s);
        self.drawn_j[2] += bus_w * self.step_s;
        self.ledger.given_j += given_j;
        self.ledger.battery_j += given_j - bus_w * self.step_s;
    }
}

/// Winding temperature that resistance and magnets follow [°C]: the reference, unless an effect lets the warming show.
fn warmed(side: &SideState, conditions: &Conditions, robot: &RobotFile) -> f64 {
    let reference_c = robot.motors.reference_temperature_c;
    reference_c + conditions.warming * (side.heat.winding_c - reference_c)
}
