//! A lower bound of what a stretch of a motion costs from the heights of its ends.

use model::{LENGTH_PER_SQUARED_GRADE, Manoeuvre};

use crate::{
    grid::{cost::SINGLE_PRECISION, layout::TILE},
    ground::stance::{Offset, orientation},
    lattice::{graph::Lattice, ground_class::GroundClass, objective::Weights, step::PreparedStep},
    table::{
        roll_bound::{NO_STAND, RollBounds, least_cos_roll},
        window::Window,
    },
};

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
    skid_left: [f32; 2],
    /// `None` where no skid counts.
    skid: Option<[[f32; 2]; 2]>,
    skid_dissipated: f32,
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

    /// Adds its bound for a row of start cells, and moves on to the height at its end.
    #[inline(always)]
    pub(crate) fn add(
        &self,
        (window, rolls): (&Window, &RollBounds),
        row: usize,
        (class, steepest): (usize, f32),
        height_m: &mut [f32; TILE],
        units: &mut [f32; TILE],
    ) {
        let mut end_m = [0.0f32; TILE];
        for (offset, weight) in &self.taps {
            let z = window.lanes(&window.height_m, row, *offset);
            for x in 0..TILE {
                end_m[x] = weight.mul_add(z[x], end_m[x]);
            }
        }
        let mut cos_roll = [1.0f32; TILE];
        for (orientation, cell) in &self.stands {
            let own = window.lanes(&rolls.0[*orientation], row, *cell);
            for x in 0..TILE {
                cos_roll[x] = if own[x] < cos_roll[x] { own[x] } else { cos_roll[x] };
            }
        }
        let mut grade = [0.0f32; TILE];
        for x in 0..TILE {
            grade[x] = (end_m[x] - height_m[x]) * self.per_horizontal_m;
        }
        let on = self.grounds[class];
        match on.skid {
            None => on.add(steepest, (&grade, &cos_roll), units, |_, _| [0.0; 2]),
            Some(skid) => on.add(steepest, (&grade, &cos_roll), units, |g, cos| on.skid(skid, g, cos)),
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
            skid_left: bound.skid_left.map(|share| share as f32),
            skid: (bound.skid_w.iter().any(|[most_w, _]| *most_w > 0.0))
                .then(|| bound.skid_w.map(|flow| flow.map(|w| (per_w * w) as f32))),
            skid_dissipated: (per_w * bound.skid_dissipated_w) as f32,
            per_steepness: (per_w * bound.per_steepness_w) as f32,
            dissipated: bound.dissipated_w.map(|w| (per_w * w) as f32),
            length: (length + fixed) as f32,
            length_per_squared: (length * LENGTH_PER_SQUARED_GRADE) as f32,
            standing_per_squared: (per_w * bound.standing_w * LENGTH_PER_SQUARED_GRADE) as f32,
        })
    }

    /// Adds the bound on grades and rolls side by side, with what the skid takes by flow.
    #[inline(always)]
    fn add(
        &self,
        steepest: f32,
        (grade, cos_roll): (&[f32; TILE], &[f32; TILE]),
        units: &mut [f32; TILE],
        skid: impl Fn(f32, f32) -> [f32; 2],
    ) {
        for x in 0..TILE {
            let bound = self.at(grade[x], cos_roll[x], skid(grade[x], cos_roll[x]));
            // False of unknown ground.
            let allowed = (grade[x].abs() <= steepest) & (cos_roll[x] > NO_STAND);
            units[x] += if allowed { bound } else { f32::INFINITY };
        }
    }

    /// What the skid takes at least, by flow.
    #[inline(always)]
    fn skid(&self, skid: [[f32; 2]; 2], grade: f32, cos_roll: f32) -> [f32; 2] {
        let [level, per_cos_roll] = self.skid_left;
        let left = cos_roll * not_negative(per_cos_roll.mul_add(cos_roll, level));
        skid.map(|[most, less]| {
            let per_left = less.mul_add(-grade.abs(), most);
            let taken = left * self.skid_dissipated.mul_add(left, per_left);
            if per_left > 0.0 { taken } else { 0.0 }
        })
    }

    #[inline(always)]
    fn at(&self, grade: f32, cos_roll: f32, skid: [f32; 2]) -> f32 {
        let squared = grade * grade;
        let flow = |flow: usize| {
            let [level, per_cos_roll, per_grade] = self.flows[flow];
            per_grade.mul_add(grade, per_cos_roll.mul_add(cos_roll, level)) + skid[flow]
        };
        let [forwards, backwards] = [flow(0), flow(1)];
        let flow = if forwards > backwards { forwards } else { backwards };
        let flow = self.per_steepness.mul_add(-grade.abs(), flow);
        let [square, both, grades] = self.dissipated;
        let dissipated = grades.mul_add(squared, cos_roll * both.mul_add(grade, square * cos_roll));
        let friction = squared.mul_add(-0.5, 1.0).mul_add(dissipated, flow);
        let friction = not_negative(self.standing_per_squared.mul_add(squared, friction));
        friction + self.length_per_squared.mul_add(squared, self.length)
    }
}

#[inline(always)]
fn not_negative(x: f32) -> f32 {
    if x > 0.0 { x } else { 0.0 }
}
