//! Products of columns with a basis taken out, scale by scale of the noise, and the log evidence of sets of them.

use nalgebra::{DMatrix, DVector};
use statrs::function::erf::erfc;

/// Columns with the basis taken out, scale by scale.
pub(crate) struct Reduced {
    /// R_s.
    grams: Vec<DMatrix<f64>>,
    log_weights: Vec<f64>,
}

/// Signs that the size of a column can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Half {
    /// Both: a normal prior.
    Both,
    /// Positive only: a half-normal prior.
    Positive,
}

/// Log evidence of a set of columns, with the posterior of their sizes.
#[derive(Clone, Debug)]
pub(crate) struct Evidence {
    /// Natural logarithm.
    pub(crate) log: f64,
    /// Posterior mean of the sizes, in prior standard deviations.
    pub(crate) mean: DVector<f64>,
    /// Their posterior covariance.
    pub(crate) covariance: DMatrix<f64>,
}

impl Evidence {
    /// The mixture of posteriors by their log weights: its covariance is the mean of theirs and the scatter of their means.
    pub(crate) fn mixed<'a>(
        logs: &[f64],
        parts: impl Iterator<Item = (&'a DVector<f64>, &'a DMatrix<f64>)> + Clone,
    ) -> Self {
        let log = log_sum(logs.iter().copied());
        let weights: Vec<f64> = logs.iter().map(|one| (one - log).exp()).collect();
        let count = parts.clone().next().map_or(0, |(mean, _)| mean.len());
        let mut mean = DVector::zeros(count);
        parts.clone().zip(&weights).for_each(|((part, _), weight)| mean += part * *weight);
        let mut covariance = DMatrix::zeros(count, count);
        for ((part, own), weight) in parts.zip(&weights) {
            let off = part - &mean;
            covariance += (own + &off * off.transpose()) * *weight;
        }
        Evidence { log, mean, covariance }
    }
}

impl Reduced {
    /// The same at the first scales alone.
    pub(crate) fn first(&self, scales: usize) -> Reduced {
        Reduced { grams: self.grams[..scales].to_vec(), log_weights: self.log_weights[..scales].to_vec() }
    }

    /// Reduced products that were worked out elsewhere, scale by scale.
    pub(crate) fn of(grams: Vec<DMatrix<f64>>, log_weights: Vec<f64>) -> Self {
        Reduced { grams, log_weights }
    }

    /// The same of some columns only, each times a factor; the residual stays.
    pub(crate) fn scaled(&self, factors: &[f64]) -> Reduced {
        let scaled = |gram: &DMatrix<f64>| {
            let last = gram.nrows() - 1;
            let factor = |i: usize| if i == last { 1.0 } else { factors[i] };
            DMatrix::from_fn(last + 1, last + 1, |i, j| factor(i) * factor(j) * gram[(i, j)])
        };
        Reduced { grams: self.grams.iter().map(scaled).collect(), log_weights: self.log_weights.clone() }
    }

    /// The same of a choice of columns; the residual stays.
    #[cfg(test)]
    pub(crate) fn select(&self, columns: &[usize]) -> Reduced {
        let chosen = |gram: &DMatrix<f64>| {
            let last = gram.nrows() - 1;
            let at = |i: usize| columns.get(i).copied().unwrap_or(last);
            let count = columns.len() + 1;
            DMatrix::from_fn(count, count, |i, j| gram[(at(i), at(j))])
        };
        Reduced { grams: self.grams.iter().map(chosen).collect(), log_weights: self.log_weights.clone() }
    }

    /// Log evidence and sizes with all columns free, `halves` saying which of the first cannot be negative.
    pub(crate) fn evidence(&self, halves: &[Half]) -> Evidence {
        let parts: Vec<Part> = (0..self.grams.len()).map(|i| self.at_scale(i, halves)).collect();
        let logs: Vec<f64> = parts.iter().map(|part| part.log).collect();
        Evidence::mixed(&logs, parts.iter().map(|part| (&part.mean, &part.covariance)))
    }

