//! Smooth functions of the inputs, and of where the robot is, that make up a Gaussian process.

use crate::average::{Average, Input};

/// Spreads of an input over which the function changes.
const LENGTH: f64 = 1.5;
/// Spreads of the positions over which the ground changes: an eighth of what was driven.
const PATCH: f64 = 0.4;
/// Functions that are taken at most, and the share of the prior variance that may be left out of every average.
const MOST: usize = 80;
pub(super) const LEFT_OUT: f64 = 0.02;
/// Inputs beyond count as so many spreads: a single bump is no place of its own.
const FARTHEST: f64 = 3.0;

/// Functions over the averages of a channel, whose sum with independent weights of one sigma 1 is the process with one sigma 1.
///
/// They are the columns of the pivoted Cholesky factor of the covariance exp(−d²/2).
pub(super) fn of_inputs(averages: &[Average], places: &[usize]) -> Vec<Vec<f64>> {
    cholesky(&standardised(averages, places, INPUTS, (LENGTH, FARTHEST)))
}

/// Functions of where the robot is, over the averages of a channel, whose sum with independent weights of one sigma 1 is a process with
/// one sigma 1 at the root mean square rim speed, in proportion to it, as what rolls takes: ground is nowhere the same. None where fewer
/// than half of the positions are known.
pub(super) fn of_ground(averages: &[Average], places: &[usize]) -> Vec<Vec<f64>> {
    let is_known = |i: &usize| averages[*i].input.position_m.iter().all(|m| m.is_finite());
    let known: Vec<usize> = places.iter().copied().filter(is_known).collect();
    if 2 * known.len() <= places.len() {
        return Vec::new();
    }
    let squares: f64 = known.iter().map(|i| averages[*i].input.rim_mps.powi(2)).sum();
    let usual_mps = (squares / known.len() as f64).sqrt().max(1e-9);
    let points = standardised(averages, &known, POSITION, (PATCH, f64::INFINITY));
    let of_known = |function: Vec<f64>| {
        let mut all = vec![0.0; places.len()];
        let rows = places.iter().enumerate().filter(|(_, i)| is_known(i));
        rows.zip(function)
            .for_each(|((row, i), x)| all[row] = x * averages[*i].input.rim_mps.abs() / usual_mps);
        all
    };
    cholesky(&points).into_iter().map(of_known).collect()
}

/// Inputs of the averages over their spreads and the length over which a function changes, no further from the middle than that.
fn standardised<const COUNT: usize>(
    averages: &[Average],
    places: &[usize],
    inputs: [fn(&Input) -> f64; COUNT],
    (length, farthest): (f64, f64),
) -> Vec<[f64; COUNT]> {
    let mut points = vec![[0.0; COUNT]; places.len()];
    let count = places.len().max(1) as f64;
    for (axis, input) in inputs.iter().enumerate() {
        let values: Vec<f64> = places.iter().map(|i| input(&averages[*i].input)).collect();
        let mean = values.iter().sum::<f64>() / count;
        let spread = (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt();
        if spread > 1e-9 {
            for (point, x) in points.iter_mut().zip(&values) {
                point[axis] = ((x - mean) / spread).clamp(-farthest, farthest) / length;
            }
        }
    }
    points
}

const INPUTS: [fn(&Input) -> f64; 5] =
    [|x| x.rim_mps, |x| x.difference_mps, |x| x.pitch_rad, |x| x.roll_rad, |x| x.accel_mps2];

const POSITION: [fn(&Input) -> f64; 2] = [|x| x.position_m[0], |x| x.position_m[1]];

/// Columns of the factor, the place that is known least next.
fn cholesky<const COUNT: usize>(points: &[[f64; COUNT]]) -> Vec<Vec<f64>> {
    let mut left = vec![1.0_f64; points.len()];
    let mut factors: Vec<Vec<f64>> = Vec::new();
    while factors.len() < MOST {
        let Some(pivot) = (0..left.len()).max_by(|a, b| left[*a].total_cmp(&left[*b])) else { break };
        if left[pivot] < LEFT_OUT {
            break;
        }
        let root = f64::sqrt(left[pivot]);
        let factor: Vec<f64> = (0..points.len())
            .map(|i| {
                let square: f64 = points[i].iter().zip(&points[pivot]).map(|(a, b)| (a - b).powi(2)).sum();
                let told: f64 = factors.iter().map(|f| f[i] * f[pivot]).sum();
                ((-0.5 * square).exp() - told) / root
            })
            .collect();
        left.iter_mut().zip(&factor).for_each(|(left, x)| *left -= x * x);
        left[pivot] = 0.0;
        factors.push(factor);
    }
    factors
}
