//! The ground as the robot stands on it: height, attitude and room under the body, cell by cell.
//!
//! - The height is the mean over the disc that the wheels' contacts go round: one function of the place alone, so that
//!   gravity telescopes, turning on the spot lifts nothing, and what is smaller than the robot counts for what the
//!   robot feels of it.
//! - The attitude is that of the plane through the four contacts, by heading.
//! - Where cells are small enough to lie between the wheels, no ground under the body may rise above that plane by more
//!   than the clearance.
//!
//! Prepared tile by tile as it is asked for, and the same whoever asks.

use std::sync::{Arc, OnceLock};

use multiversion::multiversion;
use terrain::{Cell, Terrain};

use crate::{
    grid::{heading::Heading, layout::TILE},
    ground::{
        heights::Heights,
        noise,
        stance::{Body, ORIENTATIONS, Offset, Plane, Stance, Stencil, mirrored, orientation},
    },
};

/// What the robot stands on.
pub(crate) struct Ground {
    stance: Arc<Stance>,
    /// Most that ground may rise above the plane of the wheels [m].
    most_above_m: f32,
    tiles: Vec<OnceLock<Tile>>,
    tile_columns: usize,
}

/// A tile's cells.
struct Tile {
    /// Height of the robot above the map's lowest ground, NaN where the ground is unknown [m].
    height_m: Vec<f32>,
    /// Orientations, as bits, in which the body would touch the ground; empty where it cannot.
    touched: Vec<u8>,
}

impl Ground {
    /// The ground of a terrain under a robot's wheels.
    ///
    /// Of heights that are uncertain by their noise the highest of many lies far above the ground itself: the clearance is
    /// widened by what the noise of all cells of the map comes to at most (see [`noise::highest_m`]).
    pub(crate) fn new(terrain: &Terrain, stance: Arc<Stance>, clearance_m: f64) -> Self {
        let (tile_rows, tile_columns) =
            (terrain.grid.rows.div_ceil(TILE), terrain.grid.columns.div_ceil(TILE));
        let room_for_noise_m = if stance.body.is_some() { noise::highest_m(terrain) } else { 0.0 };
        Ground {
            stance,
            most_above_m: (clearance_m + room_for_noise_m) as f32,
            tiles: std::iter::repeat_with(OnceLock::new).take(tile_rows * tile_columns).collect(),
            tile_columns,
        }
    }

    /// The cells that it is read from, which other ground may share.
    pub(crate) fn stance(&self) -> &Arc<Stance> {
        &self.stance
    }

    /// Whether the robot's body can touch the ground anywhere, as far as cells of this size can tell.
    pub(crate) fn has_body(&self) -> bool {
        self.stance.body.is_some()
    }

    /// How far the ground under the body may rise above the plane of the wheels, with room for the noise of heights, whatever the cells [m].
    pub(crate) fn allowed_above_m(&self, terrain: &Terrain) -> f64 {
        let room_for_noise_m = if self.has_body() { 0.0 } else { noise::highest_m(terrain) };
        f64::from(self.most_above_m) + room_for_noise_m
    }

    /// How far from a cell lies the ground that it depends on [cells].
    pub(crate) fn reach(&self) -> usize {
        self.stance.reach
    }

    /// Height of the robot above the map's lowest ground, NaN where the ground is unknown [m].
    #[inline]
    pub(crate) fn height_m(&self, terrain: &Terrain, Cell { row, column }: Cell) -> f32 {
        self.tile(terrain, row / TILE, column / TILE).height_m[row % TILE * TILE + column % TILE]
    }

    /// Gradient of the plane on which the robot stands, east and north; NaN where the ground is unknown or its body
    /// would touch it.
    #[inline]
    pub(crate) fn gradient(&self, terrain: &Terrain, cell: Cell, heading: Heading) -> (f64, f64) {
        if self.touches(terrain, cell, heading) {
            return (f64::NAN, f64::NAN);
        }
        let [east, north] = self.plane(terrain, cell, heading).gradient;
        (f64::from(east), f64::from(north))
    }