    /// Reduced square of the first column at the likeliest scale of the noise with all columns free.
    pub(crate) fn information(&self) -> f64 {
        self.grams.get(self.likeliest_scale()).map_or(0.0, |gram| gram[(0, 0)])
    }

    /// Index of the likeliest scale of the noise with all columns free.
    pub(crate) fn likeliest_scale(&self) -> usize {
        let log = |i: &usize| self.at_scale(*i, &[]).log;
        (0..self.grams.len()).max_by(|a, b| log(a).total_cmp(&log(b))).unwrap_or(0)
    }

    fn at_scale(&self, i: usize, halves: &[Half]) -> Part {
        let gram = &self.grams[i];
        let count = gram.nrows() - 1;
        let none = || Part {
            log: f64::NEG_INFINITY,
            mean: DVector::zeros(count),
            covariance: DMatrix::zeros(count, count),
        };
        let plain = self.log_weights[i] - 0.5 * gram[(count, count)];
        if count == 0 {
            return Part { log: plain, ..none() };
        }
        let mut with_prior = gram.view((0, 0), (count, count)).into_owned();
        (0..count).for_each(|j| with_prior[(j, j)] += 1.0);
        let Some(root) = with_prior.cholesky() else { return none() };
        let right = gram.view((0, count), (count, 1)).column(0).into_owned();
        let mean = root.solve(&right);
        let half_log_det: f64 = root.l_dirty().diagonal().iter().map(|l| l.ln()).sum();
        let covariance = root.inverse();
        let cut: f64 = (0..count)
            .filter(|j| halves.get(*j) == Some(&Half::Positive))
            .map(|j| log_share_above_zero(mean[j] / covariance[(j, j)].sqrt()) + std::f64::consts::LN_2)
            .sum();
        Part { log: plain + 0.5 * right.dot(&mean) - half_log_det + cut, mean, covariance }
    }
}

struct Part {
    log: f64,
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
}

/// ln Φ(z), by its asymptotic series where Φ underflows (Abramowitz & Stegun 26.2.12).
fn log_share_above_zero(z: f64) -> f64 {
    /// Where erfc is still exact.
    const EXACT_FROM: f64 = -30.0;
    if z > EXACT_FROM {
        return (0.5 * erfc(-z * std::f64::consts::FRAC_1_SQRT_2)).ln();
    }
    -0.5 * z * z - (-z).ln() - 0.5 * std::f64::consts::TAU.ln()
}

/// ln Σ exp.
pub(crate) fn log_sum(logs: impl IntoIterator<Item = f64>) -> f64 {
    let logs: Vec<f64> = logs.into_iter().collect();
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if most == f64::NEG_INFINITY {
        return most;
    }
    most + logs.iter().map(|log| (log - most).exp()).sum::<f64>().ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_far_below_zero_are_told_without_underflow() {
        let beside = [-29.9, -30.1].map(log_share_above_zero);
        assert!((beside[0] - beside[1] - 6.0).abs() < 0.1, "{beside:?}");
        assert!((log_share_above_zero(0.0) + std::f64::consts::LN_2).abs() < 1e-12);
    }

    #[test]
    fn a_mixture_is_as_wide_as_its_parts_and_the_way_between_them() {
        let mean = |x: f64| DVector::from_vec(vec![x]);
        let parts = [(mean(1.0), DMatrix::identity(1, 1)), (mean(3.0), DMatrix::identity(1, 1) * 0.5)];
        let mixed =
            Evidence::mixed(&[0.25_f64.ln(), 0.75_f64.ln()], parts.iter().map(|(mean, own)| (mean, own)));
        assert!(mixed.log.abs() < 1e-12 && (mixed.mean[0] - 2.5).abs() < 1e-12);
        // ¼·1 + ¾·½ + ¼·1.5² + ¾·0.5²
        assert!((mixed.covariance[(0, 0)] - (0.625 + 0.75)).abs() < 1e-12);
    }
}
