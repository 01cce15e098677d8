//! The arithmetic of one steady motion on any slope, in double or single precision.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::{Robot, Sides, gravity::Grade, lateral::SidewaysPull};

/// A float that the kernel computes with: f64 for answers, f32 where millions of edges are evaluated side by side.
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Zero.
    const ZERO: Self;
    /// Rounds a double to this precision.
    fn from_f64(value: f64) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value as f32
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }
}

/// Slack that takes the floor of the bus out of play [W].
pub(crate) const NO_FLOOR_W: f64 = 1e30;

/// Everything about a steady motion that power depends on, except the slope.
///
/// ```text
/// F_i = A_i + N (ρ_i (1 + c sin γ) + τ_i tan φ ± f(tan φ) σ) + G_i sin γ sin β,   N = cos γ
/// ```
///
/// + on the right and − on the left; the fields below are the rest, in this order, each for the whole weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerKernel<T> {
    /// A: force of each side that no slope changes [N].
    pub added_n: Sides<T>,
    /// ρ: rolling resistance of each side on level ground, along its way [N].
    pub rolling_n: Sides<T>,
    /// c: what steepness adds to rolling resistance [-].
    pub steepening: T,
    /// τ: what a load that shifts to the lower side adds to its rolling resistance, per tan φ [N].
    pub shifting_n: Sides<T>,
    /// σ: force by which the right side drives against the skid of a turn, and the left side brakes [N].
    pub skid_n: T,
    /// f: what sideways pull leaves of it.
    pub pull: SidewaysPull<T>,
    /// G: force of each side that lifts the robot, straight up [N].
    pub lifting_n: Sides<T>,
    /// u: rim speeds [m/s].
    pub rim_speed_mps: Sides<T>,
    /// k1(T) [W/N²].
    pub k1_w_per_n2: Sides<T>,
    /// Electrical per mechanical power where the side drives [-].
    pub driving: Sides<T>,
    /// Electrical per mechanical power where the ground drives the side [-].
    pub driven: Sides<T>,
    /// Power of lifting the robot straight up at its speed, m g v [W].
    pub lift_w: T,
    /// Least electrical per lifting power uphill and most that comes back of it downhill [-].
    pub floor: [T; 2],
    /// By how much the bus may go below that floor [W]; the printed form needs it, the force balance keeps it anyway.
    pub slack_w: T,
    /// Hotel load and drive electronics [W].
    pub standing_w: T,
}

impl<T: Real> PowerKernel<T> {
    /// Side forces on a grade [N].
    #[inline(always)]
    pub fn forces_n(&self, grade: Grade<T>) -> Sides<T> {
        let Grade { normal, along, tilt } = grade;
        // sin γ; rounding may bring cos γ a little above 1.
        let steep = T::from_f64(1.0) - normal * normal;
        let steepened = self.steepening * (if steep > T::ZERO { steep } else { T::ZERO }).sqrt();
        let skid_n = self.skid_n * self.pull.left_of_skid(tilt);
        let side = |added: T, rolling: T, shifting: T, lifting: T, skid: T| {
            added + normal * (rolling + rolling * steepened + shifting * tilt + skid) + lifting * along
        };
        Sides {
            left: side(
                self.added_n.left,
                self.rolling_n.left,
                self.shifting_n.left,
                self.lifting_n.left,
                -skid_n,
            ),
            right: side(
                self.added_n.right,
                self.rolling_n.right,
                self.shifting_n.right,
                self.lifting_n.right,
                skid_n,
            ),
        }
    }

    /// Electrical power of each side [W].
    ///
    /// ```text
    /// P = k1 F² + k2 u F        driving, u F ≥ 0 (eq. 2)
    /// P = k1 F² + r u F / k2    back-driven, u F < 0
    /// ```
    ///
    /// F wheel force of the side [N], u rim speed [m/s], r fraction of the back-driven power that reaches the bus.
    /// Back-driven, the same gears lose on the way back, so k2 divides; a cycle can then never create energy. The
    /// printed form has k2 in both places.
    #[inline(always)]
    pub fn side_w(&self, force_n: Sides<T>) -> Sides<T> {
        let side = |force: T, rim: T, k1: T, driving: T, driven: T| {
            let mechanical = force * rim;
            k1 * force * force + mechanical * if mechanical >= T::ZERO { driving } else { driven }
        };
        Sides {
            left: side(
                force_n.left,
                self.rim_speed_mps.left,
                self.k1_w_per_n2.left,
                self.driving.left,
                self.driven.left,
            ),
            right: side(
                force_n.right,
                self.rim_speed_mps.right,
                self.k1_w_per_n2.right,
                self.driving.right,
                self.driven.right,
            ),
        }
    }

