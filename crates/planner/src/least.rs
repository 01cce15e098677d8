//! The least that a metre of map can cost, whatever the ground: a bound that needs no field.

use model::{Manoeuvre, PowerModel};

use crate::{edge::Chain, lattice::Lattice, objective::Weights, step::PreparedStep};

/// What single precision may take off a cost of the table, as a share.
const SINGLE_PRECISION: f64 = 1e-4;

/// Least cost per metre between the ends of a motion, over all motions, surfaces and slopes that limits allow, in the
/// objective's unit.
///
/// Of energy without lifting, E − κ m g Δz, friction's share is at least κ times its work, and the standing power runs all
/// the time (see [`Lattice::potential_j`]). Per horizontal metre of a step at speed v,
///
/// ```text
/// E − κ m g Δz ≥ (κ cos ρ Σ F u + P₀) / v
/// ```
///
/// with F u each side's friction power on level ground with the least skid that a side slope leaves, ρ the steepest roll
/// allowed and P₀ the standing power: a longer way on a slope and the smaller normal force there cancel. The printed form has
/// no such floor on friction, and neither has a robot with mechanisms, whose wind may push; its standing power alone counts.
pub(crate) fn least_cost_per_m(lattice: &Lattice, weights: &Weights) -> f64 {
    let chains = lattice.chains.iter().zip(&lattice.motions).flat_map(|(chains, motions)| {
        chains.iter().zip(motions).flat_map(|(variants, motion)| variants.iter().map(move |v| (v, motion)))
    });
    let cell_size_m = lattice.terrain.grid.cell_size_m;
    let least = chains
        .filter(|(_, motion)| (motion.columns, motion.rows) != (0, 0))
        .map(|(chain, motion)| {
            let apart_m = f64::from(motion.columns).hypot(f64::from(motion.rows)) * cell_size_m;
            least_cost(lattice, weights, chain) / apart_m
        })
        .fold(f64::INFINITY, f64::min);
    (least * (1.0 - SINGLE_PRECISION)).max(0.0)
}

fn least_cost(lattice: &Lattice, weights: &Weights, chain: &Chain) -> f64 {
    chain
        .steps_with_manoeuvres()
        .map(|(step, manoeuvres, _)| least_of_step(lattice, weights, step, manoeuvres))
        .sum()
}

fn least_of_step(lattice: &Lattice, weights: &Weights, step: &PreparedStep, manoeuvres: &[Manoeuvre]) -> f64 {
    let (robot, settings) = (&lattice.robot, &lattice.settings);
    let is_plain = robot.surfaces.values().all(|surface| !robot.is_adjusted(surface));
    let holds = settings.power_model == PowerModel::ForceBalance && is_plain;
    let floor = if holds { lattice.kappa() * robot.limits.max_roll_rad.cos() } else { 0.0 };
    let steepest = robot.limits.max_roll_rad.tan();
    let on = |manoeuvre: &Manoeuvre| {
        let (kernel, speed_mps) = (manoeuvre.kernel(), manoeuvre.motion().speed_mps.abs());
        let left = |tilt| kernel.pull.left_of_skid(tilt, 0.0);
        let skid_n = kernel.skid_n * left(steepest).min(left(-steepest));
        let rims_mps = manoeuvre.motion().rim_speeds_mps;
        let friction_w = (kernel.rolling_n.left - skid_n) * rims_mps.left
            + (kernel.rolling_n.right + skid_n) * rims_mps.right;
        let least_w = (floor * friction_w).max(0.0) + kernel.standing_w;
        let duration_s = step.horizontal_m / speed_mps;
        weights.per_j * least_w * duration_s + weights.per_m * step.horizontal_m + weights.per_s * duration_s
    };
    manoeuvres.iter().map(on).fold(f64::INFINITY, f64::min)
}
