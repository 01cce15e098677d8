//! One step of a motion from a row of cells side by side, in single precision.

use model::{Grade, Manoeuvre, PowerKernel};

use crate::{
    grid::layout::TILE,
    ground::stance::orientation,
    lattice::{
        edge::Chain,
        graph::{Lattice, Settings},
        ground_class::GroundClass,
        objective::Weights,
        step::PreparedStep,
    },
    table::window::Window,
};

/// What steps are measured by.
#[derive(Clone, Copy)]
pub(crate) struct Pricing {
    pub(crate) pitch_grade: f32,
    pub(crate) roll_grade: f32,
    pub(crate) side_force_n: f32,
    pub(crate) lift_j_per_m: f32,
}

/// Values of a row of cells, where no register straddles two lines of memory.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Lanes(pub(crate) [f32; TILE]);

impl Lanes {
    pub(crate) const ZERO: Self = Lanes([0.0; TILE]);
}

impl std::ops::Deref for Lanes {
    type Target = [f32; TILE];
    #[inline(always)]
    fn deref(&self) -> &[f32; TILE] {
        &self.0
    }
}

impl std::ops::DerefMut for Lanes {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f32; TILE] {
        &mut self.0
    }
}

/// A step of a motion from a row of cells side by side.
pub(crate) struct RowStep {
    /// Cells that interpolation reads, relative to the start cell, and their weights.
    taps: Vec<((i32, i32), f32)>,
    middle: (i32, i32),
    orientation: usize,
    horizontal_m: f32,
    per_horizontal_m: f32,
    travel: (f32, f32),
    facing: f32,
    /// How it is driven on each kind of ground.
    grounds: Vec<GroundStep>,
}

/// A step on one kind of ground.
#[derive(Clone, Copy)]
struct GroundStep {
    s_per_m: f32,
    on_the_spot_s: f32,
    per_j: f32,
    per_m: f32,
    per_s: f32,
    /// Cost whatever the step takes, infinite where its direction is forbidden.
    fixed: f32,
    kernel: PowerKernel<f32>,
}

impl RowStep {
    pub(crate) fn reads(&self) -> impl Iterator<Item = (i32, i32)> + '_ {
        self.taps.iter().map(|(offset, _)| *offset).chain([self.middle])
    }

    /// Adds the step's costs for a row of start cells and moves on to the height at its end.
    #[inline(always)]
    pub(crate) fn evaluate(
        &self,
        pricing: &Pricing,
        window: &Window,
        row: usize,
        height_m: &mut Lanes,
        costs: &mut Lanes,
    ) {
        let mut rise_m = Lanes::ZERO;
        if !self.taps.is_empty() {
            let mut end_m = Lanes::ZERO;
            for (offset, weight) in &self.taps {
                let z = window.lanes(&window.height_m, row, *offset);
                for x in 0..TILE {
                    end_m[x] = weight.mul_add(z[x], end_m[x]);
                }
            }
            for ((rise_m, end_m), height_m) in rise_m.iter_mut().zip(end_m.iter()).zip(height_m.iter()) {
                *rise_m = end_m - height_m;
            }
            *height_m = end_m;
        }
        let [east, north] = &window.gradients[self.orientation];
        let east = window.lanes(east, row, self.middle);
        let north = window.lanes(north, row, self.middle);
        let ground = self.ground(&rise_m, east, north);
        if let [only] = window.present[..] {
            let step = self.costs(pricing, &self.grounds[usize::from(only)], &ground, &rise_m);
            for x in 0..TILE {
                costs[x] += step[x];
            }
            return;
        }
        let classes = window.lanes(&window.class, row, self.middle);
        for &class in &window.present {
            let step = self.costs(pricing, &self.grounds[usize::from(class)], &ground, &rise_m);
            for x in 0..TILE {
                costs[x] += if classes[x] == class { step[x] } else { 0.0 };
            }
        }
    }

    /// Grades along and across the heading, and their cosines; see `PreparedStep::drive` for the same in double.
    #[inline(always)]
    fn ground(&self, rise_m: &Lanes, east: &[f32; TILE], north: &[f32; TILE]) -> Ground {
        let (cos, sin) = self.travel;
        let mut ground = Ground {
            grade: Lanes::ZERO,
            stance_grade: Lanes::ZERO,
            side_grade: Lanes::ZERO,
            cos_pitch: Lanes::ZERO,
            cos_roll: Lanes::ZERO,
        };
        for x in 0..TILE {
            ground.side_grade[x] = north[x].mul_add(cos, -(east[x] * sin));
            ground.stance_grade[x] = east[x].mul_add(cos, north[x] * sin);
        }
        if self.horizontal_m == 0.0 {
            ground.grade = ground.stance_grade;
        } else {
            for (grade, rise_m) in ground.grade.iter_mut().zip(rise_m.iter()) {
                *grade = rise_m * self.per_horizontal_m;
            }
        }
        for x in 0..TILE {
            let (grade, side_grade) = (ground.grade[x], ground.side_grade[x]);
            ground.cos_pitch[x] = inverse_sqrt(grade.mul_add(grade, 1.0));
            ground.cos_roll[x] = inverse_sqrt(side_grade.mul_add(side_grade, 1.0));
        }
        ground
    }

    /// The cost of the step on one kind of ground, infinite where limits forbid it.
    #[inline(always)]
    fn costs(&self, pricing: &Pricing, on: &GroundStep, ground: &Ground, rise_m: &Lanes) -> Lanes {
        // Copies that the compiler can keep in registers, and short loops, in which the processor finds enough to do while
        // it waits for roots.
        let (on, power, limits) = (*on, on.kernel, *pricing);
        let (mut steepened, mut skid_n) = (Lanes::ZERO, Lanes::ZERO);
        if power.steepening != 0.0 {
            for x in 0..TILE {
                steepened[x] = power.steepened(ground.cos_pitch[x] * ground.cos_roll[x]);
            }
        }
        if power.skid_n != 0.0 {
            for x in 0..TILE {
                let (grade, side_grade) = (self.facing * ground.grade[x], self.facing * ground.side_grade[x]);
                skid_n[x] = power.skid_left_n(side_grade, grade * ground.cos_pitch[x]);
            }
        }
        let (mut largest_n, mut bus_w) = (Lanes::ZERO, Lanes::ZERO);
        for x in 0..TILE {
            let along = self.facing * ground.grade[x] * ground.cos_pitch[x];
            let tilt = self.facing * ground.side_grade[x];
            let normal = ground.cos_pitch[x] * ground.cos_roll[x];
            let force_n = power.forces_of_n(Grade { normal, along, tilt }, steepened[x], skid_n[x]);
            largest_n[x] = force_n.left.abs().max(force_n.right.abs());
            bus_w[x] = power.bus_w(power.side_w(force_n), along);
        }
        let lift_j_per_m = if self.horizontal_m == 0.0 { 0.0 } else { pricing.lift_j_per_m };
        let mut costs = Lanes::ZERO;
        for x in 0..TILE {
            let grade = ground.grade[x];
            let length_m = self.horizontal_m * grade.mul_add(grade, 1.0) * ground.cos_pitch[x];
            let duration_s = length_m.mul_add(on.s_per_m, on.on_the_spot_s);
            let friction_j = bus_w[x].mul_add(duration_s, -(lift_j_per_m * rise_m[x]));
            let friction_j = if friction_j > 0.0 { friction_j } else { 0.0 };
            let cost = on
                .per_j
                .mul_add(friction_j, on.per_m.mul_add(length_m, on.per_s.mul_add(duration_s, on.fixed)));
            // Written so that a NaN of unknown ground fails too.
            let allowed = (grade.abs() <= limits.pitch_grade)
                & (ground.stance_grade[x].abs() <= limits.pitch_grade)
                & (ground.side_grade[x].abs() <= limits.roll_grade)
                & (largest_n[x] <= limits.side_force_n);
            costs[x] = if allowed { cost } else { f32::INFINITY };
        }
        costs
    }
}

