//! What slowing down and speeding up on the way takes.

use model::{Motion, Robot};

use crate::{lattice::step::Step, path::route::Route};

/// Energy that changes of speed along a route take beside what driving at steady speed does [J]. Speeding up at the start and
/// stopping at the end, which every path has, are not among them, nor are turns on the spot before the one and after the other.
///
/// A joule of kinetic energy costs k2 joules of the battery to build up (eq. 2 with the force of inertia) and gives back r/k2 of one
/// when the motors brake, r being the part of back-driven power that reaches the bus. Of a change up and down again k2 − r/k2 is lost
/// for each joule, half of which is counted at each change, so that a path that ends slower than it began does not gain by that. The
/// robot is taken to brake by its motors; where it coasts, friction is paid out of its motion, and less is lost.
pub fn stops_j(robot: &Robot, route: &Route) -> f64 {
    under_way(route).windows(2).map(|pair| change_j(robot, [&pair[0].motion, &pair[1].motion])).sum()
}

/// Stops on the way: where the robot changes between driving ahead, backing up and turning on the spot.
pub fn stops(route: &Route) -> usize {
    // Between driving and driving on, turns on the spot to either side are one stop.
    let ways = under_way(route).iter().map(|step| way_of(step.motion.speed_mps));
    let mut ways: Vec<i8> = ways.collect();
    ways.dedup();
    let reversals = ways.windows(2).filter(|pair| pair[0] * pair[1] < 0).count();
    reversals + ways.iter().filter(|way| **way == 0).count()
}

/// The steps from the first that leads on to the last.
fn under_way(route: &Route) -> &[Step] {
    let leads = |step: &Step| step.motion.speed_mps != 0.0;
    let first = route.steps.iter().position(leads).unwrap_or(0);
    let end = route.steps.iter().rposition(leads).map_or(0, |last| last + 1);
    route.steps.get(first..end).unwrap_or_default()
}

/// Energy that a stop takes between stretches at a speed [J].
pub(crate) fn stop_j(robot: &Robot, speed_mps: f64) -> f64 {
    let (driving, standing) = (Motion::of_body(robot, speed_mps, 0.0), Motion::of_body(robot, 0.0, 0.0));
    2.0 * change_j(robot, [&driving, &standing])
}

/// Energy that a change from one motion to another takes [J].
pub(crate) fn change_j(robot: &Robot, [before, after]: [&Motion; 2]) -> f64 {
    let motors = &robot.motors;
    let k2 = (motors.left.k2 + motors.right.k2) / 2.0;
    let lost_per_j = (k2 - motors.regeneration / k2) / 2.0;
    let straight_j = robot.lifted_mass_kg() / 2.0 * square_changes(before.speed_mps, after.speed_mps);
    let turning_j =
        robot.yaw_inertia_kgm2 / 2.0 * square_changes(before.yaw_rate_radps, after.yaw_rate_radps);
    lost_per_j.max(0.0) * (straight_j + turning_j)
}

/// How much the square of a speed changes on the way from one value to another, through 0 where they have opposite signs.
fn square_changes(before: f64, after: f64) -> f64 {
    if before * after >= 0.0 {
        (after * after - before * before).abs()
    } else {
        before * before + after * after
    }
}

/// Ahead, astern, or neither.
fn way_of(speed_mps: f64) -> i8 {
    if speed_mps == 0.0 { 0 } else { speed_mps.signum() as i8 }
}
