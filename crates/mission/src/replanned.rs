//! What better knowledge of the robot would change of the path.

use planner::{Objective, Planner, Query};
use rayon::prelude::*;

use crate::{Error, chance::Chance, journey::Journey, likely::Spread, run::Conditions};

/// The same draws over paths that each was planned with its own parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Replanned {
    /// Draws that were planned anew.
    pub samples: usize,
    /// Their energies over their own paths [J].
    pub energy_j: Spread,
    /// Median of what the own path saves over the fixed one, for the same draw [J].
    pub saving_j: f64,
}

/// Plans anew for each draw; those that patience leaves out are not counted, and without any there is no answer.
pub(crate) fn replanned(
    planner: &Planner,
    queries: &[Query],
    chances: &[Chance],
    fixed: &Journey,
    conditions: &Conditions,
) -> Result<Option<Replanned>, Error> {
    let lattice = planner.lattice();
    let surfaces = planner::surface_names(lattice);
    let one = |chance: &Chance| -> Result<Option<[f64; 2]>, Error> {
        let own = Planner::new(&lattice.terrain, &chance.robot, lattice.settings)?;
        let mut journey = Journey::new(lattice.settings.power_model);
        for query in queries {
            match own.plan(query, Objective::Energy) {
                Ok(plan) => journey.drive(&lattice.robot, &plan.route.steps, &surfaces)?,
                // A draw whose robot cannot go there, or no time for it, tells nothing of the others.
                Err(_) => return Ok(None),
            }
        }
        let energy_j = |journey: &Journey| journey.run(chance, conditions, |_| {}).energy_j;
        Ok(Some([energy_j(&journey), energy_j(fixed)]))
    };
    let found: Result<Vec<_>, Error> = chances.par_iter().map(one).collect();
    let found: Vec<[f64; 2]> = found?.into_iter().flatten().collect();
    if found.is_empty() {
        return Ok(None);
    }
    Ok(Some(Replanned {
        samples: found.len(),
        energy_j: Spread::of(found.iter().map(|[own, _]| *own).collect()),
        saving_j: Spread::of(found.iter().map(|[own, fixed]| fixed - own).collect()).p50,
    }))
}
