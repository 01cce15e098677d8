//! The one function that computes power; prediction, planning, range and fitting all call it.

use serde::{Deserialize, Serialize};

use crate::{
    Robot, Sides,
    balance::{Friction, FrictionShape, SideForces},
    gravity::{Attitude, Grade, STANDARD_GRAVITY_MPS2},
    kernel::{NO_FLOOR_W, PowerKernel, ahead_and_astern},
    mechanism::Adjustment,
    motion::{Acceleration, Motion},
    prepared::PreparedSurface,
    robot::Surface,
};

/// Which form of the physics computes the power.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "kebab-case")]
pub enum PowerModel {
    /// Eq. 2 on each side, with side forces from a balance that is continuous over all radii.
    #[default]
    ForceBalance,
    /// Eqs. 1-17 region by region, as printed.
    DogruMarques,
}

/// The power of one instant and what it is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power {
    /// Wheel force of each side [N].
    pub force_n: Sides<f64>,
    /// Mechanical power at the rims, F u [W].
    pub mechanical_w: Sides<f64>,
    /// Electrical power at the motor drivers [W]; negative when a side returns power.
    pub side_w: Sides<f64>,
    /// Power drawn from the battery, hotel load and drive electronics included [W].
    pub bus_w: f64,
}

/// One motion on one surface at one motor temperature, ready to be asked about any slope.
#[derive(Clone, Copy, Debug)]
pub struct Manoeuvre {
    motion: Motion,
    kernel: PowerKernel<f64>,
    mass_kg: f64,
    /// m a/2: half of it acts on each side where the centre of turning lies half a wheelbase off [kg m].
    drifting_kg_m: f64,
    /// I / b: force difference per yaw acceleration, halved between the sides [N s²].
    turning_n_per_radps2: f64,
}

impl Manoeuvre {
    /// Prepares the side forces of a steady motion, with the mechanisms that the robot and the surface have.
    ///
    /// The printed form takes mechanisms of friction as other coefficients, alike on both sides and on every slope.
    pub fn new(
        model: PowerModel,
        robot: &Robot,
        surface: &Surface,
        motion: Motion,
        motor_temperature_c: Sides<f64>,
    ) -> Self {
        PreparedSurface::new(model, robot, surface).manoeuvre(motion, motor_temperature_c)
    }

    /// Prepares the side forces of a motion from its shape, by the force balance, with what mechanisms add.
    ///
    /// The shape must be that of this motion on the slip-angle scale of the surface that the friction is that of, and the
    /// adjustment that of [`Robot::adjustment`], with what else is to act.
    #[inline]
    pub fn adjusted(
        robot: &Robot,
        friction: &Friction,
        motion: Motion,
        shape: &FrictionShape,
        motor_temperature_c: Sides<f64>,
        adjustment: &Adjustment,
    ) -> Self {
        let forces = shape.side_forces(&friction.adjusted(adjustment));
        Manoeuvre::of_forces(robot, motion, forces, motor_temperature_c, adjustment, Floor::None)
    }

    #[inline(always)]
    pub(crate) fn of_forces(
        robot: &Robot,
        motion: Motion,
        forces: SideForces,
        motor_temperature_c: Sides<f64>,
        adjustment: &Adjustment,
        floor: Floor,
    ) -> Self {
        let motor_c = motor_temperature_c.zip(adjustment.motor_k).map(|(c, k)| c + k);
        let motors =
            robot.motor_sides().zip(motor_c).map(|(motor, c)| motor.at_temperature(&robot.motors, c));
        let regeneration = robot.motors.regeneration + adjustment.regeneration;
        let mass_kg = robot.mass_kg + adjustment.mass_kg;
        let weight_n = mass_kg * STANDARD_GRAVITY_MPS2;
        let electronics =
            motion.rim_speeds_mps.map(|u| if u == 0.0 { 0.0 } else { robot.drive_electronics_w });
        let lifting_n =
            forces.gravity_share.zip(adjustment.lifting_n).map(|(share, more_n)| weight_n * share + more_n);
        let per_force_mps = motors.zip(motion.rim_speeds_mps).map(|(motor, u)| {
            let driven = if floor == Floor::Printed { motor.k2 } else { regeneration / motor.k2 };
            ahead_and_astern(u, motor.k2, driven)
        });
        // m g v: power of lifting the robot straight up at its speed.
        let lift_w = (weight_n + adjustment.lifting_n.sum()) * motion.speed_mps;
        let least_k2 = motors.left.k2.min(motors.right.k2);
        let kernel = PowerKernel {
            added_n: adjustment.force_n,
            rolling_n: forces.rolling.map(|f| weight_n * f),
            steepening: forces.steepening,
            shifting_n: forces.shifting.map(|f| weight_n * f),
            skid_n: weight_n * forces.skid,
            pull: forces.pull,
            lifting_n,
            leaning_n: adjustment.leaning_n,
            floor_w: ahead_and_astern(lift_w, least_k2, regeneration / least_k2),
            slack_w: if floor == Floor::None { NO_FLOOR_W } else { 0.0 },
            standing_w: robot.hotel_power_w + electronics.sum() + adjustment.standing_w,
            ..PowerKernel::of_sides(motors.map(|m| m.k1_w_per_n2), per_force_mps)
        };
        Manoeuvre {
            motion,
            kernel,
            mass_kg,
            drifting_kg_m: mass_kg * robot.wheelbase_m / 2.0,
            turning_n_per_radps2: robot.yaw_inertia_kgm2 / robot.track_m,
        }
    }

