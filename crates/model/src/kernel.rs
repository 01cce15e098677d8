//! The arithmetic of one steady motion on any slope, in double or single precision.

use std::ops::{Add, Mul, Neg, Sub};

use crate::Sides;

/// A float that the kernel computes with: f64 for answers, f32 where millions of edges are evaluated side by side.
pub trait Real:
    Copy + PartialOrd + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Zero.
    const ZERO: Self;
    /// Rounds a double to this precision.
    fn from_f64(value: f64) -> Self;
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value as f32
    }
}

/// Everything about a steady motion that power depends on, except the slope.
///
/// Forces are linear in the shares of the weight across and along the heading, so one multiplication and
/// addition a side gives them for any place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerKernel<T> {
    /// Friction force of each side on level ground [N].
    pub friction_n: Sides<T>,
    /// Force of each side that lifts the robot, straight up [N].
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
    /// Side forces where the shares of the weight across (cos γ) and along (sin γ sin β) the heading are known [N].
    #[inline(always)]
    pub fn forces_n(&self, normal: T, along: T) -> Sides<T> {
        Sides {
            left: self.friction_n.left * normal + self.lifting_n.left * along,
            right: self.friction_n.right * normal + self.lifting_n.right * along,
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
    /// The same kernel in single precision.
    pub fn single(&self) -> PowerKernel<f32> {
        let both = |sides: Sides<f64>| sides.map(|x| x as f32);
        PowerKernel {
            friction_n: both(self.friction_n),
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
            v in 0.1f64..1.0, w in -1.5f64..1.5, grade in -0.4f64..0.4, r in 0.0f64..=1.0,
        ) {
            let double = kernel(v, w, r);
            let single = double.single();
            let bus = double.bus_w(double.side_w(double.forces_n(0.95, grade)), grade);
            let along = grade as f32;
            let bus_32 = single.bus_w(single.side_w(single.forces_n(0.95, along)), along);
            prop_assert!((f64::from(bus_32) - bus).abs() < 1e-5 * (bus.abs() + 100.0), "{bus_32} for {bus}");
        }
    }
}
