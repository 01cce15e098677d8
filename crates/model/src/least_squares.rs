//! Least squares: linear in closed form, non-linear by a bounded Levenberg-Marquardt.
//!
//! The solver crate is young, so it is used in this file only.

use std::marker::PhantomData;

use basin::{
    BoundedLevenbergMarquardt, BoxBounds, ConstraintDescription, ConstraintSet, ConstraintSolveError,
    Constraints, CostFunction, Executor, Jacobian, PointState, Residual,
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
///
/// # Errors
/// That of the residual function, which ends the search.
pub fn nonlinear<E: std::error::Error + 'static>(
    residuals: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    start: &[f64],
    lower: &[f64],
    upper: &[f64],
) -> Result<Vec<f64>, E> {
    let range: Vec<f64> = lower.iter().zip(upper).map(|(low, high)| high - low).collect();
    let unscaled = |z: &[f64]| -> Vec<f64> { (0..z.len()).map(|i| lower[i] + z[i] * range[i]).collect() };
    let problem = Problem {
        residuals: |z: &[f64]| residuals(&unscaled(z)),
        error: PhantomData,
        lower: DVector::zeros(range.len()),
        upper: DVector::repeat(range.len(), 1.0),
    };
    let inside = |z: f64| z.clamp(INSIDE, 1.0 - INSIDE);
    let scaled = (0..range.len()).map(|i| inside((start[i] - lower[i]) / range[i]));
    let initial = PointState::new(DVector::from_iterator(range.len(), scaled));
    // The solver's own test, on the gradient, depends on the units of the residuals and often never holds.
    let solver = BoundedLevenbergMarquardt::new().with_relative_cost_change_tolerance(COST_CHANGE);
    let outcome = Executor::new(problem, solver, initial).max_iter(MAX_ITERATIONS).run();
    match outcome {
        Ok(result) => Ok(unscaled(result.param().as_slice())),
        Err(ConstraintSolveError::Evaluation(error)) => Err(error),
        Err(_) => Ok(start.to_vec()),
    }
}

/// Derivatives of the residuals at x by central differences, one column a parameter.
///
/// # Errors
/// That of the residual function.
pub fn jacobian<E>(
    residuals: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    x: &[f64],
    lower: &[f64],
    upper: &[f64],
) -> Result<DMatrix<f64>, E> {
    let columns: Result<Vec<DVector<f64>>, E> = (0..x.len())
        .map(|j| {
            let step = (upper[j] - lower[j]) * DIFFERENCE_STEP;
            let (mut above, mut below) = (x.to_vec(), x.to_vec());
            above[j] += step;
            below[j] -= step;
            let [above, below] =
                [DVector::from_vec(residuals(&above)?), DVector::from_vec(residuals(&below)?)];
            Ok((above - below) / (2.0 * step))
        })
        .collect();
    Ok(DMatrix::from_columns(&columns?))
}

/// The search ends when a step lowers the sum of squares by less than this share. Of n values that is n/1e8 in χ², for 100 000 of
/// them a parameter's thirtieth of a sigma.
const COST_CHANGE: f64 = 1e-8;
const MAX_ITERATIONS: u64 = 200;
/// Share of its range by which every parameter starts within its bounds. Steps grow with the distance from bounds: of a parameter
/// that starts on one they are so short that the search takes its standstill for the end.
const INSIDE: f64 = 0.01;
/// Step of the central differences, as a fraction of a parameter's range: near the cube root of the rounding.
const DIFFERENCE_STEP: f64 = 1e-5;

struct Problem<F, E> {
    residuals: F,
    error: PhantomData<E>,
    lower: DVector<f64>,
    upper: DVector<f64>,
}

impl<E, F: Fn(&[f64]) -> Result<Vec<f64>, E>> Problem<F, E> {
    fn at(&self, x: &DVector<f64>) -> Result<DVector<f64>, E> {
        (self.residuals)(x.as_slice()).map(DVector::from_vec)
    }
}

impl<F, E> Constraints for Problem<F, E> {
    type Set = ConstraintSet<BoxBounds<DVector<f64>>>;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(&self.lower), Some(&self.upper)))
    }
}

impl<E: std::error::Error + 'static, F: Fn(&[f64]) -> Result<Vec<f64>, E>> CostFunction for Problem<F, E> {
    type Param = DVector<f64>;
    type Output = f64;
    type Error = E;

    fn cost(&self, x: &DVector<f64>) -> Result<f64, E> {
        Ok(0.5 * self.at(x)?.norm_squared())
    }
}

impl<E: std::error::Error + 'static, F: Fn(&[f64]) -> Result<Vec<f64>, E>> Residual for Problem<F, E> {
    type Param = DVector<f64>;
    type Output = DVector<f64>;
    type Error = E;

    fn residual(&self, x: &DVector<f64>) -> Result<DVector<f64>, E> {
        self.at(x)
    }
}

impl<E: std::error::Error + 'static, F: Fn(&[f64]) -> Result<Vec<f64>, E>> Jacobian for Problem<F, E> {
    type Jacobian = DMatrix<f64>;

    fn jacobian(&self, x: &DVector<f64>) -> Result<DMatrix<f64>, E> {
        jacobian(&self.residuals, x.as_slice(), self.lower.as_slice(), self.upper.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use std::{cell::Cell, convert::Infallible};

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
        let residuals = |p: &[f64]| {
            Ok::<_, Infallible>(data.iter().map(|(t, y)| p[0] * (-p[1] * t).exp() - y).collect::<Vec<_>>())
        };
        let free = nonlinear(residuals, &[1.0, 1.0], &[0.0, 0.0], &[5.0, 5.0]).unwrap();
        assert_relative_eq!(free[0], 2.0, epsilon = 1e-5);
        assert_relative_eq!(free[1], 1.5, epsilon = 1e-5);
        let bounded = nonlinear(residuals, &[1.0, 0.5], &[0.0, 0.0], &[5.0, 1.0]).unwrap();
        assert!(bounded[1] <= 1.0 && bounded[1] > 0.99, "{}", bounded[1]);
    }

    #[test]
    fn an_error_of_the_residuals_ends_the_search() {
        let asked = Cell::new(0);
        let residuals = |p: &[f64]| {
            asked.set(asked.get() + 1);
            if asked.get() < 5 { Ok(vec![p[0] - 3.0, p[0] * p[0] - 5.0]) } else { Err(std::fmt::Error) }
        };
        assert!(nonlinear(residuals, &[1.0], &[0.0], &[9.0]).is_err());
        assert_eq!(asked.get(), 5, "it is not asked again");
    }
}
