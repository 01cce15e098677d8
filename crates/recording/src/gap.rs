//! Where a rhythm of times pauses.

/// A step longer than so many median steps is a gap: jitter alone reaches two, a lost sample between two jittered ones
/// stays below three, so three mean that at least two samples are missing.
pub(crate) const GAP_STEPS: f64 = 3.0;

/// Steps longer than this are gaps in a stretch of increasing times \[s\]; infinite where there are fewer than two.
pub(crate) fn threshold_s(t_s: &[f64]) -> f64 {
    median_step_s(t_s).map_or(f64::INFINITY, |step_s| GAP_STEPS * step_s)
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
}
