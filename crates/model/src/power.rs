//! The one function that computes power; prediction, planning, range and fitting all call it.

use serde::{Deserialize, Serialize};

use crate::{
    Robot, Sides,
    balance::{Friction, FrictionShape, SideForces},
    gravity::{Attitude, STANDARD_GRAVITY_MPS2},
    kernel::PowerKernel,
    mechanism::Adjustment,
    motion::{Acceleration, Motion},
    paper::PaperForces,
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

/// One steady motion on one surface at one motor temperature, ready to be asked about any slope.
#[derive(Clone, Copy, Debug)]
pub struct Manoeuvre {
    motion: Motion,
    kernel: PowerKernel<f64>,
    mass_kg: f64,
    /// I / b: force difference per yaw acceleration, halved between the sides [N s²].
    turning_n_per_radps2: f64,
    /// What mechanisms add to each side's force, forward [N].
    added_n: Sides<f64>,
}

impl Manoeuvre {
    /// Prepares the side forces of a motion.
    pub fn new(
        model: PowerModel,
        robot: &Robot,
        surface: &Surface,
        motion: Motion,
        motor_temperature_c: Sides<f64>,
    ) -> Self {
        let forces = match model {
            PowerModel::ForceBalance => {
                let shape = FrictionShape::new(robot, surface.slip_angle_scale_rad, &motion);
                shape.side_forces(&Friction::new(robot, surface))
            }
            PowerModel::DogruMarques => PaperForces::new(robot, surface, &motion).side_forces(&motion),
        };
        Manoeuvre::of_forces(robot, motion, forces, motor_temperature_c, model == PowerModel::DogruMarques)
    }

    /// Prepares the side forces of a motion from its shape, by the force balance.
    ///
    /// The shape must be that of this motion on the slip-angle scale of the surface that the friction is that of.
    #[inline]
    pub fn of_shape(
        robot: &Robot,
        friction: &Friction,
        motion: Motion,
        shape: &FrictionShape,
        motor_temperature_c: Sides<f64>,
    ) -> Self {
        Manoeuvre::of_forces(robot, motion, shape.side_forces(friction), motor_temperature_c, false)
    }

    /// The same with what a mechanism adds ([`crate::mechanism`]).
    pub fn adjusted(
        robot: &Robot,
        friction: &Friction,
        motion: Motion,
        shape: &FrictionShape,
        motor_temperature_c: Sides<f64>,
        adjustment: &Adjustment,
    ) -> Self {
        let forces = shape.side_forces(&friction.adjusted(adjustment));
        let motor_c = motor_temperature_c.zip(adjustment.motor_k).map(|(c, k)| c + k);
        let mut manoeuvre = Manoeuvre::of_forces(robot, motion, forces, motor_c, false);
        let kernel = &mut manoeuvre.kernel;
        let heavier = 1.0 + adjustment.mass_kg / robot.mass_kg;
        kernel.friction_n = kernel.friction_n.map(|n| heavier * n);
        kernel.lifting_n = kernel.lifting_n.map(|n| heavier * n);
        kernel.lift_w *= heavier;
        kernel.driven = kernel.driven.zip(kernel.driving).map(|(d, k2)| d + adjustment.regeneration / k2);
        kernel.standing_w += adjustment.standing_w;
        manoeuvre.mass_kg += adjustment.mass_kg;
        manoeuvre.added_n = adjustment.force_n;
        manoeuvre
    }

    #[inline]
    fn of_forces(
        robot: &Robot,
        motion: Motion,
        forces: SideForces,
        motor_temperature_c: Sides<f64>,
        printed: bool,
    ) -> Self {
        let motors = robot
            .motor_sides()
            .zip(motor_temperature_c)
            .map(|(motor, temperature_c)| motor.at_temperature(&robot.motors, temperature_c));
        let regeneration = robot.motors.regeneration;
        let weight_n = robot.mass_kg * STANDARD_GRAVITY_MPS2;
        let least_k2 = motors.left.k2.min(motors.right.k2);
        let electronics =
            motion.rim_speeds_mps.map(|u| if u == 0.0 { 0.0 } else { robot.drive_electronics_w });
        let kernel = PowerKernel {
            friction_n: forces.friction_per_load.map(|f| weight_n * f),
            lifting_n: forces.gravity_share.map(|share| weight_n * share),
            rim_speed_mps: motion.rim_speeds_mps,
            k1_w_per_n2: motors.map(|m| m.k1_w_per_n2),
            driving: motors.map(|m| m.k2),
            driven: motors.map(|m| if printed { m.k2 } else { regeneration / m.k2 }),
            lift_w: weight_n * motion.speed_mps,
            floor: [least_k2, regeneration / least_k2],
            slack_w: if printed { 0.0 } else { NO_FLOOR_W },
            standing_w: robot.hotel_power_w + electronics.sum(),
        };
        let turning_n_per_radps2 = robot.yaw_inertia_kgm2 / robot.track_m;
        Manoeuvre { motion, kernel, mass_kg: robot.mass_kg, turning_n_per_radps2, added_n: Sides::both(0.0) }
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
    pub fn power(&self, attitude: Attitude) -> Power {
        self.power_accelerating(attitude, Acceleration::NONE)
    }

    /// Power on a slope while speeds change.
    pub fn power_accelerating(&self, attitude: Attitude, acceleration: Acceleration) -> Power {
        self.power_on_grade(attitude.weight_normal(), attitude.weight_along(), acceleration)
    }

    /// Power where the shares of the weight across (cos γ) and along (sin γ sin β) the heading are known.
    #[inline]
    pub fn power_on_grade(&self, normal: f64, along: f64, acceleration: Acceleration) -> Power {
        let steady_n = self.kernel.forces_n(normal, along);
        let forward_n = self.mass_kg * acceleration.forward_mps2 / 2.0;
        let turning_n = self.turning_n_per_radps2 * acceleration.yaw_radps2;
        let force_n = Sides {
            left: steady_n.left + forward_n - turning_n + self.added_n.left,
            right: steady_n.right + forward_n + turning_n + self.added_n.right,
        };
        let side_w = self.kernel.side_w(force_n);
        Power {
            force_n,
            mechanical_w: force_n.zip(self.motion.rim_speeds_mps).map(|(f, u)| f * u),
            side_w,
            bus_w: self.kernel.bus_w(side_w, along),
        }
    }
}

/// Slack that takes the floor of the printed form out of play [W].
const NO_FLOOR_W: f64 = 1e30;

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