impl GroundStep {
    fn new(
        (step, manoeuvre, reverse): (&PreparedStep, &Manoeuvre, bool),
        class: &GroundClass,
        settings: &Settings,
        weights: &Weights,
    ) -> Self {
        let (turning, motion) = (step.horizontal_m == 0.0, manoeuvre.motion());
        let weights = class.weights(weights, settings, step, reverse);
        GroundStep {
            s_per_m: if turning { 0.0 } else { (1.0 / motion.speed_mps.abs()) as f32 },
            on_the_spot_s: if turning { (step.turn_rad / motion.yaw_rate_radps) as f32 } else { 0.0 },
            per_j: weights.per_j as f32,
            per_m: weights.per_m as f32,
            per_s: weights.per_s as f32,
            fixed: if class.allows(step) { weights.fixed as f32 } else { f32::INFINITY },
            kernel: manoeuvre.kernel().single(),
        }
    }
}

/// The ground under a step for one row of start cells.
struct Ground {
    grade: Lanes,
    stance_grade: Lanes,
    side_grade: Lanes,
    cos_pitch: Lanes,
    cos_roll: Lanes,
}

/// 1/√x to single precision for positive x, by Newton's method: several times the speed of a square root and a division,
/// which registers share.
#[inline(always)]
fn inverse_sqrt(x: f32) -> f32 {
    // Halving and negating the exponent is a first guess within 3.5 %; each step squares the error.
    const GUESS: u32 = 0x5f37_59df;
    let half = 0.5 * x;
    let mut y = f32::from_bits(GUESS.wrapping_sub(x.to_bits() >> 1));
    for _ in 0..3 {
        y *= (half * y).mul_add(-y, 1.5);
    }
    y
}

impl Chain {
    /// Its steps in the form that rows are evaluated with.
    pub(crate) fn row_steps<'c>(
        &'c self,
        lattice: &'c Lattice,
        weights: &'c Weights,
    ) -> impl Iterator<Item = RowStep> + 'c {
        self.steps_with_manoeuvres().map(move |(step, manoeuvres, reverse)| {
            let on = |(manoeuvre, class): (&Manoeuvre, &GroundClass)| {
                GroundStep::new((step, manoeuvre, reverse), class, &lattice.settings, weights)
            };
            let turning = step.horizontal_m == 0.0;
            RowStep {
                taps: if turning { Vec::new() } else { step.end.taps().collect() },
                middle: step.middle,
                orientation: orientation(step.heading),
                horizontal_m: step.horizontal_m as f32,
                per_horizontal_m: if turning { 0.0 } else { (1.0 / step.horizontal_m) as f32 },
                travel: (step.travel.0 as f32, step.travel.1 as f32),
                facing: if reverse { -1.0 } else { 1.0 },
                grounds: manoeuvres.iter().zip(&lattice.classes.list).map(on).collect(),
            }
        })
    }
}
