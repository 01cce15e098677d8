//! From a place in metres to a lattice pose where the robot can stand.

use std::{cmp::Reverse, collections::BinaryHeap};

use terrain::Cell;

use crate::{
    error::{Blocked, Error, Place},
    grid::{
        heading::{HEADINGS, Heading, MAX_HEADING_RAD, turn_rad},
        state::State,
    },
    lattice::graph::Lattice,
    patience::{Pacer, Patience, work},
    question::rings::{farthest_ring, ring},
};

/// A place that a request names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Asked {
    pub(crate) place: Place,
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    pub(crate) heading_rad: Option<f64>,
    /// Whether the opposite heading will do as well.
    pub(crate) either_way: bool,
    pub(crate) snap_radius_m: f64,
}

impl Asked {
    /// Whether a heading was asked for.
    fn wants(&self, heading: Heading) -> bool {
        self.heading_rad.map(Heading::nearest).is_none_or(|wanted| {
            wanted == heading || (self.either_way && wanted.turned(HEADINGS as i32 / 2) == heading)
        })
    }
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
    /// Whether the cell holds the place.
    pub(crate) is_home: bool,
}

impl Snapped {
    /// The poses that stand for the place.
    pub(crate) fn states(&self) -> impl Iterator<Item = State> + '_ {
        self.headings.iter().map(|&heading| State { cell: self.cell, heading })
    }

    /// The distance by which candidates are ordered: none within the cell that holds the place [m].
    pub(crate) fn moved_m(&self) -> f64 {
        if self.is_home { 0.0 } else { self.distance_m }
    }
}

/// The cell that holds the place if the robot can stand there, else the nearest within the snap radius.
pub(crate) fn snap(lattice: &Lattice, asked: &Asked, patience: &Patience) -> Result<Snapped, Error> {
    let mut candidates = Candidates::new(lattice, *asked, patience)?;
    if let Some(nearest) = candidates.next() {
        return nearest;
    }
    // The home cell was among the candidates, so whatever heading was wanted is blocked there.
    let heading = asked.heading_rad.map_or(Heading::new(0), Heading::nearest);
    let reason = lattice.stand(State { cell: candidates.home, heading }).err().unwrap_or(Blocked::Edge);
    let Asked { place, x_m, y_m, snap_radius_m, .. } = *asked;
    Err(Error::PlaceBlocked { place, x_m, y_m, snap_radius_m, reason })
}

/// Work of holding the outline against a cell under all headings.
pub(crate) const STANDING_IN_A_CELL: u64 = HEADINGS as u64 * work::STATE;

/// The cells within the snap radius where the robot can stand, the nearest first; the one that holds the place is nearest.
///
/// An error is the last item.
pub(crate) struct Candidates<'l> {
    lattice: &'l Lattice,
    asked: Asked,
    home: Cell,
    /// The next ring of cells about the home cell.
    ring: usize,
    last_ring: usize,
    /// Cells of the rings so far by distance; that of a number of 0 or more orders like its bits.
    open: BinaryHeap<Reverse<(u64, Cell)>>,
    pacer: Pacer<'l>,
}

impl<'l> Candidates<'l> {
    pub(crate) fn new(lattice: &'l Lattice, asked: Asked, patience: &'l Patience) -> Result<Self, Error> {
        let grid = &lattice.terrain.grid;
        let Asked { place, x_m, y_m, .. } = asked;
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
        let within = (asked.snap_radius_m / grid.cell_size_m).ceil() as usize;
        Ok(Candidates {
            lattice,
            asked,
            home,
            ring: 0,
            last_ring: within.saturating_add(1).min(farthest_ring(grid, home)),
            open: BinaryHeap::new(),
            pacer: patience.pacer(),
        })
    }

    fn distance_m(&self, cell: Cell) -> f64 {
        let [x_m, y_m] = self.lattice.terrain.grid.center_m(cell);
        (x_m - self.asked.x_m).hypot(y_m - self.asked.y_m)
    }

    /// Adds the next ring's cells.
    fn open_ring(&mut self) -> Result<(), Error> {
        for cell in ring(&self.lattice.terrain.grid, self.home, self.ring) {
            self.pacer.after(work::CELL).ok_or(Error::Timeout { expanded: 0 })?;
            let distance_m = if cell == self.home { 0.0 } else { self.distance_m(cell) };
            if distance_m <= self.asked.snap_radius_m {
                self.open.push(Reverse((distance_m.to_bits(), cell)));
            }
        }
        self.ring += 1;
        Ok(())
    }

    /// The nearest cell that was not looked at, if any.
    fn nearest(&mut self) -> Result<Option<Cell>, Error> {
        loop {
            // The place lies within half a cell of the home cell's centre, so cells of further rings are no nearer than this.
            let known_m = (self.ring as f64 - 0.5) * self.lattice.terrain.grid.cell_size_m;
            let is_known = |bits: u64| self.ring > self.last_ring || f64::from_bits(bits) <= known_m;
            match self.open.peek() {
                Some(Reverse((bits, _))) if is_known(*bits) => {
                    return Ok(self.open.pop().map(|Reverse((_, cell))| cell));
                }
                None if self.ring > self.last_ring => return Ok(None),
                _ => self.open_ring()?,
            }
        }
    }

    fn look_before_standing(&mut self) -> Result<(), Error> {
        self.pacer.after(STANDING_IN_A_CELL).ok_or(Error::Timeout { expanded: 0 })
    }

    /// A cell as a candidate, if the robot can stand there under a heading that was asked for.
    fn standing(&self, cell: Cell) -> Option<Snapped> {
        let all = Heading::all().filter(|heading| self.asked.wants(*heading));
        let headings: Vec<Heading> =
            all.filter(|&heading| self.lattice.stand(State { cell, heading }).is_ok()).collect();
        let turn_to =
            |heading: &Heading| self.asked.heading_rad.map_or(0.0, |h| turn_rad(h, heading.angle_rad()));
        let turn_rad = headings.iter().map(turn_to).min_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        Some(Snapped {
            cell,
            headings,
            distance_m: self.distance_m(cell),
            turn_rad,
            is_home: cell == self.home,
        })
    }
}

impl Iterator for Candidates<'_> {
    type Item = Result<Snapped, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let cell = match self.nearest().and_then(|cell| self.look_before_standing().map(|()| cell)) {
                Ok(cell) => cell?,
                Err(error) => return Some(Err(error)),
            };
            if let Some(snapped) = self.standing(cell) {
                return Some(Ok(snapped));
            }
        }
    }
}
