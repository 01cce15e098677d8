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
    /// `self · factor + term`; rounded once only in single precision, where it is evaluated with the instruction for it.
    fn mul_add(self, factor: Self, term: Self) -> Self;
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
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
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
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        f32::mul_add(self, factor, term)
    }
}

/// Slack that takes the floor of the bus out of play [W].
pub(crate) const NO_FLOOR_W: f64 = 1e30;

/// Everything about a steady motion that power depends on, except the slope.
///
/// ```text
/// F_i = A_i + N (ρ_i (1 + c sin γ) + τ_i tan φ ± f(tan φ, sin γ sin β) σ) + (G_i ± T tan φ) sin γ sin β,   N = cos γ
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
    /// T: force by which the right side drives, and the left side brakes, against a weight that leans over the lower side [N].
    pub leaning_n: T,
    /// k1(T) [W/N²].
    pub k1_w_per_n2: Sides<T>,
    /// Electrical power per force of a side that pushes forwards, beside k1: rim speed times k2, or r/k2 where the force is
    /// against the motion [W/N].
    pub forwards_mps: Sides<T>,
    /// The same of a side that pushes backwards [W/N].
    pub backwards_mps: Sides<T>,
    /// Least power of the bus per `along` uphill, and most that comes back of it downhill [W].
    pub floor_w: [T; 2],
    /// By how much the bus may go below that floor [W]; the printed form needs it, the force balance keeps it anyway.
    pub slack_w: T,
    /// Hotel load and drive electronics [W].
    pub standing_w: T,
}

impl<T: Real> PowerKernel<T> {
    /// Side forces on a grade [N].
    #[inline(always)]
    pub fn forces_n(&self, grade: Grade<T>) -> Sides<T> {
        // Most robots do not have the one, and half of all motions not the other.
        let steepened = if self.steepening == T::ZERO { T::ZERO } else { self.steepened(grade.normal) };
        let skid_n = if self.skid_n == T::ZERO { T::ZERO } else { self.skid_left_n(grade.tilt, grade.along) };
        self.forces_of_n(grade, steepened, skid_n)
    }

    /// c sin γ: share by which steepness adds to rolling resistance.
    #[inline(always)]
    pub fn steepened(&self, normal: T) -> T {
        // Rounding may bring cos γ a little above 1.
        let squared = T::from_f64(1.0) - normal * normal;
        self.steepening * (if squared > T::ZERO { squared } else { T::ZERO }).sqrt()
    }

    /// f σ: force by which the right side drives against the skid of the turn where the ground tilts and climbs [N].
    #[inline(always)]
    pub fn skid_left_n(&self, tilt: T, along: T) -> T {
        self.skid_n * self.pull.left_of_skid(tilt, along)
    }

