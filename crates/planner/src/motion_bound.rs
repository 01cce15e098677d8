//! Lower bounds of the cost of motions from the heights of their ends and the steepness about them.

use model::{PowerKernel, Sides};

use crate::{
    cost::SINGLE_PRECISION, edge::Chain, ground_class::StepWeights, lattice::Lattice, objective::Weights,
};

/// A line below the cost of every motion between two cells: units at ends of one height, and units per metre of rise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    pub(crate) level: f32,
    pub(crate) per_m: f32,
}

/// Grades at which steps are touched by tangents, over the steepest that limits allow.
const TANGENTS: usize = 61;
/// Steepness of the gentlest class of ground [-].
const GENTLEST: f64 = 0.02;
/// Each class of ground is so many times as steep as the one before.
const STEEPER: f64 = 1.25;
/// Steepest grade that bounds are worked out for, 45°: where limits allow more, costs are evaluated [-].
const STEEPEST: f64 = 1.0;

/// Classes of steepness for which bounds are worked out. The last holds on all ground where the robot's limits are less than 45°:
/// they forbid what is steeper.
pub(crate) fn steepness_classes(lattice: &Lattice) -> Vec<f64> {
    let steepest = steepest_allowed(lattice).clamp(0.0, STEEPEST);
    let gentler = std::iter::successors(Some(GENTLEST), |steepness| Some(steepness * STEEPER));
    gentler.take_while(|steepness| *steepness < steepest).chain([steepest]).collect()
}

/// Whether the last class holds on all ground.
pub(crate) fn is_limited(lattice: &Lattice) -> bool {
    steepest_allowed(lattice) <= STEEPEST
}

/// The steepest that any limit allows, along or across.
fn steepest_allowed(lattice: &Lattice) -> f64 {
    lattice.limits.pitch_grade.max(lattice.limits.roll_grade)
}

/// A step of a motion on one kind of ground, and tangents of its cost.
struct Step<'m> {
    kernel: &'m PowerKernel<f64>,
    weights: StepWeights,
    horizontal_m: f64,
    s_per_m: f64,
    facing: f64,
    lift_j_per_m: f64,
    /// By grade, from the steepest descent on, so that slopes rise.
    tangents: Vec<Tangent>,
}

/// What a tangent of a step's cost is made of.
#[derive(Clone, Copy)]
struct Tangent {
    marginal_w_per_n: Sides<f64>,
    /// Slope of the length of the way, √(1 + g²).
    length_slope: f64,
    /// Slope of the cost per horizontal metre.
    slope: f64,
}

impl<'m> Step<'m> {
    fn new(
        kernel: &'m PowerKernel<f64>,
        weights: StepWeights,
        [horizontal_m, s_per_m, facing]: [f64; 3],
        [steepest, lift_j_per_m]: [f64; 2],
    ) -> Self {
        let mut step =
            Step { kernel, weights, horizontal_m, s_per_m, facing, lift_j_per_m, tangents: Vec::new() };
        step.tangents = grades(steepest)
            .map(|grade| {
                let marginal_w_per_n = kernel.marginal_w_per_n(facing * grade);
                step.tangent(marginal_w_per_n, grade / (1.0 + grade * grade).sqrt())
            })
            .collect();
        step
    }

    fn tangent(&self, marginal_w_per_n: Sides<f64>, length_slope: f64) -> Tangent {
        let per_grade_w = self.kernel.supported_w_per_grade(marginal_w_per_n);
        let friction_j_per_m = self.s_per_m * self.facing * per_grade_w - self.lift_j_per_m;
        let slope = self.weights.per_j * friction_j_per_m + self.per_length() * length_slope;
        Tangent { marginal_w_per_n, length_slope, slope }
    }

    /// Cost of a metre along the ground, its energy apart.
    fn per_length(&self) -> f64 {
        self.weights.per_m + self.weights.per_s * self.s_per_m
    }

    /// A tangent of a slope, or the steepest or flattest there is.
    fn tangent_of_slope(&self, slope: f64) -> Tangent {
        let above = self.tangents.partition_point(|tangent| tangent.slope < slope);
        let (Some(low), Some(high)) =
            (self.tangents.get(above.saturating_sub(1)), self.tangents.get(above).or(self.tangents.last()))
        else {
            return self.tangent(Sides::both(0.0), 0.0);
        };
        let apart = high.slope - low.slope;
        let share = if apart > 0.0 { ((slope - low.slope) / apart).clamp(0.0, 1.0) } else { 0.0 };
        let between = |a: f64, b: f64| a + share * (b - a);
        let marginal_w_per_n =
            low.marginal_w_per_n.zip(high.marginal_w_per_n).map(|(low, high)| between(low, high));
        self.tangent(marginal_w_per_n, between(low.length_slope, high.length_slope))
    }

    /// The most by which a line of some slope, per horizontal metre, may be raised without crossing the step's cost where
    /// grades are at most so steep.
    fn least_above(&self, slope: f64, tangent: &Tangent, steepest: f64) -> f64 {
        let Some(line) = self.kernel.supporting_line(tangent.marginal_w_per_n, steepest) else {
            return f64::NEG_INFINITY;
        };
        let length = (1.0 - tangent.length_slope * tangent.length_slope).max(0.0).sqrt();
        let per_m = self.weights.per_j * self.s_per_m * line.level_w + self.per_length() * length;
        let askew = (slope - tangent.slope).abs() * steepest;
        self.horizontal_m * (per_m - askew) + self.weights.fixed
    }

    /// The least that the step costs whatever energy it takes.
    fn least_without_energy(&self) -> f64 {
        self.horizontal_m * self.per_length() + self.weights.fixed
    }
}