    /// Whether the robot's body would touch the ground.
    #[inline]
    pub(crate) fn touches(&self, terrain: &Terrain, cell: Cell, heading: Heading) -> bool {
        if self.stance.body.is_none() {
            return false;
        }
        let tile = self.tile(terrain, cell.row / TILE, cell.column / TILE);
        tile.touched_in(cell.row % TILE * TILE + cell.column % TILE, orientation(heading))
    }

    /// Height of the highest ground under the body above the plane of the wheels [m]; `None` where cells are too
    /// large to tell.
    pub(crate) fn rises_m(&self, terrain: &Terrain, cell: Cell, heading: Heading) -> Option<f64> {
        let body = self.stance.body.as_ref()?;
        let plane = self.plane(terrain, cell, heading);
        let at = heights_about(terrain, cell);
        let under = &body.under[orientation(heading)];
        let above_m = under.iter().map(|&offset| above_m(&self.stance, &plane, offset, at(offset)));
        Some(f64::from(above_m.fold(f32::NEG_INFINITY, f32::max)))
    }

    /// The plane through the ground at the wheels.
    #[inline]
    pub(crate) fn plane(&self, terrain: &Terrain, cell: Cell, heading: Heading) -> Plane {
        let here_m = terrain.relative_m()[terrain.grid.index(cell)];
        self.stance.contacts[orientation(heading)].plane(here_m, heights_about(terrain, cell))
    }

    /// Copies a row of a tile's heights, from a column of the map on.
    pub(crate) fn copy_heights(&self, terrain: &Terrain, row: usize, from_column: usize, out: &mut [f32]) {
        self.copy_row(terrain, row, from_column, out, |tile, range, part| {
            part.copy_from_slice(&tile.height_m[range]);
        });
    }

    /// Makes NaN of the cells of a row, from a column of the map on, where the body would touch the ground.
    fn strike_touched(
        &self,
        terrain: &Terrain,
        (row, from_column): (usize, usize),
        orientation: usize,
        out: &mut [f32],
    ) {
        self.copy_row(terrain, row, from_column, out, |tile, range, part| {
            if tile.touched.is_empty() {
                return;
            }
            for (at, value) in range.zip(part) {
                if tile.touched_in(at, orientation) {
                    *value = f32::NAN;
                }
            }
        });
    }

    /// Visits the tiles along a row, each with its own range and the part of `out` that stands for it.
    fn copy_row(
        &self,
        terrain: &Terrain,
        row: usize,
        mut column: usize,
        mut out: &mut [f32],
        mut visit: impl FnMut(&Tile, std::ops::Range<usize>, &mut [f32]),
    ) {
        while !out.is_empty() {
            let within = column % TILE;
            let count = (TILE - within).min(out.len());
            let (part, rest) = out.split_at_mut(count);
            let from = row % TILE * TILE + within;
            visit(self.tile(terrain, row / TILE, column / TILE), from..from + count, part);
            (out, column) = (rest, column + count);
        }
    }

    /// Gradients of all cells of a row, by the orientation asked for, from the heights around; NaN as in
    /// [`Ground::gradient`].
    pub(crate) fn gradient_row(
        &self,
        terrain: &Terrain,
        heights: &Heights,
        (row, from_column): (usize, usize),
        orientation: usize,
        [east, north]: [&mut [f32]; 2],
    ) {
        let place = (row as isize, from_column as isize);
        gradients(&self.stance.contacts[orientation], heights, place, east, north);
        if self.stance.body.is_some() {
            self.strike_touched(terrain, (row, from_column), orientation, east);
        }
    }

    fn tile(&self, terrain: &Terrain, tile_row: usize, tile_column: usize) -> &Tile {
        self.tiles[tile_row * self.tile_columns + tile_column].get_or_init(|| {
            let origin = Cell { row: tile_row * TILE, column: tile_column * TILE };
            self.prepare(terrain, origin)
        })
    }

