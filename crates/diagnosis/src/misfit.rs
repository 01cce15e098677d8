//! How well a fit explains the drives: squared errors that nothing takes, what departures from the robot's file cost included.

use crate::{
    average::Quantity,
    baseline::Baseline,
    series::Series,
    weigh::{Sizes, system_of},
};

/// Squares of each quantity, in the order of [`Quantity::ALL`].
pub(crate) type Squares = [f64; Quantity::ALL.len()];

/// Squared errors by the noise of another fit, so that fits can be compared.
pub(crate) fn misfit(series: &Series, fit: &Baseline, by: &Baseline) -> f64 {
    by_quantity(series, fit, by).iter().sum()
}

/// The same with mechanisms' sizes at their best, as far as power follows them in proportion.
pub(crate) fn least_misfit(series: &Series, fit: &Baseline, by: &Baseline) -> f64 {
    system_of(series, fit, Sizes::Free, by).left().norm_squared()
}

/// The same as [`misfit`] of each quantity; departures from the robot's file count as power.
pub(crate) fn by_quantity(series: &Series, fit: &Baseline, by: &Baseline) -> Squares {
    let system = system_of(series, fit, Sizes::Fixed, by);
    let mut squares = Squares::default();
    for (i, left) in system.left().iter().enumerate() {
        let quantity = series.averages.get(i).map_or(Quantity::Power, |average| average.quantity());
        squares[quantity as usize] += left * left;
    }
    squares
}
