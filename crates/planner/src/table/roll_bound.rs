//! How far the robot may lean on the cells of a window, by orientation, whatever the direction of a step near it.

use multiversion::multiversion;

use crate::{
    grid::heading::{Heading, turn_rad},
    ground::stance::{ORIENTATIONS, orientation},
    lattice::{graph::Lattice, step::PreparedStep},
    table::window::Window,
};

/// Directions of travel that steps of each orientation have, as turns from the orientation's heading [rad].
#[derive(Clone, Debug, Default)]
pub(crate) struct Directions([Option<[f64; 2]>; ORIENTATIONS]);

/// On ground so marked the robot cannot stand: it is unknown, too steep for its limits, or would touch the body.
pub(crate) const NO_STAND: f32 = f32::NEG_INFINITY;

/// Share by which limits and grades count as larger than they are, for rounding.
const ROUNDING: f32 = 1.0001;
/// More than rounding adds to the cosine of a roll.
const COSINE_ROUNDING: f32 = 1e-6;

impl Directions {
    /// Takes a step's direction in.
    pub(crate) fn add(&mut self, step: &PreparedStep) {
        let k = orientation(step.heading);
        let half_turn = std::f64::consts::PI;
        let turn = turn_rad(Heading::new(k).angle_rad(), step.travel.1.atan2(step.travel.0));
        // Wheels stand on the same places both ways round.
        let turn = if turn.abs() > half_turn / 2.0 { turn - half_turn.copysign(turn) } else { turn };
        let [low, high] = self.0[k].unwrap_or([turn, turn]);
        self.0[k] = Some([low.min(turn), high.max(turn)]);
    }
}

/// Lower bounds of the cosine of roll by orientation and cell of a window; [`NO_STAND`] where no step may stand.
///
/// The grade across a direction θ is R sin(φ − θ), with the gradient's size R and direction φ. Between two directions less than a right angle
/// apart it is at most the larger of those across them, over the cosine of half the angle between them, and, where both have
/// one sign, at least the smaller. With a grade s across, cos ρ = 1/√(1 + s²) ≥ 1 − s²/2.
pub(crate) struct RollBounds(pub(crate) [Vec<f32>; ORIENTATIONS]);

impl RollBounds {
    pub(crate) fn new(window: &Window, directions: &Directions, lattice: &Lattice) -> Self {
        let limits =
            [lattice.limits.pitch_grade, lattice.limits.roll_grade].map(|limit| limit as f32 * ROUNDING);
        let least = least_cos_roll(lattice) as f32;
        RollBounds(std::array::from_fn(|k| {
            let Some(turns) = directions.0[k] else { return Vec::new() };
            let ways = turns.map(|turn| {
                let (sin, cos) = (Heading::new(k).angle_rad() + turn).sin_cos();
                [cos as f32, sin as f32]
            });
            let widened = ROUNDING / ((turns[1] - turns[0]) / 2.0).cos() as f32;
            let mut cosines = vec![NO_STAND; window.height_m.len()];
            fill(&mut cosines, &window.gradients[k], ways, (limits, least, widened));
            cosines
        }))
    }
}

/// Cosine of the steepest roll that the robot's limits allow.
pub(crate) fn least_cos_roll(lattice: &Lattice) -> f64 {
    let roll = lattice.limits.roll_grade;
    1.0 / (1.0 + roll * roll).sqrt()
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2+fma", "aarch64+neon"))]
fn fill(
    cosines: &mut [f32],
    [east, north]: &[Vec<f32>; 2],
    ways: [[f32; 2]; 2],
    ([most_pitch, most_roll], least, widened): ([f32; 2], f32, f32),
) {
    let [[cos, sin], [other_cos, other_sin]] = ways;
    for ((cosine, east), north) in cosines.iter_mut().zip(east).zip(north) {
        let across = [north * cos - east * sin, north * other_cos - east * other_sin];
        let along = [east * cos + north * sin, east * other_cos + north * other_sin];
        let smaller = |[a, b]: [f32; 2]| {
            let less = if a.abs() < b.abs() { a.abs() } else { b.abs() };
            if a * b > 0.0 { less } else { a * b * 0.0 }
        };
        let larger = if across[0].abs() > across[1].abs() { across[0].abs() } else { across[1].abs() };
        let steepest = larger * widened;
        let bound = 1.0 - COSINE_ROUNDING - 0.5 * steepest * steepest;
        let bound = if bound > least { bound } else { least - COSINE_ROUNDING };
        // False of a NaN, too.
        let may_stand = (smaller(across) <= most_roll) & (smaller(along) <= most_pitch);
        *cosine = if may_stand { bound } else { NO_STAND };
    }
}
