//! The farthest place that a charge reaches.

use planner::{Goal, Heading, Place, Planner, Query, State};
use rayon::prelude::*;
use terrain::Cell;

use crate::{
    Error,
    likely::Spread,
    meter::Meter,
    round_trip::{Homeward, Outward},
};

/// How far a charge carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carries {
    /// On level ground of the robot's default surface, straight on until the reserve is reached; `None` where that draws
    /// nothing and so never ends [m].
    pub level_m: Option<Spread>,
    /// Whether every place of the map that a way leads to can be reached; the goal is the farthest of them then.
    pub whole_map: bool,
}

/// A cell that a way leads to, and back from where that is asked for.
struct Reached {
    /// In a straight line from the start [m].
    away_m: f64,
    /// Least energy of the way there, or there and back [J].
    energy_j: f64,
    /// The pose in which it is reached with that energy.
    state: State,
}

/// Every cell that a way leads to.
pub(crate) struct Reachable<'p> {
    places: Vec<Reached>,
    farthest_m: f64,
    home: Cell,
    /// Ways back, where they are part of the question.
    pub(crate) homeward: Option<Homeward<'p>>,
}

impl<'p> Reachable<'p> {
    /// Works out the least energies of all cells, exact for the lattice.
    ///
    /// # Errors
    /// A start that cannot be, or patience that ends first.
    pub(crate) fn new(planner: &'p Planner, query: &Query, back: bool) -> Result<Self, Error> {
        let (lattice, patience) = (planner.lattice(), &query.patience);
        let start = &query.start;
        let start_m = [start.x_m, start.y_m];
        let starts =
            planner.states_at(Place::Start, start_m, start.heading_rad, query.snap_radius_m, patience)?;
        let home = starts.first().ok_or(Error::NowhereToGo)?.cell;
        let outward = Outward::new(planner, &starts, home, patience)?;
        let homeward = if back { Some(Homeward::new(planner, home, patience)?) } else { None };
        let grid = &lattice.terrain.grid;
        let [x_m, y_m] = grid.center_m(home);
        let reached = |cell: Cell| {
            let poses = Heading::all().map(|heading| State { cell, heading });
            let (state, energy_j) = outward.best_of(poses, homeward.as_ref())?;
            let [x, y] = grid.center_m(cell);
            Some(Reached { away_m: (x - x_m).hypot(y - y_m), energy_j, state })
        };
        let row = |row: usize| -> Result<Vec<Reached>, Error> {
            let mut meter = Meter::new(patience, "comparing places");
            let cells = (0..grid.columns).map(|column| Cell { row, column });
            cells.filter_map(|cell| meter.spend(WORK_PER_CELL).map(|()| reached(cell)).transpose()).collect()
        };
        let rows: Result<Vec<Vec<Reached>>, Error> = (0..grid.rows).into_par_iter().map(row).collect();
        let places: Vec<Reached> = rows?.into_iter().flatten().collect();
        let farthest_m = places.iter().map(|place| place.away_m).fold(0.0, f64::max);
        Ok(Reachable { places, farthest_m, home, homeward })
    }

    /// The farthest goal within an energy, and whether it is the farthest of all; `None` where not even a cell away is.
    pub(crate) fn farthest(&self, planner: &Planner, budget_j: f64) -> Option<(Goal, bool)> {
        let within =
            self.places.iter().filter(|place| place.energy_j <= budget_j && place.state.cell != self.home);
        let best =
            within.max_by(|a, b| a.away_m.total_cmp(&b.away_m).then(b.energy_j.total_cmp(&a.energy_j)))?;
        let [x_m, y_m] = planner.lattice().terrain.grid.center_m(best.state.cell);
        // The way home has to begin in the heading that it was worked out for.
        let heading_rad = self.homeward.is_some().then(|| best.state.heading.angle_rad());
        Some((
            Goal { x_m, y_m, heading_rad, either_way: false, tolerance_m: 0.0 },
            best.away_m == self.farthest_m,
        ))
    }
}

/// Work of a cell: two costs of each heading.
const WORK_PER_CELL: usize = 8;