    /// Power drawn from the battery [W].
    #[inline(always)]
    pub fn bus_w(&self, side_w: Sides<T>, along: T) -> T {
        let lift_w = self.lift_w * along;
        let floor_w = lift_w * (if lift_w >= T::ZERO { self.floor[0] } else { self.floor[1] }) - self.slack_w;
        let drawn_w = side_w.left + side_w.right;
        (if drawn_w >= floor_w { drawn_w } else { floor_w }) + self.standing_w
    }
}

impl PowerKernel<f64> {
    /// A robot's motors at rim speeds and temperatures, with no force on them yet and nothing else that draws power.
    pub fn of_motors(robot: &Robot, rim_speed_mps: Sides<f64>, motor_c: Sides<f64>) -> Self {
        let motors =
            robot.motor_sides().zip(motor_c).map(|(motor, c)| motor.at_temperature(&robot.motors, c));
        let least_k2 = motors.left.k2.min(motors.right.k2);
        let nothing = Sides::both(0.0);
        PowerKernel {
            added_n: nothing,
            rolling_n: nothing,
            steepening: 0.0,
            shifting_n: nothing,
            skid_n: 0.0,
            pull: SidewaysPull::NONE,
            lifting_n: nothing,
            rim_speed_mps,
            k1_w_per_n2: motors.map(|m| m.k1_w_per_n2),
            driving: motors.map(|m| m.k2),
            driven: motors.map(|m| robot.motors.regeneration / m.k2),
            lift_w: 0.0,
            floor: [least_k2, robot.motors.regeneration / least_k2],
            slack_w: NO_FLOOR_W,
            standing_w: 0.0,
        }
    }

    /// The same kernel in single precision.
    pub fn single(&self) -> PowerKernel<f32> {
        let both = |sides: Sides<f64>| sides.map(|x| x as f32);
        PowerKernel {
            added_n: both(self.added_n),
            rolling_n: both(self.rolling_n),
            steepening: self.steepening as f32,
            shifting_n: both(self.shifting_n),
            skid_n: self.skid_n as f32,
            pull: self.pull.single(),
            lifting_n: both(self.lifting_n),
            rim_speed_mps: both(self.rim_speed_mps),
            k1_w_per_n2: both(self.k1_w_per_n2),
            driving: both(self.driving),
            driven: both(self.driven),
            lift_w: self.lift_w as f32,
            floor: self.floor.map(|x| x as f32),
            slack_w: self.slack_w as f32,
            standing_w: self.standing_w as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{Manoeuvre, Motion, PowerModel, builtin};

    fn kernel(speed_mps: f64, yaw_radps: f64, regeneration: f64) -> PowerKernel<f64> {
        let mut robot = builtin::husky_a200();
        robot.motors.regeneration = regeneration;
        let motion = Motion::of_body(&robot, speed_mps, yaw_radps);
        let marble = &robot.surfaces["marble"];
        *Manoeuvre::new(PowerModel::ForceBalance, &robot, marble, motion, Sides::both(20.0)).kernel()
    }

    proptest! {
        #[test]
        fn a_side_never_draws_less_than_the_mechanical_power_it_could_come_from(
            force in -1000.0f64..1000.0, speed in -2.0f64..2.0, r in 0.0f64..=1.0,
        ) {
            let side = kernel(speed, 0.0, r).side_w(Sides::both(force));
            prop_assert!(side.left >= force * speed - 1e-9 && side.right >= force * speed - 1e-9);
        }

        #[test]
        fn a_side_is_continuous_where_the_flow_of_power_turns_round(speed in -2.0f64..2.0, r in 0.0f64..=1.0) {
            let kernel = kernel(speed, 0.0, r);
            let step = kernel.side_w(Sides::both(1e-9)).left - kernel.side_w(Sides::both(-1e-9)).left;
            prop_assert!(step.abs() < 1e-7);
        }

        #[test]
        fn single_precision_gives_the_same_power_to_six_digits(
            v in 0.1f64..1.0, w in -1.5f64..1.5, along in -0.4f64..0.4, tilt in -0.2f64..0.2, r in 0.0f64..=1.0,
        ) {
            let double = kernel(v, w, r);
            let single = double.single();
            let bus = double.bus_w(double.side_w(double.forces_n(Grade { normal: 0.95, along, tilt })), along);
            let (along, tilt) = (along as f32, tilt as f32);
            let bus_32 = single.bus_w(single.side_w(single.forces_n(Grade { normal: 0.95, along, tilt })), along);
            prop_assert!((f64::from(bus_32) - bus).abs() < 1e-5 * (bus.abs() + 100.0), "{bus_32} for {bus}");
        }
    }
}
