//! Streams of different rates on one clock.
//!
//! The rows are the stamps of one stream, the base. Every other stream is interpolated linearly at them between two
//! neighbours that lie no farther apart than a stated gap, angles on the shorter arc. Before its first sample, after its
//! last and across wider gaps a stream has no value: nothing is extrapolated.

use std::f64::consts::{PI, TAU};

use crate::gap::Gaps;

/// How values lie between their neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// On the straight line.
    Line,
    /// On the shorter arc, in −π to π.
    ShorterArc,
}

/// Values of a stream at other times; NaN where there is none.
///
/// `t_s` and `at_s` increase, `t_s` has one time per value. Samples that are NaN are none: whether their neighbours may
/// be joined is then the gap's to say.
pub fn interpolate(t_s: &[f64], values: &[f64], at_s: &[f64], max_gap_s: f64, between: Between) -> Vec<f64> {
    interpolate_within(t_s, values, at_s, Some(max_gap_s), between)
}

/// Values of a stream at other times, joined over gaps that were asked for or by the rhythm of its samples.
pub(crate) fn interpolate_within(
    t_s: &[f64],
    values: &[f64],
    at_s: &[f64],
    max_gap_s: Option<f64>,
    between: Between,
) -> Vec<f64> {
    let samples: Vec<(f64, f64)> =
        t_s.iter().copied().zip(values.iter().copied()).filter(|(_, value)| !value.is_nan()).collect();
    let samples_s: Vec<f64> = samples.iter().map(|sample| sample.0).collect();
    let gaps = Gaps::of(&samples_s, max_gap_s);
    let mut next = 0;
    let mut aligned = Vec::with_capacity(at_s.len());
    for &at in at_s {
        while samples.get(next).is_some_and(|sample| sample.0 < at) {
            next += 1;
        }
        let after = samples.get(next);
        let before = next.checked_sub(1).and_then(|last| samples.get(last));
        aligned.push(match (before, after) {
            (_, Some(&(t, value))) if t == at => value,
            (Some(&(t0, value0)), Some(&(t1, value1))) if !gaps.is_gap(&samples_s, next - 1) => {
                let share = (at - t0) / (t1 - t0);
                match between {
                    Between::Line => value0 + share * (value1 - value0),
                    Between::ShorterArc => wrapped(value0 + share * wrapped(value1 - value0)),
                }
            }
            _ => f64::NAN,
        });
    }
    aligned
}

/// The same angle in −π to π.
fn wrapped(angle_rad: f64) -> f64 {
    let turned = (angle_rad + PI).rem_euclid(TAU) - PI;
    if turned.is_finite() { turned } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    use super::*;

    fn line(t_s: &[f64], values: &[f64], at_s: &[f64]) -> Vec<f64> {
        interpolate(t_s, values, at_s, 1.5, Between::Line)
    }

    #[test]
    fn values_between_neighbours_are_interpolated_and_nothing_else_is() {
        let aligned = line(&[0.0, 1.0, 4.0], &[0.0, 2.0, 8.0], &[-0.1, 0.0, 0.25, 1.0, 2.0, 4.0, 4.1]);
        let known: Vec<Option<f64>> = aligned.iter().map(|v| (!v.is_nan()).then_some(*v)).collect();
        assert_eq!(known, [None, Some(0.0), Some(0.5), Some(2.0), None, Some(8.0), None]);
    }

    #[test]
    fn missing_samples_are_bridged_only_within_the_gap() {
        let nan = f64::NAN;
        let t_s = [0.0, 0.5, 1.0, 2.0, 3.0];
        let aligned = line(&t_s, &[0.0, nan, 1.0, nan, 3.0], &[0.5, 2.0]);
        assert_relative_eq!(aligned[0], 0.5);
        assert!(aligned[1].is_nan());
    }

    #[test]
    fn headings_turn_by_the_shorter_arc() {
        let aligned = interpolate(&[0.0, 1.0], &[3.0, -3.0], &[0.5], 2.0, Between::ShorterArc);
        assert_relative_eq!(aligned[0].abs(), PI, epsilon = 1e-12);
    }

    proptest! {
        #[test]
        fn a_straight_line_comes_back_exactly_wherever_it_is_sampled(
            slope in -5.0..5.0f64, offset in -5.0..5.0f64, shift in 0.0..1.0f64
        ) {
            let t_s: Vec<f64> = (0..50).map(f64::from).collect();
            let values: Vec<f64> = t_s.iter().map(|t| offset + slope * t).collect();
            let at_s: Vec<f64> = (0..49).map(|t| f64::from(t) + shift).collect();
            for (at, value) in at_s.iter().zip(line(&t_s, &values, &at_s)) {
                prop_assert!((value - (offset + slope * at)).abs() < 1e-9);
            }
        }
    }
}
