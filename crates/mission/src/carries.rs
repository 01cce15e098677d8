//! How far a charge carries where no goal is named.

use model::Grade;
use planner::{ExactField, Goal, Objective, Place, Planner, Query, Step, body_motion};
use terrain::Cell;

use crate::{
    Error,
    chance::{Chance, Doubt, Drawn},
    journey::{Journey, Part},
    likely::{LEAST_DRAWS, Spread},
    range::Question,
    run::{Conditions, Passage},
};
use rayon::prelude::*;

/// How far a charge carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carries {
    /// On level ground of the robot's default surface, straight on until the reserve is reached [m].
    pub level_m: Spread,
    /// Whether every place of the map that a way leads to can be reached; the goal is the farthest of them then.
    pub whole_map: bool,
}

/// The farthest goal within an energy, in a straight line from the start, and whether it is the farthest of all.
///
/// Energies are exact for the lattice, `back` with the best way home. `None` where not even a cell away is within reach.
pub(crate) fn farthest(
    planner: &Planner,
    query: &Query,
    back: bool,
    budget_j: f64,
) -> Result<Option<(Goal, bool)>, Error> {
    let (lattice, patience) = (planner.lattice(), &query.patience);
    let (start, table) = (&query.start, planner.table(Objective::Energy));
    let place_m = [start.x_m, start.y_m];
    let starts = planner.states_at(Place::Start, place_m, start.heading_rad, query.snap_radius_m)?;
    let Some(home) = starts.first().map(|state| state.cell) else { return Ok(None) };
    let late = || planner::Error::Timeout { expanded: 0 };
    let seeds: Vec<_> = starts.iter().map(|state| (*state, 0.0)).collect();
    let outward = ExactField::from_starts(table, &seeds, f64::INFINITY, patience).ok_or_else(late)?;
    let homeward = match back {
        false => None,
        true => {
            let homes = planner.states_at(Place::Start, place_m, None, query.snap_radius_m)?;
            let goals: Vec<_> = homes.iter().map(|state| (*state, 0.0)).collect();
            Some(ExactField::to_goals(table, &goals, f64::INFINITY, patience).ok_or_else(late)?)
        }
    };
    // Heights cancel over a way out and back.
    let rise_j = |cell: Cell| lattice.potential_j(cell) - lattice.potential_j(home);
    let energy_j = |cell: Cell| -> Option<f64> {
        let (_, out) = outward.least_at(cell)?;
        Some(match &homeward {
            None => out + rise_j(cell),
            Some(field) => out + field.least_at(cell)?.1,
        })
    };
    let grid = &lattice.terrain.grid;
    let [x_m, y_m] = grid.center_m(home);
    let away_m = |cell: Cell| {
        let [x, y] = grid.center_m(cell);
        (x - x_m).hypot(y - y_m)
    };
    let places: Vec<(f64, f64, Cell)> = (0..grid.cells())
        .into_par_iter()
        .map(|i| grid.cell(i))
        .filter_map(|cell| Some((away_m(cell), energy_j(cell)?, cell)))
        .collect();
    let farthest_m = places.iter().map(|(away_m, ..)| *away_m).fold(0.0, f64::max);
    let within = places.iter().filter(|(_, energy_j, cell)| *energy_j <= budget_j && *cell != home);
    let best = within.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
    Ok(best.map(|(away_m, _, cell)| {
        let [x_m, y_m] = grid.center_m(*cell);
        (Goal { x_m, y_m, heading_rad: None, tolerance_m: 0.0 }, *away_m == farthest_m)
    }))
}

/// Steps that level ground is cut into: charge and temperature are held within each.
const LEVEL_STEPS: usize = 400;
/// So many times the way that the capacity would carry at the power it sets out with is far enough.
const FAR: f64 = 2.0;

/// Distance on level ground until the reserve is reached.
pub(crate) fn level_m(
    planner: &Planner,
    question: &Question,
    drawn: &Drawn<'_>,
    conditions: &Conditions,
) -> Result<Spread, Error> {
    let lattice = planner.lattice();
    let (robot, settings) = (&lattice.robot, &lattice.settings);
    let motion = body_motion(robot, settings.speed_mps, None, 0.0, false);
    let capacity_j = drawn.battery.capacity_wh * 3600.0;
    let mut journey = Journey::new(settings.power_model);
    let step = |duration_s: f64| Step {
        end_m: [0.0; 2],
        heading_rad: 0.0,
        length_m: duration_s * motion.speed_mps,
        rise_m: 0.0,
        duration_s,
        motion,
        grade: Grade::LEVEL,
        surface: 0,
        bus_w: 0.0,
    };
    let names = [robot.default_surface.clone()];
    journey.drive(robot, &[step(1.0)], &names)?;
    let chance = Chance::nominal(robot, crate::Pack::new(drawn.battery, 1.0), 1.0);
    let power_w = journey.run(&chance, conditions, |_| {}).energy_j;
    let steps = vec![step(FAR * capacity_j / power_w.max(1e-9) / LEVEL_STEPS as f64); LEVEL_STEPS];
    let mut journey = Journey::new(settings.power_model);
    journey.drive(robot, &steps, &names)?;
    let doubt = Doubt { elevation_sigma_m: 0.0, ..question.doubt };
    let drawn = Drawn { doubt: &doubt, ..*drawn };
    let one = |number: usize| {
        let chance = drawn.chance(journey.length_m(), number as u64);
        let (mut reached_m, mut before) = (0.0, chance.charge);
        journey.run(&chance, conditions, |passage: &Passage| {
            if before > conditions.reserve {
                let Some(Part::Step(step)) = journey.parts.get(passage.part) else { return };
                let share = (before - conditions.reserve) / (before - passage.charge).max(1e-12);
                reached_m += share.min(1.0) * step.duration_s * motion.speed_mps;
            }
            before = passage.charge.min(before);
        });
        reached_m
    };
    Ok(Spread::of((0..question.samples).into_par_iter().with_min_len(LEAST_DRAWS).map(one).collect()))
}