    fn prepare(&self, terrain: &Terrain, origin: Cell) -> Tile {
        let rows = TILE.min(terrain.grid.rows - origin.row);
        let columns = TILE.min(terrain.grid.columns - origin.column);
        let first = (origin.row as isize, origin.column as isize);
        let heights = Heights::new(terrain, first, (TILE, TILE), self.stance.reach);
        let mut tile = Tile { height_m: vec![f32::NAN; TILE * TILE], touched: Vec::new() };
        for row in 0..rows {
            let out = &mut tile.height_m[row * TILE..][..columns];
            means(&self.stance.disc, &heights, (first.0 + row as isize, first.1), out);
        }
        if let Some(body) = &self.stance.body {
            self.touch(body, &heights, origin, &mut tile);
        }
        tile
    }

    /// Finds where the body would touch the ground.
    fn touch(&self, body: &Body, heights: &Heights, origin: Cell, tile: &mut Tile) {
        let mut first = Rows::default();
        for row in 0..TILE {
            let place = ((origin.row + row) as isize, origin.column as isize);
            means(&self.stance.contacts[0], heights, place, &mut first.height_m);
            gradients(&self.stance.contacts[0], heights, place, &mut first.east, &mut first.north);
            spread(body, heights, place, self.stance.cell_size_m, &mut first);
            for column in 0..TILE {
                // Where the ground lies near the plane of one orientation it lies near those of all; by far the most does.
                let apart_m = first.above_m[column].max(-first.below_m[column]) * body.apart;
                if first.height_m[column].is_nan() || first.above_m[column] + apart_m <= self.most_above_m {
                    continue;
                }
                let cell = Cell { row: origin.row + row, column: origin.column + column };
                let bits = self.touched_at(body, heights, cell, first.above_m[column]);
                if bits != 0 {
                    tile.touched.resize(TILE * TILE, 0);
                    tile.touched[row * TILE + column] = bits;
                }
            }
        }
    }

    /// The orientations in which the body would touch the ground at a cell, as bits, where the ground about it rises so
    /// far above the plane of the first.
    fn touched_at(&self, body: &Body, heights: &Heights, cell: Cell, above_first_m: f32) -> u8 {
        let at = |offset: Offset| heights.at_m(cell, offset);
        let here_m = at((0, 0));
        let planes: [Plane; ORIENTATIONS] =
            std::array::from_fn(|k| self.stance.contacts[k].plane(here_m, at));
        let touches = |k: usize| {
            let plane = &planes[k];
            let turned = [0, 1].map(|i| plane.gradient[i] - planes[0].gradient[i]);
            let apart_m = planes[0].height_m - plane.height_m + turned[0].hypot(turned[1]) * body.radius_m;
            above_first_m + apart_m > self.most_above_m
                && body.under[k]
                    .iter()
                    .any(|&offset| above_m(&self.stance, plane, offset, at(offset)) > self.most_above_m)
        };
        (0..ORIENTATIONS).fold(0, |bits, k| bits | u8::from(touches(k)) << k)
    }
}

/// A row of cells: the plane of one orientation, and how far the ground about lies above and below it.
struct Rows {
    height_m: [f32; TILE],
    east: [f32; TILE],
    north: [f32; TILE],
    above_m: [f32; TILE],
    below_m: [f32; TILE],
}

impl Default for Rows {
    fn default() -> Self {
        let none = [0.0; TILE];
        Rows { height_m: none, east: none, north: none, above_m: none, below_m: none }
    }
}

impl Tile {
    fn touched_in(&self, at: usize, orientation: usize) -> bool {
        self.touched.get(at).is_some_and(|bits| bits >> orientation & 1 == 1)
    }
}

