//! Errors of fits on stretches that they did not see.

use nalgebra::{DMatrix, DVector};

use crate::fit::joint::{Fitted, Joint};

/// Length of stretches that are fitted and held out in turn \[s\]: longer than manoeuvres.
const STRETCH_S: f64 = 60.0;

/// Errors of a fit's prediction of power in the stretches that were held out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct HeldOut {
    /// Root mean square error [W].
    pub(crate) rmse_w: f64,
    /// Root mean square error over the noise, seconds farther off than [`STRAY_SIGMAS`] counted as so far off: the noise is that of ordinary
    /// seconds, and a few quick moves must not decide whether the model describes the rest.
    pub(crate) over_noise: f64,
    /// Share of seconds that are farther off.
    pub(crate) strays: f64,
}

/// Seconds farther off, in standard deviations of the noise, are one in 2000 by chance.
pub(crate) const STRAY_SIGMAS: f64 = 3.5;

/// Errors with robot, discrepancy and sizes fitted to all other stretches.
pub(crate) fn held_out(joint: &Joint<'_>, fitted: &Fitted) -> HeldOut {
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
    let (mut squares, mut cut, mut variances, mut strays, mut rows) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for held_out in 0..2 {
        let seen: Vec<usize> = (0..basis.nrows()).filter(|i| fold(*i) != Some(held_out)).collect();
        let train = white.select_rows(&seen);
        let transposed = train.transpose();
        let gram = &transposed * &train + DMatrix::identity(columns, columns);
        let right = transposed * DVector::from_iterator(seen.len(), seen.iter().map(|i| left[*i]));
        let Some(root) = gram.cholesky() else {
            return HeldOut { rmse_w: f64::NAN, over_noise: f64::NAN, strays: 0.0 };
        };
        let weights = root.solve(&right);
        for i in (0..observed.test_rows).filter(|i| observed.is_power(*i) && fold(*i) == Some(held_out)) {
            let square = error_w(joint, fitted, &weights, i).powi(2);
            let variance = joint
                .baseline
                .noise
                .sigma(observed.averages()[i].channel, joint.baseline.predicted[i])
                .powi(2);
            let most = STRAY_SIGMAS.powi(2) * variance;
            squares += square;
            cut += square.min(most);
            variances += variance;
            strays += f64::from(u8::from(square > most));
            rows += 1.0;
        }
    }
    let rows = f64::max(rows, 1.0);
    HeldOut { rmse_w: (squares / rows).sqrt(), over_noise: (cut / variances).sqrt(), strays: strays / rows }
}

/// Recorded less predicted of one row, with weights of the basis and of sizes.
fn error_w(joint: &Joint<'_>, fitted: &Fitted, weights: &DVector<f64>, i: usize) -> f64 {
    let basis: f64 =
        joint.raw_basis.iter().zip(weights.iter()).map(|(column, weight)| column[i] * weight).sum();
    let sizes = fitted.raw_columns.iter().zip(&fitted.sizes).zip(weights.iter().skip(joint.raw_basis.len()));
    let sizes: f64 = sizes.map(|((column, at), to)| column[i] * (to - at)).sum();
    joint.baseline.residual[i] - fitted.effect[i] - basis - sizes
}
