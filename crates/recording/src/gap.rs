//! Where a rhythm of times pauses.

/// A step longer than so many median steps is a gap: jitter alone reaches two, a lost sample between two jittered ones
/// stays below three, so three mean that at least two samples are missing.
pub(crate) const GAP_STEPS: f64 = 3.0;

/// Rounding of a clock's numbers that steps are compared with, as a share of a step.
pub(crate) const STEP_ROUNDING: f64 = 1e-3;

/// Steps in a row that are a rhythm: so many pauses of one length do not come by chance.
const RHYTHM_STEPS: usize = 10;

/// How much the longest step of a rhythm may be of the shortest.
const EVEN: f64 = 1.5;

/// A step longer than so many of an even rhythm on both sides of it is a gap, whatever rhythm most of the times have.
const DROPOUT_STEPS: f64 = 10.0;

/// Steps longer than this are gaps in a stretch of increasing times, unless the rhythm around them is as slow \[s\]; infinite where
/// there are fewer than two.
pub(crate) fn threshold_s(t_s: &[f64]) -> f64 {
    median_step_s(t_s).map_or(f64::INFINITY, |step_s| GAP_STEPS * step_s)
}

/// Which steps of increasing times are gaps.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Gaps {
    /// Those longer than was asked for \[s\].
    Longer(f64),
    /// Those out of the rhythm around them; where there is none, those longer than this \[s\].
    OutOfRhythm(f64),
}

impl Gaps {
    /// The gaps of some times by their own rhythm, or those longer than was asked for.
    pub(crate) fn of(t_s: &[f64], asked_s: Option<f64>) -> Gaps {
        asked_s.map_or_else(|| Gaps::OutOfRhythm(threshold_s(t_s)), Gaps::Longer)
    }

    /// Whether the step behind a time is a gap.
    pub(crate) fn is_gap(self, t_s: &[f64], at: usize) -> bool {
        match self {
            Gaps::Longer(longest_s) => t_s[at + 1] - t_s[at] > longest_s,
            Gaps::OutOfRhythm(longest_s) => is_out_of_rhythm(t_s, at, longest_s),
        }
    }
}

fn is_out_of_rhythm(t_s: &[f64], at: usize, longest_s: f64) -> bool {
    let step_s = t_s[at + 1] - t_s[at];
    if step_s > longest_s {
        // A log may begin at 1 Hz and go on at 10 Hz, or tell once a minute that the robot is parked.
        let first = at.saturating_sub(RHYTHM_STEPS);
        return !(first..=at + 1)
            .any(|from| rhythm(t_s, from).is_some_and(|[least_s, _]| step_s <= GAP_STEPS * least_s));
    }
    let is_like_the_last = at > 0 && step_s <= GAP_STEPS * (t_s[at] - t_s[at - 1]);
    if is_like_the_last {
        return false;
    }
    let before = at.checked_sub(RHYTHM_STEPS).and_then(|from| rhythm(t_s, from));
    let is_dropout = |[_, most_s]: [f64; 2]| step_s > DROPOUT_STEPS * most_s;
    before.is_some_and(is_dropout) && rhythm(t_s, at + 1).is_some_and(is_dropout)
}

/// Least and greatest of the steps behind a time, if they are an even rhythm.
fn rhythm(t_s: &[f64], from: usize) -> Option<[f64; 2]> {
    let steps = t_s.get(from..=from + RHYTHM_STEPS)?.windows(2).map(|pair| pair[1] - pair[0]);
    let [least, most] = steps.fold([f64::INFINITY, 0.0], |[l, m], step| [step.min(l), step.max(m)]);
    (most <= EVEN * least).then_some([least, most])
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

    /// Lengths of the steps that are gaps \[s\].
    fn gaps(steps_s: &[(usize, f64)]) -> Vec<f64> {
        let mut t_s = vec![0.0];
        for (count, step_s) in steps_s {
            (0..*count).for_each(|_| t_s.push(t_s[t_s.len() - 1] + step_s));
        }
        let gaps = Gaps::of(&t_s, None);
        let found = (0..t_s.len() - 1).filter(|at| gaps.is_gap(&t_s, *at));
        found.map(|at| (100.0 * (t_s[at + 1] - t_s[at])).round() / 100.0).collect()
    }

    #[test]
    fn a_rhythm_that_is_kept_for_a_while_is_no_row_of_gaps() {
        assert!(gaps(&[(20, 1.0), (200, 0.1)]).is_empty());
        assert!(gaps(&[(20, 1.0), (20, 0.1)]).is_empty());
        assert!(gaps(&[(200, 0.1), (12, 60.0)]).is_empty());
        let paused: Vec<(usize, f64)> = [(39, 0.1), (1, 5.0)].repeat(7);
        assert_eq!(gaps(&paused), [5.0; 7]);
    }

    #[test]
    fn a_dropout_is_a_gap_whatever_rhythm_other_rows_have() {
        assert_eq!(gaps(&[(100, 0.1), (1, 100.0), (100, 0.1), (12, 60.0)]), [100.0]);
        assert_eq!(gaps(&[(100, 0.1), (1, 100.0), (100, 0.1), (900, 60.0)]), [100.0]);
        assert_eq!(gaps(&[(20, 1.0), (200, 0.1), (1, 2.0), (200, 0.1)]), [2.0]);
        assert_eq!(gaps(&[(30, 0.1), (1, 0.5), (30, 0.1)]), [0.5]);
    }
}