/// Height of ground at an offset above a plane; nothing where it is unknown, which blocks in its own way [m].
#[inline]
fn above_m(stance: &Stance, plane: &Plane, (columns, rows): Offset, height_m: f32) -> f32 {
    let [east, north] = plane.gradient;
    let cell_size_m = stance.cell_size_m;
    let level_m = plane.height_m + cell_size_m * (east * columns as f32 + north * rows as f32);
    if height_m.is_nan() { f32::NEG_INFINITY } else { height_m - level_m }
}

/// Heights by offset from a cell; NaN beyond the map.
fn heights_about(terrain: &Terrain, cell: Cell) -> impl Fn(Offset) -> f32 + '_ {
    let grid = &terrain.grid;
    move |(columns, rows)| {
        let row = cell.row.checked_add_signed(rows as isize).filter(|row| *row < grid.rows);
        let column = cell.column.checked_add_signed(columns as isize).filter(|column| *column < grid.columns);
        row.zip(column).map_or(f32::NAN, |(row, column)| terrain.relative_m()[row * grid.columns + column])
    }
}

/// Heights of a stencil along a row.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2+fma", "aarch64+neon"))]
fn means(stencil: &Stencil, heights: &Heights, place: (isize, isize), out: &mut [f32]) {
    let here_m = heights.row_m(place, (0, 0), out.len());
    for (out, here_m) in out.iter_mut().zip(here_m) {
        *out = stencil.centre * here_m;
    }
    for pair in stencil.pairs.iter().filter(|pair| pair.height != 0.0) {
        let (columns, rows) = pair.offset;
        let one_m = heights.row_m(place, (columns, rows), out.len());
        let other_m = heights.row_m(place, (-columns, -rows), out.len());
        for (((out, here_m), one_m), other_m) in out.iter_mut().zip(here_m).zip(one_m).zip(other_m) {
            let (one_m, other_m) = mirrored(*here_m, *one_m, *other_m);
            *out += pair.height * (one_m + other_m);
        }
    }
}

/// Gradients of a stencil along a row.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2+fma", "aarch64+neon"))]
fn gradients(
    stencil: &Stencil,
    heights: &Heights,
    place: (isize, isize),
    east: &mut [f32],
    north: &mut [f32],
) {
    let count = east.len();
    let here_m = heights.row_m(place, (0, 0), count);
    // Unknown ground has no gradient.
    for ((east, north), here_m) in east.iter_mut().zip(north.iter_mut()).zip(here_m) {
        (*east, *north) = (0.0 * here_m, 0.0 * here_m);
    }
    for pair in &stencil.pairs {
        let (columns, rows) = pair.offset;
        let one_m = &heights.row_m(place, (columns, rows), count)[..count];
        let other_m = &heights.row_m(place, (-columns, -rows), count)[..count];
        let [by_east, by_north] = pair.gradient;
        for x in 0..count {
            let (one_m, other_m) = mirrored(here_m[x], one_m[x], other_m[x]);
            east[x] += by_east * (one_m - other_m);
            north[x] += by_north * (one_m - other_m);
        }
    }
}

/// How far the known ground about a row of cells lies above and below the planes there.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2+fma", "aarch64+neon"))]
fn spread(body: &Body, heights: &Heights, place: (isize, isize), cell_size_m: f32, rows: &mut Rows) {
    rows.above_m = [0.0; TILE];
    rows.below_m = [0.0; TILE];
    for &(columns, at_row) in &body.under_any {
        let height_m = &heights.row_m(place, (columns, at_row), TILE)[..TILE];
        let (x_m, y_m) = (cell_size_m * columns as f32, cell_size_m * at_row as f32);
        for (x, height_m) in height_m.iter().enumerate() {
            let above_m = height_m - (rows.height_m[x] + x_m * rows.east[x] + y_m * rows.north[x]);
            // Comparisons that are false of unknown ground.
            rows.above_m[x] = if above_m > rows.above_m[x] { above_m } else { rows.above_m[x] };
            rows.below_m[x] = if above_m < rows.below_m[x] { above_m } else { rows.below_m[x] };
        }
    }
}
