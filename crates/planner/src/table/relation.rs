//! What a robot's costs prove of its costs where it drives faster or slower, carries more or less, or draws more or less while it stands.

use model::{Manoeuvre, Robot};

use crate::{
    lattice::{
        graph::{Lattice, Settings},
        objective::{Objective, Surcharge, Weights},
    },
    table::least::{LeastOfStep, chains, floor_under_limits, least_on},
};

/// A lower bound of what any motion costs, from what it costs under another load, speed or standing power.
///
/// With A what forces take beyond lifting, D what they dissipate in the motors and P₀ the standing power, a step takes
/// `c = A + (D + P₀) τ`. Only the time τ depends on speed where every wheel turns faster than some mm/s or stands; elsewhere there is no
/// relation. Where the mass is μ times as large, A is too, and D is μ² times as large:
///
/// ```text
/// c' = μ A + (μ² D + P₀') τ'
/// c' − λ c = (μ − λ) A + (μ² τ' − λ τ) D + P₀' τ' − λ P₀ τ
///          ≥ (μ a + P₀' τ') − λ (a + P₀ τ)        λ ≤ μ,  λ ≤ μ² τ'/τ
/// ```
///
/// with a ≤ A the floor of friction, which no slope goes below. Times grow with the way on a slope, in which the rest is linear: it is looked
/// at on level ground and on the steepest that limits allow. The share λ is the largest that leaves no step a negative rest. What is left of
/// a motion's steps, per metre between its ends, is the least of all motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relation {
    /// λ: share of the other cost.
    pub share: f64,
    /// What comes on top per metre between the ends of a motion, in the objective's unit.
    pub per_m: f64,
}

/// Room for rounding in double precision.
const ROUNDING: f64 = 1e-9;

impl Relation {
    /// What costs of an objective on one lattice prove of those on another of the same ground and motions; `None` where they prove nothing.
    pub fn between(known: &Lattice, wanted: &Lattice, objective: Objective) -> Option<Self> {
        if !are_alike(known, wanted) || !known.terrain.is_same_ground(&wanted.terrain) {
            return None;
        }
        let mass_ratio = wanted.robot.mass_kg / known.robot.mass_kg;
        let lift_ratio = wanted.lift_j_per_m() / known.lift_j_per_m();
        // A lighter robot may drive where a heavier one could not push.
        let may_do_more = mass_ratio < 1.0 && may_lack_force(known);
        let are_scaled =
            (lift_ratio / mass_ratio - 1.0).abs() <= ROUNDING && are_forces_scaled(known, wanted, mass_ratio);
        if may_do_more || !are_scaled {
            return None;
        }
        let weights = plain_weights(known, wanted, objective)?;
        let floor = floor_under_limits(known)?;
        let pairs = || {
            chains(known).zip(chains(wanted)).map(|((known_chain, motion), (wanted_chain, _))| {
                let steps = known_chain.steps_with_manoeuvres().zip(wanted_chain.steps_with_manoeuvres());
                let steps = steps.map(|((step, manoeuvres, reverse), (_, wanted_manoeuvres, _))| {
                    let each = manoeuvres.iter().zip(wanted_manoeuvres).zip(&known.classes.list);
                    let of = move |((manoeuvre, wanted_manoeuvre), class)| {
                        let on = |lattice, manoeuvre| {
                            least_on(lattice, &weights, (step, manoeuvre, reverse), class, floor)
                        };
                        (on(known, manoeuvre), on(wanted, wanted_manoeuvre))
                    };
                    each.map(of).collect::<Vec<_>>()
                });
                (steps.collect::<Vec<_>>(), motion)
            })
        };
        let ways = [1.0, (1.0 + known.limits.pitch_grade.powi(2)).sqrt() * (1.0 + ROUNDING)];
        let share = pairs().flat_map(|(steps, _)| steps).flatten();
        let share = share.map(|(known, wanted)| largest_share((&known, &wanted), mass_ratio, ways));
        let share = share.fold(f64::INFINITY, f64::min) * (1.0 - ROUNDING);
        if !(share.is_finite() && share > 0.0) {
            return None;
        }
        let rest = |(known, wanted): &(LeastOfStep, LeastOfStep)| {
            let over = ways.map(|longer| wanted.cost_over(longer) - share * known.cost_over(longer));
            over[0].min(over[1])
        };
        let leads = pairs().filter(|(_, motion)| (motion.columns, motion.rows) != (0, 0));
        let per_m = leads.map(|(steps, motion)| {
            let cells = f64::from(motion.columns).hypot(f64::from(motion.rows));
            let least = steps.iter().map(|kinds| kinds.iter().map(rest).fold(f64::INFINITY, f64::min));
            least.sum::<f64>() / (cells * known.terrain.grid.cell_size_m)
        });
        let per_m = per_m.fold(f64::INFINITY, f64::min) * (1.0 - ROUNDING);
        Some(Relation { share, per_m: per_m.max(0.0) })
    }
}

