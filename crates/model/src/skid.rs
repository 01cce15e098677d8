//! Lateral skid of the wheels while turning.

use crate::{
    Robot, Sides,
    elementary::{first_quadrant_angle, tanh_of_positive},
    lateral,
    robot::Surface,
};

/// Moment that skid sets against the turn, per newton of normal load [m].
///
/// ```text
/// M_skid / N = sgn(ω) f S m μ_S,   S = 2a (¼ − (δx/a)²),   m = Σ_i n_i tanh(α_i / α_s),   α_i = atan2(|ω| a/2, |v − ω y_i|)
/// ```
///
/// S arm of full skid (eq. 15), m share of it that the slip angles α_i of a turn about the middle of the base call up, n_i load share of a
/// side (eq. 14). α_s → 0 is the paper's Coulomb skid; α_s > 0 lets wide arcs skid less than tight ones, as rubber does.
///
/// f is what moving the centre of turning leaves (`level_share` in `lateral.rs`). Eq. 15 takes it abreast of the centre of mass. Wherever all
/// wheels skid as hard as they can, the heavier axle would then push sideways more than the other and nothing would hold against it, so that
/// the robot really turns about a place nearer to that axle: in a spin on Coulomb ground at the axle itself, where f S is the lighter
/// axle's load share times the wheelbase. Arcs so wide that tyres answer in proportion to their slip angles keep eq. 15, f = 1.
pub fn moment_per_load_m(robot: &Robot, surface: &Surface, speed_mps: f64, yaw_rate_radps: f64) -> f64 {
    let skid = SkidLaw::new(robot, surface.slip_angle_scale_rad).skid(speed_mps, yaw_rate_radps);
    skid.arm_m * surface.mu_skid
}

/// What a turn calls up of the full skid resistance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Skid {
    /// f S m of [`moment_per_load_m`], with the sign of the turn [m].
    pub(crate) arm_m: f64,
    /// m [-].
    pub(crate) mobilized: f64,
    /// f [-].
    pub(crate) level_share: f64,
}

impl Default for Skid {
    /// None.
    fn default() -> Self {
        Skid { arm_m: 0.0, mobilized: 0.0, level_share: 1.0 }
    }
}

/// What every turn of a robot on ground of one slip-angle scale shares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SkidLaw {
    /// α_s [rad].
    slip_angle_scale_rad: f64,
    base: SkidBase,
}

impl SkidLaw {
    pub(crate) fn new(robot: &Robot, slip_angle_scale_rad: f64) -> Self {
        SkidLaw { slip_angle_scale_rad, base: SkidBase::of(robot) }
    }

    /// The skid of a turn; none straight on.
    #[inline(always)]
    pub(crate) fn skid(&self, speed_mps: f64, yaw_rate_radps: f64) -> Skid {
        let slip_rad = self.base.slip_angles_rad(speed_mps, yaw_rate_radps);
        // No closure, which is not sure to be computed in place.
        let saturation = Sides {
            left: saturation(slip_rad.left, self.slip_angle_scale_rad),
            right: saturation(slip_rad.right, self.slip_angle_scale_rad),
        };
        let of = self.base.skid(yaw_rate_radps, saturation);
        Skid { arm_m: of.arm_m * sign(yaw_rate_radps), ..of }
    }
}

/// What skid asks of a robot's geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SkidBase {
    /// a/2 [m].
    half_wheelbase_m: f64,
    /// b/2 [m].
    half_track_m: f64,
    /// Load share of the left side beyond one half [-].
    load_left: f64,
    /// ε [-].
    load_forward: f64,
    /// S of [`moment_per_load_m`] [m].
    full_arm_m: f64,
}

impl SkidBase {
    fn of(robot: &Robot) -> Self {
        SkidBase {
            half_wheelbase_m: robot.wheelbase_m / 2.0,
            half_track_m: robot.track_m / 2.0,
            load_left: robot.center_of_mass.left_m / robot.track_m,
            load_forward: load_forward(robot),
            full_arm_m: full_arm_m(robot),
        }
    }

    /// α_i of [`moment_per_load_m`]; NaN where the robot stands [rad].
    #[inline(always)]
    fn slip_angles_rad(&self, speed_mps: f64, yaw_rate_radps: f64) -> Sides<f64> {
        let across_mps = (yaw_rate_radps * self.half_wheelbase_m).abs();
        let turned_mps = yaw_rate_radps * self.half_track_m;
        Sides {
            left: first_quadrant_angle(across_mps, (speed_mps - turned_mps).abs()),
            right: first_quadrant_angle(across_mps, (speed_mps + turned_mps).abs()),
        }
    }

    /// Of how much the wheels of each side feel of the full skid resistance, at any law; the arm without a sign.
    #[inline(always)]
    fn skid(&self, yaw_rate_radps: f64, felt: Sides<f64>) -> Skid {
        let mobilized = (0.5 + self.load_left) * felt.left + (0.5 - self.load_left) * felt.right;
        let mobilized = if yaw_rate_radps == 0.0 { 0.0 } else { mobilized };
        let level_share = lateral::level_share(self.load_forward, mobilized);
        Skid { arm_m: level_share * self.full_arm_m * mobilized, mobilized, level_share }
    }
}

/// ε: load share of the front axle beyond one half (eq. 14), −½ to ½.
pub(crate) fn load_forward(robot: &Robot) -> f64 {
    robot.center_of_mass.forward_m / robot.wheelbase_m
}

