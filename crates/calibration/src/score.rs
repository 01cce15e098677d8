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
        Tally::of(predicted.iter().copied().zip(recorded.iter().copied())).score()
    }
}

/// What a score is made of, pair by pair; tallies of parts add up to that of the whole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Tally {
    pub(crate) count: usize,
    sum: f64,
    squares: f64,
    /// Mean of what was recorded, and the sum of squares about it.
    mean: f64,
    spread: f64,
    missed: f64,
    amount: f64,
}

impl Tally {
    pub(crate) fn of(pairs: impl Iterator<Item = (f64, f64)>) -> Tally {
        let mut tally = Tally::default();
        pairs.for_each(|(predicted, recorded)| tally.add(predicted, recorded));
        tally
    }

    /// Adds a pair of predicted and recorded values.
    #[inline]
    pub(crate) fn add(&mut self, predicted: f64, recorded: f64) {
        let error = predicted - recorded;
        self.count += 1;
        self.sum += error;
        self.squares += error * error;
        self.missed += error.abs();
        self.amount += recorded.abs();
        // Welford's updates: a constant stays without spread, however large.
        let from_mean = recorded - self.mean;
        self.mean += from_mean / self.count as f64;
        self.spread += from_mean * (recorded - self.mean);
    }

    /// Adds the pairs of another part.
    pub(crate) fn join(self, other: &Tally) -> Tally {
        let count = self.count + other.count;
        let apart = other.mean - self.mean;
        let share = other.count as f64 / count.max(1) as f64;
        Tally {
            count,
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
            mean: self.mean + apart * share,
            spread: self.spread + other.spread + apart * apart * share * self.count as f64,
            missed: self.missed + other.missed,
            amount: self.amount + other.amount,
        }
    }

    pub(crate) fn score(&self) -> Score {
        let n = self.count as f64;
        Score {
            count: self.count,
            bias: self.sum / n,
            rmse: (self.squares / n).sqrt(),
            r2: if self.spread > 0.0 { 1.0 - self.squares / self.spread } else { f64::NAN },
            normalized_error_percent: 100.0 * self.missed / self.amount,
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
    fn tallies_of_parts_add_up_to_that_of_the_whole() {
        let pairs = |range: std::ops::Range<i32>| {
            range.map(|i| (f64::from(i * 7 % 11), f64::from(i * 5 % 13))).collect::<Vec<_>>()
        };
        let whole = Tally::of(pairs(0..40).into_iter()).score();
        let parts = [0..3, 3..3, 3..17, 17..40].map(|range| Tally::of(pairs(range).into_iter()));
        let joined = parts.iter().fold(Tally::default(), |all, part| all.join(part)).score();
        assert_eq!(whole.count, joined.count);
        for (a, b) in [(whole.bias, joined.bias), (whole.rmse, joined.rmse), (whole.r2, joined.r2)] {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        // By definition, about the mean.
        let recorded: Vec<f64> = pairs(0..40).iter().map(|pair| pair.1).collect();
        let mean = recorded.iter().sum::<f64>() / 40.0;
        let spread: f64 = recorded.iter().map(|r| (r - mean).powi(2)).sum();
        let missed: f64 = pairs(0..40).iter().map(|(p, r)| (p - r).powi(2)).sum();
        assert!((whole.r2 - (1.0 - missed / spread)).abs() < 1e-12);
    }

    #[test]
    fn the_median_of_an_even_count_lies_between_the_middle_two() {
        assert_eq!(median(&[4.0, 1.0, 3.0, 2.0]), 2.5);
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
    }
}
