//! What a candidate gains in blocks that were held out of the fit.

use nalgebra::{DMatrix, DVector};

use super::{System, root};
use crate::shared;

/// Rows that are held out together, and the products of their columns with each other and with the errors.
struct Part {
    rows: Vec<usize>,
    square: DMatrix<f64>,
    right: DVector<f64>,
}

impl System {
    /// Drop of squared errors block by block when each tenth of the blocks is judged by a fit of the others.
    pub(crate) fn held_out(&self, columns: &[Vec<f64>], folds: usize) -> Vec<f64> {
        let count = self.columns.ncols() + shared::count(&self.shared);
        let all_columns = count + columns.len();
        // Whole stretches of neighbouring blocks are left out together.
        let fold = |block: usize| block * folds / self.blocks.max(1);
        let part = |out: usize| {
            let rows: Vec<usize> = (0..self.rows).filter(|i| fold(self.block[*i]) == out).collect();
            let part = self.dense(columns, &rows);
            let (square, right) = (part.transpose() * &part, part.tr_mul(&self.errors_in(&rows)));
            Part { rows, square, right }
        };
        let parts: Vec<Part> = (0..folds).map(part).collect();
        let all = parts.iter().fold(self.known_before(columns.len()), |(square, right), part| {
            (square + &part.square, right + &part.right)
        });
        let mut gains = vec![0.0; self.blocks];
        for Part { rows, square, right } in &parts {
            let (square, right) = (&all.0 - square, &all.1 - right);
            let solve = |n: usize| {
                let square = square.view((0, 0), (n, n)).into_owned();
                root(square).map(|root| root.solve(&right.rows(0, n)))
            };
            let (Some(before), Some(after)) = (solve(count), solve(all_columns)) else { continue };
            let (part, errors) = (self.dense(columns, rows), self.errors_in(rows));
            let left = [&errors - part.columns(0, count) * before, &errors - &part * after];
            for (k, i) in rows.iter().enumerate() {
                gains[self.block[*i]] += left[0][k].powi(2) - left[1][k].powi(2);
            }
        }
        gains
    }

    /// All columns over some of the recorded rows, those of a candidate last: over all rows at once they would take gigabytes of long
    /// drives.
    fn dense(&self, columns: &[Vec<f64>], rows: &[usize]) -> DMatrix<f64> {
        let always = self.columns.ncols();
        let count = always + shared::count(&self.shared) + columns.len();
        let mut part = DMatrix::zeros(rows.len(), count);
        for j in 0..always {
            rows.iter().enumerate().for_each(|(k, i)| part[(k, j)] = self.columns[(*i, j)]);
        }
        let mut within = vec![None; self.rows];
        rows.iter().enumerate().for_each(|(k, i)| within[*i] = Some(k));
        let mut at = always;
        for one in self.shared.iter() {
            let own: Vec<(usize, usize)> =
                one.places.iter().enumerate().filter_map(|(i, place)| Some((i, within[*place]?))).collect();
            for j in 0..one.columns.ncols() {
                own.iter().for_each(|(i, k)| part[(*k, at + j)] = one.columns[(*i, j)]);
            }
            at += one.columns.ncols();
        }
        for (j, column) in columns.iter().enumerate() {
            rows.iter().enumerate().for_each(|(k, i)| part[(k, at + j)] = column[*i]);
        }
        part
    }

    fn errors_in(&self, rows: &[usize]) -> DVector<f64> {
        DVector::from_fn(rows.len(), |k, _| self.errors[rows[k]])
    }

    /// What is known before of all columns, those of a candidate last, of which nothing is: products with each other and with the errors.
    fn known_before(&self, candidate: usize) -> (DMatrix<f64>, DVector<f64>) {
        let (always, shared) = (self.columns.ncols(), shared::count(&self.shared));
        let known = |j: usize| self.columns[(self.rows + j, j)];
        let all = always + shared + candidate;
        let squares = DVector::from_fn(all, |j, _| match j {
            j if j < always => known(j).powi(2),
            j if j < always + shared => 1.0,
            _ => 0.0,
        });
        let right =
            DVector::from_fn(
                all,
                |j, _| {
                    if j < always { known(j) * self.errors[self.rows + j] } else { 0.0 }
                },
            );
        (DMatrix::from_diagonal(&squares), right)
    }
}