/// Whether forces are so many times as large wherever the robot drives. At other speeds they are the same, but for wheels that hardly turn: their
/// rolling resistance goes with their speed.
fn are_forces_scaled(known: &Lattice, wanted: &Lattice, ratio: f64) -> bool {
    let manoeuvres = |lattice| {
        let steps = chains(lattice).flat_map(|(chain, _)| chain.steps_with_manoeuvres());
        steps.flat_map(|(_, manoeuvres, _)| manoeuvres.iter().map(Manoeuvre::kernel))
    };
    manoeuvres(known).zip(manoeuvres(wanted)).all(|(known, wanted)| {
        let most_n = ROUNDING * wanted.lifting_n.sum().abs();
        let is_scaled = |known_n: f64, wanted_n: f64| (wanted_n - ratio * known_n).abs() <= most_n;
        is_scaled(known.rolling_n.left, wanted.rolling_n.left)
            && is_scaled(known.rolling_n.right, wanted.rolling_n.right)
            && is_scaled(known.skid_n, wanted.skid_n)
    })
}

/// Whether a climb within the limits may ask a side for more force than it has.
fn may_lack_force(lattice: &Lattice) -> bool {
    let limits = &lattice.limits;
    let steepest = [limits.pitch_grade, limits.roll_grade];
    let manoeuvres = chains(lattice).flat_map(|(chain, _)| chain.steps_with_manoeuvres());
    let mut forces_n =
        manoeuvres.flat_map(|(_, manoeuvres, _)| manoeuvres).map(|m| m.kernel().largest_force_n(steepest));
    forces_n.any(|force_n| force_n >= limits.side_force_n)
}

/// The largest share of a step's cost that leaves none of its parts a negative rest, over ways so many times as long as on the map.
fn largest_share((known, wanted): (&LeastOfStep, &LeastOfStep), mass_ratio: f64, ways: [f64; 2]) -> f64 {
    let whole = |longer: f64| match known.cost_over(longer) {
        cost if cost > 0.0 => wanted.cost_over(longer) / cost,
        _ => f64::INFINITY,
    };
    let whole = whole(ways[0]).min(whole(ways[1]));
    let slower = wanted.duration_s / known.duration_s;
    let by_force =
        if known.weights.per_j > 0.0 { mass_ratio.min(mass_ratio.powi(2) * slower) } else { whole };
    whole.min(by_force)
}

/// The objective's weights without what decides between equals, which its proofs take off; `None` where energy is none.
fn plain_weights(known: &Lattice, wanted: &Lattice, objective: Objective) -> Option<Weights> {
    let plain = |per_j: f64, per_m: f64, per_s: f64| Weights {
        per_j,
        per_m,
        per_s,
        of_surcharge: Surcharge { j: per_j, m: per_m, s: per_s },
    };
    match objective {
        Objective::Energy => {
            let counts_time = |lattice: &Lattice| lattice.weights(objective).per_s > 0.0;
            (!counts_time(known) && !counts_time(wanted)).then(|| plain(1.0, 0.0, 0.0))
        }
        Objective::Distance => Some(plain(0.0, 1.0, 0.0)),
        Objective::Time => Some(plain(0.0, 0.0, 1.0)),
    }
}

/// Whether robots differ in load and standing power alone, ways of driving in speed alone, and both have the same motions.
fn are_alike(known: &Lattice, wanted: &Lattice) -> bool {
    let loaded = Robot {
        name: known.robot.name.clone(),
        mass_kg: known.robot.mass_kg,
        yaw_inertia_kgm2: known.robot.yaw_inertia_kgm2,
        hotel_power_w: known.robot.hotel_power_w,
        battery: known.robot.battery,
        uncertainty: known.robot.uncertainty,
        source: known.robot.source.clone(),
        provenance: known.robot.provenance.clone(),
        posterior: known.robot.posterior.clone(),
        model_error: known.robot.model_error.clone(),
        noise: known.robot.noise,
        ..wanted.robot.clone()
    };
    loaded == known.robot
        && Settings { speed_mps: known.settings.speed_mps, ..wanted.settings } == known.settings
        && known.classes == wanted.classes
        && known.motions == wanted.motions
}
