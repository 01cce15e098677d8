//! The `dogru-marques` model: the paper's eqs. 1-17 as printed, region by region.
//!
//! It exists to reproduce the paper. Three defects keep it from being the default: a jump at R = R_c, a
//! copper loss that doubles between "straight" and "very wide arc", and an eq. 6 that on a descent returns
//! `k2 m g Δh` to the bus, more than the hill holds.

use crate::{
    Robot, Sides,
    balance::SideForces,
    lateral::SidewaysPull,
    motion::Motion,
    robot::{SpeedFriction, Surface},
    rolling,
};

/// Turning radius, in tracks, beyond which a motion counts as straight (R = ∞ in the paper's tables).
///
/// The paper does not say where its "straight" begins; its widest arcs are about 17 tracks (0.9 m/s at
/// 0.1 rad/s), so 50 lies safely outside of what it calls an arc.
const STRAIGHT_TRACKS: f64 = 50.0;

/// The paper's three regions of motion (§III-C).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// R = ∞: both sides roll and share the load.
    Straight,
    /// R > R_c: the outer side drags the robot, the inner one brakes.
    OuterDrags,
    /// R ≤ R_c: the sides turn against each other and each overcomes its own friction.
    OppositeSides,
}

/// Friction coefficients of both sides, referred to the robot's whole normal load as in Table II.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperForces {
    /// Where the motion lies.
    pub region: Region,
    /// Friction of each side over the normal load [-].
    pub friction: Sides<f64>,
}

/// Which region a motion lies in.
pub fn region(robot: &Robot, motion: &Motion) -> Region {
    let Sides { left, right } = motion.rim_speeds_mps;
    if motion.turning_radius_m().abs() >= STRAIGHT_TRACKS * robot.track_m {
        Region::Straight
    } else if left * right > 0.0 {
        Region::OuterDrags
    } else {
        Region::OppositeSides
    }
}

/// Distance from the geometric centre to the centre of mass, positive towards the outer wheels [m].
fn outward_offset_m(robot: &Robot, motion: &Motion) -> f64 {
    let left_m = robot.center_of_mass.left_m;
    if left_side_is_outer(motion) { left_m } else { -left_m }
}

fn left_side_is_outer(motion: &Motion) -> bool {
    motion.rim_speeds_mps.left.abs() > motion.rim_speeds_mps.right.abs()
}

/// The friction coefficient of a turning robot, eq. 16 (eq. 15 when `correction` is 1).
///
/// ```text
/// μ = (R0 + δy)/(R0 + b/2) · c · μ_R + 2a (1/4 − (δx/a)²)/(R0 + b/2) · μ_S
/// ```
///
/// R0 distance from the geometric centre to the instantaneous centre [m], δy offset of the centre of mass
/// towards the outer wheels [m], c the correction of eq. 16. Force of the outer side over m g cos γ.
pub fn turning_friction(
    robot: &Robot,
    radius_m: f64,
    outward_m: f64,
    correction: f64,
    mu: (f64, f64),
) -> f64 {
    let columns = turning_friction_columns(robot, radius_m, outward_m, correction);
    columns.0 * mu.0 + columns.1 * mu.1
}

/// The factors of μ_R and μ_S in eq. 16; fitting the two is linear least squares on these.
pub fn turning_friction_columns(robot: &Robot, radius_m: f64, outward_m: f64, correction: f64) -> (f64, f64) {
    let a = robot.wheelbase_m;
    let outer_m = radius_m + robot.track_m / 2.0;
    let skid_m = 2.0 * a * (0.25 - (robot.center_of_mass.forward_m / a).powi(2));
    ((radius_m + outward_m) / outer_m * correction, skid_m / outer_m)
}

impl PaperForces {
    /// Finds the region and the friction of both sides.
    pub fn new(robot: &Robot, surface: &Surface, motion: &Motion) -> Self {
        let region = region(robot, motion);
        let correction = rolling::center_of_mass_correction(robot);
        let mu = coefficients_at(surface, motion.speed_mps.abs());
        let outward_m = outward_offset_m(robot, motion);
        let outer = |radius_m: f64| turning_friction(robot, radius_m, outward_m, correction, mu);
        let (outer, inner) = match region {
            Region::Straight => (mu.0 * correction / 2.0, mu.0 * correction / 2.0),
            Region::OuterDrags => (outer(motion.turning_radius_m().abs()), 0.0),
            Region::OppositeSides => {
                let constant = surface.dogru_marques.as_ref().and_then(|p| p.inner_friction);
                let radius_m = motion.turning_radius_m().abs();
                // At rest there is no radius; nothing turns, so nothing drags.
                let outer = if radius_m.is_finite() { outer(radius_m) } else { 0.0 };
                (outer, constant.unwrap_or_else(|| 0.5 * (turning_friction(robot, 0.0, 0.0, 0.0, mu) + mu.0)))
            }
        };
        let friction = if left_side_is_outer(motion) {
            Sides { left: outer, right: inner }
        } else {
            Sides { left: inner, right: outer }
        };
        PaperForces { region, friction }
    }

