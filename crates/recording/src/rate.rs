//! Speeds from positions: joints that tell how far they have turned, or counters of encoder ticks.

/// Rates of change of positions, by central differences between neighbours that are known; NaN where there are none.
///
/// A counter that begins again after `wraps_at` goes the shorter way round.
pub(crate) fn rates(t_s: &[f64], positions: &[f64], wraps_at: Option<f64>) -> Vec<f64> {
    let known: Vec<usize> = (0..positions.len()).filter(|at| !positions[*at].is_nan()).collect();
    let step = |from: usize, to: usize| {
        let moved = positions[to] - positions[from];
        match wraps_at {
            Some(wraps_at) => moved - wraps_at * (moved / wraps_at).round(),
            None => moved,
        }
    };
    let mut rates = vec![f64::NAN; positions.len()];
    for (place, at) in known.iter().enumerate() {
        let before = place.checked_sub(1).map(|place| known[place]);
        let after = known.get(place + 1).copied();
        let ends = [before.unwrap_or(*at), after.unwrap_or(*at)];
        let moved =
            before.map_or(0.0, |before| step(before, *at)) + after.map_or(0.0, |after| step(*at, after));
        let span_s = t_s[ends[1]] - t_s[ends[0]];
        if span_s > 0.0 {
            rates[*at] = moved / span_s;
        }
    }
    rates
}

/// Positions of a counter that goes on where it begins again.
pub(crate) fn unwrapped(positions: &[f64], wraps_at: f64) -> Vec<f64> {
    let (mut last, mut turns) = (f64::NAN, 0.0);
    let mut go_on = |position: f64| {
        if !position.is_nan() {
            if !last.is_nan() {
                turns -= ((position - last) / wraps_at).round();
            }
            last = position;
        }
        position + wraps_at * turns
    };
    positions.iter().map(|position| go_on(*position)).collect()
}

/// A counter's value that it cannot have, where it begins again before: those of a counter from zero lie below `wraps_at`, and those of one with
/// a sign within half of it.
pub(crate) fn beyond_wrap(positions: &[f64], wraps_at: f64) -> Option<f64> {
    let known = || positions.iter().copied().filter(|position| position.is_finite());
    let [least, greatest] =
        known().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    let farthest = if greatest.abs() >= least.abs() { greatest } else { least };
    (greatest - least > wraps_at || farthest.abs() > wraps_at).then_some(farthest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_counter_goes_on_where_it_begins_again() {
        let nan = f64::NAN;
        let on = unwrapped(&[8.0, 9.0, nan, 1.0, 9.0, 8.0], 10.0);
        assert_eq!([on[0], on[1], on[3], on[4], on[5]], [8.0, 9.0, 11.0, 9.0, 8.0]);
    }

    #[test]
    fn an_even_motion_has_its_rate_everywhere_across_holes_and_wraps() {
        let t_s: Vec<f64> = (0..100).map(|i| 0.1 * f64::from(i)).collect();
        let positions: Vec<f64> = t_s.iter().map(|t| (1000.0 + 300.0 * t).rem_euclid(1024.0)).collect();
        assert!(rates(&t_s, &positions, Some(1024.0)).iter().all(|rate| (rate - 300.0).abs() < 1e-6));
        let mut holed: Vec<f64> = t_s.iter().map(|t| -2.0 * t).collect();
        holed[50] = f64::NAN;
        let found = rates(&t_s, &holed, None);
        assert!(found[50].is_nan() && found.iter().filter(|rate| (*rate + 2.0).abs() < 1e-9).count() == 99);
        assert!(rates(&[1.0], &[5.0], None)[0].is_nan());
    }

    #[test]
    fn a_counter_that_begins_again_has_no_values_beyond() {
        assert_eq!(beyond_wrap(&[0.0, 1023.0, f64::NAN, 5.0], 1024.0), None);
        assert_eq!(beyond_wrap(&[-32_768.0, 32_767.0], 65_536.0), None);
        assert_eq!(beyond_wrap(&[3.0, 65_000.0], 100.0), Some(65_000.0));
        assert_eq!(beyond_wrap(&[-80.0, 60.0], 100.0), Some(-80.0));
    }
}
