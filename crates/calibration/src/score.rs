//! How well a prediction holds against what was recorded.

use serde::Serialize;

/// Differences between predicted and recorded values of one unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Score {
    /// Values compared.
    pub count: usize,
    /// Mean of predicted less recorded.
    pub bias: f64,
    /// Root mean square of predicted less recorded.
    pub rmse: f64,
    /// R² = 1 − SSE/SST about the mean of what was recorded; NaN where that is constant.
    pub r2: f64,
    /// 100 Σ|predicted − recorded| / Σ|recorded|: eq. 17 of Dogru & Marques (2018), each value weighted by what was recorded \[%\].
    pub normalized_error_percent: f64,
}

impl Score {
    /// Compares pairs of predicted and recorded values; NaN for none.
    pub fn of(predicted: &[f64], recorded: &[f64]) -> Score {
        let count = predicted.len().min(recorded.len());
        let n = count as f64;
        let mean = recorded.iter().sum::<f64>() / n;
        let (mut sum, mut squares, mut spread) = (0.0, 0.0, 0.0);
        let (mut missed, mut amount) = (0.0, 0.0);
        for (p, r) in predicted.iter().zip(recorded) {
            sum += p - r;
            squares += (p - r).powi(2);
            spread += (r - mean).powi(2);
            missed += (p - r).abs();
            amount += r.abs();
        }
        let r2 = if spread > 0.0 { 1.0 - squares / spread } else { f64::NAN };
        Score {
            count,
            bias: sum / n,
            rmse: (squares / n).sqrt(),
            r2,
            normalized_error_percent: 100.0 * missed / amount,
        }
    }
}

/// The middle of values by size; NaN for none.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => sorted[middle],
        _ => (sorted[middle - 1] + sorted[middle]) / 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_prediction_of_the_mean_explains_nothing_and_the_truth_everything() {
        let recorded = [1.0, 2.0, 3.0];
        assert!((Score::of(&[2.0; 3], &recorded).r2).abs() < 1e-12);
        assert_eq!(Score::of(&recorded, &recorded).r2, 1.0);
        assert!((Score::of(&[2.0, 3.0, 4.0], &recorded).bias - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_median_of_an_even_count_lies_between_the_middle_two() {
        assert_eq!(median(&[4.0, 1.0, 3.0, 2.0]), 2.5);
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
    }
}
