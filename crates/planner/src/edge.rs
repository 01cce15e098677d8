//! What one motion costs on the ground at hand: the edge energy that plan, matrix and reachability share.

use model::{Acceleration, Manoeuvre, Motion as BodyMotion, Robot};
use terrain::{Cell, slope};

use crate::{
    footprint::{Footprint, first_blocked, shifted},
    lattice::Lattice,
    primitive::Piece,
};

/// Totals of one motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Edge {
    /// Energy drawn from the battery; negative when more came back [J].
    pub energy_j: f64,
    /// Energy that flowed back into the battery, 0 or more [J].
    pub recovered_j: f64,
    /// Time [s].
    pub duration_s: f64,
    /// Length along the ground [m].
    pub length_m: f64,
    /// Height gained on the way up [m].
    pub climb_m: f64,
    /// Height lost on the way down, 0 or more [m].
    pub descent_m: f64,
}

impl Edge {
    /// Adds one step.
    pub fn add(&mut self, step: &Step) {
        let energy_j = step.energy_j();
        self.energy_j += energy_j;
        self.recovered_j += (-energy_j).max(0.0);
        self.duration_s += step.duration_s;
        self.length_m += step.length_m;
        self.climb_m += step.rise_m.max(0.0);
        self.descent_m += (-step.rise_m).max(0.0);
    }
}

/// A stretch of a motion at constant grade, surface and curvature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Where it ends: x, y relative to the start cell's centre [m].
    pub end_m: [f64; 2],
    /// Heading of the robot at its end [rad].
    pub heading_rad: f64,
    /// Length along the ground [m].
    pub length_m: f64,
    /// Height gained [m].
    pub rise_m: f64,
    /// Time [s].
    pub duration_s: f64,
    /// Body speeds.
    pub motion: BodyMotion,
    /// Rise per metre across the heading, positive with the left side up.
    pub side_grade: f64,
    /// cos γ: share of the weight that presses on the ground.
    pub normal: f64,
    /// sin γ sin β: share of the weight along the heading.
    pub along: f64,
    /// Index of the surface among the map's, the robot's default last.
    pub surface: usize,
    /// Power drawn from the battery [W].
    pub bus_w: f64,
}

impl Step {
    /// Energy drawn from the battery [J].
    pub fn energy_j(&self) -> f64 {
        self.bus_w * self.duration_s
    }
}

/// One way to drive a motion, with everything prepared that does not depend on the cell it starts from.
pub(crate) struct Chain {
    pieces: Vec<PreparedPiece>,
    sweep: Vec<(i32, i32)>,
    /// Largest king's distance of a swept cell: with more clearance nothing can be touched.
    reach: u8,
    /// Cells that interpolation reads, as the corners of their bounding box.
    read_from: (i32, i32),
    read_to: (i32, i32),
    reverse: bool,
}

struct PreparedPiece {
    /// One manoeuvre per surface.
    manoeuvres: Vec<Manoeuvre>,
    steps: Vec<PreparedStep>,
}

pub(crate) struct PreparedStep {
    pub(crate) horizontal_m: f64,
    pub(crate) turn_rad: f64,
    end_m: [f64; 2],
    end_heading_rad: f64,
    /// Unit vector of travel half way.
    pub(crate) travel: (f64, f64),
    /// Cell under the middle.
    pub(crate) middle: (i32, i32),
    pub(crate) end: Sample,
}

/// Bilinear interpolation between cell centres at a fixed place relative to the start cell.
pub(crate) struct Sample {
    corner: (i32, i32),
    weights: [f32; 4],
}

/// Longest step, in cells: half of the longest straight between lattice points, √5, with a little room.
const STEP_CELLS: f64 = 1.25;
/// Largest turn within a step [rad]: the widest between neighbouring headings, 0.464. Half way the pitch is that of the
/// chord, and the error of second order in the turn.
const STEP_TURN_RAD: f64 = 0.47;
/// Spacing of the poses whose footprints make up a sweep, in cells.
const SWEEP_CELLS: f64 = 0.25;

impl Chain {
    pub(crate) fn new(
        pieces: &[Piece],
        reverse: bool,
        footprint: &Footprint,
        cell_size_m: f64,
        manoeuvres: &impl Fn(&Piece, bool) -> Vec<Manoeuvre>,
    ) -> Self {
        let prepared: Vec<PreparedPiece> = pieces
            .iter()
            .map(|piece| PreparedPiece {
                manoeuvres: manoeuvres(piece, reverse),
                steps: prepare_steps(piece, reverse, cell_size_m),
            })
            .collect();
        let sweep = sweep(pieces, footprint, cell_size_m);
        let reach = sweep.iter().map(|(c, r)| c.abs().max(r.abs())).max().unwrap_or(0);
        let steps = || prepared.iter().flat_map(|p| &p.steps);
        let corners = || {
            let read = steps().flat_map(|s| [s.end.corner, s.end.far_corner(), s.middle]);
            read.chain([(0, 0)])
        };
        let read_from = corners().fold((0, 0), |low, corner| (low.0.min(corner.0), low.1.min(corner.1)));
        let read_to = corners().fold((0, 0), |high, corner| (high.0.max(corner.0), high.1.max(corner.1)));
        let reach = u8::try_from(reach).unwrap_or(u8::MAX);
        Chain { pieces: prepared, sweep, reach, read_from, read_to, reverse }
    }

