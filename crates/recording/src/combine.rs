//! How several columns or fields become one value.

use std::{borrow::Cow, ops::Range};

use serde::{Deserialize, Serialize};

use crate::align::{Between, interpolate_within};

/// How several columns or fields become one value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Combine {
    /// Their mean, as of the wheels of a side.
    #[default]
    Mean,
    /// Their sum, as of currents.
    Sum,
    /// Their product, as of current and voltage.
    Product,
    /// Rim speed of the left side from odometry: of speed v and yaw rate ω, v − ω b/2, b the map's `wheel_separation_m`.
    LeftOfTwist,
    /// That of the right side: v + ω b/2.
    RightOfTwist,
    /// Time of whole seconds and of nanoseconds beside them, as `secs` and `nsecs` of a ROS stamp.
    SecondsAndNanoseconds,
}

impl Combine {
    /// Whether it takes a speed and a yaw rate.
    pub(crate) fn is_of_twist(self) -> bool {
        matches!(self, Combine::LeftOfTwist | Combine::RightOfTwist)
    }

    /// One value of several; NaN when one of them is. A twist's needs the separation of the wheels \[m\].
    pub(crate) fn of(self, values: impl Iterator<Item = f64>, separation_m: f64) -> f64 {
        let half_m = match self {
            Combine::LeftOfTwist => -0.5 * separation_m,
            Combine::RightOfTwist => 0.5 * separation_m,
            _ => 0.0,
        };
        if self == Combine::SecondsAndNanoseconds {
            return values.zip([1.0, 1e-9]).map(|(value, by)| by * value).sum();
        }
        if self.is_of_twist() {
            return values.zip([1.0, half_m]).map(|(value, by)| by * value).sum();
        }
        let (mut count, mut sum, mut product) = (0.0, 0.0, 1.0);
        for value in values {
            count += 1.0;
            sum += value;
            product *= value;
        }
        match self {
            Combine::Mean => sum / count,
            Combine::Sum => sum,
            Combine::Product => product,
            Combine::LeftOfTwist | Combine::RightOfTwist | Combine::SecondsAndNanoseconds => f64::NAN,
        }
    }
}

impl Combine {
    /// One column of several of the same rows, none of which is a twist's.
    pub(crate) fn of_rows(self, parts: &[Vec<f64>]) -> Vec<f64> {
        let rows = parts.iter().map(Vec::len).min().unwrap_or(0);
        (0..rows).map(|row| self.of(parts.iter().map(|part| part[row]), f64::NAN)).collect()
    }

    /// One column of several of the same rows. Where they have samples in different rows, as topics joined on the union of their stamps
    /// have, those of the column with most are the result's, at which the others are interpolated linearly over three of their own steps.
    pub(crate) fn of_columns<P: AsRef<[f64]>>(self, t_s: &[f64], parts: &[P], separation_m: f64) -> Vec<f64> {
        let parts: Vec<&[f64]> = parts.iter().map(AsRef::as_ref).collect();
        let samples = |part: &[f64]| part.iter().filter(|value| !value.is_nan()).count();
        let most = parts.iter().map(|part| samples(part)).max().unwrap_or(0);
        let base = parts.iter().position(|part| samples(part) == most).unwrap_or(0);
        let rows = parts.iter().map(|part| part.len()).min().unwrap_or(0);
        let is_whole = most == rows && parts.iter().all(|part| samples(part) == rows);
        let aligned: Vec<Cow<'_, [f64]>> = parts
            .iter()
            .enumerate()
            .map(|(index, part)| match is_whole || index == base || t_s.len() != part.len() {
                true => Cow::Borrowed(*part),
                false => Cow::Owned(filled(t_s, part)),
            })
            .collect();
        (0..rows).map(|row| self.of(aligned.iter().map(|part| part[row]), separation_m)).collect()
    }
}

/// A column with its short holes filled, stretch by stretch of increasing time.
fn filled(t_s: &[f64], values: &[f64]) -> Vec<f64> {
    let mut filled = Vec::with_capacity(values.len());
    for rows in increasing(t_s) {
        let samples_s: Vec<f64> =
            rows.clone().filter(|row| !values[*row].is_nan()).map(|row| t_s[row]).collect();
        // Two samples show no rhythm.
        let longest_s = (samples_s.len() <= 2).then_some(0.0);
        let own = &values[rows.clone()];
        filled.extend(interpolate_within(&t_s[rows.clone()], own, &t_s[rows], longest_s, Between::Line));
    }
    filled
}

/// Stretches of rows whose time increases.
fn increasing(t_s: &[f64]) -> Vec<Range<usize>> {
    let mut start = 0;
    let stretch = |rows: &[f64]| {
        start += rows.len();
        start - rows.len()..start
    };
    t_s.chunk_by(|before, after| after > before).map(stretch).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_different_rows_are_combined_at_those_of_the_one_with_most() {
        let nan = f64::NAN;
        let t_s: Vec<f64> = (0..8).map(f64::from).collect();
        let current_a = [1.0, nan, 2.0, nan, 3.0, nan, 4.0, nan];
        let voltage_v = [nan, 10.0, nan, 20.0, nan, 30.0, nan, nan];
        let power_w = Combine::Product.of_columns(&t_s, &[&current_a, &voltage_v], f64::NAN);
        let known: Vec<Option<f64>> = power_w.iter().map(|w| (!w.is_nan()).then_some(*w)).collect();
        assert_eq!(known, [None, None, Some(30.0), None, Some(75.0), None, None, None]);
        assert_eq!(Combine::Sum.of_columns(&[], &[&[1.0, 2.0], &[3.0, nan]], f64::NAN)[0], 4.0);
        assert_eq!(increasing(&[0.0, 1.0, 0.0, 1.0, 1.0]), [0..2, 2..4, 4..5]);
    }
}
