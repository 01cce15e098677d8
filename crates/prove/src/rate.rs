//! A share of cases, with what so few cases say about it.

use serde::Serialize;
use statrs::distribution::{Beta, ContinuousCDF};

/// How often something happened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Rate {
    /// So often.
    pub hits: usize,
    /// Of so many.
    pub of: usize,
    /// 95 % interval of the chance of it, after Clopper and Pearson (Biometrika 26, 1934).
    pub interval_95: [f64; 2],
}

impl Rate {
    /// So many of so many.
    pub fn new(hits: usize, of: usize) -> Self {
        Rate { hits, of, interval_95: [lower(hits, of), 1.0 - lower(of - hits.min(of), of)] }
    }

    /// How many of these say yes.
    pub fn of(answers: impl IntoIterator<Item = bool>) -> Self {
        let (mut hits, mut of) = (0, 0);
        for answer in answers {
            hits += usize::from(answer);
            of += 1;
        }
        Rate::new(hits, of)
    }

    /// The share; none of no cases.
    pub fn share(&self) -> Option<f64> {
        (self.of > 0).then(|| self.hits as f64 / self.of as f64)
    }
}

/// Chance below which as many hits would be seen once in forty.
fn lower(hits: usize, of: usize) -> f64 {
    if hits == 0 {
        return 0.0;
    }
    Beta::new(hits as f64, (of - hits.min(of)) as f64 + 1.0).map_or(0.0, |beta| beta.inverse_cdf(0.025))
}

/// The median; none of no numbers.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        n if n % 2 == 1 => Some(values[middle]),
        _ => Some((values[middle - 1] + values[middle]) / 2.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_those_of_the_tables() {
        // Exact binomial limits; for no hits the upper one is 1 - 0.025^(1/n).
        for (hits, of, [low, high]) in [
            (0, 60, [0.0, 1.0 - 0.025_f64.powf(1.0 / 60.0)]),
            (10, 10, [0.025_f64.powf(0.1), 1.0]),
            (5, 10, [0.18709, 0.81291]),
            (1, 20, [0.00127, 0.24873]),
        ] {
            let found = Rate::new(hits, of).interval_95;
            assert!(
                (found[0] - low).abs() < 1e-4 && (found[1] - high).abs() < 1e-4,
                "{hits}/{of}: {found:?}"
            );
        }
    }

    #[test]
    fn of_no_cases_nothing_is_known() {
        let none = Rate::new(0, 0);
        assert_eq!((none.share(), none.interval_95), (None, [0.0, 1.0]));
    }

    #[test]
    fn medians_lie_in_the_middle() {
        assert_eq!(median([3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median([4.0, 1.0, 2.0, f64::NAN, 3.0]), Some(2.5));
        assert_eq!(median([]), None);
    }
}
