//! How far a path's energy may be off, given what is known of the robot.

use model::Robot;

use crate::{lattice::Lattice, patience::Patience, planner::surface_names, route::Route};

/// Half width of the central 95 % of a normal distribution, in standard deviations.
const NORMAL_95: f64 = 1.959_964;

/// A relative sigma and what it scales.
type Parameter = (f64, fn(&mut Robot, f64));

/// Steps whose interval is worked out whether patience is over or not, so that an answer that is there is not lost.
const STEPS_AT_LEAST: usize = 1 << 14;

/// Central 95 % interval of a path's energy [J]; `None` where patience ends first on a long path.
///
/// The energy is computed anew with each parameter one sigma up and one down; the larger of the two changes counts as
/// that parameter's standard deviation, and the parameters as independent.
pub(crate) fn energy_interval_j(route: &Route, lattice: &Lattice, patience: &Patience) -> Option<[f64; 2]> {
    let (robot, settings) = (&lattice.robot, &lattice.settings);
    let surfaces = surface_names(lattice);
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
    let patience = if route.steps.len() <= STEPS_AT_LEAST { &Patience::default() } else { patience };
    let mut variance_j2 = 0.0;
    for (sigma, scale) in parameters {
        let mut largest_j: f64 = 0.0;
        for factor in [1.0 + sigma, 1.0 - sigma] {
            let mut changed = robot.clone();
            scale(&mut changed, factor);
            let model = settings.power_model;
            let temperature_c = settings.motor_temperature_c;
            let energy_j = route.energy_within_j((&changed, model), &surfaces, temperature_c, patience)?;
            largest_j = largest_j.max((energy_j - route.total.energy_j).abs());
        }
        variance_j2 += largest_j.powi(2);
    }
    let half_j = NORMAL_95 * variance_j2.sqrt();
    Some([route.total.energy_j - half_j, route.total.energy_j + half_j])
}
