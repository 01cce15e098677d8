//! A lower bound of what a stretch of a motion costs from the heights of its ends.

use model::{LENGTH_PER_SQUARED_GRADE, Manoeuvre};

use crate::{
    cost::SINGLE_PRECISION,
    ground_class::GroundClass,
    lattice::Lattice,
    objective::Weights,
    roll_bound::{NO_STAND, RollBounds, least_cos_roll},
    stance::{Offset, orientation},
    step::PreparedStep,
    window::Window,
};

/// Cells that are bounded side by side: as many as leave a bound in registers.
pub(crate) const ABREAST: usize = 32;

/// Steps of a motion that follow each other on the same kind of motion, as one stretch.
///
/// The cost of a step is convex in its grade g. By Jensen's inequality steps of lengths h that follow each other cost, together, at least
/// what their sum would at the grade between their ends,
///
/// ```text
/// Σ h c(g) ≥ (Σ h) c(Σ h g / Σ h)
/// ```
///
/// with the least cosine of roll of any of them, in which c rises as far as [`model::PowerBound`] says. Steps that skid are not taken together, as
/// what their skid may take off is not convex.
pub(crate) struct PieceBound {
    /// Cells that the height at its end is read from, relative to the start cell, and their weights.
    pub(crate) taps: Vec<(Offset, f32)>,
    /// Orientations and cells on which the robot stands on the way.
    stands: Vec<(usize, Offset)>,
    per_horizontal_m: f32,
    /// By kind of ground.
    grounds: Vec<Coefficients>,
}

/// A bound on one kind of ground, in units of the table; see [`model::PowerBound`].
#[derive(Clone, Copy, Default)]
struct Coefficients {
    flows: [[f32; 3]; 2],
    per_steepness: f32,
    dissipated: [f32; 3],
    /// Of what energy does not count for: for all of it, and per square of the grade.
    length: f32,
    length_per_squared: f32,
    standing_per_squared: f32,
}

/// Steps of one stretch with their manoeuvres by kind of ground.
pub(crate) type Steps<'c> = [(&'c PreparedStep, &'c [Manoeuvre], bool)];

impl PieceBound {
    /// `None` where there is no bound for the motion.
    pub(crate) fn new(lattice: &Lattice, weights: &Weights, units: f64, steps: &Steps<'_>) -> Option<Self> {
        let &(last, ..) = steps.last()?;
        let horizontal_m: f64 = steps.iter().map(|(step, ..)| step.horizontal_m).sum();
        let grounds = lattice.classes.list.iter().enumerate();
        let grounds = grounds
            .map(|(i, class)| Coefficients::new(lattice, (weights, units), (i, class), steps, horizontal_m));
        Some(PieceBound {
            taps: last.end.taps().collect(),
            stands: steps.iter().map(|(step, ..)| (orientation(step.heading), step.middle)).collect(),
            per_horizontal_m: (1.0 / horizontal_m) as f32,
            grounds: grounds.collect::<Option<_>>()?,
        })
    }

    /// Adds its bound for cells of a row from `first` on, and moves on to the height at its end.
    #[inline(always)]
    pub(crate) fn add(
        &self,
        (window, rolls): (&Window, &RollBounds),
        (row, first): (usize, usize),
        (class, steepest): (usize, f32),
        height_m: &mut [f32; ABREAST],
        units: &mut [f32; ABREAST],
    ) {
        let mut end_m = [0.0f32; ABREAST];
        for (offset, weight) in &self.taps {
            let z = &window.lanes(&window.height_m, row, *offset)[first..first + ABREAST];
            for x in 0..ABREAST {
                end_m[x] = weight.mul_add(z[x], end_m[x]);
            }
        }
        let mut cos_roll = [1.0f32; ABREAST];
        for (orientation, cell) in &self.stands {
            let own = &window.lanes(&rolls.0[*orientation], row, *cell)[first..first + ABREAST];
            for x in 0..ABREAST {
                cos_roll[x] = if own[x] < cos_roll[x] { own[x] } else { cos_roll[x] };
            }
        }
        let on = self.grounds[class];
        for x in 0..ABREAST {
            let grade = (end_m[x] - height_m[x]) * self.per_horizontal_m;
            let bound = on.at(grade, cos_roll[x]);
            // False of unknown ground.
            let allowed = (grade.abs() <= steepest) & (cos_roll[x] > NO_STAND);
            units[x] += if allowed { bound } else { f32::INFINITY };
        }
        *height_m = end_m;
    }
}

impl Coefficients {
    fn new(
        lattice: &Lattice,
        (weights, units): (&Weights, f64),
        (place, class): (usize, &GroundClass),
        steps: &Steps<'_>,
        horizontal_m: f64,
    ) -> Option<Self> {
        let &(first, manoeuvres, reverse) = steps.first()?;
        let manoeuvre = manoeuvres.get(place)?;
        let bound =
            manoeuvre.kernel().lower_bound(reverse, lattice.limits.pitch_grade, least_cos_roll(lattice))?;
        let weights = class.weights(weights, &lattice.settings, first, reverse);
        let units = units * (1.0 - SINGLE_PRECISION);
        let s = horizontal_m / manoeuvre.motion().speed_mps.abs();
        let per_w = units * weights.per_j * s;
        let lift = units * weights.per_j * lattice.lift_j_per_m() * horizontal_m;
        let length = units * (weights.per_m * horizontal_m + weights.per_s * s);
        let fixed = match steps.iter().all(|(step, ..)| class.allows(step)) {
            true => units * weights.fixed * steps.len() as f64,
            false => f64::INFINITY,
        };
        let flow = |[level_w, per_cos_roll_w, per_grade_w]: [f64; 3]| {
            [
                (per_w * (level_w + bound.standing_w)) as f32,
                (per_w * per_cos_roll_w) as f32,
                (per_w * per_grade_w - lift) as f32,
            ]
        };
        Some(Coefficients {
            flows: bound.flows_w.map(flow),
            per_steepness: (per_w * bound.per_steepness_w) as f32,
            dissipated: bound.dissipated_w.map(|w| (per_w * w) as f32),
            length: (length + fixed) as f32,
            length_per_squared: (length * LENGTH_PER_SQUARED_GRADE) as f32,
            standing_per_squared: (per_w * bound.standing_w * LENGTH_PER_SQUARED_GRADE) as f32,
        })
    }

    #[inline(always)]
    fn at(&self, grade: f32, cos_roll: f32) -> f32 {
        let squared = grade * grade;
        let flow = |[level, per_cos_roll, per_grade]: [f32; 3]| {
            per_grade.mul_add(grade, per_cos_roll.mul_add(cos_roll, level))
        };
        let [forwards, backwards] = self.flows.map(flow);
        let flow = if forwards > backwards { forwards } else { backwards };
        let flow = self.per_steepness.mul_add(-grade.abs(), flow);
        let [square, both, grades] = self.dissipated;
        let dissipated = grades.mul_add(squared, cos_roll * both.mul_add(grade, square * cos_roll));
        let friction = squared.mul_add(-0.5, 1.0).mul_add(dissipated, flow);
        let friction = self.standing_per_squared.mul_add(squared, friction);
        let friction = if friction > 0.0 { friction } else { 0.0 };
        friction + self.length_per_squared.mul_add(squared, self.length)
    }
}