    /// Eqs. 3-5 for each side: friction along the way the wheel turns, and that side's part of gravity.
    ///
    /// The side powers that follow are as printed. The bus takes at least what gravity asks for, `k2 m g sinγ sinβ v`
    /// uphill, and returns at most what the descent holds, `r m g |sinγ sinβ| v / k2`.
    pub(crate) fn side_forces(&self, motion: &Motion) -> SideForces {
        let gravity_share = match (self.region, left_side_is_outer(motion)) {
            (Region::OuterDrags, true) => Sides { left: 1.0, right: 0.0 },
            (Region::OuterDrags, false) => Sides { left: 0.0, right: 1.0 },
            _ => Sides::both(0.5),
        };
        let way = motion.rim_speeds_mps.map(|u| if u == 0.0 { 0.0 } else { u.signum() });
        SideForces {
            rolling: self.friction.zip(way).map(|(mu, way)| mu * way),
            steepening: 0.0,
            shifting: Sides::both(0.0),
            skid: 0.0,
            pull: SidewaysPull::NONE,
            gravity_share,
        }
    }
}

/// (μ_R, μ_S) at a speed: the table's, interpolated and held at its ends, or the surface's constants.
fn coefficients_at(surface: &Surface, speed_mps: f64) -> (f64, f64) {
    let table: &[SpeedFriction] = surface.dogru_marques.as_ref().map_or(&[], |p| &p.by_speed);
    let (Some(first), Some(last)) = (table.first(), table.last()) else {
        return (surface.mu_roll, surface.mu_skid);
    };
    if speed_mps <= first.speed_mps {
        return (first.mu_roll, first.mu_skid);
    }
    for pair in table.windows(2) {
        let [low, high] = pair else { continue };
        if speed_mps <= high.speed_mps && high.speed_mps > low.speed_mps {
            let t = (speed_mps - low.speed_mps) / (high.speed_mps - low.speed_mps);
            return (
                low.mu_roll + t * (high.mu_roll - low.mu_roll),
                low.mu_skid + t * (high.mu_skid - low.mu_skid),
            );
        }
    }
    (last.mu_roll, last.mu_skid)
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::{Attitude, PowerModel, STANDARD_GRAVITY_MPS2, builtin, power, robot::PaperSurface};

    #[test]
    fn regions_follow_the_rims() {
        let robot = builtin::husky_a200();
        let of = |v, w| region(&robot, &Motion::of_body(&robot, v, w));
        assert_eq!(of(0.5, 0.0), Region::Straight);
        assert_eq!(of(0.5, 0.5), Region::OuterDrags);
        assert_eq!(of(0.1, 1.0), Region::OppositeSides);
        assert_eq!(of(0.0, 1.0), Region::OppositeSides);
    }

    #[test]
    fn a_speed_table_is_interpolated_and_held_at_its_ends() {
        let row = |speed_mps, mu_roll, mu_skid| SpeedFriction { speed_mps, mu_roll, mu_skid };
        let mut surface = builtin::husky_a200().surfaces["marble"].clone();
        surface.dogru_marques = Some(PaperSurface {
            by_speed: vec![row(0.2, 0.1, 0.2), row(0.4, 0.06, 0.3)],
            ..Default::default()
        });
        assert_eq!(coefficients_at(&surface, 0.0), (0.1, 0.2));
        assert_eq!(coefficients_at(&surface, 0.9), (0.06, 0.3));
        let (roll, skid) = coefficients_at(&surface, 0.3);
        assert_relative_eq!(roll, 0.08, epsilon = 1e-12);
        assert_relative_eq!(skid, 0.25, epsilon = 1e-12);
    }

    #[test]
    fn a_wide_arc_loses_twice_the_copper_of_a_straight_line() {
        // One of the defects named above: it is the paper's, and kept on purpose.
        let mut robot = builtin::husky_a200();
        robot.motors.right = robot.motors.left;
        let copper = |yaw: f64| {
            let motion = Motion::of_body(&robot, 0.5, yaw);
            let p = power(
                PowerModel::DogruMarques,
                &robot,
                &robot.surfaces["marble"],
                motion,
                Attitude::LEVEL,
                Sides::both(20.0),
            );
            p.side_w.sum() - robot.motors.left.k2 * p.mechanical_w.sum()
        };
        let wide = 0.5 / (45.0 * robot.track_m);
        let ratio = copper(wide) / copper(0.0);
        assert!((1.9..2.4).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_descent_returns_no_more_than_the_hill_holds() {
        let robot = builtin::husky_a200();
        let attitude = Attitude { pitch_rad: -0.4, roll_rad: 0.0 };
        for yaw in [0.0, 0.3, 1.0] {
            let motion = Motion::of_body(&robot, 0.5, yaw);
            let p = power(
                PowerModel::DogruMarques,
                &robot,
                &robot.surfaces["marble"],
                motion,
                attitude,
                Sides::both(20.0),
            );
            let falling_w = robot.mass_kg * STANDARD_GRAVITY_MPS2 * 0.4f64.sin() * 0.5;
            assert!(p.bus_w >= -falling_w, "{} W against {falling_w} W", p.bus_w);
        }
    }
}