    /// The cells it sweeps and their largest king's distance.
    pub(crate) fn sweep(&self) -> (&[(i32, i32)], u8) {
        (&self.sweep, self.reach)
    }

    /// Its steps, each with the manoeuvres of all surfaces and whether it is driven backwards.
    pub(crate) fn steps_with_manoeuvres(&self) -> impl Iterator<Item = (&PreparedStep, &[Manoeuvre], bool)> {
        self.pieces
            .iter()
            .flat_map(|piece| piece.steps.iter().map(|step| (step, &piece.manoeuvres[..], self.reverse)))
    }

    /// Totals on level ground of the robot's default surface, whatever its limits.
    pub(crate) fn on_level_ground(&self) -> Edge {
        let mut total = Edge::default();
        for (step, manoeuvres, reverse) in self.steps_with_manoeuvres() {
            let surface = manoeuvres.len() - 1;
            if let Some(done) =
                step.drive(&manoeuvres[surface], 0.0, (0.0, 0.0), reverse, &Limits::NONE, surface)
            {
                total.add(&done);
            }
        }
        total
    }

    /// Totals of driving this from a cell; `None` where ground, obstacles or limits forbid it.
    pub(crate) fn edge(&self, lattice: &Lattice, cell: Cell) -> Option<Edge> {
        let mut total = Edge::default();
        self.drive(lattice, cell, |step| total.add(step))?;
        Some(total)
    }

    /// Visits every step of driving this from a cell; `None`, possibly after some visits, where it is forbidden.
    pub(crate) fn drive(
        &self,
        lattice: &Lattice,
        cell: Cell,
        mut visit: impl FnMut(&Step),
    ) -> Option<()> {
        let terrain = &lattice.terrain;
        let index = terrain.grid.index(cell);
        shifted(terrain, cell, self.read_from)?;
        shifted(terrain, cell, self.read_to)?;
        if lattice.clearance.at(index) <= self.reach && first_blocked(terrain, cell, &self.sweep).is_some() {
            return None;
        }
        let z = terrain.relative_m();
        let columns = terrain.grid.columns as isize;
        let offset = |(c, r): (i32, i32)| (index as isize + r as isize * columns + c as isize) as usize;
        let mut height_m = z[index];
        for piece in &self.pieces {
            for step in &piece.steps {
                let end_m = step.end.height_m(z, offset(step.end.corner), columns as usize);
                let middle = offset(step.middle);
                let slope = slope::gradient_at(terrain, terrain.grid.cell(middle));
                let surface = if lattice.terrain.surfaces().is_some() {
                    lattice.surface_index(terrain.grid.cell(middle))
                } else {
                    0
                };
                let rise_m = f64::from(end_m - height_m);
                let done = step.drive(
                    &piece.manoeuvres[surface],
                    rise_m,
                    slope,
                    self.reverse,
                    &lattice.limits,
                    surface,
                )?;
                visit(&done);
                height_m = end_m;
            }
        }
        Some(())
    }
}

/// The robot's limits in the form that a step compares with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    pub(crate) pitch_grade: f64,
    pub(crate) roll_grade: f64,
    pub(crate) side_force_n: f64,
}

impl Limits {
    const NONE: Limits =
        Limits { pitch_grade: f64::INFINITY, roll_grade: f64::INFINITY, side_force_n: f64::INFINITY };

    pub(crate) fn of(robot: &Robot) -> Self {
        let limits = &robot.limits;
        Limits {
            pitch_grade: limits.max_pitch_rad.tan(),
            roll_grade: limits.max_roll_rad.tan(),
            side_force_n: limits.max_side_force_n.unwrap_or(f64::INFINITY),
        }
    }
}

impl PreparedStep {
    /// The step on ground that rises by `rise_m` and slopes by `slope` (east, north) half way.
    #[inline]
    fn drive(
        &self,
        manoeuvre: &Manoeuvre,
        rise_m: f64,
        slope: (f64, f64),
        reverse: bool,
        limits: &Limits,
        surface: usize,
    ) -> Option<Step> {
        let (cos, sin) = self.travel;
        let turning = self.horizontal_m == 0.0;
        let grade = if turning { slope.0 * cos + slope.1 * sin } else { rise_m / self.horizontal_m };
        let side_grade = slope.1 * cos - slope.0 * sin;
        // Written so that a NaN of unknown ground fails too.
        if !(grade.abs() <= limits.pitch_grade && side_grade.abs() <= limits.roll_grade) {
            return None;
        }
        let cos_pitch = 1.0 / (1.0 + grade * grade).sqrt();
        let cos_roll = 1.0 / (1.0 + side_grade * side_grade).sqrt();
        let facing = if reverse { -1.0 } else { 1.0 };
        let (normal, along) = (cos_pitch * cos_roll, facing * grade * cos_pitch);
        let motion = *manoeuvre.motion();
        let length_m = self.horizontal_m / cos_pitch;
        let duration_s =
            if turning { self.turn_rad / motion.yaw_rate_radps } else { length_m / motion.speed_mps.abs() };
        let power = manoeuvre.power_on_grade(normal, along, Acceleration::NONE);
        if power.force_n.left.abs().max(power.force_n.right.abs()) > limits.side_force_n {
            return None;
        }
        Some(Step {
            end_m: self.end_m,
            heading_rad: self.end_heading_rad,
            length_m,
            rise_m: if turning { 0.0 } else { rise_m },
            duration_s,
            motion,
            side_grade: facing * side_grade,
            normal,
            along,
            surface,
            bus_w: power.bus_w,
        })
    }
}

