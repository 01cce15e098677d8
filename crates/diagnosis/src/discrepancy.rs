//! What the model misses of the robot, as a smooth function of the inputs that nobody names: the same in suspect and in healthy
//! drives (Kennedy and O'Hagan, J. R. Stat. Soc. B 63, 2001, §4, with a Gaussian process as prior).
//!
//! Where healthy drives went, they tell the function, and what only suspect drives have stands out against it. Where they did
//! not go, the function may be anything of its usual size, and nothing small stands out.

use nalgebra::{DMatrix, DVector};

use crate::{
    average::{Average, Input},
    channel,
    noise::Whitening,
};

/// Spreads of an input over which the function changes.
const LENGTH: f64 = 1.5;
/// Functions that are taken at most, and the share of the prior variance that may be left out of every average.
const MOST: usize = 80;
const LEFT_OUT: f64 = 0.02;
/// Inputs beyond count as so many spreads: a single bump is no place of its own.
const FARTHEST: f64 = 3.0;

/// Sizes of the function that are weighed, as shares of the mean power, and sizes of the scatter, as shares of what it seems
/// while the function is not told from it.
const SIZES: [f64; 7] = [0.0, 0.0025, 0.005, 0.01, 0.02, 0.04, 0.08];
const SCATTERS: [f64; 5] = [0.6, 0.7, 0.8, 0.9, 1.0];

/// The functions of one set of drives, one for each channel.
#[derive(Debug)]
pub(crate) struct Discrepancy {
    channels: Vec<Process>,
}

#[derive(Debug)]
struct Process {
    /// By function, over the averages of the channel.
    functions: Vec<Vec<f64>>,
    /// One sigma of it, as a share of the mean power.
    share: f64,
}

/// Errors with what else is fitted to them, all over their scatter.
pub(crate) struct Whitened<'a> {
    /// Errors.
    pub(crate) errors: Vec<f64>,
    /// Columns with weights of one sigma 1.
    pub(crate) columns: Vec<Vec<f64>>,
    /// Makes the same of any other column in watts.
    pub(crate) white: &'a Whitening,
}

impl Discrepancy {
    /// Learns how large the functions are: the size under which the errors of healthy drives are most likely, of all drives
    /// where none is known to be healthy.
    pub(crate) fn learn(averages: &[Average], means: &[f64], beside: &Whitened<'_>) -> Self {
        let process = |(channel, mean): (usize, &f64)| {
            let places = channel::places(averages, channel);
            let functions = functions(averages, &places);
            let columns = channel::spread(&scaled(&functions, *mean), &places, averages.len());
            Process { share: share(averages, channel, &columns, beside), functions }
        };
        Discrepancy { channels: means.iter().enumerate().map(process).collect() }
    }

    /// Size of the largest function of so many first channels, as a share of the channel's mean.
    pub(crate) fn share(&self, channels: usize) -> f64 {
        self.channels.iter().take(channels).map(|process| process.share).fold(0.0, f64::max)
    }

    /// Columns over the averages of a channel of such a mean size, with weights of one sigma 1; none where it misses nothing.
    pub(crate) fn of_channel(&self, channel: usize, mean: f64) -> Vec<Vec<f64>> {
        match self.channels.get(channel) {
            Some(Process { functions, share }) if *share > 0.0 => scaled(functions, share * mean),
            _ => Vec::new(),
        }
    }
}

fn scaled(functions: &[Vec<f64>], by: f64) -> Vec<Vec<f64>> {
    functions.iter().map(|function| function.iter().map(|value| value * by).collect()).collect()
}

/// The likeliest size of a channel's function, as a share of those given.
fn share(averages: &[Average], channel: usize, functions: &[Vec<f64>], beside: &Whitened<'_>) -> f64 {
    let has_healthy = averages.iter().any(|a| !a.suspect);
    let tells = |a: &Average| a.channel == channel && !(has_healthy && a.suspect);
    let rows: Vec<usize> = (0..averages.len()).filter(|i| tells(&averages[*i])).collect();
    let own: Vec<Vec<f64>> = functions.iter().map(|f| beside.white.of(f)).collect();
    let first = beside.columns.len();
    let columns: Vec<&Vec<f64>> = beside.columns.iter().chain(&own).collect();
    let all = DMatrix::from_fn(rows.len(), columns.len(), |i, j| columns[j][rows[i]]);
    let errors = DVector::from_fn(rows.len(), |i, _| beside.errors[rows[i]]);
    let (square, right) = (all.transpose() * &all, all.tr_mul(&errors));
    let mut best = (f64::NEG_INFINITY, 0.0);
    for share in SIZES {
        let size = |j: usize| if j < first { 1.0 } else { share };
        let square =
            DMatrix::from_fn(columns.len(), columns.len(), |i, j| square[(i, j)] * size(i) * size(j));
        let right = DVector::from_fn(right.len(), |i, _| right[i] * size(i));
        for scatter in SCATTERS {
            let likely = log_likelihood(&square, &right, errors.norm_squared(), rows.len(), scatter);
            if likely > best.0 {
                best = (likely, share);
            }
        }
    }
    best.1
}

