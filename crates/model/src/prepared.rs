//! A robot on one surface, prepared for the power of many motions there.

use std::borrow::Cow;

use multiversion::multiversion;

use crate::{
    Robot, Sides,
    balance::{Friction, ShapeLaw},
    gravity::Attitude,
    mechanism::{Adjustment, Moment},
    motion::{Motion, RimSpeeds},
    paper::PaperForces,
    power::{Floor, Manoeuvre, Power, PowerModel},
    robot::Surface,
};

/// A robot on one surface, with everything worked out that all motions there share.
#[derive(Clone, Copy, Debug)]
pub struct PreparedSurface<'r> {
    model: PowerModel,
    robot: &'r Robot,
    surface: &'r Surface,
    friction: Friction,
    shapes: ShapeLaw,
    rims: RimSpeeds,
    /// The height of its load, or mechanisms of the robot or of this surface, act.
    is_adjusted: bool,
    /// Its wheels slip.
    slips: bool,
}

/// Steady moments as columns, each of one value for all moments or of as many as there are moments.
#[derive(Clone, Copy, Debug)]
pub struct MomentColumns<'a> {
    /// Forward speed [m/s].
    pub speed_mps: &'a [f64],
    /// Yaw rate, positive turning left [rad/s].
    pub yaw_rate_radps: &'a [f64],
    /// Pitch, positive climbing [rad].
    pub pitch_rad: &'a [f64],
    /// Roll, positive left side up [rad].
    pub roll_rad: &'a [f64],
    /// Temperature of each side's motor [°C].
    pub motor_temperature_c: Sides<&'a [f64]>,
}

/// Where the power of moments is written, all columns of the same length.
#[derive(Debug)]
pub struct PowerColumns<'a> {
    /// Power drawn from the battery [W].
    pub bus_w: &'a mut [f64],
    /// Electrical power at the motor drivers [W].
    pub side_w: Sides<&'a mut [f64]>,
    /// Wheel force of each side [N].
    pub force_n: Sides<&'a mut [f64]>,
}

impl<'r> PreparedSurface<'r> {
    /// Prepares the power of a robot on a surface.
    pub fn new(model: PowerModel, robot: &'r Robot, surface: &'r Surface) -> Self {
        PreparedSurface {
            model,
            robot,
            surface,
            friction: Friction::new(robot, surface),
            shapes: ShapeLaw::new(robot, surface.slip_angle_scale_rad),
            rims: RimSpeeds::of(robot),
            is_adjusted: robot.is_adjusted(surface),
            slips: robot.wheel_slip() != 0.0 || robot.turning_slip() != 0.0,
        }
    }

    /// The motion whose wheels turn as the slip track says.
    #[inline(always)]
    pub fn motion(&self, speed_mps: f64, yaw_rate_radps: f64) -> Motion {
        let rim_speeds_mps = self.rims.at_mps(speed_mps, yaw_rate_radps);
        Motion { speed_mps, yaw_rate_radps, rim_speeds_mps, heading_rad: None }
    }

    /// Prepares the side forces of a steady motion, with the mechanisms that the robot and the surface have.
    ///
    /// The printed form takes mechanisms of friction as other coefficients, alike on both sides and on every slope.
    pub fn manoeuvre(&self, motion: Motion, motor_temperature_c: Sides<f64>) -> Manoeuvre {
        let adjustment = if self.is_adjusted {
            self.robot.adjustment(self.surface, &Moment::steady(motion))
        } else {
            Adjustment::default()
        };
        match self.model {
            PowerModel::ForceBalance => self.balanced(motion, motor_temperature_c, &adjustment),
            PowerModel::DogruMarques => self.printed(motion, motor_temperature_c, &adjustment),
        }
    }

    /// The force balance of a motion.
    #[inline(always)]
    fn balanced(
        &self,
        motion: Motion,
        motor_temperature_c: Sides<f64>,
        adjustment: &Adjustment,
    ) -> Manoeuvre {
        let forces = self.shapes.shape(&motion).side_forces(&self.friction.adjusted(adjustment));
        // Steady motion keeps the floor of itself, but not where wind pushes harder than friction holds: going in circles must not
        // pay there either.
        let pushed = self.slips
            || adjustment.force_n != Sides::both(0.0)
            || adjustment.lifting_n != Sides::both(0.0)
            || adjustment.leaning_n != 0.0;
        let floor = if pushed { Floor::Kept } else { Floor::None };
        Manoeuvre::of_forces(self.robot, motion, forces, motor_temperature_c, adjustment, floor)
    }

    /// The forces of a motion as printed.
    fn printed(&self, motion: Motion, motor_temperature_c: Sides<f64>, adjustment: &Adjustment) -> Manoeuvre {
        let surface = if self.is_adjusted {
            Cow::Owned(self.surface.scaled(adjustment.mu_roll.sum() / 2.0, adjustment.mu_skid))
        } else {
            Cow::Borrowed(self.surface)
        };
        let forces = PaperForces::new(self.robot, &surface, &motion).side_forces(&motion);
        Manoeuvre::of_forces(self.robot, motion, forces, motor_temperature_c, adjustment, Floor::Printed)
    }

