//! The least that a metre of map can cost, whatever the ground: a bound that needs no field.

use model::{Manoeuvre, PowerModel};

use crate::{
    grid::cost::SINGLE_PRECISION,
    lattice::{
        edge::Chain,
        graph::Lattice,
        ground_class::{GroundClass, StepWeights},
        objective::Weights,
        primitive::Motion,
        step::{Limits, PreparedStep, Step},
    },
};

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
    let floor = floor_under_limits(lattice).unwrap_or(0.0);
    let cell_size_m = lattice.terrain.grid.cell_size_m;
    let least = chains(lattice)
        .filter(|(_, motion)| (motion.columns, motion.rows) != (0, 0))
        .map(|(chain, motion)| {
            let apart_m = f64::from(motion.columns).hypot(f64::from(motion.rows)) * cell_size_m;
            least_cost(lattice, weights, chain, floor) / apart_m
        })
        .fold(f64::INFINITY, f64::min);
    (least * (1.0 - SINGLE_PRECISION)).max(0.0)
}

/// Least cost of any motion that takes something of a sum, in its unit: turns on the spot have no length.
///
/// Side slopes count up to 84°, where a tenth of the normal force is left. The forms of power without a floor on friction
/// are driven on level ground and on the steepest that the limits allow; slopes between are taken to cost at least half of
/// the least of these. What a wind may push for nothing costs nothing.
pub(crate) fn least_cost_of_motion(
    lattice: &Lattice,
    weights: &Weights,
    takes_some: impl Fn(i32, i32) -> bool,
) -> f64 {
    const LEAST_NORMAL: f64 = 0.1;
    const SHARE_BETWEEN_SLOPES: f64 = 0.5;
    let normal = lattice.robot.limits.max_roll_rad.cos().max(LEAST_NORMAL);
    let of = |chain: &Chain| match friction_floor(lattice) {
        Some(floor) => least_cost(lattice, weights, chain, floor * normal),
        None => SHARE_BETWEEN_SLOPES * least_cost_on_slopes(lattice, weights, chain),
    };
    let chains = chains(lattice).filter(|(_, motion)| takes_some(motion.columns, motion.rows));
    chains.map(|(chain, _)| of(chain).max(0.0)).fold(f64::INFINITY, f64::min)
}

/// Least cost of a chain's steps on level ground and the steepest slopes, whatever the surface.
fn least_cost_on_slopes(lattice: &Lattice, weights: &Weights, chain: &Chain) -> f64 {
    let steps = chain.steps_with_manoeuvres();
    let of_step = |(step, manoeuvres, reverse): (&PreparedStep, &[Manoeuvre], bool)| {
        let on = |(manoeuvre, class): (&Manoeuvre, &GroundClass)| {
            let weights = class.weights(weights, &lattice.settings, step, reverse);
            let driven =
                slopes(lattice).filter_map(|slope| driven_on(step, (manoeuvre, class.name, reverse), slope));
            let cost = |done: Step| {
                let unlifted_j = lattice.unlifted_j(&done);
                weights.per_j * unlifted_j
                    + weights.per_m * done.length_m
                    + weights.per_s * done.duration_s
                    + weights.fixed
            };
            driven.map(cost).fold(f64::INFINITY, f64::min)
        };
        manoeuvres.iter().zip(&lattice.classes.list).map(on).fold(f64::INFINITY, f64::min)
    };
    steps.map(of_step).sum()
}

/// All variants of all motions.
pub(crate) fn chains(lattice: &Lattice) -> impl Iterator<Item = (&Chain, &Motion)> {
    lattice.chains.iter().zip(&lattice.motions).flat_map(|(chains, motions)| {
        chains.iter().zip(motions).flat_map(|(variants, motion)| variants.iter().map(move |v| (v, motion)))
    })
}

/// κ, the least share of friction's work that is drawn, where the form of power has such a floor.
fn friction_floor(lattice: &Lattice) -> Option<f64> {
    let (robot, settings) = (&lattice.robot, &lattice.settings);
    let is_plain = robot.surfaces.values().all(|surface| !robot.is_adjusted(surface));
    (settings.power_model == PowerModel::ForceBalance && is_plain).then(|| lattice.kappa())
}

/// The least share of friction's work on level ground that is drawn on any slope that limits allow, where there is such a floor.
pub(crate) fn floor_under_limits(lattice: &Lattice) -> Option<f64> {
    friction_floor(lattice).map(|floor| floor * lattice.robot.limits.max_roll_rad.cos())
}

