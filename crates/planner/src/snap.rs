//! From a place in metres to a lattice pose where the robot can stand.

use terrain::Cell;

use crate::{
    error::{Blocked, Error, Place},
    heading::{Heading, MAX_HEADING_RAD, turn_rad},
    lattice::{Lattice, State},
};

/// A place that a request names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Asked {
    pub(crate) place: Place,
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    pub(crate) heading_rad: Option<f64>,
    pub(crate) snap_radius_m: f64,
}

/// The cell and headings that stand for it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Snapped {
    pub(crate) cell: Cell,
    pub(crate) headings: Vec<Heading>,
    /// From the place to the cell's centre [m].
    pub(crate) distance_m: f64,
    /// From the asked heading to the lattice's [rad].
    pub(crate) turn_rad: f64,
}

/// The cell that holds the place if the robot can stand there, else the nearest within the snap radius.
pub(crate) fn snap(lattice: &Lattice, asked: &Asked) -> Result<Snapped, Error> {
    let grid = &lattice.terrain.grid;
    let Asked { place, x_m, y_m, .. } = *asked;
    let sensible = -MAX_HEADING_RAD..=MAX_HEADING_RAD;
    if let Some(heading_rad) = asked.heading_rad.filter(|heading_rad| !sensible.contains(heading_rad)) {
        return Err(Error::Heading { place, heading_rad });
    }
    let home = grid.cell_at(x_m, y_m).ok_or(Error::OutsideMap {
        place,
        x_m,
        y_m,
        west_south_m: grid.origin_m,
        east_north_m: grid.far_corner_m(),
    })?;
    let wanted = asked.heading_rad.map(Heading::nearest);
    let standing = |cell: Cell| -> Vec<Heading> {
        let all = Heading::all().filter(|h| wanted.is_none_or(|w| w == *h));
        all.filter(|&heading| lattice.stand(State { cell, heading }).is_ok()).collect()
    };
    let distance_m = |cell: Cell| {
        let [cx, cy] = grid.center_m(cell);
        (cx - x_m).hypot(cy - y_m)
    };
    let near = cells_within(lattice, home, asked.snap_radius_m)
        .into_iter()
        .filter(|&cell| cell == home || distance_m(cell) <= asked.snap_radius_m)
        .map(|cell| (if cell == home { 0.0 } else { distance_m(cell) }, cell));
    let mut candidates: Vec<(f64, Cell)> = near.collect();
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (_, cell) in candidates {
        let headings = standing(cell);
        if let Some(&first) = headings.first() {
            let turned = asked.heading_rad.map_or(0.0, |h| turn_rad(h, first.angle_rad()));
            return Ok(Snapped { cell, headings, distance_m: distance_m(cell), turn_rad: turned });
        }
    }
    // The home cell was among the candidates, so whatever heading was wanted is blocked there.
    let heading = wanted.unwrap_or(Heading::new(0));
    let reason = lattice.stand(State { cell: home, heading }).err().unwrap_or(Blocked::Edge);
    Err(Error::PlaceBlocked { place, x_m, y_m, snap_radius_m: asked.snap_radius_m, reason })
}

/// Cells within a distance of a cell, by king's moves, on the map.
pub(crate) fn cells_within(lattice: &Lattice, home: Cell, radius_m: f64) -> Vec<Cell> {
    let grid = &lattice.terrain.grid;
    let reach = (radius_m / grid.cell_size_m).ceil() as usize + 1;
    let rows = home.row.saturating_sub(reach)..=(home.row + reach).min(grid.rows - 1);
    let columns = home.column.saturating_sub(reach)..=(home.column + reach).min(grid.columns - 1);
    rows.flat_map(|row| columns.clone().map(move |column| Cell { row, column })).collect()
}