    /// Side forces on a grade, from the two terms that cost a square root each [N].
    #[inline(always)]
    pub fn forces_of_n(&self, grade: Grade<T>, steepened: T, skid_n: T) -> Sides<T> {
        let Grade { normal, along, tilt } = grade;
        let leaning_n = self.leaning_n * tilt;
        let side = |added: T, rolling: T, shifting: T, lifting: T, skid: T| {
            let per_load_n = shifting.mul_add(tilt, rolling.mul_add(steepened, rolling)) + skid;
            per_load_n.mul_add(normal, lifting.mul_add(along, added))
        };
        Sides {
            left: side(
                self.added_n.left,
                self.rolling_n.left,
                self.shifting_n.left,
                self.lifting_n.left - leaning_n,
                -skid_n,
            ),
            right: side(
                self.added_n.right,
                self.rolling_n.right,
                self.shifting_n.right,
                self.lifting_n.right + leaning_n,
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
        let side = |force: T, k1: T, forwards: T, backwards: T| {
            k1.mul_add(force, if force >= T::ZERO { forwards } else { backwards }) * force
        };
        Sides {
            left: side(force_n.left, self.k1_w_per_n2.left, self.forwards_mps.left, self.backwards_mps.left),
            right: side(
                force_n.right,
                self.k1_w_per_n2.right,
                self.forwards_mps.right,
                self.backwards_mps.right,
            ),
        }
    }

    /// Power drawn from the battery [W].
    #[inline(always)]
    pub fn bus_w(&self, side_w: Sides<T>, along: T) -> T {
        let [up_w, down_w] = self.floor_w;
        let floor_w = along.mul_add(if along >= T::ZERO { up_w } else { down_w }, -self.slack_w);
        let drawn_w = side_w.left + side_w.right;
        (if drawn_w >= floor_w { drawn_w } else { floor_w }) + self.standing_w
    }
}

/// What a force forwards and one backwards draw per newton, `driving` and `driven` of each mechanical watt [W/N].
#[inline(always)]
pub(crate) fn ahead_and_astern(rim_speed_mps: f64, driving: f64, driven: f64) -> [f64; 2] {
    let (with, against) = (rim_speed_mps * driving, rim_speed_mps * driven);
    if rim_speed_mps >= 0.0 { [with, against] } else { [against, with] }
}

impl PowerKernel<f64> {
    /// Sides with no force on them yet and nothing else that draws power.
    #[inline(always)]
    pub(crate) fn of_sides(k1_w_per_n2: Sides<f64>, per_force_mps: Sides<[f64; 2]>) -> Self {
        let [forwards_mps, backwards_mps] = [0, 1].map(|way| per_force_mps.map(|ways| ways[way]));
        let nothing = Sides::both(0.0);
        PowerKernel {
            added_n: nothing,
            rolling_n: nothing,
            steepening: 0.0,
            shifting_n: nothing,
            skid_n: 0.0,
            pull: SidewaysPull::NONE,
            lifting_n: nothing,
            leaning_n: 0.0,
            k1_w_per_n2,
            forwards_mps,
            backwards_mps,
            floor_w: [0.0, 0.0],
            slack_w: NO_FLOOR_W,
            standing_w: 0.0,
        }
    }

    /// A robot's motors at rim speeds and temperatures, with no force on them yet and nothing else that draws power.
    pub fn of_motors(robot: &Robot, rim_speed_mps: Sides<f64>, motor_c: Sides<f64>) -> Self {
        let motors =
            robot.motor_sides().zip(motor_c).map(|(motor, c)| motor.at_temperature(&robot.motors, c));
        let per_force_mps = motors
            .zip(rim_speed_mps)
            .map(|(motor, u)| ahead_and_astern(u, motor.k2, robot.motors.regeneration / motor.k2));
        Self::of_sides(motors.map(|m| m.k1_w_per_n2), per_force_mps)
    }

    /// A force that no side exceeds either way on slopes of up to a grade along the way and across it [N].
    ///
    /// Every term of [`PowerKernel`] at its largest: `N ≤ 1`, `sin γ ≤ 1`, `sin γ sin β` no more than the grade along, `tan φ` than that across.
    pub fn largest_force_n(&self, steepest: [f64; 2]) -> f64 {
        let [along, across] = steepest.map(f64::abs);
        let [least, most] = self.pull.range_left();
        let skid_n = self.skid_n.abs() * least.abs().max(most.abs());
        let side = |added: f64, rolling: f64, shifting: f64, lifting: f64| {
            let loaded_n = rolling.abs() * (1.0 + self.steepening.abs()) + shifting.abs() * across;
            added.abs() + loaded_n + (lifting.abs() + self.leaning_n.abs() * across) * along
        };
        let left = side(self.added_n.left, self.rolling_n.left, self.shifting_n.left, self.lifting_n.left);
        let right =
            side(self.added_n.right, self.rolling_n.right, self.shifting_n.right, self.lifting_n.right);
        left.max(right) + skid_n
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
            leaning_n: self.leaning_n as f32,
            k1_w_per_n2: both(self.k1_w_per_n2),
            forwards_mps: both(self.forwards_mps),
            backwards_mps: both(self.backwards_mps),
            floor_w: self.floor_w.map(|x| x as f32),
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
        fn no_slope_asks_a_side_for_more_than_its_largest_force(
            v in -1.0f64..1.0, w in -1.5f64..1.5, limits in [0.0f64..1.0, 0.0f64..1.0],
            along in -1.0f64..=1.0, across in -1.0f64..=1.0,
        ) {
            let kernel = kernel(v, w, 0.5);
            let (along, across) = (along * limits[0], across * limits[1]);
            let normal = 1.0 / (1.0 + along * along + across * across).sqrt();
            let force_n = kernel.forces_n(Grade { normal, along: along * normal, tilt: across });
            let most_n = force_n.left.abs().max(force_n.right.abs());
            prop_assert!(most_n <= kernel.largest_force_n(limits), "{most_n} N");
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
