//! The `force-balance` model: side forces from a quasi-static balance, continuous over every turning radius.

use crate::{Robot, Sides, motion::Motion, robot::Surface, rolling, skid};

/// Side forces of one motion on one surface, per newton of weight; the slope enters later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SideForces {
    /// Friction force of each side over the robot's normal load m g cos γ [-].
    pub(crate) friction_per_load: Sides<f64>,
    /// Share of gravity's pull m g sin γ sin β that each side carries [-].
    pub(crate) gravity_share: Sides<f64>,
}

/// Balances rolling and skid resistance and gravity for a motion.
///
/// ```text
/// F_l + F_r       = N c μ_R (n_l s_l + n_r s_r)               + m g sinγ sinβ + m dv/dt
/// (F_r − F_l) b/2 = M_skid + N c μ_R (n_r s_r − n_l s_l) b/2  + I dω/dt
/// ```
///
/// n load share of a side (eq. 14), s direction of its rolling, c the correction of eq. 16, N normal load.
pub(crate) fn side_forces(robot: &Robot, surface: &Surface, motion: &Motion) -> SideForces {
    let mu_roll = surface.mu_roll * rolling::center_of_mass_correction(robot);
    let rolling = rolling::load_share(robot)
        .zip(motion.rim_speeds_mps)
        .map(|(n, u)| mu_roll * n * rolling::direction(u));
    let moment_m = skid::moment_per_load_m(robot, surface, motion.speed_mps, motion.yaw_rate_radps);
    let skid = moment_m / robot.track_m;
    SideForces {
        friction_per_load: Sides { left: rolling.left - skid, right: rolling.right + skid },
        gravity_share: Sides::both(0.5),
    }
}
