//! The `force-balance` model: side forces from a quasi-static balance, continuous over every turning radius.

use crate::{
    Robot, Sides,
    lateral::SidewaysPull,
    mechanism::Adjustment,
    motion::Motion,
    robot::Surface,
    rolling,
    skid::{self, Skid, SkidLaw},
};

/// Side forces of one motion on one surface, per newton of weight; the slope enters later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SideForces {
    /// Rolling resistance of each side over the robot's normal load m g cos γ, along its way [-].
    pub(crate) rolling: Sides<f64>,
    /// What steepness adds to it, per sin γ and share of itself [-].
    pub(crate) steepening: f64,
    /// What a load that shifts to the lower side adds to it, per tan φ [-].
    pub(crate) shifting: Sides<f64>,
    /// Force over the normal load by which the right side drives against the skid of a turn, and the left side brakes [-].
    pub(crate) skid: f64,
    /// What sideways pull leaves of it.
    pub(crate) pull: SidewaysPull<f64>,
    /// Share of gravity's pull m g sin γ sin β that each side carries [-].
    pub(crate) gravity_share: Sides<f64>,
}

/// What a motion makes of friction coefficients: everything in its side forces but μ_R and μ_S themselves.
///
/// Fits ask for the same motions with other coefficients again and again; this is the part that costs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionShape {
    /// s: direction of each side's rolling, −1 to 1 [-].
    rolling: Sides<f64>,
    /// What skids.
    skid: Skid,
    /// ε: load share of the front axle beyond one half [-].
    load_forward: f64,
}

/// What the shapes of all motions of a robot on ground of one slip-angle scale share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeLaw {
    skid: SkidLaw,
    /// ε: load share of the front axle beyond one half [-].
    load_forward: f64,
}

impl ShapeLaw {
    /// Prepares shapes on ground of a slip-angle scale α_s [rad].
    pub fn new(robot: &Robot, slip_angle_scale_rad: f64) -> Self {
        ShapeLaw { skid: SkidLaw::new(robot, slip_angle_scale_rad), load_forward: skid::load_forward(robot) }
    }

    /// The shape of a motion.
    #[inline(always)]
    pub fn shape(&self, motion: &Motion) -> FrictionShape {
        FrictionShape {
            rolling: motion.rim_speeds_mps.map(rolling::direction),
            skid: self.skid.skid(motion.speed_mps, motion.yaw_rate_radps),
            load_forward: self.load_forward,
        }
    }
}

/// What a robot and a surface make of every shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// μ_R n: rolling resistance of each side over the normal load [-].
    rolling_per_load: Sides<f64>,
    /// μ_S [-].
    mu_skid: f64,
    /// b [m].
    track_m: f64,
    /// μ_R of each side [-].
    mu_roll: Sides<f64>,
    /// See [`Adjustment::mu_roll_per_steepness`].
    steepening: f64,
    /// See [`Adjustment::load_left_per_tilt`].
    load_left_per_tilt: f64,
    /// See [`Adjustment::load_forward_per_along`].
    load_forward_per_along: f64,
}

impl Friction {
    /// Friction of a robot on a surface.
    pub fn new(robot: &Robot, surface: &Surface) -> Self {
        Friction {
            rolling_per_load: rolling::load_share(robot).map(|n| surface.mu_roll * n),
            mu_skid: surface.mu_skid,
            track_m: robot.track_m,
            mu_roll: Sides::both(surface.mu_roll),
            steepening: 0.0,
            load_left_per_tilt: 0.0,
            load_forward_per_along: 0.0,
        }
    }

    /// The same with what a mechanism changes of it.
    #[inline(always)]
    pub(crate) fn adjusted(&self, adjustment: &Adjustment) -> Friction {
        let shifted = Sides { left: adjustment.load_left, right: -adjustment.load_left };
        let rolling = self.rolling_per_load.zip(shifted).zip(self.mu_roll.zip(adjustment.mu_roll));
        Friction {
            rolling_per_load: rolling.map(|((r, shifted), (mu_roll, c))| c * (r + mu_roll * shifted)),
            mu_skid: adjustment.mu_skid * self.mu_skid,
            mu_roll: self.mu_roll.zip(adjustment.mu_roll).map(|(mu_roll, c)| c * mu_roll),
            steepening: adjustment.mu_roll_per_steepness,
            load_left_per_tilt: adjustment.load_left_per_tilt,
            load_forward_per_along: adjustment.load_forward_per_along,
            ..*self
        }
    }
}

impl FrictionShape {
    /// The shape of a motion on ground of a slip-angle scale α_s [rad].
    pub fn new(robot: &Robot, slip_angle_scale_rad: f64, motion: &Motion) -> Self {
        ShapeLaw::new(robot, slip_angle_scale_rad).shape(motion)
    }

    /// Balances rolling and skid resistance and gravity.
    ///
    /// ```text
    /// F_l + F_r       = N μ_R (n_l s_l + n_r s_r)                 + m g sinγ sinβ + m dv/dt
    /// (F_r − F_l) b/2 = f M_skid + N μ_R (n_r s_r − n_l s_l) b/2  + I dω/dt
    /// ```
    ///
    /// n load share of a side (eq. 14), s direction of its rolling, N normal load, f what sideways pull leaves of the skid
    /// ([`SidewaysPull`]). The correction of μ_R in eq. 16 for a centre of mass off the middle, found there by experiment, is left out: the
    /// wheels together carry the same load wherever it lies, and what such a robot skids less is in M_skid.
    #[inline(always)]
    pub(crate) fn side_forces(&self, friction: &Friction) -> SideForces {
        let shifted = Sides { left: friction.load_left_per_tilt, right: -friction.load_left_per_tilt };
        let shifting = friction.mu_roll.zip(shifted).zip(self.rolling).map(|((mu, n), s)| mu * n * s);
        SideForces {
            rolling: friction.rolling_per_load.zip(self.rolling).map(|(r, s)| r * s),
            steepening: friction.steepening,
            shifting,
            skid: self.skid.arm_m * (friction.mu_skid / friction.track_m),
            pull: SidewaysPull::new(friction.mu_skid, &self.skid)
                .shifted([self.load_forward, friction.load_forward_per_along], &self.skid),
            gravity_share: Sides::both(0.5),
        }
    }
}