/// Logarithm of the likelihood of errors that are columns with weights of one sigma 1 and noise of one sigma `scatter`, but for
/// a constant.
fn log_likelihood(
    square: &DMatrix<f64>,
    right: &DVector<f64>,
    errors: f64,
    rows: usize,
    scatter: f64,
) -> f64 {
    let variance = scatter * scatter;
    let system = DMatrix::identity(square.nrows(), square.ncols()) + square / variance;
    let Some(root) = system.cholesky() else { return f64::NEG_INFINITY };
    let log_determinant = 2.0 * root.l_dirty().diagonal().map(f64::ln).sum() + rows as f64 * variance.ln();
    let explained = right.dot(&root.solve(right)) / (variance * variance);
    -0.5 * (errors / variance - explained + log_determinant)
}

/// Functions over the averages of a channel, whose sum with independent weights of one sigma 1 is the process with one sigma 1.
///
/// They are the columns of the pivoted Cholesky factor of the covariance exp(−d²/2).
fn functions(averages: &[Average], places: &[usize]) -> Vec<Vec<f64>> {
    cholesky(&standardised(averages, places))
}

/// Inputs of the averages over their spreads and the length.
fn standardised(averages: &[Average], places: &[usize]) -> Vec<[f64; INPUTS.len()]> {
    let mut points = vec![[0.0; INPUTS.len()]; places.len()];
    let count = places.len().max(1) as f64;
    for (axis, input) in INPUTS.iter().enumerate() {
        let values: Vec<f64> = places.iter().map(|i| input(&averages[*i].input)).collect();
        let mean = values.iter().sum::<f64>() / count;
        let spread = (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt();
        if spread > 1e-9 {
            for (point, x) in points.iter_mut().zip(&values) {
                point[axis] = ((x - mean) / spread).clamp(-FARTHEST, FARTHEST) / LENGTH;
            }
        }
    }
    points
}

const INPUTS: [fn(&Input) -> f64; 5] =
    [|x| x.rim_mps, |x| x.difference_mps, |x| x.pitch_rad, |x| x.roll_rad, |x| x.accel_mps2];

/// Columns of the factor, the place that is known least next.
fn cholesky(points: &[[f64; INPUTS.len()]]) -> Vec<Vec<f64>> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;

    fn averages(count: usize) -> Vec<Average> {
        let of = |i: usize| {
            let x = i as f64;
            let input = Input {
                rim_mps: (0.1 * x).sin(),
                difference_mps: (0.07 * x).cos(),
                pitch_rad: 0.03 * (0.013 * x).sin(),
                ..Input::default()
            };
            Average { channel: i % 2, run: 0, suspect: false, t_s: x, input }
        };
        (0..count).map(of).collect()
    }

    /// Errors made of a smooth function of so many watts and noise of one watt.
    fn learnt(averages: &[Average], size_w: f64) -> f64 {
        let mut noise = 12345_u64;
        let mut normal = || -> f64 {
            let uniform = |state: &mut u64| {
                *state =
                    state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (*state >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(|_| uniform(&mut noise)).sum::<f64>() - 6.0
        };
        let of = |a: &Average| size_w * (1.4 * (2.0 * a.input.rim_mps + a.input.difference_mps).sin());
        let errors: Vec<f64> = averages.iter().map(|a| of(a) + normal()).collect();
        let predicted = vec![100.0; averages.len()];
        let white = Noise::of(&errors, &predicted, averages, &vec![true; averages.len()])
            .whitening(&predicted, averages);
        let beside = Whitened { errors: white.of(&errors), columns: Vec::new(), white: &white };
        let learnt = Discrepancy::learn(averages, &[100.0, 100.0], &beside);
        learnt.channels[0].share
    }

    #[test]
    fn its_size_is_learnt_from_the_errors() {
        let averages = averages(1200);
        assert_eq!(learnt(&averages, 0.0), 0.0);
        assert!((0.005..=0.02).contains(&learnt(&averages, 1.0)), "{}", learnt(&averages, 1.0));
        assert!(learnt(&averages, 3.0) > learnt(&averages, 1.0));
    }

    #[test]
    fn products_of_the_functions_are_the_covariance_and_channels_stay_apart() {
        let averages = averages(300);
        let of = |channel| {
            let places = channel::places(&averages, channel);
            channel::spread(&functions(&averages, &places), &places, averages.len())
        };
        let functions = [of(0), of(1)].concat();
        let covariance = |i: usize, j: usize| -> f64 { functions.iter().map(|f| f[i] * f[j]).sum() };
        for i in (0..300).step_by(7) {
            assert!((covariance(i, i) - 1.0).abs() < LEFT_OUT + 1e-9, "{i}: {}", covariance(i, i));
        }
        assert!(covariance(4, 6) > 0.9, "neighbours go together");
        assert!(covariance(4, 5).abs() < 1e-12, "left and right have each their own");
    }
}
