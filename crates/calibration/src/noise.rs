//! How far one-second averages scatter about a fit.

use crate::{Drives, correlation::Correlation, folds, score::median};

/// Share of the averages, at the lowest and at the highest predictions, whose spreads are compared.
const END_SHARE: usize = 3;

/// How far errors scatter, and how they hang together.
#[derive(Clone, Copy)]
pub(crate) struct Noise {
    /// Spread of a one-second average where nothing is predicted.
    floor: f64,
    /// Its growth with what is predicted.
    gain: f64,
    /// How neighbouring seconds err alike.
    pub(crate) correlation: Correlation,
}

impl Noise {
    /// Noise that grows with what is predicted, as that of power does, whose meter errs by a share of it. From the median errors of the
    /// third of the averages with the smallest predictions and of that with the largest,
    ///
    /// ```text
    /// sigma² = floor² + (gain · predicted)²
    /// ```
    pub(crate) fn growing(predicted: &[f64], recorded: &[f64], drives: &Drives) -> Noise {
        let errors: Vec<f64> = predicted.iter().zip(recorded).map(|(p, r)| p - r).collect();
        Noise::about(predicted, &errors, least(recorded)).correlated(predicted, &errors, drives)
    }

    /// Noise of one spread throughout, from the median error.
    pub(crate) fn even(predicted: &[f64], recorded: &[f64], drives: &Drives) -> Noise {
        let errors: Vec<f64> = predicted.iter().zip(recorded).map(|(p, r)| p - r).collect();
        let floor = spread(errors.iter().copied()).max(least(recorded));
        Noise { floor, gain: 0.0, correlation: Correlation::NONE }.correlated(predicted, &errors, drives)
    }

    fn correlated(self, predicted: &[f64], errors: &[f64], drives: &Drives) -> Noise {
        let clipped: Vec<f64> =
            (0..errors.len()).map(|i| (errors[i] / self.sigma(predicted[i])).clamp(-3.0, 3.0)).collect();
        Noise { correlation: Correlation::of(&clipped, &folds::series(drives)), ..self }
    }

    fn about(predicted: &[f64], errors: &[f64], least: f64) -> Noise {
        let mut order: Vec<usize> = (0..errors.len()).collect();
        order.sort_by(|a, b| predicted[*a].abs().total_cmp(&predicted[*b].abs()));
        let end = errors.len().div_ceil(END_SHARE);
        let [low, high] = [&order[..end], &order[errors.len() - end..]].map(|places| {
            let level = median(&places.iter().map(|&i| predicted[i].abs()).collect::<Vec<_>>());
            [level, spread(places.iter().map(|&i| errors[i]))].map(|x| x * x)
        });
        let whole = spread(errors.iter().copied()).max(least);
        let gain = if high[0] > low[0] { ((high[1] - low[1]) / (high[0] - low[0])).max(0.0) } else { 0.0 };
        if gain == 0.0 {
            return Noise { floor: whole, gain, correlation: Correlation::NONE };
        }
        let floor = (low[1] - gain * low[0]).max((LEAST_FLOOR * whole).powi(2)).sqrt();
        Noise { floor, gain: gain.sqrt(), correlation: Correlation::NONE }
    }

    /// Spread of a one-second average of which so much is predicted.
    fn sigma(&self, predicted: f64) -> f64 {
        self.floor.hypot(self.gain * predicted)
    }

    /// The spread of every average.
    pub(crate) fn sigmas(&self, predicted: &[f64]) -> Vec<f64> {
        predicted.iter().map(|p| self.sigma(*p)).collect()
    }

    /// One number for how noisy it is: the median spread, more where neighbours err alike.
    pub(crate) fn typical(&self, predicted: &[f64]) -> f64 {
        median(&self.sigmas(predicted)) * self.correlation.inflation().sqrt()
    }
}

/// The floor is no lower than this share of the spread over all, so that standstill does not decide everything.
const LEAST_FLOOR: f64 = 0.2;

/// Errors beyond so many sigmas count linearly: Huber's choice of 1.5 to 3 keeps 95 % efficiency or more on normal errors.
pub(crate) const LARGEST: f64 = 2.5;

/// The sigma of normal errors whose median magnitude is that of these.
fn spread(errors: impl Iterator<Item = f64>) -> f64 {
    /// Ratio of sigma to the median absolute error of a normal distribution.
    const SIGMA_PER_MEDIAN: f64 = 1.4826;
    SIGMA_PER_MEDIAN * median(&errors.map(f64::abs).collect::<Vec<_>>())
}

/// A spread below this share of what is recorded is rounding.
fn least(recorded: &[f64]) -> f64 {
    1e-6 * median(&recorded.iter().map(|r| r.abs()).collect::<Vec<_>>()).max(1e-3)
}
