//! Motions that the table allows, driven in double precision.
//!
//! The table holds motions against the robot's limits in single precision, so one within rounding of a limit may be allowed
//! there and forbidden in double precision. A path that was found over it is driven all the same: it exceeds the limit by
//! rounding at most.

use terrain::Cell;

use crate::{
    grid::state::State,
    ground::spans::{first_blocked, shifted},
    lattice::{
        edge::{Chain, Edge},
        graph::Lattice,
        objective::Weights,
        step::{Limits, Step},
    },
};

/// The variant in which a motion from a state costs least.
pub(crate) fn cheapest(lattice: &Lattice, weights: &Weights, state: State, motion: usize) -> Option<usize> {
    let end = lattice.successor(state, motion)?;
    let lifted_j = lattice.potential_j(end.cell) - lattice.potential_j(state.cell);
    let within = least(weights, lifted_j, lattice.variants(state.cell, state.heading, motion));
    within.or_else(|| {
        let chains = &lattice.chains[state.heading.index()][motion];
        let edges = chains.iter().map(|chain| {
            let mut total = Edge::default();
            drive_unlimited(lattice, chain, state.cell, |step| total.add(step))?;
            Some(total)
        });
        least(weights, lifted_j, edges)
    })
}

/// Place of the edge that costs least.
fn least(weights: &Weights, lifted_j: f64, edges: impl Iterator<Item = Option<Edge>>) -> Option<usize> {
    edges
        .enumerate()
        .filter_map(|(variant, edge)| Some((variant, weights.cost(&edge?, lifted_j))))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(variant, _)| variant)
}

/// Visits every step of driving a chain from a cell, whatever the robot's limits; `None` where it touches blocked ground or
/// reads beyond the map.
pub(crate) fn drive_unlimited(
    lattice: &Lattice,
    chain: &Chain,
    cell: Cell,
    mut visit: impl FnMut(&Step),
) -> Option<()> {
    let terrain = &lattice.terrain;
    if first_blocked(&lattice.clearance, cell, chain.sweep()).is_some() {
        return None;
    }
    let mut height_m = lattice.ground.height_m(terrain, cell);
    for (step, manoeuvres, reverse) in chain.steps_with_manoeuvres() {
        for read in [step.end.corner, step.end.far_corner(), step.middle] {
            shifted(terrain, cell, read)?;
        }
        let manoeuvre_on = |class: usize| &manoeuvres[class];
        let driven = step.drive_within(lattice, (cell, height_m), reverse, manoeuvre_on, &Limits::NONE);
        let (done, end_m) = driven?;
        visit(&done);
        height_m = end_m;
    }
    Some(())
}
