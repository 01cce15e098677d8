//! How likely errors are where a function of some size is among what made them.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::average::Average;

/// Sizes of the function that are weighed, as shares of the mean power, and sizes of the scatter, as shares of what it seems
/// while the function is not told from it.
pub(super) const SIZES: [f64; 7] = [0.0, 0.0025, 0.005, 0.01, 0.02, 0.04, 0.08];
const SCATTERS: [f64; 5] = [0.6, 0.7, 0.8, 0.9, 1.0];

/// Logarithms of likelihoods, by [`SIZES`].
pub(super) type Likelihoods = [f64; SIZES.len()];

/// Number of the largest.
pub(super) fn most(likelihoods: &Likelihoods) -> usize {
    (1..SIZES.len()).fold(0, |best, i| if likelihoods[i] > likelihoods[best] { i } else { best })
}

/// How likely the errors of a channel are where a function has each size, as a share of that of its columns, beside others; all alike
/// where there is no function.
pub(super) fn likelihoods(
    averages: &[Average],
    channel: usize,
    (own, beside): (&[Vec<f64>], &[Vec<f64>]),
    errors: &[f64],
) -> Likelihoods {
    if own.is_empty() {
        return [0.0; SIZES.len()];
    }
    let has_healthy = averages.iter().any(|a| !a.suspect);
    let tells = |a: &Average| a.channel == channel && !(has_healthy && a.suspect);
    let rows: Vec<usize> = (0..averages.len()).filter(|i| tells(&averages[*i])).collect();
    // Columns of other channels are nothing here, and would cost the most.
    let is_own = |column: &&Vec<f64>| rows.iter().any(|i| column[*i] != 0.0);
    let mut columns: Vec<&Vec<f64>> = beside.iter().filter(is_own).collect();
    let first = columns.len();
    columns.extend(own);
    let all = DMatrix::from_fn(rows.len(), columns.len(), |i, j| columns[j][rows[i]]);
    let errors = DVector::from_fn(rows.len(), |i, _| errors[rows[i]]);
    let (square, right) = (all.transpose() * &all, all.tr_mul(&errors));
    let of_size = |share: f64| {
        let size = |j: usize| if j < first { 1.0 } else { share };
        let square =
            DMatrix::from_fn(columns.len(), columns.len(), |i, j| square[(i, j)] * size(i) * size(j));
        let right = DVector::from_fn(right.len(), |i, _| right[i] * size(i));
        highest(|scatter| log_likelihood(&square, &right, errors.norm_squared(), rows.len(), scatter))
    };
    let mut likelihoods = [0.0; SIZES.len()];
    likelihoods
        .par_iter_mut()
        .zip(SIZES)
        .with_max_len(1)
        .for_each(|(likely, share)| *likely = of_size(share));
    likelihoods
}

/// The highest of likelihoods, by [`SCATTERS`] from the last on, to where they fall.
fn highest(of: impl Fn(f64) -> f64) -> f64 {
    let mut highest = f64::NEG_INFINITY;
    for likely in SCATTERS.into_iter().rev().map(of) {
        if likely < highest {
            break;
        }
        highest = likely;
    }
    highest
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_highest_of_scatters_is_found_without_those_beyond_where_they_fall() {
        for peak in [0.5, 0.7, 0.85, 1.2] {
            let of = |scatter: f64| -(scatter - peak).powi(2);
            let all = SCATTERS.into_iter().map(of).fold(f64::NEG_INFINITY, f64::max);
            assert_eq!(highest(of), all, "{peak}");
        }
        let asked = std::cell::Cell::new(0);
        highest(|scatter| {
            asked.set(asked.get() + 1);
            scatter
        });
        assert_eq!(asked.get(), 2, "nothing is asked beyond the first that falls");
    }
}
