//! Errors of fits on stretches that they did not see.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::{
    evidence::linear_model::transposed,
    fit::joint::{Fitted, Joint},
};

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
    let sizes = transposed(observed.test_rows, sizes.len(), sizes.iter().map(DVector::as_slice));
    let left = &fitted.left.columns;
    let basis = joint.model.transposed();
    let columns = basis.nrows() + sizes.nrows();
    let parts: Vec<_> = [None, Some(0), Some(1)]
        .into_par_iter()
        .map(|part| {
            let rows: Vec<usize> = (0..basis.ncols()).filter(|i| fold(*i) == part).collect();
            moments((basis, &sizes), left, &rows)
        })
        .collect();
    let (mut squares, mut cut, mut variances, mut strays, mut rows) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for held_out in 0..2 {
        let [(healthy_gram, healthy_right), (gram, right)] = [&parts[0], &parts[2 - held_out]];
        let gram = healthy_gram + gram + DMatrix::identity(columns, columns);
        let Some(root) = gram.cholesky() else {
            return HeldOut { rmse_w: f64::NAN, over_noise: f64::NAN, strays: 0.0 };
        };
        let errors_w = errors_w(joint, fitted, &root.solve(&(healthy_right + right)));
        for i in (0..observed.test_rows).filter(|i| observed.is_power(*i) && fold(*i) == Some(held_out)) {
            let square = errors_w[i].powi(2);
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

/// Products of a transposed basis, with columns of the test drives below it, over some rows, and theirs with what is left there; stretch by
/// stretch, since a copy of a long drive's basis is half of all memory.
fn moments(
    (basis, sizes): (&DMatrix<f64>, &DMatrix<f64>),
    left: &DMatrix<f64>,
    rows: &[usize],
) -> (DMatrix<f64>, DVector<f64>) {
    /// Rows that are multiplied at once: they stay in the cache.
    const ROWS_AT_ONCE: usize = 1024;
    let (first, count) = (basis.nrows(), basis.nrows() + sizes.nrows());
    let (mut gram, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
    let stretches = rows.chunk_by(|a, b| a + 1 == *b).flat_map(|stretch| stretch.chunks(ROWS_AT_ONCE));
    for stretch in stretches {
        let (from, rows) = (stretch[0], stretch.len());
        let own = basis.columns(from, rows);
        gram.view_mut((0, 0), (first, first)).gemm(1.0, &own, &own.transpose(), 1.0);
        right.rows_mut(0, first).gemv(1.0, &own, &left.column(0).rows(from, rows), 1.0);
        // Only the test drives have effects, and a stretch is in them or beside them.
        if from + rows <= sizes.ncols() && sizes.nrows() > 0 {
            let beside = sizes.columns(from, rows);
            let across = beside * own.transpose();
            let mut below = gram.view_mut((first, 0), (sizes.nrows(), first));
            below += &across;
            let mut above = gram.view_mut((0, first), (first, sizes.nrows()));
            above += across.transpose();
            let mut last = gram.view_mut((first, first), (sizes.nrows(), sizes.nrows()));
            last += beside * beside.transpose();
            right.rows_mut(first, sizes.nrows()).gemv(1.0, &beside, &left.column(0).rows(from, rows), 1.0);
        }
    }
    (gram, right)
}

/// Recorded less predicted of the test drives, with weights of the basis and of sizes.
fn errors_w(joint: &Joint<'_>, fitted: &Fitted, weights: &DVector<f64>) -> Vec<f64> {
    let of_basis = joint.model.transposed().nrows();
    let basis = joint.by_basis(&weights.rows(0, of_basis).into_owned());
    let sizes: Vec<f64> =
        fitted.sizes.iter().zip(weights.iter().skip(of_basis)).map(|(at, to)| to - at).collect();
    let error_w = |i: usize| {
        let of_sizes: f64 = fitted.raw_columns.iter().zip(&sizes).map(|(column, by)| column[i] * by).sum();
        joint.baseline.residual[i] - fitted.effect[i] - basis[i] - of_sizes
    };
    (0..basis.len()).map(error_w).collect()
}