    /// Power of the moments from number `first` on, as many as `powers` has room for.
    ///
    /// # Panics
    /// Where a column of neither one value nor enough is given, or columns of different lengths are to be written.
    pub fn powers(&self, moments: &MomentColumns<'_>, first: usize, powers: PowerColumns<'_>) {
        let PowerColumns { bus_w, side_w, force_n } = powers;
        let columns = [bus_w, side_w.left, side_w.right, force_n.left, force_n.right];
        let count = columns[0].len();
        assert!(columns.iter().all(|column| column.len() == count), "columns to write are of one length");
        let (mut block, mut found) = (Block::default(), [[0.0; BLOCK]; 5]);
        let by_side = self.is_adjusted || self.model != PowerModel::ForceBalance;
        let mut columns = columns;
        for from in (0..count).step_by(BLOCK) {
            let places = from..count.min(from + BLOCK);
            block.take(moments, first + from, places.len());
            if by_side {
                self.each(&block, &mut found, |motion, motor_c| self.manoeuvre(motion, motor_c));
            } else if moments.motor_temperature_c.left.len() == 1
                && moments.motor_temperature_c.right.len() == 1
            {
                powers_at_one_temperature(self, &block, &mut found);
            } else {
                powers_at_temperatures(self, &block, &mut found);
            }
            for (column, found) in columns.iter_mut().zip(&found) {
                column[places.clone()].copy_from_slice(&found[..places.len()]);
            }
        }
    }

    #[inline(always)]
    fn each(
        &self,
        block: &Block,
        found: &mut [[f64; BLOCK]; 5],
        manoeuvre: impl Fn(Motion, Sides<f64>) -> Manoeuvre,
    ) {
        for i in 0..BLOCK {
            let motor_c = Sides { left: block.left_c[i], right: block.right_c[i] };
            let motion = self.motion(block.speed_mps[i], block.yaw_rate_radps[i]);
            let attitude = Attitude { pitch_rad: block.pitch_rad[i], roll_rad: block.roll_rad[i] };
            let Power { bus_w, side_w, force_n, .. } = manoeuvre(motion, motor_c).power(attitude);
            let all = [bus_w, side_w.left, side_w.right, force_n.left, force_n.right];
            for (column, value) in found.iter_mut().zip(all) {
                column[i] = value;
            }
        }
    }
}

/// Moments that are computed side by side: few enough to stay in the nearest cache.
const BLOCK: usize = 128;

/// Columns of a block of moments; places that no moment fills hold earlier ones.
struct Block {
    speed_mps: [f64; BLOCK],
    yaw_rate_radps: [f64; BLOCK],
    pitch_rad: [f64; BLOCK],
    roll_rad: [f64; BLOCK],
    left_c: [f64; BLOCK],
    right_c: [f64; BLOCK],
}

impl Default for Block {
    fn default() -> Self {
        let nothing = [0.0; BLOCK];
        Block {
            speed_mps: nothing,
            yaw_rate_radps: nothing,
            pitch_rad: nothing,
            roll_rad: nothing,
            left_c: nothing,
            right_c: nothing,
        }
    }
}

impl Block {
    fn take(&mut self, moments: &MomentColumns<'_>, first: usize, count: usize) {
        let Sides { left, right } = moments.motor_temperature_c;
        for (values, column) in [
            (&mut self.speed_mps, moments.speed_mps),
            (&mut self.yaw_rate_radps, moments.yaw_rate_radps),
            (&mut self.pitch_rad, moments.pitch_rad),
            (&mut self.roll_rad, moments.roll_rad),
            (&mut self.left_c, left),
            (&mut self.right_c, right),
        ] {
            match column {
                [one] => values.fill(*one),
                _ => values[..count].copy_from_slice(&column[first..first + count]),
            }
        }
    }
}

/// Without mechanisms, by the force balance, with motors that stay as warm as at the first moment.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2+fma", "aarch64+neon"))]
fn powers_at_one_temperature(prepared: &PreparedSurface<'_>, block: &Block, found: &mut [[f64; BLOCK]; 5]) {
    let motor_c = Sides { left: block.left_c[0], right: block.right_c[0] };
    let nothing = Adjustment::default();
    prepared.each(block, found, |motion, _| prepared.balanced(motion, motor_c, &nothing));
}

