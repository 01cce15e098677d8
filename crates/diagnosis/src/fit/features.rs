//! Smooth functions of some quantities: random Fourier features (Rahimi & Recht, NIPS 2007) of a squared-exponential covariance, drawn
//! once and for all from a Halton sequence.

use std::f64::consts::{SQRT_2, TAU};

use statrs::function::erf::erf_inv;

/// Bases of the Halton sequence, by coordinate (Halton, Numer. Math. 2, 1960).
const PRIMES: [usize; 6] = [2, 3, 5, 7, 11, 13];
/// The first points of a Halton sequence lie in lines.
const SKIPPED: usize = 20;

/// Functions φ_k(x) = √(2/K) cos(ω_k·x/ℓ + φ), whose weights of variance one make a smooth function of variance one.
pub(crate) struct Features<const N: usize> {
    waves: Vec<([f64; N], f64)>,
}

impl<const N: usize> Features<N> {
    /// So many functions of length scales.
    pub(crate) fn new(count: usize, lengths: [f64; N]) -> Self {
        let wave = |k: usize| {
            let share = |coordinate: usize| radical_inverse(k + SKIPPED, PRIMES[coordinate % PRIMES.len()]);
            let frequency = std::array::from_fn(|q| SQRT_2 * erf_inv(2.0 * share(q) - 1.0) / lengths[q]);
            (frequency, TAU * share(N))
        };
        Features { waves: (0..count).map(wave).collect() }
    }

    /// Number of functions.
    pub(crate) fn count(&self) -> usize {
        self.waves.len()
    }

    /// One function at a point.
    pub(crate) fn at(&self, k: usize, point: &[f64; N]) -> f64 {
        let (frequency, phase) = &self.waves[k];
        let angle: f64 = frequency.iter().zip(point).map(|(f, x)| f * x).sum::<f64>() + phase;
        (2.0 / self.waves.len() as f64).sqrt() * angle.cos()
    }
}

/// Digits of a number in a base, mirrored about the point.
fn radical_inverse(mut number: usize, base: usize) -> f64 {
    let (mut share, mut digit) = (0.0, 1.0 / base as f64);
    while number > 0 {
        share += digit * (number % base) as f64;
        number /= base;
        digit /= base as f64;
    }
    share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_have_the_covariance_of_smooth_functions() {
        let features = Features::<2>::new(400, [1.0, 2.0]);
        let covariance = |a: [f64; 2], b: [f64; 2]| -> f64 {
            (0..features.count()).map(|k| features.at(k, &a) * features.at(k, &b)).sum()
        };
        for (a, b) in [([0.0_f64, 0.0], [0.0_f64, 0.0]), ([0.3, 0.1], [1.0, 1.5]), ([0.0, 0.0], [3.0, 0.0])] {
            let squared: f64 = (a[0] - b[0]).powi(2) + ((a[1] - b[1]) / 2.0).powi(2);
            let expected = (-0.5 * squared).exp();
            assert!((covariance(a, b) - expected).abs() < 0.1, "{a:?} {b:?} {}", covariance(a, b));
        }
    }
}