/// Grades at which tangents touch, from the steepest descent to the steepest climb.
fn grades(steepest: f64) -> impl Iterator<Item = f64> {
    let middle = (TANGENTS - 1) as f64 / 2.0;
    (0..TANGENTS).map(move |i| (i as f64 / middle - 1.0) * steepest)
}

/// Lines below the costs of the motions between two cells, by class of steepness.
///
/// A motion is driven in steps of lengths h and grades g, with Σ h g the height of its end over its start. Its cost is the sum
/// of its steps', and for any slope B
///
/// ```text
/// Σ c(g, s) ≥ Σ min over g, s of (c(g, s) − B h g) + B Δz
/// ```
///
/// so that a line for each B needs the height of the end alone. The minimum of each step is bounded from below by a tangent of its power
/// (`PowerKernel::supporting_line`) whose slope is B or as near to it as there is. No energy is below nothing once lifting is
/// taken out of it, which is the last line.
pub(crate) fn lines(
    lattice: &Lattice,
    weights: &Weights,
    class: usize,
    chains: &[&Chain],
    classes: &[f64],
    (units, slack): (f64, f64),
) -> Vec<Vec<Line>> {
    let Some(&steepest) = classes.last() else { return Vec::new() };
    let steps: Vec<Vec<Step<'_>>> =
        chains.iter().filter_map(|chain| steps_of(lattice, weights, class, chain, steepest)).collect();
    let mut by_class = vec![Vec::new(); classes.len()];
    let Some(first) = steps.first() else { return by_class };
    let line = |level: f64, per_m: f64| Line {
        level: ((1.0 - SINGLE_PRECISION) * level * units - slack) as f32,
        per_m: ((1.0 - SINGLE_PRECISION) * per_m * units) as f32,
    };
    let length_m: f64 = first.iter().map(|step| step.horizontal_m).sum();
    for (at, grade) in grades(steepest).enumerate() {
        let slope =
            first.iter().map(|step| step.horizontal_m * step.tangents[at].slope).sum::<f64>() / length_m;
        let tangents: Vec<Vec<Tangent>> = steps
            .iter()
            .map(|steps| steps.iter().map(|step| step.tangent_of_slope(slope)).collect())
            .collect();
        let apart = 2.0 * steepest / (TANGENTS - 1) as f64;
        for (lines, steepness) in by_class.iter_mut().zip(classes) {
            if grade.abs() > steepness + apart {
                continue;
            }
            let of_chain = |(steps, tangents): (&Vec<Step<'_>>, &Vec<Tangent>)| -> f64 {
                steps.iter().zip(tangents).map(|(step, t)| step.least_above(slope, t, *steepness)).sum()
            };
            let level = steps.iter().zip(&tangents).map(of_chain).fold(f64::INFINITY, f64::min);
            if level.is_finite() {
                lines.push(line(level, slope));
            }
        }
    }
    let without_energy = steps.iter().map(|steps| steps.iter().map(Step::least_without_energy).sum());
    let without_energy = line(without_energy.fold(f64::INFINITY, f64::min), 0.0);
    for (lines, steepness) in by_class.iter_mut().zip(classes) {
        lines.push(without_energy);
        let longest_m = steps.iter().map(|s| s.iter().map(|step| step.horizontal_m).sum::<f64>());
        keep_highest(lines, (longest_m.fold(0.0, f64::max) * steepness) as f32);
    }
    by_class
}

/// A chain's steps on a kind of ground; `None` where one of them may not be driven.
fn steps_of<'m>(
    lattice: &Lattice,
    weights: &Weights,
    class: usize,
    chain: &'m Chain,
    steepest: f64,
) -> Option<Vec<Step<'m>>> {
    let ground = &lattice.classes.list[class];
    let of = chain.steps_with_manoeuvres().map(|(step, manoeuvres, reverse)| {
        let manoeuvre = &manoeuvres[class];
        ground.allows(step).then(|| {
            Step::new(
                manoeuvre.kernel(),
                ground.weights(weights, &lattice.settings, step, reverse),
                [
                    step.horizontal_m,
                    1.0 / manoeuvre.motion().speed_mps.abs(),
                    if reverse { -1.0 } else { 1.0 },
                ],
                [steepest, lattice.lift_j_per_m()],
            )
        })
    });
    of.collect()
}

/// Keeps those of some lines that are the highest somewhere within a rise or fall, in the order of their slopes.
fn keep_highest(lines: &mut Vec<Line>, most_m: f32) {
    lines.sort_by(|a, b| a.per_m.total_cmp(&b.per_m).then(b.level.total_cmp(&a.level)));
    lines.dedup_by(|next, kept| next.per_m == kept.per_m);
    // Where the second of two lines passes the first.
    let passes = |a: &Line, b: &Line| (a.level - b.level) / (b.per_m - a.per_m);
    let mut kept: Vec<Line> = Vec::with_capacity(lines.len());
    for line in lines.drain(..) {
        while let [.., before, last] = kept[..]
            && passes(&last, &line) <= passes(&before, &last)
        {
            kept.pop();
        }
        kept.push(line);
    }
    let from = kept
        .windows(2)
        .position(|pair| passes(&pair[0], &pair[1]) > -most_m)
        .unwrap_or(kept.len().saturating_sub(1));
    let until = kept
        .windows(2)
        .position(|pair| passes(&pair[0], &pair[1]) > most_m)
        .unwrap_or(kept.len().saturating_sub(1));
    *lines = kept.drain(from..=until.max(from).min(kept.len().saturating_sub(1))).collect();
}
