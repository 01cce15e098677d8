//! The `force-balance` model: side forces from a quasi-static balance, continuous over every turning radius.

use crate::{
    Robot, Sides,
    gravity::STANDARD_GRAVITY_MPS2,
    motion::{Acceleration, Motion},
    robot::Surface,
    rolling, skid,
};

/// Side forces of one motion on one surface, per newton of normal load; the slope enters later.
///
/// Splitting the work here keeps one formula for a single prediction and for the millions of edges of a
/// map: what depends on speed, radius and surface is found once, gravity is added for each place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionForces {
    /// Friction force of each side over the robot's normal load m g cos γ [-].
    pub per_load: Sides<f64>,
}

impl FrictionForces {
    /// Balances rolling and skid resistance for a motion.
    ///
    /// ```text
    /// F_l + F_r       = N c μ_R (n_l s_l + n_r s_r)                       + m g sinγ sinβ + m dv/dt
    /// (F_r − F_l) b/2 = M_skid + N c μ_R (n_r s_r − n_l s_l) b/2           + I dω/dt
    /// ```
    ///
    /// n load share of a side (eq. 14), s direction of its rolling, c the correction of eq. 16, N normal load.
    pub fn new(robot: &Robot, surface: &Surface, motion: &Motion) -> Self {
        let mu_roll = surface.mu_roll * rolling::center_of_mass_correction(robot);
        let rolling = rolling::load_share(robot)
            .zip(motion.rim_speeds_mps)
            .map(|(n, u)| mu_roll * n * rolling::direction(u));
        let skid =
            skid::moment_per_load_m(robot, surface, motion.speed_mps, motion.yaw_rate_radps) / robot.track_m;
        FrictionForces { per_load: Sides { left: rolling.left - skid, right: rolling.right + skid } }
    }

    /// The side forces on a slope, with accelerations [N].
    ///
    /// `normal` and `along` are the shares of the weight across and along the heading (eqs. 4 and 5).
    #[inline]
    pub fn on_slope_n(
        &self,
        robot: &Robot,
        normal: f64,
        along: f64,
        acceleration: Acceleration,
    ) -> Sides<f64> {
        let weight_n = robot.mass_kg * STANDARD_GRAVITY_MPS2;
        let shared_n = (weight_n * along + robot.mass_kg * acceleration.forward_mps2) / 2.0;
        let turning_n = robot.yaw_inertia_kgm2 * acceleration.yaw_radps2 / robot.track_m;
        Sides {
            left: weight_n * normal * self.per_load.left + shared_n - turning_n,
            right: weight_n * normal * self.per_load.right + shared_n + turning_n,
        }
    }
}