fn least_cost(lattice: &Lattice, weights: &Weights, chain: &Chain, floor: f64) -> f64 {
    chain.steps_with_manoeuvres().map(|step| least_of_step(lattice, weights, step, floor)).sum()
}

fn least_of_step(
    lattice: &Lattice,
    weights: &Weights,
    (step, manoeuvres, reverse): (&PreparedStep, &[Manoeuvre], bool),
    floor: f64,
) -> f64 {
    let on = |(manoeuvre, class): (&Manoeuvre, &GroundClass)| {
        least_on(lattice, weights, (step, manoeuvre, reverse), class, floor).cost()
    };
    manoeuvres.iter().zip(&lattice.classes.list).map(on).fold(f64::INFINITY, f64::min)
}

/// What a step takes at least on a kind of ground, whatever the slope.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeastOfStep {
    /// Energy beyond lifting that forces take, and that of the standing power [J].
    pub(crate) friction_j: f64,
    pub(crate) standing_j: f64,
    /// Length on the map [m].
    pub(crate) length_m: f64,
    /// Time [s].
    pub(crate) duration_s: f64,
    /// What these weigh there.
    pub(crate) weights: StepWeights,
}

impl LeastOfStep {
    /// Their weighted sum.
    pub(crate) fn cost(&self) -> f64 {
        self.cost_over(1.0)
    }

    /// The same where the way over the ground is so many times as long as on the map: friction's least stays what it is, since the wheels
    /// press less on a slope.
    pub(crate) fn cost_over(&self, longer: f64) -> f64 {
        let StepWeights { per_j, per_m, per_s, fixed } = self.weights;
        let along = per_j * self.standing_j + per_m * self.length_m + per_s * self.duration_s;
        per_j * self.friction_j + longer * along + fixed
    }
}

/// The same of a step on one kind of ground, where at least a share `floor` of friction's power on level ground is drawn.
pub(crate) fn least_on(
    lattice: &Lattice,
    weights: &Weights,
    (step, manoeuvre, reverse): (&PreparedStep, &Manoeuvre, bool),
    class: &GroundClass,
    floor: f64,
) -> LeastOfStep {
    let steepest = lattice.robot.limits.max_roll_rad.tan();
    let (kernel, motion) = (manoeuvre.kernel(), manoeuvre.motion());
    let left = |tilt| kernel.pull.left_of_skid(tilt, 0.0);
    let skid_n = kernel.skid_n * left(steepest).min(left(-steepest));
    let rims_mps = motion.rim_speeds_mps;
    let friction_w =
        (kernel.rolling_n.left - skid_n) * rims_mps.left + (kernel.rolling_n.right + skid_n) * rims_mps.right;
    let duration_s = match step.horizontal_m {
        0.0 => step.turn_rad / motion.yaw_rate_radps,
        horizontal_m => horizontal_m / motion.speed_mps.abs(),
    };
    LeastOfStep {
        friction_j: (floor * friction_w).max(0.0) * duration_s,
        standing_j: kernel.standing_w * duration_s,
        length_m: step.horizontal_m,
        duration_s,
        weights: class.weights(weights, &lattice.settings, step, reverse),
    }
}

/// Level ground and the steepest that limits allow, up, down and to either side.
pub(crate) fn slopes(lattice: &Lattice) -> impl Iterator<Item = [f64; 2]> {
    /// Beyond, a robot's weight is all on the slope and costs hardly change [m/m].
    const STEEPEST: f64 = 100.0;
    let steepest = |grade: f64| [-1.0, 0.0, 1.0].map(|sign| sign * grade.abs().min(STEEPEST));
    let (pitches, rolls) = (steepest(lattice.limits.pitch_grade), steepest(lattice.limits.roll_grade));
    pitches.into_iter().flat_map(move |pitch| rolls.map(|roll| [pitch, roll]))
}

/// A step driven on a slope that is given along its travel and across it [m/m].
pub(crate) fn driven_on(
    step: &PreparedStep,
    (manoeuvre, surface, reverse): (&Manoeuvre, usize, bool),
    [grade, side_grade]: [f64; 2],
) -> Option<Step> {
    let (cos, sin) = step.travel;
    let slope = (grade * cos - side_grade * sin, grade * sin + side_grade * cos);
    step.drive(manoeuvre, grade * step.horizontal_m, slope, reverse, &Limits::NONE, surface)
}
