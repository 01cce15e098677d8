//! Power meters that are slower than the wheels.
//!
//! Between two readings of such a meter a robot starts, turns and stops. A reading is then the mean over a period, not the power of one
//! moment, and has to be compared with the mean of what is predicted over that period: rows stay as dense as the wheels' samples, each
//! reading holds over the rows of its period, and [`Recording::reading_ends`](crate::Recording::reading_ends) tells where each ends.

use crate::gap::{self, Gaps};

/// Readings that are at least so far apart are held over their period \[s\]: half of the second over which power is compared, so that no mean over
/// one would have two readings inside it.
const SLOW_S: f64 = 0.5;
/// Rows of the wheels in a period, at least, for its mean to tell more than a row.
const LEAST_ROWS: f64 = 2.0;

/// Whether a meter with these steps is slower than the wheels, and nobody said that values may not be taken over its steps.
pub(crate) fn is_slow(meter_step_s: f64, wheel_step_s: f64, max_gap_s: Option<f64>) -> bool {
    meter_step_s >= SLOW_S
        && meter_step_s >= LEAST_ROWS * wheel_step_s
        && max_gap_s.is_none_or(|gap_s| gap_s >= meter_step_s)
}

/// Readings of a slow meter, as (time \[s\], value), laid over rows.
pub(crate) struct Held {
    /// By row the reading of its period; NaN where there is none.
    pub(crate) values: Vec<f64>,
    /// By row, whether it is the last of a period.
    pub(crate) ends: Vec<bool>,
}

/// Holds every reading over the rows since the reading before it, or over one median step where that is farther away than a gap.
pub(crate) fn held(readings: &[(f64, f64)], at_s: &[f64]) -> Held {
    let own_s: Vec<f64> = readings.iter().map(|reading| reading.0).collect();
    let (gaps, step_s) = (Gaps::of(&own_s, None), gap::median_step_s(&own_s).unwrap_or(0.0));
    let mut held = Held { values: vec![f64::NAN; at_s.len()], ends: vec![false; at_s.len()] };
    let (mut first, mut before_s) = (0, f64::NEG_INFINITY);
    for (reading, (t_s, value)) in readings.iter().enumerate() {
        let is_behind_gap = reading == 0 || gaps.is_gap(&own_s, reading - 1);
        let begins_s = if is_behind_gap { t_s - step_s } else { before_s };
        while at_s.get(first).is_some_and(|at| *at <= begins_s) {
            first += 1;
        }
        let start = first;
        while at_s.get(first).is_some_and(|at| at <= t_s) {
            first += 1;
        }
        held.values[start..first].fill(*value);
        if first > start {
            held.ends[first - 1] = true;
        }
        before_s = *t_s;
    }
    held
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_holds_since_the_one_before_and_one_step_back_after_a_gap() {
        let at_s: Vec<f64> = (0..40).map(|row| 0.5 * f64::from(row)).collect();
        let readings = [(2.0, 1.0), (4.0, 2.0), (6.0, 3.0), (16.0, 4.0)];
        let held = held(&readings, &at_s);
        let of = |t_s: f64| held.values[(2.0 * t_s) as usize];
        assert!(of(0.0).is_nan() && of(2.5) == 2.0 && of(4.0) == 2.0 && of(4.5) == 3.0);
        assert!(of(6.5).is_nan() && of(14.0).is_nan() && of(14.5) == 4.0 && of(16.5).is_nan());
        let ends: Vec<usize> = (0..40).filter(|row| held.ends[*row]).collect();
        assert_eq!(ends, [4, 8, 12, 32]);
    }

    #[test]
    fn meters_as_fast_as_wheels_or_forbidden_to_bridge_are_not_slow() {
        assert!(is_slow(2.0, 0.1, None) && is_slow(0.5, 0.1, Some(1.0)));
        assert!(!is_slow(0.2, 0.05, None) && !is_slow(1.0, 1.0, None) && !is_slow(2.0, 0.1, Some(0.5)));
    }
}
