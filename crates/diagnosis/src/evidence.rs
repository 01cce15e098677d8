//! How much a candidate explains, beside everything else that is fitted with it.

use nalgebra::{DMatrix, DVector};

/// Whitened errors, the sensitivities of everything that is fitted whatever the candidate, and the blocks that count as one
/// piece of evidence each.
pub(crate) struct System {
    errors: DVector<f64>,
    /// Sensitivities of the robot's own numbers, with rows below for what is known of them.
    always: DMatrix<f64>,
    /// Rows of the errors that are recorded, the rest being what is known before.
    rows: usize,
    /// Block by row.
    block: Vec<usize>,
    blocks: usize,
    /// (AᵀA)⁻¹ of `always`.
    inverse: DMatrix<f64>,
}

/// What a candidate explains.
#[derive(Clone, Debug)]
pub(crate) struct Evidence {
    /// Values of its linear parameters.
    pub(crate) values: Vec<f64>,
    /// Their covariance, from blocks.
    pub(crate) covariance: DMatrix<f64>,
    /// valuesᵀ covariance⁻¹ values: how many block-wise standard errors the values are from nothing, squared.
    pub(crate) wald: f64,
    /// The whitened sensitivities that nothing else explains.
    pub(crate) own: DMatrix<f64>,
}

impl System {
    /// Puts a system together: `known` has the weight of what is known before of each column, in the same units.
    pub(crate) fn new(
        errors: Vec<f64>,
        columns: &[Vec<f64>],
        known: &[f64],
        offset: &[f64],
        block: Vec<usize>,
    ) -> Self {
        let (rows, count) = (errors.len(), columns.len());
        let mut always = DMatrix::zeros(rows + count, count);
        for (j, column) in columns.iter().enumerate() {
            for (i, value) in column.iter().enumerate() {
                always[(i, j)] = *value;
            }
            always[(rows + j, j)] = known[j];
        }
        let mut all = errors;
        all.extend_from_slice(offset);
        let inverse = (always.transpose() * &always)
            .pseudo_inverse(1e-12)
            .unwrap_or_else(|_| DMatrix::zeros(count, count));
        let blocks = block.iter().max().map_or(0, |b| b + 1);
        System { errors: DVector::from_vec(all), always, rows, block, blocks, inverse }
    }

    /// Number of blocks.
    pub(crate) fn blocks(&self) -> usize {
        self.blocks
    }

    /// What is left of a column when everything fitted always has taken its part.
    fn own(&self, columns: &[Vec<f64>]) -> DMatrix<f64> {
        let mut own = DMatrix::zeros(self.always.nrows(), columns.len());
        for (j, column) in columns.iter().enumerate() {
            for (i, value) in column.iter().enumerate() {
                own[(i, j)] = *value;
            }
        }
        let share = &self.inverse * (self.always.transpose() * &own);
        own - &self.always * share
    }

    /// The errors that are left when nothing but what is fitted always is.
    pub(crate) fn left(&self) -> DVector<f64> {
        let share = &self.inverse * (self.always.transpose() * &self.errors);
        &self.errors - &self.always * share
    }

    /// What a candidate's columns explain; `None` where the rest explains all that they do.
    pub(crate) fn weigh(&self, columns: &[Vec<f64>]) -> Option<Evidence> {
        let own = self.own(columns);
        let left = self.left();
        let square = own.transpose() * &own;
        for (j, column) in columns.iter().enumerate() {
            let whole: f64 = column.iter().map(|x| x * x).sum();
            // Less than a ten-thousandth of its own is rounding.
            if square[(j, j)] < 1e-4 * whole || whole == 0.0 {
                return None;
            }
        }
        let inverse = square.try_inverse()?;
        let values = &inverse * (own.transpose() * &left);
        let after = &left - &own * &values;
        let mut scores = DMatrix::<f64>::zeros(columns.len(), self.blocks);
        for (i, block) in self.block.iter().enumerate() {
            for j in 0..columns.len() {
                scores[(j, *block)] += own[(i, j)] * after[i];
            }
        }
        // Rows of what is known before hang together with no block.
        for i in self.rows..after.len() {
            for j in 0..columns.len() {
                let block = (i - self.rows) % self.blocks.max(1);
                scores[(j, block)] += own[(i, j)] * after[i];
            }
        }
        let freedom = self.blocks as f64 / (self.blocks as f64 - columns.len() as f64 - 1.0).max(1.0);
        let robust = &inverse * (&scores * scores.transpose()) * &inverse * freedom;
        // The larger of both, as in `calibration::fit`.
        let trusting = &inverse * (after.norm_squared() / self.rows.max(1) as f64).max(1.0);
        let stretch: Vec<f64> = (0..columns.len())
            .map(|j| (trusting[(j, j)] / robust[(j, j)].max(1e-300)).max(1.0).sqrt())
            .collect();
        let covariance =
            DMatrix::from_fn(columns.len(), columns.len(), |i, j| robust[(i, j)] * stretch[i] * stretch[j]);
        let wald = (values.transpose() * covariance.clone().try_inverse()? * &values)[(0, 0)];
        Some(Evidence { values: values.iter().copied().collect(), covariance, wald, own })
    }

    /// Drop of squared errors block by block when each tenth of the blocks is judged by a fit of the others.
    pub(crate) fn held_out(&self, columns: &[Vec<f64>], folds: usize) -> Vec<f64> {
        let count = self.always.ncols();
        let mut with = DMatrix::zeros(self.always.nrows(), count + columns.len());
        with.view_mut((0, 0), (self.always.nrows(), count)).copy_from(&self.always);
        for (j, column) in columns.iter().enumerate() {
            for (i, value) in column.iter().enumerate() {
                with[(i, count + j)] = *value;
            }
        }
        let all = (with.transpose() * &with, with.transpose() * &self.errors);
        let mut gains = vec![0.0; self.blocks];
        // Whole stretches of neighbouring blocks are left out together.
        let fold = |block: usize| block * folds / self.blocks.max(1);
        for out in 0..folds {
            let rows: Vec<usize> = (0..self.rows).filter(|i| fold(self.block[*i]) == out).collect();
            let part = DMatrix::from_fn(rows.len(), with.ncols(), |i, j| with[(rows[i], j)]);
            let errors = DVector::from_fn(rows.len(), |i, _| self.errors[rows[i]]);
            let square = &all.0 - part.transpose() * &part;
            let right = &all.1 - part.transpose() * &errors;
            let solve = |n: usize| {
                let square = square.view((0, 0), (n, n)).into_owned();
                square.pseudo_inverse(1e-12).ok().map(|inverse| inverse * right.rows(0, n))
            };
            let (Some(before), Some(after)) = (solve(count), solve(with.ncols())) else { continue };
            let left = [&errors - part.columns(0, count) * before, &errors - &part * after];
            for (k, i) in rows.iter().enumerate() {
                gains[self.block[*i]] += left[0][k].powi(2) - left[1][k].powi(2);
            }
        }
        gains
    }
}
