//! Table II and Fig. 13 of the paper from the force-balance model with one constant set.
//!
//! The experiment grid is the paper's (§IV): speeds and yaw rates raised uniformly, wheels limited to 1 m/s.

use model::{
    Attitude, Motion, PowerModel, Robot, STANDARD_GRAVITY_MPS2, Sides, WarmMotor, builtin,
    fit::{FrictionSample, rolling_and_skid},
    inversion::{SideOnSlope, SlopeSign},
    power,
};

/// Side forces over m g, in the rows of Table II. M1 (left) is the inner, M2 (right) the outer side.
#[derive(Debug)]
#[allow(dead_code)]
pub(crate) struct TableII {
    pub(crate) spin: Sides<f64>,
    pub(crate) straight: Sides<f64>,
    pub(crate) outer_mean: f64,
    pub(crate) outer_max: f64,
    pub(crate) outer_min: f64,
    pub(crate) inner_mean: f64,
    pub(crate) inner_min: f64,
    pub(crate) inner_max: f64,
}

/// The coefficients of eq. 16 as the paper's procedure would fit them at one speed.
#[derive(Debug)]
#[allow(dead_code)]
pub(crate) struct SpeedFit {
    pub(crate) speed_mps: f64,
    pub(crate) mu_roll: f64,
    pub(crate) mu_skid: f64,
    pub(crate) share_inside: f64,
}

fn robot() -> Robot {
    builtin::configuration_b()
}

fn side_friction(robot: &Robot, v: f64, w: f64) -> Sides<f64> {
    let p = power(
        PowerModel::ForceBalance,
        robot,
        &robot.surfaces["marble"],
        Motion::of_body(robot, v, w),
        Attitude::LEVEL,
        Sides::both(20.0),
    );
    p.force_n.map(|f| f / (robot.mass_kg * STANDARD_GRAVITY_MPS2))
}

/// Speeds and yaw rates in steps of 0.1, as far as the outer wheel stays within the firmware's 1 m/s.
fn grid(robot: &Robot) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    for v in (0..10).map(|i| 0.1 * f64::from(i)) {
        for w in (1..=37).map(|i| 0.1 * f64::from(i)) {
            if robot.rim_speeds_mps(v, w).right <= robot.max_wheel_speed_mps + 1e-9 {
                points.push((v, w));
            }
        }
    }
    points
}

pub(crate) fn table_ii() -> TableII {
    let robot = robot();
    let outside: Vec<Sides<f64>> = grid(&robot)
        .into_iter()
        .filter(|(v, w)| v / w > robot.track_m / 2.0)
        .map(|(v, w)| side_friction(&robot, v, w))
        .collect();
    let mean = |side: fn(&Sides<f64>) -> f64| outside.iter().map(side).sum::<f64>() / outside.len() as f64;
    let extreme = |side: fn(&Sides<f64>) -> f64, pick: fn(f64, f64) -> f64| {
        outside.iter().map(side).reduce(pick).expect("the grid reaches outside R_c")
    };
    TableII {
        spin: side_friction(&robot, 0.0, 1.0).map(f64::abs),
        straight: side_friction(&robot, 0.5, 0.0),
        outer_mean: mean(|s| s.right),
        outer_max: extreme(|s| s.right, f64::max),
        outer_min: extreme(|s| s.right, f64::min),
        inner_mean: mean(|s| s.left),
        inner_min: extreme(|s| s.left, f64::min),
        inner_max: extreme(|s| s.left, f64::max),
    }
}

/// Measures the outer side's friction as the paper does, through its power and eq. 6, and fits eq. 16 speed by speed.
pub(crate) fn fig_13() -> Vec<SpeedFit> {
    let robot = robot();
    let mut fits = Vec::new();
    for speed_mps in (1..10).map(|i| 0.1 * f64::from(i)) {
        let samples: Vec<FrictionSample> = commanded_runs(&robot, speed_mps)
            .into_iter()
            .map(|(v, w)| outer_friction(&robot, v, w))
            .collect();
        let inside = samples.iter().filter(|s| s.radius_m <= robot.track_m / 2.0).count();
        let (mu_roll, mu_skid) = rolling_and_skid(&robot, &samples).expect("the radii differ");
        fits.push(SpeedFit {
            speed_mps,
            mu_roll,
            mu_skid,
            share_inside: inside as f64 / samples.len() as f64,
        });
    }
    fits
}

/// Yaw rates up to 2 rad/s at one commanded speed; the firmware holds a wheel that is asked for more at 1 m/s (§IV).
fn commanded_runs(robot: &Robot, speed_mps: f64) -> Vec<(f64, f64)> {
    (1..=20)
        .map(|i| 0.1 * f64::from(i))
        .map(|w| {
            let asked = robot.rim_speeds_mps(speed_mps, w);
            let right = asked.right.min(robot.max_wheel_speed_mps);
            let motion = Motion::of_wheels(robot, Sides { left: asked.left, right });
            (motion.speed_mps, motion.yaw_rate_radps)
        })
        .collect()
}

fn outer_friction(robot: &Robot, v: f64, w: f64) -> FrictionSample {
    let motion = Motion::of_body(robot, v, w);
    let marble = &robot.surfaces["marble"];
    let p = power(PowerModel::ForceBalance, robot, marble, motion, Attitude::LEVEL, Sides::both(20.0));
    let outer = SideOnSlope {
        motor: WarmMotor { k1_w_per_n2: robot.motors.right.k1_w_per_n2, k2: robot.motors.right.k2 },
        mass_kg: robot.mass_kg,
        inclination_rad: 0.0,
        heading_from_contour_rad: 0.0,
        rim_speed_mps: motion.rim_speeds_mps.right,
    };
    let roots =
        outer.friction_from_power(p.side_w.right, SlopeSign::Plus).expect("a driving side has a real root");
    FrictionSample { radius_m: v / w, outward_m: 0.0, friction: roots.friction }
}
