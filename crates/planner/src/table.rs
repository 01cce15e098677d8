//! Cost of every motion from every state, for one objective.

use rayon::prelude::*;

use crate::{
    edge::Edge,
    heading::{HEADINGS, Heading},
    lattice::{Lattice, State},
};

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

/// What a joule weighs where length or time decide, in metres or seconds: enough to choose between equals, and at
/// 100 kJ a centimetre.
const TIE_PER_J: f64 = 1e-7;

/// Costs of all motions, with gravity taken out of energy so that none is negative.
pub struct CostTable {
    costs: Vec<f32>,
    motions: usize,
}

impl Objective {
    /// Cost of a motion that was driven, between places whose height potentials differ by `lifted_j`.
    pub fn cost(self, edge: &Edge, lifted_j: f64) -> f64 {
        let friction_j = edge.energy_j - lifted_j;
        debug_assert!(
            friction_j >= -1e-6 * (1.0 + lifted_j.abs()),
            "a motion gained {friction_j} J besides gravity"
        );
        let friction_j = friction_j.max(0.0);
        match self {
            Objective::Energy => friction_j,
            Objective::Distance => edge.length_m + TIE_PER_J * friction_j,
            Objective::Time => edge.duration_s + TIE_PER_J * friction_j,
        }
    }
}

impl CostTable {
    /// Evaluates every motion from every state, rows in parallel.
    pub fn new(lattice: &Lattice<'_>, objective: Objective) -> Self {
        let motions = lattice.motions_per_state();
        let columns = lattice.terrain.grid.columns;
        let mut costs = vec![f32::INFINITY; lattice.states() * motions];
        costs.par_chunks_mut(columns * HEADINGS * motions).enumerate().for_each(|(row, costs)| {
            for (i, cost) in costs.iter_mut().enumerate() {
                let (state, motion) = (i / motions, i % motions);
                let cell = terrain::Cell { row, column: state / HEADINGS };
                let state = State { cell, heading: Heading::new(state % HEADINGS) };
                if let Some((_, least)) = cheapest(lattice, objective, state, motion) {
                    *cost = least as f32;
                }
            }
        });
        CostTable { costs, motions }
    }

    /// Cost of a motion from a state; infinite where it cannot be driven.
    #[inline]
    pub fn cost(&self, state: usize, motion: usize) -> f32 {
        self.costs[state * self.motions + motion]
    }

    /// Costs of all motions from a state.
    #[inline]
    pub fn costs(&self, state: usize) -> &[f32] {
        &self.costs[state * self.motions..(state + 1) * self.motions]
    }
}

/// The cheapest way to drive a motion from a state: its variant and cost.
pub(crate) fn cheapest(
    lattice: &Lattice<'_>,
    objective: Objective,
    state: State,
    motion: usize,
) -> Option<(usize, f64)> {
    let end = lattice.successor(state, motion)?;
    let lifted_j = lattice.potential_j(end.cell) - lattice.potential_j(state.cell);
    lattice
        .variants(state.cell, state.heading, motion)
        .enumerate()
        .filter_map(|(variant, edge)| Some((variant, objective.cost(&edge?, lifted_j))))
        .min_by(|a, b| a.1.total_cmp(&b.1))
}
