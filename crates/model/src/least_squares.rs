//! Least squares: linear in closed form, non-linear by a bounded Levenberg-Marquardt.
//!
//! The solver crate is young, so it is used in this file only.

use std::convert::Infallible;

use basin::{
    BoundedLevenbergMarquardt, BoxBounds, ConstraintDescription, ConstraintSet, Constraints, CostFunction,
    Executor, Jacobian, PointState, Residual,
};
use nalgebra::{DMatrix, DVector};

/// Largest ratio of singular values (columns scaled to unit length) at which parameters count as determined.
///
/// Double precision leaves about six digits in the solution at this point.
const LARGEST_CONDITION: f64 = 1e6;

/// Solves `columns · x ≈ target` in the least-squares sense; `None` when the columns do not determine x.
pub fn linear<const N: usize>(rows: &[([f64; N], f64)]) -> Option<[f64; N]> {
    if rows.len() < N {
        return None;
    }
    let design = DMatrix::from_fn(rows.len(), N, |i, j| rows[i].0[j]);
    let target = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.1));
    let scale: Vec<f64> = design.column_iter().map(|c| c.norm()).collect();
    if scale.iter().any(|s| *s == 0.0 || !s.is_finite()) {
        return None;
    }
    let scaled = DMatrix::from_fn(rows.len(), N, |i, j| design[(i, j)] / scale[j]);
    let svd = scaled.svd(true, true);
    let (largest, smallest) = (svd.singular_values.max(), svd.singular_values.min());
    if smallest * LARGEST_CONDITION < largest {
        return None;
    }
    let solution = svd.solve(&target, 0.0).ok()?;
    let mut x = [0.0; N];
    for (j, value) in x.iter_mut().enumerate() {
        *value = solution[j] / scale[j];
    }
    Some(x)
}

/// Finds parameters within bounds that minimise the sum of squared residuals.
///
/// Derivatives are central differences with a step relative to each parameter's range. Returns the best
/// parameters found; the residual function must be finite inside the bounds.
pub fn nonlinear(
    residuals: impl Fn(&[f64]) -> Vec<f64>,
    start: &[f64],
    lower: &[f64],
    upper: &[f64],
) -> Vec<f64> {
    let range: Vec<f64> = lower.iter().zip(upper).map(|(low, high)| high - low).collect();
    let unscaled = |z: &[f64]| -> Vec<f64> { (0..z.len()).map(|i| lower[i] + z[i] * range[i]).collect() };
    let problem = Problem {
        residuals: |z: &[f64]| residuals(&unscaled(z)),
        lower: DVector::zeros(range.len()),
        upper: DVector::repeat(range.len(), 1.0),
    };
    let scaled = (0..range.len()).map(|i| (start[i] - lower[i]) / range[i]);
    let initial = PointState::new(DVector::from_iterator(range.len(), scaled));
    // The solver's own test, on the gradient, depends on the units of the residuals and often never holds.
    let solver = BoundedLevenbergMarquardt::new().with_relative_cost_change_tolerance(COST_CHANGE);
    let outcome = Executor::new(problem, solver, initial).max_iter(MAX_ITERATIONS).run();
    match outcome {
        Ok(result) => unscaled(result.param().as_slice()),
        Err(_) => start.to_vec(),
    }
}

/// Derivatives of the residuals at x by central differences, one column a parameter.
pub fn jacobian(
    residuals: impl Fn(&[f64]) -> Vec<f64>,
    x: &[f64],
    lower: &[f64],
    upper: &[f64],
) -> DMatrix<f64> {
    let columns: Vec<DVector<f64>> = (0..x.len())
        .map(|j| {
            let step = (upper[j] - lower[j]) * DIFFERENCE_STEP;
            let (mut above, mut below) = (x.to_vec(), x.to_vec());
            above[j] += step;
            below[j] -= step;
            (DVector::from_vec(residuals(&above)) - DVector::from_vec(residuals(&below))) / (2.0 * step)
        })
        .collect();
    DMatrix::from_columns(&columns)
}

/// The search ends when a step lowers the sum of squares by less than this share. Of n values that is n/1e8 in χ², for 100 000 of
/// them a parameter's thirtieth of a sigma.
const COST_CHANGE: f64 = 1e-8;
const MAX_ITERATIONS: u64 = 200;
/// Step of the central differences, as a fraction of a parameter's range: near the cube root of the rounding.
const DIFFERENCE_STEP: f64 = 1e-5;

struct Problem<F> {
    residuals: F,
    lower: DVector<f64>,
    upper: DVector<f64>,
}

impl<F: Fn(&[f64]) -> Vec<f64>> Problem<F> {
    fn at(&self, x: &DVector<f64>) -> DVector<f64> {
        DVector::from_vec((self.residuals)(x.as_slice()))
    }
}

impl<F> Constraints for Problem<F> {
    type Set = ConstraintSet<BoxBounds<DVector<f64>>>;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(&self.lower), Some(&self.upper)))
    }
}

impl<F: Fn(&[f64]) -> Vec<f64>> CostFunction for Problem<F> {
    type Param = DVector<f64>;
    type Output = f64;
    type Error = Infallible;

    fn cost(&self, x: &DVector<f64>) -> Result<f64, Infallible> {
        Ok(0.5 * self.at(x).norm_squared())
    }
}

impl<F: Fn(&[f64]) -> Vec<f64>> Residual for Problem<F> {
    type Param = DVector<f64>;
    type Output = DVector<f64>;
    type Error = Infallible;

    fn residual(&self, x: &DVector<f64>) -> Result<DVector<f64>, Infallible> {
        Ok(self.at(x))
    }
}

impl<F: Fn(&[f64]) -> Vec<f64>> Jacobian for Problem<F> {
    type Jacobian = DMatrix<f64>;

    fn jacobian(&self, x: &DVector<f64>) -> Result<DMatrix<f64>, Infallible> {
        Ok(jacobian(&self.residuals, x.as_slice(), self.lower.as_slice(), self.upper.as_slice()))
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn a_line_is_found_and_parallel_columns_are_refused() {
        let rows: Vec<([f64; 2], f64)> =
            (0..5).map(|i| ([1.0, f64::from(i)], 3.0 + 2.0 * f64::from(i))).collect();
        let [offset, slope] = linear(&rows).unwrap();
        assert_relative_eq!(offset, 3.0, epsilon = 1e-12);
        assert_relative_eq!(slope, 2.0, epsilon = 1e-12);
        let parallel: Vec<([f64; 2], f64)> =
            (1..5).map(|i| ([f64::from(i), 2.0 * f64::from(i)], 1.0)).collect();
        assert_eq!(linear(&parallel), None);
    }

    #[test]
    fn a_decay_is_found_and_bounds_hold() {
        let data: Vec<(f64, f64)> =
            (0..20).map(|i| f64::from(i) * 0.1).map(|t| (t, 2.0 * (-1.5 * t).exp())).collect();
        let residuals =
            |p: &[f64]| data.iter().map(|(t, y)| p[0] * (-p[1] * t).exp() - y).collect::<Vec<_>>();
        let free = nonlinear(residuals, &[1.0, 1.0], &[0.0, 0.0], &[5.0, 5.0]);
        assert_relative_eq!(free[0], 2.0, epsilon = 1e-5);
        assert_relative_eq!(free[1], 1.5, epsilon = 1e-5);
        let bounded = nonlinear(residuals, &[1.0, 0.5], &[0.0, 0.0], &[5.0, 1.0]);
        assert!(bounded[1] <= 1.0 && bounded[1] > 0.99, "{}", bounded[1]);
    }
}
