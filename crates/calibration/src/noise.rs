//! How far one-second averages scatter about a fit.

use crate::{Drives, score::median};

/// How far errors scatter, and by how much their hanging together widens what follows from them.
#[derive(Clone, Copy)]
pub(crate) struct Noise {
    /// Spread of a one-second average.
    pub(crate) sigma: f64,
    /// Variance of a mean of neighbouring averages over that of a mean of independent ones.
    pub(crate) inflation: f64,
}

impl Noise {
    /// From the median error, and the correlation ρ of neighbouring seconds as (1 + ρ) / (1 − ρ), the variance of a mean of a
    /// first-order process over that of white noise.
    pub(crate) fn of(predicted: &[f64], recorded: &[f64], drives: &Drives) -> Noise {
        /// Ratio of sigma to the median absolute error of a normal distribution.
        const SIGMA_PER_MEDIAN: f64 = 1.4826;
        let errors: Vec<f64> = predicted.iter().zip(recorded).map(|(p, r)| p - r).collect();
        let magnitudes: Vec<f64> = errors.iter().map(|e| e.abs()).collect();
        let floor = 1e-6 * median(&recorded.iter().map(|r| r.abs()).collect::<Vec<_>>()).max(1e-3);
        let sigma = (SIGMA_PER_MEDIAN * median(&magnitudes)).max(floor);
        let clip = |e: f64| e.clamp(-3.0 * sigma, 3.0 * sigma);
        let (mut product, mut square) = (0.0, 0.0);
        for (i, pair) in errors.windows(2).enumerate() {
            let n = drives.averages.len();
            let together = (i + 1) % n != 0 && drives.averages[i % n].run == drives.averages[(i + 1) % n].run;
            if together {
                product += clip(pair[0]) * clip(pair[1]);
                square += clip(pair[0]).powi(2);
            }
        }
        let correlation = if square > 0.0 { (product / square).clamp(0.0, 0.9) } else { 0.0 };
        Noise { sigma, inflation: (1.0 + correlation) / (1.0 - correlation) }
    }

    /// A deviation that weighs as much as a prior that is off by its sigma.
    pub(crate) fn weight(&self) -> f64 {
        self.sigma * self.inflation.sqrt()
    }

    /// Errors beyond this count linearly: Huber's choice of 1.5 to 3 sigmas keeps 95 % efficiency or more on normal errors.
    pub(crate) fn largest(&self) -> f64 {
        2.5 * self.sigma
    }
}
