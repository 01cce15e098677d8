//! One step at constant grade, surface and curvature: the evaluation that lattice motions and free courses share.

use model::{Acceleration, Grade, Manoeuvre, Motion as BodyMotion, Robot};
use terrain::Cell;

use crate::{
    grid::heading::Heading,
    ground::stance::Offset,
    lattice::{graph::Lattice, objective::Surcharge, primitive::Piece},
};

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
    /// How the ground carries the weight.
    pub grade: Grade<f64>,
    /// Rise per metre under the robot's wheels half way, its nose up; on ground smaller than the robot it is not the slope of the
    /// way [-].
    pub stance_grade: f64,
    /// Index of the surface among the map's, the robot's default last.
    pub surface: usize,
    /// Power drawn from the battery [W].
    pub bus_w: f64,
    /// What preferences add in comparisons.
    pub surcharge: Surcharge,
}

impl Step {
    /// Energy drawn from the battery [J].
    pub fn energy_j(&self) -> f64 {
        self.bus_w * self.duration_s
    }

    /// Length on the map [m].
    pub(crate) fn horizontal_m(&self) -> f64 {
        (self.length_m * self.length_m - self.rise_m * self.rise_m).max(0.0).sqrt()
    }

    /// Pitch of the robot on its wheels half way [rad].
    pub fn stance_pitch_rad(&self) -> f64 {
        self.stance_grade.atan()
    }
}

pub(crate) struct PreparedStep {
    pub(crate) horizontal_m: f64,
    pub(crate) turn_rad: f64,
    end_m: [f64; 2],
    end_heading_rad: f64,
    /// Unit vector of travel half way.
    pub(crate) travel: (f64, f64),
    /// Heading of the robot half way [rad].
    pub(crate) heading_rad: f64,
    /// Cell under the middle.
    pub(crate) middle: (i32, i32),
    /// The heading nearest to the robot's half way.
    pub(crate) heading: Heading,
    pub(crate) end: Sample,
}

/// Bilinear interpolation between cell centres at a fixed place relative to the start cell.
pub(crate) struct Sample {
    pub(crate) corner: (i32, i32),
    weights: [f32; 4],
}

/// Longest step, in cells: half of the longest straight between lattice points, √5, with a little room.
pub(crate) const STEP_CELLS: f64 = 1.25;
/// Largest turn within a step [rad]: the widest between neighbouring headings, 0.464. Half way the pitch is that of the
/// chord, and the error of second order in the turn.
const STEP_TURN_RAD: f64 = 0.47;
/// Half way between two headings the one that is turned to counts, so that mirrored motions read mirrored ground.
const TIE: f64 = 1e-6;

/// The robot's limits in the form that a step compares with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    pub(crate) pitch_grade: f64,
    pub(crate) roll_grade: f64,
    pub(crate) side_force_n: f64,
}

impl Limits {
    pub(crate) const NONE: Limits =
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
    /// The lattice's pose at its end, if it ends in one: the offset of its cell and its heading.
    pub(crate) fn end_pose(&self) -> (Offset, Heading) {
        (self.end.corner, Heading::nearest(self.end_heading_rad))
    }

