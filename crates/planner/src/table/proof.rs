//! What costs of the table prove of amounts in double precision.

use crate::{
    grid::cost::{LARGEST_ROUNDING, SINGLE_PRECISION},
    lattice::{
        graph::Lattice,
        objective::{Objective, Weights},
    },
    table::least::{chains, driven_on, least_cost_of_motion, slopes},
};

/// A lower bound of an objective's amount along any path, from a lower bound of its cost in the table.
///
/// A motion that costs c when driven in double precision has `t` units in the table. With `U` units to the objective's unit, the
/// relative error σ of single precision, the error `a` in units of taking lifting work off energy, and the rounding ρ,
///
/// ```text
/// t ≤ (U c (1 + σ) + a) (1 + ρ)     from 2048 units on
/// t ≤  U c (1 + σ) + a + 1          below, where costs are rounded up to whole units
/// ```
///
/// so that of a motion of at least `t₀` units, and therefore of every path of `T` units in all,
///
/// ```text
/// U c ≥ q t      q = (1 − ρ)(1 − σ) − (1 + a) / t₀
/// C   ≥ q T / U
/// ```
///
/// What follows at the goal is rounded down, the estimate ahead never exceeds the table's costs, and energy's height potential
/// between the ends is added in double precision, so `q T / U` plus it bounds the energy that is reported.
///
/// Length and time have a share of energy among their costs, to choose between equals. Of a path with length ℓ it is at most
/// `τ ℓ + τ₀`: the largest share of any motion that leads on, and eight turns on the spot, the most that the shortest of
/// paths needs in one place, for each cell and once more. Turns on the spot have no length, so that all that they cost, with
/// the unit that it is rounded up by, counts there. A robot without friction has time among its costs of energy, which
/// proves nothing of energy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Proof {
    /// Amount proven by a unit of cost, 0 or more.
    per_unit: f64,
    /// What is taken off.
    off: f64,
}

impl Proof {
    /// Of nothing but that no amount is negative.
    pub(crate) const NONE: Proof = Proof { per_unit: 0.0, off: 0.0 };

    pub(crate) fn new(lattice: &Lattice, objective: Objective, weights: &Weights, units: f64) -> Self {
        if objective == Objective::Energy && weights.per_s > 0.0 {
            return Proof::NONE;
        }
        let takes_some = |columns, rows| objective != Objective::Distance || (columns, rows) != (0, 0);
        let sum = Self::of_sum(lattice, weights, units, takes_some);
        let tie = Tie::new(lattice, objective, weights, allowed(lattice, weights, units) / units);
        Proof { per_unit: sum.per_unit / (1.0 + tie.share), off: tie.once / (1.0 + tie.share) }
    }

    /// Of a sum of energy without lifting, length and time, over paths of motions that take some of it.
    pub(crate) fn of_sum(
        lattice: &Lattice,
        weights: &Weights,
        units: f64,
        takes_some: impl Fn(i32, i32) -> bool,
    ) -> Self {
        let least_units = least_cost_of_motion(lattice, weights, takes_some) * units;
        let lost = allowed(lattice, weights, units) / least_units;
        let share = (1.0 - LARGEST_ROUNDING) * (1.0 - SINGLE_PRECISION) - lost;
        // A motion that may take nothing proves nothing.
        Proof { per_unit: share.max(0.0) / units, off: 0.0 }
    }

    /// Amount proven by a unit of cost.
    pub(crate) fn per_unit(&self) -> f64 {
        self.per_unit
    }

    /// Share of a path's units that may be lost to cancellation, at most: what `q` lacks of the roundings that are relative. Each motion loses
    /// `a` of at least `t₀` units.
    pub(crate) fn lost(&self, units: f64) -> f64 {
        ((1.0 - LARGEST_ROUNDING) * (1.0 - SINGLE_PRECISION) - units * self.per_unit).max(0.0)
    }

    /// The least amount of a path that costs at least so many units.
    pub(crate) fn least(&self, units: f64) -> f64 {
        (units * self.per_unit - self.off).max(0.0)
    }
}

/// Most units of a motion's cost that are not its own: the whole one that it is rounded up by, and those of cancellation.
fn allowed(lattice: &Lattice, weights: &Weights, units: f64) -> f64 {
    1.0 + cancellation(lattice, weights) * units
}

/// Largest error of a motion's cost that comes from taking lifting work off energy in single precision, in the objective's
/// unit: eight roundings of the work of the longest motion up the steepest slope.
pub(crate) fn cancellation(lattice: &Lattice, weights: &Weights) -> f64 {
    const ROUNDINGS: f64 = 8.0;
    /// On steeper ground hardly any weight is left on the wheels [m/m].
    const STEEPEST: f64 = 100.0;
    let grade = lattice.limits.pitch_grade.abs().min(STEEPEST);
    let longest = chains(lattice).map(|(_, motion)| f64::from(motion.columns).hypot(f64::from(motion.rows)));
    let longest_m = longest.fold(0.0, f64::max) * lattice.terrain.grid.cell_size_m;
    let [_, largest_factor] = lattice.classes.factors();
    let per_j = weights.per_j * largest_factor.max(1.0);
    ROUNDINGS * f64::from(f32::EPSILON / 2.0) * per_j * lattice.lift_j_per_m() * grade * longest_m
}

/// Costs of a path besides those of its length or time, at most: the energy among them, and turns on the spot.
struct Tie {
    /// Share of the amount.
    share: f64,
    /// Once for a path, in the objective's unit.
    once: f64,
}

impl Tie {
    /// Most turns on the spot that the shortest of paths has in one place: half a circle.
    const TURNS_IN_PLACE: f64 = 8.0;

    /// `rounding` is the most that a motion is rounded up by, in the objective's unit.
    fn new(lattice: &Lattice, objective: Objective, weights: &Weights, rounding: f64) -> Self {
        if objective == Objective::Energy {
            return Tie { share: 0.0, once: 0.0 };
        }
        let (mut share, mut turn) = (0.0f64, 0.0f64);
        for (chain, _) in chains(lattice) {
            for (step, manoeuvres, reverse) in chain.steps_with_manoeuvres() {
                for (manoeuvre, class) in manoeuvres.iter().zip(&lattice.classes.list) {
                    let weights = class.weights(weights, &lattice.settings, step, reverse);
                    for slope in slopes(lattice) {
                        let Some(done) = driven_on(step, (manoeuvre, class.name, reverse), slope) else {
                            continue;
                        };
                        let energy = weights.per_j * lattice.unlifted_j(&done).max(0.0);
                        let amount =
                            weights.per_m * done.length_m + weights.per_s * done.duration_s + weights.fixed;
                        if amount > 0.0 {
                            share = share.max(energy / amount);
                        } else {
                            turn = turn.max(energy * (1.0 + SINGLE_PRECISION) + rounding);
                        }
                    }
                }
            }
        }
        let once = Self::TURNS_IN_PLACE * turn;
        // Where a cost factor is below 1, a cell's length counts for less than the cell.
        let [least_factor, _] = lattice.classes.factors();
        let least_m = lattice.terrain.grid.cell_size_m * least_factor.min(1.0);
        Tie { share: share + once / least_m, once }
    }
}
