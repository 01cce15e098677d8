//! Least squares of many columns, judged by blocks that were left out.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::{average::Average, channel};

/// Tenths that are left out in turn.
pub(crate) const FOLDS: usize = 10;

/// NormalEquations of columns with each other and with errors.
#[derive(Clone)]
pub(crate) struct NormalEquations {
    pub(crate) square: DMatrix<f64>,
    pub(crate) right: DVector<f64>,
}

impl NormalEquations {
    /// Of so many columns over no rows.
    pub(crate) fn none(count: usize) -> Self {
        NormalEquations { square: DMatrix::zeros(count, count), right: DVector::zeros(count) }
    }

    /// Adds rows in which only some of the columns are anything.
    pub(crate) fn add(&mut self, reached: &[usize], part: &DMatrix<f64>, errors: &DVector<f64>) {
        // NormalEquations with what was turned round first are far faster where columns are many.
        let (square, right) = (part.transpose() * part, part.tr_mul(errors));
        for (j, to) in reached.iter().enumerate() {
            reached.iter().enumerate().for_each(|(i, from)| self.square[(*from, *to)] += square[(i, j)]);
            self.right[*to] += right[j];
        }
    }
}

/// Columns and errors as their products, fold by fold.
pub(crate) struct Folded<'a> {
    fold: &'a [usize],
    products: Vec<NormalEquations>,
}

impl<'a> Folded<'a> {
    /// Adds up the products of all rows of each fold, channel by channel, as most columns are of one channel only.
    pub(crate) fn new(columns: &[Vec<f64>], errors: &[f64], fold: &'a [usize], averages: &[Average]) -> Self {
        let products = |out: usize| {
            let mut products = NormalEquations::none(columns.len());
            for channel in 0..channel::count(averages) {
                let is_own = |i: &usize| fold[*i] == out && averages[*i].channel == channel;
                let rows: Vec<usize> = (0..errors.len()).filter(is_own).collect();
                let is_reached = |j: &usize| rows.iter().any(|i| columns[*j][*i] != 0.0);
                let reached: Vec<usize> = (0..columns.len()).filter(is_reached).collect();
                let part = DMatrix::from_fn(rows.len(), reached.len(), |i, j| columns[reached[j]][rows[i]]);
                products.add(&reached, &part, &DVector::from_fn(rows.len(), |i, _| errors[rows[i]]));
            }
            products
        };
        Folded { fold, products: (0..FOLDS).into_par_iter().map(products).collect() }
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
            square += &self.products[fold].square;
            right += &self.products[fold].right;
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
    use crate::average::Input;

    /// Averages of two channels in turn.
    fn averages(count: usize) -> Vec<Average> {
        let input = Input::default();
        let average = |i: usize| Average { channel: i % 2, run: 0, suspect: true, t_s: i as f64, input };
        (0..count).map(average).collect()
    }

    #[test]
    fn columns_of_one_channel_are_fitted_as_least_squares_over_all_rows_would() {
        let column = |k: usize| -> Vec<f64> { (0..60).map(|i| (1.7 * (i * (k + 1)) as f64).sin()).collect() };
        let of_channel = |k: usize| -> Vec<f64> {
            column(k).into_iter().enumerate().map(|(i, x)| if i % 2 == k % 2 { x } else { 0.0 }).collect()
        };
        let (columns, errors) = ([column(0), of_channel(1), of_channel(2)], column(5));
        let fold: Vec<usize> = (0..60).map(|i| i / 6).collect();
        let folded = Folded::new(&columns, &errors, &fold, &averages(60));
        let fitted = folded.fitted(&columns, &[0.0; 3], &[0.0; 3]);
        let matrix = DMatrix::from_fn(60, 3, |i, j| columns[j][i]);
        let shares = matrix.clone().svd(true, true).solve(&DVector::from_vec(errors), 1e-12).unwrap();
        let by_hand = matrix * shares;
        assert!(fitted.iter().zip(by_hand.iter()).all(|(a, b)| (a - b).abs() < 1e-7), "{fitted:?} {by_hand}");
    }

    #[test]
    fn a_row_does_not_tell_what_it_is_predicted_by() {
        let fold: Vec<usize> = (0..100).map(|i| i / 10).collect();
        let mut errors = vec![0.0; 100];
        errors[5] = 100.0;
        let columns = vec![vec![1.0; 100]];
        let folded = Folded::new(&columns, &errors, &fold, &averages(100));
        let (held_out, fitted) =
            (folded.held_out(&columns, &[0.0], &[0.0]), folded.fitted(&columns, &[0.0], &[0.0]));
        assert!(held_out[5].abs() < 1e-9, "its own fold was left out: {}", held_out[5]);
        assert!((held_out[50] - 100.0 / 90.0).abs() < 1e-6 && (fitted[5] - 1.0).abs() < 1e-6);
    }
}