    /// Drives the step on a lattice's ground, from a height; `None` where the limits or unknown ground forbid it.
    ///
    /// The step counts its places from the cell `from`, and the caller has seen to it that they
    /// lie on the map. Returns what it takes and the height at its end.
    #[inline]
    pub(crate) fn drive_on<'m>(
        &self,
        lattice: &Lattice,
        from: Cell,
        height_m: f32,
        reverse: bool,
        manoeuvre_on: impl FnOnce(usize) -> &'m Manoeuvre,
    ) -> Option<(Step, f32)> {
        self.drive_within(lattice, (from, height_m), reverse, manoeuvre_on, &lattice.limits)
    }

    /// The same within other limits than the robot's.
    #[inline(always)]
    pub(crate) fn drive_within<'m>(
        &self,
        lattice: &Lattice,
        (from, height_m): (Cell, f32),
        reverse: bool,
        manoeuvre_on: impl FnOnce(usize) -> &'m Manoeuvre,
        limits: &Limits,
    ) -> Option<(Step, f32)> {
        let terrain = &lattice.terrain;
        let offset = |(columns, rows): (i32, i32)| Cell {
            row: from.row.wrapping_add_signed(rows as isize),
            column: from.column.wrapping_add_signed(columns as isize),
        };
        let ground = &lattice.ground;
        let end_m = self.end.height_m(|cell| ground.height_m(terrain, cell), offset(self.end.corner));
        let middle = offset(self.middle);
        let slope = ground.gradient(terrain, middle, self.heading);
        let place = lattice.classes.at(terrain, middle);
        let class = &lattice.classes.list[place];
        if !class.allows(self) {
            return None;
        }
        let rise_m = f64::from(end_m - height_m);
        let mut step = self.drive(manoeuvre_on(place), rise_m, slope, reverse, limits, class.name)?;
        // Nearly all ground is weighed as it is.
        let unlifted_j = if class.rule.cost_factor == 1.0 { 0.0 } else { lattice.unlifted_j(&step) };
        let takes = [unlifted_j, step.length_m, step.duration_s];
        step.surcharge = class.surcharge(&lattice.settings, self, reverse, takes);
        Some((step, end_m))
    }

    /// The step on ground that rises by `rise_m` and slopes by `slope` (east, north) under the wheels half way.
    #[inline(always)]
    pub(crate) fn drive(
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
        let stance_grade = slope.0 * cos + slope.1 * sin;
        let grade = if turning { stance_grade } else { rise_m / self.horizontal_m };
        let side_grade = slope.1 * cos - slope.0 * sin;
        // Written so that a NaN of unknown ground fails too.
        let allowed = grade.abs() <= limits.pitch_grade
            && stance_grade.abs() <= limits.pitch_grade
            && side_grade.abs() <= limits.roll_grade;
        if !allowed {
            return None;
        }
        let cos_pitch = 1.0 / (1.0 + grade * grade).sqrt();
        let cos_roll = 1.0 / (1.0 + side_grade * side_grade).sqrt();
        let facing = if reverse { -1.0 } else { 1.0 };
        let grade = Grade {
            normal: cos_pitch * cos_roll,
            along: facing * grade * cos_pitch,
            tilt: facing * side_grade,
        };
        let motion = *manoeuvre.motion();
        let length_m = self.horizontal_m / cos_pitch;
        let duration_s =
            if turning { self.turn_rad / motion.yaw_rate_radps } else { length_m / motion.speed_mps.abs() };
        let power = manoeuvre.power_on_grade(grade, Acceleration::NONE);
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
            grade,
            stance_grade: facing * stance_grade,
            surface,
            bus_w: power.bus_w,
            surcharge: Surcharge::default(),
        })
    }
}

impl Sample {
    /// Interpolates at a place; whole cells to nine decimals, so that lattice points read exactly one cell.
    pub(crate) fn at(place_m: [f64; 2], cell_size_m: f64) -> Self {
        let whole = |v: f64| {
            let near = rounded(v * 1e9) as f64 / 1e9;
            let below = floored(near);
            (below as i32, near - below as f64)
        };
        let (column, east) = whole(place_m[0] / cell_size_m);
        let (row, north) = whole(place_m[1] / cell_size_m);
        let weights =
            [(1.0 - east) * (1.0 - north), east * (1.0 - north), (1.0 - east) * north, east * north];
        Sample { corner: (column, row), weights: weights.map(|w| w as f32) }
    }

    /// Offsets and weights of the cells that count.
    pub(crate) fn taps(&self) -> impl Iterator<Item = ((i32, i32), f32)> + '_ {
        let (column, row) = self.corner;
        let corners = [(column, row), (column + 1, row), (column, row + 1), (column + 1, row + 1)];
        corners.into_iter().zip(self.weights).filter(|(_, weight)| *weight != 0.0)
    }

    /// The corner opposite to `corner`, as far as its weights reach.
    pub(crate) fn far_corner(&self) -> (i32, i32) {
        let [_, se, nw, ne] = self.weights;
        let east = i32::from(se != 0.0 || ne != 0.0);
        let north = i32::from(nw != 0.0 || ne != 0.0);
        (self.corner.0 + east, self.corner.1 + north)
    }

    #[inline]
    pub(crate) fn height_m(&self, at_m: impl Fn(Cell) -> f32, corner: Cell) -> f32 {
        let mut height_m = 0.0;
        for (weight, [rows, columns]) in self.weights.into_iter().zip([[0, 0], [0, 1], [1, 0], [1, 1]]) {
            if weight != 0.0 {
                height_m += weight * at_m(Cell { row: corner.row + rows, column: corner.column + columns });
            }
        }
        height_m
    }
}

