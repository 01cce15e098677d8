//! Times that repeat because they were rounded.

use crate::gap::median_step_s;

/// Fewer repeats are rows that were written twice.
const LEAST_REPEATS: usize = 3;

/// Rows of which at least one is a repeat, for times to be taken as rounded: 11 Hz in tenths of a second repeats one of eleven.
const ROWS_PER_REPEAT: usize = 20;

/// What of a run's times is equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Repeats {
    /// Different times.
    pub(crate) times: usize,
    /// Median step between them; `None` of one time.
    pub(crate) step_s: Option<f64>,
}

impl Repeats {
    /// The repeats of times that never go back, where there are as many as rounding makes.
    pub(crate) fn of(t_s: &[f64]) -> Option<Repeats> {
        if t_s.windows(2).any(|pair| pair[1] < pair[0]) {
            return None;
        }
        let mut times = t_s.to_vec();
        times.dedup();
        let repeats = t_s.len() - times.len();
        let is_rounded = repeats >= LEAST_REPEATS && ROWS_PER_REPEAT * repeats >= t_s.len();
        is_rounded.then(|| Repeats { times: times.len(), step_s: median_step_s(&times) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_repeats_are_rounding_and_a_few_are_not() {
        let rounded: Vec<f64> = (0..60).map(|row| f64::from(row / 10)).collect();
        assert_eq!(Repeats::of(&rounded), Some(Repeats { times: 6, step_s: Some(1.0) }));
        assert_eq!(Repeats::of(&[1.7e9; 60]), Some(Repeats { times: 1, step_s: None }));
        assert_eq!(Repeats::of(&[0.0, 0.1, 0.1, 0.2]), None);
        assert_eq!(Repeats::of(&[0.0, 0.0, 0.0, 0.0, -1.0]), None);
    }
}
