//! What a path is to have least of, and what that makes of a motion.

use crate::edge::Edge;

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
}

impl Objective {
    /// The objective's weights for a robot that takes `level` for a step on level ground.
    pub(crate) fn weights(self, level: &Edge) -> Weights {
        let tie = |amount: f64| if level.energy_j > 0.0 { TIE_SHARE * amount / level.energy_j } else { 0.0 };
        match self {
            Objective::Energy => Weights { per_j: 1.0, per_m: 0.0, per_s: 0.0 },
            Objective::Distance => Weights { per_j: tie(level.length_m), per_m: 1.0, per_s: 0.0 },
            Objective::Time => Weights { per_j: tie(level.duration_s), per_m: 0.0, per_s: 1.0 },
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
        self.per_j * friction_j.max(0.0) + self.per_m * edge.length_m + self.per_s * edge.duration_s
    }
}