/// S of [`moment_per_load_m`], Σ_i |x_i − δx| · n_i [m].
fn full_arm_m(robot: &Robot) -> f64 {
    2.0 * robot.wheelbase_m * (0.25 - load_forward(robot).powi(2))
}

/// f S m of [`moment_per_load_m`], for any law σ of how much of the full skid resistance a wheel feels at a slip angle, 0 to π/2 [m].
pub fn mobilized_arm_m(
    robot: &Robot,
    speed_mps: f64,
    yaw_rate_radps: f64,
    mobilized: impl Fn(f64) -> f64,
) -> f64 {
    let base = SkidBase::of(robot);
    base.skid(yaw_rate_radps, base.slip_angles_rad(speed_mps, yaw_rate_radps).map(mobilized)).arm_m
}

/// tanh(α/α_s): how much of the full skid resistance a wheel feels, 0 to 1.
#[inline(always)]
fn saturation(slip_angle_rad: f64, scale_rad: f64) -> f64 {
    let saturation = tanh_of_positive(slip_angle_rad / scale_rad);
    if scale_rad == 0.0 { 1.0 } else { saturation }
}

#[inline(always)]
fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    use super::*;
    use crate::builtin;

    #[test]
    fn coulomb_skid_of_a_centred_robot_is_half_the_wheelbase_times_mu() {
        let robot = builtin::husky_a200();
        let surface = Surface { slip_angle_scale_rad: 0.0, ..robot.surfaces["marble"].clone() };
        assert_relative_eq!(moment_per_load_m(&robot, &surface, 0.3, 0.5), 0.29 * 0.27, epsilon = 1e-12);
    }

    #[test]
    fn a_mass_on_the_rear_axle_does_not_skid() {
        let mut robot = builtin::husky_a200();
        robot.center_of_mass.forward_m = -robot.wheelbase_m / 2.0;
        let moment_m = moment_per_load_m(&robot, &robot.surfaces["marble"], 0.3, 0.5);
        assert!(moment_m.abs() < 1e-12, "{moment_m}");
    }

    /// The arm about the centre of turning at which tyres push to both sides alike, by bisection.
    fn arm_by_search_m(robot: &Robot, scale_rad: f64, speed_mps: f64, yaw_rate_radps: f64) -> f64 {
        let (half_a, half_b) = (robot.wheelbase_m / 2.0, robot.track_m / 2.0);
        let com = &robot.center_of_mass;
        let about = |centre_m: f64| {
            let (mut sideways, mut arm_m) = (0.0, 0.0);
            for (x_m, y_m) in [(half_a, half_b), (half_a, -half_b), (-half_a, half_b), (-half_a, -half_b)] {
                let load = (0.5 + com.forward_m * x_m.signum() / robot.wheelbase_m)
                    * (0.5 + com.left_m * y_m.signum() / robot.track_m);
                let across_mps = yaw_rate_radps * (x_m - centre_m);
                let slip_rad = across_mps.abs().atan2((speed_mps - yaw_rate_radps * y_m).abs());
                let skid = load * (slip_rad / scale_rad).tanh();
                sideways += across_mps.signum() * skid;
                arm_m += (x_m - centre_m).abs() * skid;
            }
            (sideways * yaw_rate_radps.signum(), arm_m)
        };
        let (mut low_m, mut high_m) = (-half_a, half_a);
        for _ in 0..60 {
            let middle_m = (low_m + high_m) / 2.0;
            if about(middle_m).0 > 0.0 { low_m = middle_m } else { high_m = middle_m }
        }
        about(low_m).1
    }

    #[test]
    fn a_spin_on_coulomb_ground_turns_about_the_heavier_axle() {
        let mut robot = builtin::husky_a200();
        robot.center_of_mass.forward_m = 0.08;
        let surface = Surface { slip_angle_scale_rad: 0.0, ..robot.surfaces["marble"].clone() };
        let lighter = 0.5 - 0.08 / 0.54;
        let moment_m = moment_per_load_m(&robot, &surface, 0.0, 0.5);
        assert_relative_eq!(moment_m, 0.29 * 0.54 * lighter, max_relative = 1e-12);
    }

    proptest! {
        #[test]
        fn the_arm_is_that_of_the_centre_at_which_tyres_push_to_both_sides_alike(
            forward_m in -0.11f64..0.11, left_m in -0.1f64..0.1, scale_rad in 0.02f64..0.3, v in -1.0f64..1.0, w in 0.1f64..2.0,
        ) {
            let mut robot = builtin::husky_a200();
            (robot.center_of_mass.forward_m, robot.center_of_mass.left_m) = (forward_m, left_m);
            let arm_m = SkidLaw::new(&robot, scale_rad).skid(v, w).arm_m;
            let searched_m = arm_by_search_m(&robot, scale_rad, v, w);
            prop_assert!((arm_m / searched_m - 1.0).abs() < 0.03, "{} m for {} m", arm_m, searched_m);
        }

        #[test]
        fn skid_opposes_the_turn_and_never_exceeds_coulomb(v in -1.0f64..1.0, w in -3.0f64..3.0) {
            let robot = builtin::husky_a200();
            let moment_m = moment_per_load_m(&robot, &robot.surfaces["marble"], v, w);
            prop_assert!(moment_m * w >= 0.0);
            prop_assert!(moment_m.abs() <= 0.29 * 0.27 + 1e-12);
            let mirrored_m = moment_per_load_m(&robot, &robot.surfaces["marble"], v, -w);
            prop_assert!((mirrored_m + moment_m).abs() < 1e-15);
        }
    }
}
