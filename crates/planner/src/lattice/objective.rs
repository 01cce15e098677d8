//! What a path is to have least of, and what that makes of a motion.

use crate::{grid::cost::UNITS_OF_REFERENCE, lattice::edge::Edge};

/// What a path is to have least of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Objective {
    /// Energy drawn from the battery.
    #[default]
    Energy,
    /// Length along the ground.
    Distance,
    /// Time.
    Time,
}

/// Share of a path's length or time that its energy may weigh on level ground, to choose between equals.
const TIE_SHARE: f64 = 1e-5;
/// Share of the reference energy that the time of a step on level ground weighs for a robot without friction, to choose the
/// fastest of paths that all take nothing: four units of the table, so that lengths of steps are told apart.
const FRICTIONLESS_TIE_SHARE: f64 = 4.0 / UNITS_OF_REFERENCE;

/// An objective as weights of what a motion takes.
///
/// None is negative, and at least one is above nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Of energy beyond lifting [1/J].
    pub per_j: f64,
    /// Of length [1/m].
    pub per_m: f64,
    /// Of time [1/s].
    pub per_s: f64,
    /// Of what preferences add, each in its own unit.
    pub of_surcharge: Surcharge,
}

/// What preferences add to a path in comparisons: it is not drawn from the battery, nor driven.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surcharge {
    /// To energy [J].
    pub j: f64,
    /// To length [m].
    pub m: f64,
    /// To time [s].
    pub s: f64,
}

impl Surcharge {
    /// Adds another.
    pub fn add(&mut self, other: &Surcharge) {
        (self.j, self.m, self.s) = (self.j + other.j, self.m + other.m, self.s + other.s);
    }
}

impl Objective {
    /// A path's amount of the objective [J, m or s].
    pub fn amount(self, total: &Edge) -> f64 {
        match self {
            Objective::Energy => total.energy_j,
            Objective::Distance => total.length_m,
            Objective::Time => total.duration_s,
        }
    }

    /// What a path is compared by: its amount, with what preferences add [J, m or s].
    pub fn compared(self, total: &Edge) -> f64 {
        let Surcharge { j, m, s } = total.surcharge;
        match self {
            Objective::Energy => total.energy_j + j,
            Objective::Distance => total.length_m + m,
            Objective::Time => total.duration_s + s,
        }
    }

    /// The objective's weights for a robot that takes `level` for a step on level ground, and at least `reference_j` for
    /// one that counts.
    ///
    /// Friction may be nothing or next to it. Ties of length and time then weigh energy by the reference, so that they stay
    /// ties; and of paths that take no energy the fastest is the best.
    pub(crate) fn weights(self, level: &Edge, reference_j: f64) -> Weights {
        let energy_j = level.energy_j.max(reference_j);
        let tie = |amount: f64| TIE_SHARE * amount / energy_j;
        let missing_j = (reference_j - level.energy_j).clamp(0.0, reference_j);
        match self {
            Objective::Energy => Weights {
                per_j: 1.0,
                per_m: 0.0,
                per_s: FRICTIONLESS_TIE_SHARE * missing_j / level.duration_s,
                of_surcharge: Surcharge { j: 1.0, ..Surcharge::default() },
            },
            Objective::Distance => Weights {
                per_j: tie(level.length_m),
                per_m: 1.0,
                per_s: 0.0,
                of_surcharge: Surcharge { m: 1.0, ..Surcharge::default() },
            },
            Objective::Time => Weights {
                per_j: tie(level.duration_s),
                per_m: 0.0,
                per_s: 1.0,
                of_surcharge: Surcharge { s: 1.0, ..Surcharge::default() },
            },
        }
    }
}

impl Weights {
    /// Cost of a motion that was driven, between places whose height potentials differ by `lifted_j`.
    pub fn cost(&self, edge: &Edge, lifted_j: f64) -> f64 {
        let friction_j = edge.energy_j - lifted_j;
        debug_assert!(
            friction_j >= -1e-6 * (1.0 + lifted_j.abs()),
            "a motion gained {friction_j} J besides gravity"
        );
        // Only rounding can have made it negative.
        self.of(&Edge { energy_j: friction_j.max(0.0), ..*edge })
    }

    /// Weighted sum of a motion's energy, length and time, with what preferences add.
    pub(crate) fn of(&self, edge: &Edge) -> f64 {
        let taken = self.per_j * edge.energy_j + self.per_m * edge.length_m + self.per_s * edge.duration_s;
        taken + self.of_surcharge(&edge.surcharge)
    }

    /// Weighted sum of what preferences add.
    pub(crate) fn of_surcharge(&self, surcharge: &Surcharge) -> f64 {
        let Surcharge { j, m, s } = self.of_surcharge;
        j * surcharge.j + m * surcharge.m + s * surcharge.s
    }
}