/// The steps of a piece, none longer than `longest_cells` and none turning by more than [`STEP_TURN_RAD`].
pub(crate) fn prepare_steps(
    piece: &Piece,
    reverse: bool,
    cell_size_m: f64,
    longest_cells: f64,
) -> impl ExactSizeIterator<Item = PreparedStep> + '_ {
    // Rounding must not add a step to whole cells.
    let by_length = (piece.length_m / (longest_cells * cell_size_m) - 1e-9).ceil();
    let count = by_length.max((piece.turn_rad.abs() / STEP_TURN_RAD).ceil()).max(1.0) as usize;
    let facing_rad = if reverse { std::f64::consts::PI } else { 0.0 };
    let mut along = HalfSteps::new(piece, count);
    (0..count).map(move |i| {
        let middle = along.next();
        let end = along.next();
        let heading_rad = |half_steps: usize| {
            piece.heading_rad + piece.turn_rad * (half_steps as f64 / (2 * count) as f64) + facing_rad
        };
        let half_way_rad = heading_rad(2 * i + 1);
        PreparedStep {
            horizontal_m: piece.length_m / count as f64,
            turn_rad: piece.turn_rad / count as f64,
            end_m: end.place_m,
            end_heading_rad: heading_rad(2 * i + 2),
            travel: (middle.travel[0], middle.travel[1]),
            heading_rad: half_way_rad,
            heading: Heading::nearest(half_way_rad + TIE * piece.turn_rad / count as f64),
            middle: {
                let [column, row] = middle.place_m.map(|m| rounded(m / cell_size_m) as i32);
                (column, row)
            },
            end: Sample::at(end.place_m, cell_size_m),
        }
    })
}

/// The next whole number below, without the call that the library's is on processors of before 2008.
#[inline(always)]
fn floored(value: f64) -> i64 {
    let towards_zero = value as i64;
    towards_zero - i64::from(towards_zero as f64 > value)
}

/// The nearest whole number, of two the one further from 0.
#[inline(always)]
fn rounded(value: f64) -> i64 {
    (value + 0.5f64.copysign(value)) as i64
}

/// A place along a piece, and the unit vector of travel there.
#[derive(Clone, Copy)]
struct Along {
    place_m: [f64; 2],
    travel: [f64; 2],
}

/// Places half a step apart along a piece, each turned on from the one before, so that no angle is asked for its sine again.
struct HalfSteps {
    at: Along,
    /// Unit vector of the chord to the next place.
    chord: [f64; 2],
    chord_m: f64,
    /// Cosine and sine of what half a step turns.
    turn: [f64; 2],
}

impl HalfSteps {
    fn new(piece: &Piece, steps: usize) -> Self {
        let halves = (2 * steps) as f64;
        let (length_m, turn_rad) = (piece.length_m / halves, piece.turn_rad / halves);
        // The chord of an arc points half way through its turn and is shorter by sinc of that half.
        let half_rad = turn_rad / 2.0;
        let chord_m = if half_rad.abs() < 1e-9 { length_m } else { length_m * half_rad.sin() / half_rad };
        let unit = |angle_rad: f64| {
            let (sin, cos) = angle_rad.sin_cos();
            [cos, sin]
        };
        let travel = unit(piece.heading_rad);
        let (chord, turn) = if turn_rad == 0.0 {
            (travel, [1.0, 0.0])
        } else {
            (unit(piece.heading_rad + half_rad), unit(turn_rad))
        };
        HalfSteps { at: Along { place_m: piece.start_m, travel }, chord, chord_m, turn }
    }

    fn next(&mut self) -> Along {
        let [[x_m, y_m], [east, north]] = [self.at.place_m, self.chord];
        self.at.place_m = [x_m + self.chord_m * east, y_m + self.chord_m * north];
        let [cos, sin] = self.turn;
        let turned = |[east, north]: [f64; 2]| [cos * east - sin * north, sin * east + cos * north];
        (self.at.travel, self.chord) = (turned(self.at.travel), turned(self.chord));
        self.at
    }
}