    /// The motion this was prepared for.
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// The arithmetic of this motion, for evaluating many places at once.
    pub fn kernel(&self) -> &PowerKernel<f64> {
        &self.kernel
    }

    /// Power in steady motion on a slope.
    #[inline(always)]
    pub fn power(&self, attitude: Attitude) -> Power {
        self.power_accelerating(attitude, Acceleration::NONE)
    }

    /// Power on a slope while speeds change.
    #[inline(always)]
    pub fn power_accelerating(&self, attitude: Attitude, acceleration: Acceleration) -> Power {
        self.power_on_grade(attitude.grade(), acceleration)
    }

    /// Side forces on a grade where tyres hold the robot on a circle as well [N].
    ///
    /// ```text
    /// F_l + F_r = … + m ω |ω| d
    /// ```
    ///
    /// Tyres that push inwards slip outwards: the robot turns about a place d ahead of its middle, and what pulls it there has to be driven
    /// against. It grows with the fourth power of speed on the same circle, so that slow robots hardly feel it.
    #[inline(always)]
    fn steady_n(&self, grade: Grade<f64>, left_mps2: f64) -> Sides<f64> {
        if left_mps2 == 0.0 {
            return self.kernel.forces_n(grade);
        }
        // Ground that rises to the left has to be held against as a turn to the left has.
        let held = grade.tilt + left_mps2 / (STANDARD_GRAVITY_MPS2 * grade.normal);
        let skid_n = self.kernel.skid_left_n(held, grade.along);
        let steady_n = self.kernel.forces_of_n(grade, self.kernel.steepened(grade.normal), skid_n);
        let yaw_rate_radps = self.motion.yaw_rate_radps;
        let drifting_n =
            self.drifting_kg_m * yaw_rate_radps * yaw_rate_radps.abs() * self.kernel.pull.drift(held) / 2.0;
        steady_n.map(|force_n| force_n + drifting_n)
    }

    /// Power where it is known how the ground carries the weight.
    #[inline(always)]
    pub fn power_on_grade(&self, grade: Grade<f64>, acceleration: Acceleration) -> Power {
        let steady_n = self.steady_n(grade, acceleration.left_mps2);
        let forward_n = self.mass_kg * acceleration.forward_mps2 / 2.0;
        // What leans over the lower side resists being sped up there as it does being lifted.
        let leaning_n =
            self.kernel.leaning_n * grade.tilt * acceleration.forward_mps2 / STANDARD_GRAVITY_MPS2;
        let turning_n = self.turning_n_per_radps2 * acceleration.yaw_radps2 + leaning_n;
        let force_n = Sides {
            left: steady_n.left + forward_n - turning_n,
            right: steady_n.right + forward_n + turning_n,
        };
        let side_w = self.kernel.side_w(force_n);
        Power {
            force_n,
            mechanical_w: force_n.zip(self.motion.rim_speeds_mps).map(|(f, u)| f * u),
            side_w,
            bus_w: self.kernel.bus_w(side_w, grade.along),
        }
    }
}

/// Whether the bus draws at least what lifting needs and returns at most what a descent holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Floor {
    /// The forces alone say what is drawn; while speeds change, a robot may give more back.
    None,
    /// Yes.
    Kept,
    /// Yes, with the printed form's losses of back-driven sides.
    Printed,
}

/// Electrical power of a robot at one instant.
///
/// The order of work is that of the physics: motion, loads, side forces, side powers, bus. Everything in
/// the program that needs watts calls this or the [`Manoeuvre`] inside it.
///
/// ```
/// use model::{Attitude, Motion, PowerModel, Sides, builtin, power};
/// let husky = builtin::husky_a200();
/// let spin = Motion::of_body(&husky, 0.0, 1.0);
/// let marble = husky.surface("marble")?;
/// let p = power(PowerModel::ForceBalance, &husky, marble, spin, Attitude::LEVEL, Sides::both(20.0));
/// assert!(p.side_w.left > 100.0 && p.side_w.left < 140.0); // the paper measured 106 W and 116 W
/// # Ok::<(), model::Error>(())
/// ```
pub fn power(
    model: PowerModel,
    robot: &Robot,
    surface: &Surface,
    motion: Motion,
    attitude: Attitude,
    motor_temperature_c: Sides<f64>,
) -> Power {
    Manoeuvre::new(model, robot, surface, motion, motor_temperature_c).power(attitude)
}
