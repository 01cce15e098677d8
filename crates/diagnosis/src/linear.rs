//! Least squares of many columns, judged by blocks that were left out.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Tenths that are left out in turn.
pub(crate) const FOLDS: usize = 10;

/// Columns and errors as their products, fold by fold.
pub(crate) struct Folded<'a> {
    fold: &'a [usize],
    square: Vec<DMatrix<f64>>,
    right: Vec<DVector<f64>>,
}

impl<'a> Folded<'a> {
    /// Adds up the products of all rows of each fold.
    pub(crate) fn new(columns: &[Vec<f64>], errors: &[f64], fold: &'a [usize]) -> Self {
        let count = columns.len();
        let products = |out: usize| {
            let rows: Vec<usize> = (0..errors.len()).filter(|i| fold[*i] == out).collect();
            let part = DMatrix::from_fn(rows.len(), count, |i, j| columns[j][rows[i]]);
            let own = DVector::from_fn(rows.len(), |i, _| errors[rows[i]]);
            // Products with what was turned round first are far faster where columns are many.
            (part.transpose() * &part, part.tr_mul(&own))
        };
        let (square, right) = (0..FOLDS).into_par_iter().map(products).unzip();
        Folded { fold, square, right }
    }

    /// What columns, those of the fit or the same in another scale, say of every row when fitted to the rows of other folds.
    /// Each has a weight of what is known of its share before, and that share.
    pub(crate) fn held_out(&self, columns: &[Vec<f64>], known: &[f64], before: &[f64]) -> Vec<f64> {
        let shares: Vec<Vec<f64>> =
            (0..FOLDS).into_par_iter().map(|out| self.shares(Some(out), known, before)).collect();
        self.sum(columns, |fold, j| shares[fold][j])
    }

    /// The same when fitted to all rows.
    pub(crate) fn fitted(&self, columns: &[Vec<f64>], known: &[f64], before: &[f64]) -> Vec<f64> {
        let shares = self.shares(None, known, before);
        self.sum(columns, |_, j| shares[j])
    }

    /// Columns times the shares that each has in each fold, added up: column by column, as long ones lie far apart.
    fn sum(&self, columns: &[Vec<f64>], share: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let mut sum = vec![0.0; self.fold.len()];
        for (j, column) in columns.iter().enumerate() {
            let rows = sum.iter_mut().zip(column).zip(self.fold);
            rows.for_each(|((sum, value), fold)| *sum += value * share(*fold, j));
        }
        sum
    }

    fn shares(&self, without: Option<usize>, known: &[f64], before: &[f64]) -> Vec<f64> {
        let count = known.len();
        let mut square = DMatrix::from_diagonal(&DVector::from_column_slice(known));
        let mut right = DVector::from_fn(count, |j, _| known[j] * before[j]);
        for fold in (0..FOLDS).filter(|fold| Some(*fold) != without) {
            square += &self.square[fold];
            right += &self.right[fold];
        }
        // Columns that nothing excites take no share.
        for j in 0..count {
            square[(j, j)] += 1e-9 * (1.0 + square[(j, j)]);
        }
        match square.cholesky() {
            Some(root) => root.solve(&right).iter().copied().collect(),
            None => vec![0.0; count],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_does_not_tell_what_it_is_predicted_by() {
        let fold: Vec<usize> = (0..100).map(|i| i / 10).collect();
        let mut errors = vec![0.0; 100];
        errors[5] = 100.0;
        let columns = vec![vec![1.0; 100]];
        let folded = Folded::new(&columns, &errors, &fold);
        let (held_out, fitted) =
            (folded.held_out(&columns, &[0.0], &[0.0]), folded.fitted(&columns, &[0.0], &[0.0]));
        assert!(held_out[5].abs() < 1e-9, "its own fold was left out: {}", held_out[5]);
        assert!((held_out[50] - 100.0 / 90.0).abs() < 1e-6 && (fitted[5] - 1.0).abs() < 1e-6);
    }
}
