//! The one function that computes power; prediction, planning, range and fitting all call it.

use serde::{Deserialize, Serialize};

use crate::{
    Robot, Sides,
    balance::FrictionForces,
    gravity::Attitude,
    motion::{Acceleration, Motion},
    motor::WarmMotor,
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
pub struct Manoeuvre<'a> {
    robot: &'a Robot,
    motion: Motion,
    forces: Forces,
    motors: Sides<WarmMotor>,
    standing_w: f64,
}

#[derive(Clone, Copy, Debug)]
enum Forces {
    Balance(FrictionForces),
    Paper(PaperForces),
}

impl<'a> Manoeuvre<'a> {
    /// Prepares the side forces of a motion.
    pub fn new(
        model: PowerModel,
        robot: &'a Robot,
        surface: &Surface,
        motion: Motion,
        motor_temperature_c: Sides<f64>,
    ) -> Self {
        let forces = match model {
            PowerModel::ForceBalance => Forces::Balance(FrictionForces::new(robot, surface, &motion)),
            PowerModel::DogruMarques => Forces::Paper(PaperForces::new(robot, surface, &motion)),
        };
        let motors = robot
            .motor_sides()
            .zip(motor_temperature_c)
            .map(|(motor, temperature_c)| motor.at_temperature(&robot.motors, temperature_c));
        let driving = motion.rim_speeds_mps.map(|u| if u == 0.0 { 0.0 } else { robot.drive_electronics_w });
        Manoeuvre { robot, motion, forces, motors, standing_w: robot.hotel_power_w + driving.sum() }
    }

    /// The motion this was prepared for.
    pub fn motion(&self) -> &Motion {
        &self.motion
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
        match &self.forces {
            Forces::Balance(friction) => {
                let force_n = friction.on_slope_n(self.robot, normal, along, acceleration);
                let rims = force_n.zip(self.motion.rim_speeds_mps);
                let r = self.robot.motors.regeneration;
                let side_w = rims.zip(self.motors).map(|((f, u), motor)| motor.power_w(f, u, r));
                Power {
                    force_n,
                    mechanical_w: rims.map(|(f, u)| f * u),
                    side_w,
                    bus_w: side_w.sum() + self.standing_w,
                }
            }
            Forces::Paper(paper) => {
                paper.power(self.robot, &self.motion, self.motors, (normal, along), self.standing_w)
            }
        }
    }
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
