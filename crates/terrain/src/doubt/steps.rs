//! Differences between neighbouring cells, by edges.

use rayon::prelude::*;

use super::Values;
use crate::{Cell, Terrain, Warning, WarningKind, fill_value};

/// Steps between cells of a map, but for those at cells of conventional fill values.
pub(super) struct Steps {
    /// Edge of a cell [m].
    pub(super) cell_size_m: f64,
    pub(super) count: usize,
    /// Sum of their squares [m²].
    pub(super) squares_m2: f64,
    /// Those that are not level.
    pub(super) sloped: usize,
    /// Those of them that are one round step of heights high ([`Values::round_step_m`]).
    pub(super) single: usize,
    round_step_m: f64,
    /// Those that are steeper than 45°.
    pub(super) steep: usize,
    /// Those of more than half a circle, were they degrees.
    pub(super) beyond_half_circle: usize,
    pub(super) candidates: Vec<Candidate>,
}

/// A value that may be a fill value, and the steps at its cells and elsewhere.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pub(super) value: f64,
    relative_m: f32,
    is_conventional: bool,
    pub(super) cells: usize,
    /// Steps from its cells to others.
    pub(super) edges: usize,
    /// Lowest of them [m].
    pub(super) least_edge_m: f64,
    /// Steps away from its cells and from those of conventional fill values.
    pub(super) others: usize,
    /// Those of them that are not level.
    pub(super) sloped_others: usize,
    /// Highest of them [m].
    pub(super) highest_other_m: f64,
}

impl Steps {
    pub(super) fn of(terrain: &Terrain, values: &Values) -> Self {
        let candidates = candidates(terrain, values);
        let rows = 0..terrain.grid.rows;
        let round_step_m = values.round_step_m.unwrap_or(0.0);
        let empty = || Steps::empty(terrain.grid.cell_size_m, round_step_m, &candidates);
        rows.into_par_iter()
            .fold(empty, |mut steps, row| {
                steps.add_row(terrain, row);
                steps
            })
            .reduce(empty, Steps::joined)
    }

    fn empty(cell_size_m: f64, round_step_m: f64, candidates: &[Candidate]) -> Self {
        let candidates = candidates.to_vec();
        Steps {
            cell_size_m,
            count: 0,
            squares_m2: 0.0,
            sloped: 0,
            single: 0,
            round_step_m,
            steep: 0,
            beyond_half_circle: 0,
            candidates,
        }
    }

    /// Adds the cells of a row, and its steps to the east and north.
    fn add_row(&mut self, terrain: &Terrain, row: usize) {
        let grid = &terrain.grid;
        for column in 0..grid.columns {
            let index = grid.index(Cell { row, column });
            let here = terrain.relative_m[index];
            if here.is_nan() {
                continue;
            }
            let at_here = self.candidate_of(here);
            if let Some(candidate) = at_here.and_then(|at| self.candidates.get_mut(at)) {
                candidate.cells += 1;
            }
            let east = (column + 1 < grid.columns).then(|| terrain.relative_m[index + 1]);
            let north = terrain.relative_m.get(index + grid.columns).copied();
            for there in [east, north].into_iter().flatten().filter(|z| !z.is_nan()) {
                self.add_step(at_here, here, there);
            }
        }
    }

    fn add_step(&mut self, at_here: Option<usize>, here: f32, there: f32) {
        let at_there = self.candidate_of(there);
        let step_m = f64::from((there - here).abs());
        let is_conventional = |at: Option<usize>| {
            at.and_then(|at| self.candidates.get(at)).is_some_and(|one| one.is_conventional)
        };
        let is_of_ground = !is_conventional(at_here) && !is_conventional(at_there);
        if is_of_ground {
            self.count += 1;
            self.squares_m2 += step_m * step_m;
            self.sloped += usize::from(step_m > 0.0);
            // The next multiple is twice as high.
            self.single += usize::from(step_m > 0.0 && step_m < 1.5 * self.round_step_m);
            self.steep += usize::from(step_m > self.cell_size_m);
            self.beyond_half_circle += usize::from(step_m > 180.0);
        }
        for (at, candidate) in self.candidates.iter_mut().enumerate() {
            let touches = [at_here, at_there].map(|other| other == Some(at));
            match touches {
                [true, true] => {}
                [true, false] | [false, true] => {
                    candidate.edges += 1;
                    candidate.least_edge_m = candidate.least_edge_m.min(step_m);
                }
                [false, false] if is_of_ground => {
                    candidate.others += 1;
                    candidate.sloped_others += usize::from(step_m > 0.0);
                    candidate.highest_other_m = candidate.highest_other_m.max(step_m);
                }
                [false, false] => {}
            }
        }
    }

    fn candidate_of(&self, relative_m: f32) -> Option<usize> {
        self.candidates.iter().position(|candidate| candidate.relative_m == relative_m)
    }

    fn joined(mut self, other: Steps) -> Self {
        self.count += other.count;
        self.squares_m2 += other.squares_m2;
        self.sloped += other.sloped;
        self.single += other.single;
        self.steep += other.steep;
        self.beyond_half_circle += other.beyond_half_circle;
        for (own, other) in self.candidates.iter_mut().zip(other.candidates) {
            own.cells += other.cells;
            own.edges += other.edges;
            own.least_edge_m = own.least_edge_m.min(other.least_edge_m);
            own.others += other.others;
            own.sloped_others += other.sloped_others;
            own.highest_other_m = own.highest_other_m.max(other.highest_other_m);
        }
        self
    }
}

/// Conventional fill values that ground may have, and the extremes of the map, where they lie within it.
fn candidates(terrain: &Terrain, values: &Values) -> Vec<Candidate> {
    let mut candidates: Vec<Candidate> = Vec::new();
    let conventional = fill_value::POSSIBLY_GROUND;
    // As the cells have them, in single precision.
    let cells_m = 0.0..=(values.highest_m - terrain.base_m) as f32;
    for value in conventional.into_iter().chain([values.lowest_m, values.highest_m]) {
        let relative_m = (value - terrain.base_m) as f32;
        let is_new = candidates.iter().all(|candidate| candidate.relative_m != relative_m);
        if is_new && cells_m.contains(&relative_m) {
            candidates.push(Candidate {
                value,
                relative_m,
                is_conventional: fill_value::is_conventional(value),
                cells: 0,
                edges: 0,
                least_edge_m: f64::INFINITY,
                others: 0,
                sloped_others: 0,
                highest_other_m: 0.0,
            });
        }
    }
    candidates
}

/// A warning where more than half of all steps are steeper than 45°. Loose ground slides at 35 to 45°, so that no ground that
/// can be driven on is mostly steeper: elevations in another unit than the cells, a picture or noise are.
pub(super) fn impossible_slopes(steps: &Steps) -> Option<Warning> {
    (2 * steps.steep > steps.count).then(|| {
        let percent = 100.0 * steps.steep as f64 / steps.count as f64;
        let detail = format!(
            "{percent:.0} % of all steps between neighbouring cells are steeper than 45°, which no ground is: the map looks like a picture, noise or heights in another unit than its cells of {} m, not like elevation",
            steps.cell_size_m
        );
        Warning::new(WarningKind::ImpossibleSlopes, detail)
    })
}