/// Without mechanisms, by the force balance.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2+fma", "aarch64+neon"))]
fn powers_at_temperatures(prepared: &PreparedSurface<'_>, block: &Block, found: &mut [[f64; BLOCK]; 5]) {
    let nothing = Adjustment::default();
    prepared.each(block, found, |motion, motor_c| prepared.balanced(motion, motor_c, &nothing));
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::{builtin, power};

    /// More than one block, and not a whole number of them.
    const MOMENTS: usize = 2 * BLOCK + 5;

    fn spread(irrational: f64, most: f64) -> Vec<f64> {
        (0..MOMENTS).map(|i| most * (2.0 * (i as f64 * irrational).fract() - 1.0)).collect()
    }

    fn husky(changes: &[(&str, Value)]) -> Robot {
        let mut file = serde_json::to_value(builtin::husky_a200()).unwrap();
        for (pointer, value) in changes {
            let (object, key) = pointer.rsplit_once('/').unwrap();
            file.pointer_mut(object).unwrap()[key] = value.clone();
        }
        Robot::from_json(&file.to_string()).unwrap()
    }

    #[test]
    fn columns_hold_to_the_last_bit_what_each_moment_comes_to_by_itself() {
        let soft = json!([{"mechanism": "soft_soil", "parameters": {"sinking": 0.5}}]);
        let slipping = json!([{"mechanism": "wheel_slip", "parameters": {"slip": 0.2, "turning": 0.1}}]);
        let robots = [
            husky(&[]),
            husky(&[("/surfaces/marble/slip_angle_scale_rad", json!(0.0))]),
            husky(&[("/center_of_mass/forward_m", json!(0.06)), ("/center_of_mass/left_m", json!(-0.04))]),
            husky(&[("/center_of_mass/height_m", json!(0.4)), ("/motors/regeneration", json!(0.3))]),
            husky(&[("/surfaces/marble/mechanisms", soft), ("/drive_electronics_w", json!(4.0))]),
            husky(&[("/mechanisms", slipping)]),
        ];
        let mut speed_mps = spread(std::f64::consts::SQRT_2, 1.0);
        let mut yaw_rate_radps = spread(std::f64::consts::E, 1.5);
        // Standing, straight on, on the spot, and one side at rest.
        speed_mps[..4].copy_from_slice(&[0.0, 0.5, 0.0, 0.27]);
        yaw_rate_radps[..4].copy_from_slice(&[0.0, 0.0, 1.0, 1.0]);
        let (pitch_rad, roll_rad) = (spread(std::f64::consts::PI, 0.4), spread(std::f64::consts::LN_2, 0.3));
        let warm_c: Vec<f64> = spread(std::f64::consts::LN_10, 30.0).iter().map(|c| c + 40.0).collect();
        for robot in &robots {
            let marble = robot.surface("marble").unwrap();
            for model in [PowerModel::ForceBalance, PowerModel::DogruMarques] {
                for left_c in [&[20.0][..], &warm_c] {
                    let moments = MomentColumns {
                        speed_mps: &speed_mps,
                        yaw_rate_radps: &yaw_rate_radps,
                        pitch_rad: &pitch_rad,
                        roll_rad: &roll_rad,
                        motor_temperature_c: Sides { left: left_c, right: &[25.0] },
                    };
                    let first = 3;
                    let mut found =
                        [const { Vec::new() }; 5].map(|_: Vec<f64>| vec![f64::NAN; MOMENTS - first]);
                    let [bus_w, left_w, right_w, left_n, right_n] = &mut found;
                    let side_w = Sides { left: &mut left_w[..], right: &mut right_w[..] };
                    let force_n = Sides { left: &mut left_n[..], right: &mut right_n[..] };
                    PreparedSurface::new(model, robot, marble).powers(
                        &moments,
                        first,
                        PowerColumns { bus_w, side_w, force_n },
                    );
                    for i in first..MOMENTS {
                        let motion = Motion::of_body(robot, speed_mps[i], yaw_rate_radps[i]);
                        let attitude = Attitude { pitch_rad: pitch_rad[i], roll_rad: roll_rad[i] };
                        let left = left_c[if left_c.len() == 1 { 0 } else { i }];
                        let p = power(model, robot, marble, motion, attitude, Sides { left, right: 25.0 });
                        let alone = [p.bus_w, p.side_w.left, p.side_w.right, p.force_n.left, p.force_n.right];
                        let together = [0, 1, 2, 3, 4].map(|column| found[column][i - first]);
                        assert_eq!(together, alone, "moment {i} by {model:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_no_number_stays_none() {
        let robot = builtin::husky_a200();
        let prepared = PreparedSurface::new(PowerModel::ForceBalance, &robot, &robot.surfaces["marble"]);
        for place in 0..4 {
            let mut values = [0.4, 0.3, 0.1, 0.05];
            values[place] = f64::NAN;
            let [speed_mps, yaw_rate_radps, pitch_rad, roll_rad] = values;
            let motion = prepared.motion(speed_mps, yaw_rate_radps);
            let power = prepared.manoeuvre(motion, Sides::both(20.0)).power(Attitude { pitch_rad, roll_rad });
            assert!(power.side_w.left.is_nan(), "{place}");
        }
    }
}
