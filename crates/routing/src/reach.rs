//! What can be reached from a place, or can reach it, or both, and at what energy.

use planner::{ExactField, Heading, Lattice, Objective, Patience, Place, Planner, State, work};
use rayon::prelude::*;
use terrain::{Cell, Grid};

use crate::{
    error::Error,
    outline::{Polygon, outline},
    waypoint::Waypoint,
};

/// Which way the energy is spent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// From the place to each cell.
    #[default]
    Outward,
    /// From each cell to the place.
    Homeward,
    /// From the place to each cell and back again, on from the pose in which it was reached.
    OutAndBack,
}

/// Least energy of every cell, exact on the lattice with its headings.
///
/// A cell's energy is the least over its headings; out and back it is the least over headings of both ways together, joined
/// in that heading, so a turn before the way back counts. The energy is what has been drawn from the battery on arrival, at
/// the end of the whole way: on the way to ground that lies lower more may have been drawn for a while and come back since.
/// A battery that takes no charge when it is full can do with less of what comes back; that is not looked at here.
///
/// Energies come from the planner's table: at most 1/2048 above those of driving the path, without height.
#[derive(Clone, Debug, PartialEq)]
pub struct Reach {
    /// Where the cells lie.
    pub grid: Grid,
    /// By cell, row-major from the south; NaN where no path leads, or only paths that take more than the most asked for [J].
    pub energy_j: Vec<f64>,
}

/// Least energies up to the most that is of interest, `most_j`, which may be infinite [J]. Where the place has a heading, the
/// robot departs with it and arrives with it; otherwise any will do.
///
/// # Errors
/// A place off the map or where the robot cannot stand, a most that is not above nothing, or patience that ended first.
pub fn reach(
    planner: &Planner,
    place: &Waypoint,
    kind: Kind,
    most_j: f64,
    snap_radius_m: Option<f64>,
    patience: &Patience,
) -> Result<Reach, Error> {
    if most_j.is_nan() || most_j <= 0.0 {
        return Err(Error::NotPositive { field: "energies_j".to_owned(), value: most_j });
    }
    let states = place.states(planner, Place::Start, snap_radius_m, patience)?;
    let seeds: Vec<(State, f64)> = states.into_iter().map(|state| (state, 0.0)).collect();
    let lattice = planner.lattice();
    let home_j = seeds.first().map_or(0.0, |(state, _)| lattice.potential_j(state.cell));
    let table = planner.table(Objective::Energy);
    let late = || Error::Planner(planner::Error::Timeout { expanded: 0 });
    // Costs are E − Δφ, so a budget of energy becomes one of cost with the potentials that can come off it.
    let out = |limit_j: f64| ExactField::from_starts(table, &seeds, limit_j, patience).ok_or_else(late);
    let back = |limit_j: f64| ExactField::to_goals(table, &seeds, limit_j, patience).ok_or_else(late);
    let cells = Cells { lattice, most_j, patience };
    let energy_j = match kind {
        Kind::Outward => {
            let out = out(room_j(most_j, home_j))?;
            cells.least(|state, height_j| Some(out.cost(state)? + height_j - home_j))
        }
        Kind::Homeward => {
            let highest_j = cells.highest_j().ok_or_else(late)?;
            let back = back(room_j(most_j, highest_j - home_j))?;
            cells.least(|state, height_j| Some(back.cost(state)? + home_j - height_j))
        }
        Kind::OutAndBack => {
            let (out, back) = rayon::join(|| out(room_j(most_j, 0.0)), || back(room_j(most_j, 0.0)));
            let (out, back) = (out?, back?);
            cells.least(|state, _| Some(out.cost(state)? + back.cost(state)?))
        }
    };
    Ok(Reach { grid: lattice.terrain.grid, energy_j: energy_j.ok_or_else(late)? })
}

/// A limit of cost that leaves out nothing within a budget, to rounding.
fn room_j(most_j: f64, potential_j: f64) -> f64 {
    /// Costs are whole units, of which a step on level ground has 65 536; this is far more than one.
    const ROUNDING: f64 = 1e-6;
    (most_j + potential_j.max(0.0)) * (1.0 + ROUNDING)
}

/// The cells of a map, looked at one after the other.
struct Cells<'c> {
    lattice: &'c Lattice,
    most_j: f64,
    patience: &'c Patience,
}

impl Cells<'_> {
    /// The highest potential on the map [J]; `None` where patience ends first.
    fn highest_j(&self) -> Option<f64> {
        let grid = &self.lattice.terrain.grid;
        let (mut highest_j, mut pacer) = (0.0f64, self.patience.pacer());
        for index in 0..grid.cells() {
            pacer.after(work::CELL)?;
            // Unknown ground is NaN, which is never the greater.
            highest_j = highest_j.max(self.lattice.potential_j(grid.cell(index)));
        }
        Some(highest_j)
    }

    /// Least energies by cell, given that of a state with the height potential of its cell; `None` where patience ends
    /// first.
    fn least(&self, energy_j: impl Fn(State, f64) -> Option<f64> + Sync) -> Option<Vec<f64>> {
        let grid = &self.lattice.terrain.grid;
        let one = |cell: Cell| {
            let height_j = self.lattice.potential_j(cell);
            let energies_j = Heading::all().filter_map(|heading| energy_j(State { cell, heading }, height_j));
            energies_j.filter(|energy_j| *energy_j <= self.most_j).reduce(f64::min).unwrap_or(f64::NAN)
        };
        // Memory that is zero need not be touched before its row is.
        let mut least_j = vec![0.0; grid.cells()];
        let rows = least_j.par_chunks_mut(grid.columns).enumerate();
        rows.try_for_each(|(row, least_j)| {
            if self.patience.is_over() {
                return None;
            }
            let mut pacer = self.patience.pacer();
            for (column, least_j) in least_j.iter_mut().enumerate() {
                pacer.after(work::STATE)?;
                *least_j = one(Cell { row, column });
            }
            Some(())
        })?;
        Some(least_j)
    }
}

impl Reach {
    /// The ground within an energy, as polygons along the edges of its cells.
    ///
    /// # Errors
    /// Patience that ended first.
    pub fn within(&self, energy_j: f64, patience: &Patience) -> Result<Vec<Polygon>, Error> {
        let polygons = outline(&self.grid, |index| self.energy_j[index] <= energy_j, patience);
        polygons.ok_or(Error::Planner(planner::Error::Timeout { expanded: 0 }))
    }

    /// Area of the ground within an energy [m²].
    ///
    /// # Errors
    /// Patience that ended first.
    pub fn area_m2(&self, energy_j: f64, patience: &Patience) -> Result<f64, Error> {
        let (mut cells, mut pacer) = (0usize, patience.pacer());
        for row in self.energy_j.chunks(self.grid.columns) {
            let late = Error::Planner(planner::Error::Timeout { expanded: 0 });
            pacer.after(row.len() as u64 * work::CELL).ok_or(late)?;
            cells += row.iter().filter(|least_j| **least_j <= energy_j).count();
        }
        Ok(cells as f64 * self.grid.cell_size_m.powi(2))
    }
}
