//! Errors of fits on stretches that they did not see.

use nalgebra::{DMatrix, DVector};

use crate::posterior::fit::joint::{Fitted, Joint};

/// Length of stretches that are fitted and held out in turn \[s\]: longer than manoeuvres.
const STRETCH_S: f64 = 60.0;

/// Root mean square error of a fit's prediction of power in the stretches that were held out, robot, discrepancy and sizes fitted to all
/// others [W].
pub(crate) fn rmse_w(joint: &Joint<'_>, fitted: &Fitted) -> f64 {
    let observed = joint.observed;
    let fold = |i: usize| (i < observed.test_rows).then(|| (observed.driven_s[i] / STRETCH_S) as usize % 2);
    let sizes = joint.whiten(&fitted.raw_columns);
    let (basis, count) = (joint.model.basis(), sizes.len());
    let columns = basis.ncols() + count;
    let white = DMatrix::from_fn(basis.nrows(), columns, |i, j| match j.checked_sub(basis.ncols()) {
        None => basis[(i, j)],
        Some(size) => sizes[size].get(i).copied().unwrap_or(0.0),
    });
    let left = fitted.left.columns.column(0);
    let (mut squares, mut rows) = (0.0, 0.0);
    for held_out in 0..2 {
        let seen: Vec<usize> = (0..basis.nrows()).filter(|i| fold(*i) != Some(held_out)).collect();
        let train = white.select_rows(&seen);
        let transposed = train.transpose();
        let gram = &transposed * &train + DMatrix::identity(columns, columns);
        let right = transposed * DVector::from_iterator(seen.len(), seen.iter().map(|i| left[*i]));
        let Some(root) = gram.cholesky() else { return f64::NAN };
        let weights = root.solve(&right);
        for i in (0..observed.test_rows).filter(|i| observed.is_power(*i) && fold(*i) == Some(held_out)) {
            squares += error_w(joint, fitted, &weights, i).powi(2);
            rows += 1.0;
        }
    }
    (squares / f64::max(rows, 1.0)).sqrt()
}

/// Recorded less predicted of one row, with weights of the basis and of sizes.
fn error_w(joint: &Joint<'_>, fitted: &Fitted, weights: &DVector<f64>, i: usize) -> f64 {
    let basis: f64 =
        joint.raw_basis.iter().zip(weights.iter()).map(|(column, weight)| column[i] * weight).sum();
    let sizes = fitted.raw_columns.iter().zip(&fitted.sizes).zip(weights.iter().skip(joint.raw_basis.len()));
    let sizes: f64 = sizes.map(|((column, at), to)| column[i] * (to - at)).sum();
    joint.baseline.residual[i] - fitted.effect[i] - basis - sizes
}
