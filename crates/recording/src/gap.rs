//! Where a rhythm of times pauses.

/// A step longer than so many median steps is a gap: jitter alone reaches two, a lost sample between two jittered ones
/// stays below three, so three mean that at least two samples are missing.
pub(crate) const GAP_STEPS: f64 = 3.0;

/// Steps longer than this are gaps in a stretch of increasing times \[s\]; infinite where there are fewer than two.
pub(crate) fn threshold_s(t_s: &[f64]) -> f64 {
    median_step_s(t_s).map_or(f64::INFINITY, |step_s| GAP_STEPS * step_s.max(slowest_rhythm_s(t_s)))
}

/// The longest step that is kept for a while, as where a log begins at 1 Hz and goes on at 10 Hz; 0 where none is.
fn slowest_rhythm_s(t_s: &[f64]) -> f64 {
    /// Steps in a row that are a rhythm: so many pauses of one length do not come by chance.
    const KEPT: usize = 10;
    /// How much the longest of them may be of the shortest.
    const EVEN: f64 = 1.5;
    let steps: Vec<f64> = t_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let even = |steps: &[f64]| {
        let [least, most] =
            steps.iter().fold([f64::INFINITY, 0.0], |[l, m], step| [step.min(l), step.max(m)]);
        if most <= EVEN * least { least } else { 0.0 }
    };
    steps.windows(KEPT).map(even).fold(0.0, f64::max)
}

/// The median step of increasing times \[s\].
pub(crate) fn median_step_s(t_s: &[f64]) -> Option<f64> {
    median(t_s.windows(2).map(|pair| pair[1] - pair[0]).collect())
}

/// The median; the upper one of an even number, `None` of no values.
pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    let (_, median, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_step_sets_the_threshold_and_one_time_has_none() {
        assert_eq!(median_step_s(&[0.0, 1.0, 2.0, 9.0]), Some(1.0));
        assert_eq!(threshold_s(&[0.0, 1.0, 2.0, 9.0]), 3.0);
        assert_eq!(threshold_s(&[4.0]), f64::INFINITY);
    }

    #[test]
    fn a_rhythm_that_is_kept_for_a_while_is_no_row_of_gaps() {
        let slow = (0..20).map(f64::from);
        let fast = (1..200).map(|i| 19.0 + 0.1 * f64::from(i));
        let both: Vec<f64> = slow.chain(fast).collect();
        assert_eq!(threshold_s(&both), 3.0);
        let paused: Vec<f64> = (0..300).map(|i| 0.1 * f64::from(i) + f64::from(i / 40) * 5.0).collect();
        assert!(threshold_s(&paused) < 0.31, "pauses now and then: {}", threshold_s(&paused));
    }
}
