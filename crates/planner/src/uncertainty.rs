//! How far a path's energy may be off, given what is known of the robot.

use model::{PowerModel, Robot};

use crate::route::Route;

/// Half width of the central 95 % of a normal distribution, in standard deviations.
const NORMAL_95: f64 = 1.959_964;

/// A relative sigma and what it scales.
type Parameter = (f64, fn(&mut Robot, f64));

/// Central 95 % interval of a path's energy [J].
///
/// The energy is computed anew with each parameter one sigma up and one down; the larger of the two changes counts as
/// that parameter's standard deviation, and the parameters as independent.
pub(crate) fn energy_interval_j(
    route: &Route,
    robot: &Robot,
    model: PowerModel,
    surfaces: &[String],
    motor_temperature_c: f64,
) -> [f64; 2] {
    let energy_j = |changed: &Robot| route.energy_with_j(changed, model, surfaces, motor_temperature_c);
    let u = &robot.uncertainty;
    let parameters: [Parameter; 5] = [
        (u.mu_roll, |r, factor| r.surfaces.values_mut().for_each(|s| *s = s.scaled(factor, 1.0))),
        (u.mu_skid, |r, factor| r.surfaces.values_mut().for_each(|s| *s = s.scaled(1.0, factor))),
        (u.k1, |r, factor| {
            r.motors.left.k1_w_per_n2 *= factor;
            r.motors.right.k1_w_per_n2 *= factor;
        }),
        (u.k2, |r, factor| {
            r.motors.left.k2 = (r.motors.left.k2 * factor).max(1.0);
            r.motors.right.k2 = (r.motors.right.k2 * factor).max(1.0);
        }),
        (u.mass_kg, |r, factor| r.mass_kg *= factor),
    ];
    let variance_j2: f64 = parameters
        .into_iter()
        .map(|(sigma, scale)| {
            let mut changed = [robot.clone(), robot.clone()];
            scale(&mut changed[0], 1.0 + sigma);
            scale(&mut changed[1], 1.0 - sigma);
            let [up_j, down_j] = changed.map(|r| (energy_j(&r) - route.total.energy_j).abs());
            up_j.max(down_j).powi(2)
        })
        .sum();
    let half_j = NORMAL_95 * variance_j2.sqrt();
    [route.total.energy_j - half_j, route.total.energy_j + half_j]
}