impl Sample {
    /// Interpolates at a place; whole cells to nine decimals, so that lattice points read exactly one cell.
    fn at(place_m: [f64; 2], cell_size_m: f64) -> Self {
        let whole = |v: f64| {
            let near = (v * 1e9).round() / 1e9;
            (near.floor(), near - near.floor())
        };
        let (column, east) = whole(place_m[0] / cell_size_m);
        let (row, north) = whole(place_m[1] / cell_size_m);
        let weights =
            [(1.0 - east) * (1.0 - north), east * (1.0 - north), (1.0 - east) * north, east * north];
        Sample { corner: (column as i32, row as i32), weights: weights.map(|w| w as f32) }
    }

    /// Offsets and weights of the cells that count.
    pub(crate) fn taps(&self) -> impl Iterator<Item = ((i32, i32), f32)> + '_ {
        let (column, row) = self.corner;
        let corners = [(column, row), (column + 1, row), (column, row + 1), (column + 1, row + 1)];
        corners.into_iter().zip(self.weights).filter(|(_, weight)| *weight != 0.0)
    }

    /// The corner opposite to `corner`, as far as its weights reach.
    fn far_corner(&self) -> (i32, i32) {
        let [_, se, nw, ne] = self.weights;
        let east = i32::from(se != 0.0 || ne != 0.0);
        let north = i32::from(nw != 0.0 || ne != 0.0);
        (self.corner.0 + east, self.corner.1 + north)
    }

    #[inline]
    fn height_m(&self, z: &[f32], corner: usize, columns: usize) -> f32 {
        let mut height_m = 0.0;
        for (weight, index) in
            self.weights.into_iter().zip([corner, corner + 1, corner + columns, corner + columns + 1])
        {
            if weight != 0.0 {
                height_m += weight * z[index];
            }
        }
        height_m
    }
}

fn prepare_steps(piece: &Piece, reverse: bool, cell_size_m: f64) -> Vec<PreparedStep> {
    // Rounding must not add a step to whole cells.
    let by_length = (piece.length_m / (STEP_CELLS * cell_size_m) - 1e-9).ceil();
    let count = by_length.max((piece.turn_rad.abs() / STEP_TURN_RAD).ceil()).max(1.0) as usize;
    let facing_rad = if reverse { std::f64::consts::PI } else { 0.0 };
    (0..count)
        .map(|i| {
            let [x, y, heading] = piece.pose_at((i + 1) as f64 / count as f64);
            let [mx, my, travel_rad] = piece.pose_at((i as f64 + 0.5) / count as f64);
            PreparedStep {
                horizontal_m: piece.length_m / count as f64,
                turn_rad: piece.turn_rad / count as f64,
                end_m: [x, y],
                end_heading_rad: heading + facing_rad,
                travel: (travel_rad.cos(), travel_rad.sin()),
                middle: ((mx / cell_size_m).round() as i32, (my / cell_size_m).round() as i32),
                end: Sample::at([x, y], cell_size_m),
            }
        })
        .collect()
}

/// Every cell that the footprint touches along the pieces, sorted.
fn sweep(pieces: &[Piece], footprint: &Footprint, cell_size_m: f64) -> Vec<(i32, i32)> {
    let half_length_m = footprint.length_m / 2.0;
    // A bitmap about the start cell, wide enough for any pose of the pieces.
    let far_m = pieces.iter().map(|p| p.start_m[0].hypot(p.start_m[1]) + p.length_m).fold(0.0, f64::max);
    let reach = ((far_m + footprint.length_m.hypot(footprint.width_m)) / cell_size_m).ceil() as i32 + 2;
    let side = (2 * reach + 1) as usize;
    let mut touched = vec![false; side * side];
    for piece in pieces {
        // A turning robot's corners move by its half length times the turn.
        let travelled_m = piece.length_m + piece.turn_rad.abs() * half_length_m;
        let poses = (travelled_m / (SWEEP_CELLS * cell_size_m)).ceil().max(1.0) as usize;
        for i in 0..=poses {
            for (column, row) in footprint.cells_at(piece.pose_at(i as f64 / poses as f64), cell_size_m) {
                touched[(row + reach) as usize * side + (column + reach) as usize] = true;
            }
        }
    }
    let place = |i: usize| ((i % side) as i32 - reach, (i / side) as i32 - reach);
    (0..touched.len()).filter(|i| touched[*i]).map(place).collect()
}
