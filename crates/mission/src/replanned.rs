//! What better knowledge of the robot would change of the path.

use planner::{Objective, Patience, Planner, Query};
use rayon::prelude::*;

use crate::{Error, chance::Drawn, journey::Journey, likely::Spread, meter::Meter, run::Conditions};

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

/// What is planned anew.
pub(crate) struct Anew<'a> {
    pub(crate) planner: &'a Planner,
    /// The question of each way.
    pub(crate) queries: &'a [Query],
    /// The ways as they were planned once for all draws.
    pub(crate) fixed: &'a Journey,
    pub(crate) drawn: &'a Drawn<'a>,
    pub(crate) conditions: &'a Conditions,
}

/// Plans anew for each draw; those that patience leaves out are not counted, and without any there is no answer.
///
/// # Errors
/// Robots that the map's ground does not suit.
pub(crate) fn replanned(
    anew: &Anew<'_>,
    samples: usize,
    patience: &Patience,
) -> Result<Option<Replanned>, Error> {
    let Anew { planner, queries, fixed, drawn, conditions } = anew;
    let lattice = planner.lattice();
    let surfaces = planner::surface_names(lattice);
    let one = |number: usize| -> Result<Option<[f64; 2]>, Error> {
        let mut meter = Meter::new(patience, "planning anew");
        if meter.look().is_err() {
            return Ok(None);
        }
        let chance = drawn.chance(fixed.length_m(), number as u64);
        let own = match Planner::prepare(&lattice.terrain, &chance.robot, lattice.settings, patience) {
            Err(planner::Error::Timeout { .. }) => return Ok(None),
            prepared => prepared?,
        };
        let mut journey = Journey::new(lattice.settings.power_model);
        for query in *queries {
            match own.plan(query, Objective::Energy) {
                Ok(plan) => journey.drive_route(lattice, &plan.route, &surfaces)?,
                // A draw whose robot cannot go there, or no time for it, tells nothing of the others.
                Err(_) => return Ok(None),
            }
        }
        let mut energy_j =
            |journey: &Journey| journey.run(&chance, conditions, &mut meter, |_| {}).map(|run| run.energy_j);
        Ok(energy_j(&journey).and_then(|own_j| Ok([own_j, energy_j(fixed)?])).ok())
    };
    let found: Result<Vec<_>, Error> = (0..samples).into_par_iter().map(one).collect();
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
