//! How far drives climb by their heights, beside the slopes that were read on the way.
//!
//! An inclinometer that is askew reads slopes that heights do not show; what holds the robot back changes neither.

use calibration::Drives;
use recording::{Channel, Recording};

/// Length of the stretches whose climb is compared [s]: long enough that a slope counts for more than the noise of both heights.
const WINDOW_S: f64 = 20.0;
/// Longest gap that a stretch may have [s].
const MOST_GAP_S: f64 = 3.0;
/// Stretches from which climbs are told.
const LEAST_WINDOWS: usize = 10;
/// Climbs of drives of one kind.
pub(crate) struct Climb {
    /// By average: that from which the climb up to it counts, where one ends.
    began: Vec<Option<usize>>,
    /// Climb up to each average by heights; NaN where none ends [m].
    risen_m: Vec<f64>,
    /// Time by average.
    t_s: Vec<f64>,
}

impl Climb {
    /// The climbs of a recording, where it has heights, and slopes that were not told by them.
    pub(crate) fn of(recording: &Recording, drives: &Drives) -> Option<Climb> {
        recording.channel(Channel::Pitch)?;
        let height_m = drives.averaged(recording.channel(Channel::Z)?);
        let t_s: Vec<f64> = drives.averages.iter().map(|average| average.t_s).collect();
        let run: Vec<usize> = drives.averages.iter().map(|average| average.run).collect();
        let (mut began, mut risen_m) = (vec![None; t_s.len()], vec![f64::NAN; t_s.len()]);
        let mut first: Option<usize> = None;
        for i in 0..t_s.len() {
            let goes_on = i > 0 && run[i] == run[i - 1] && t_s[i] - t_s[i - 1] <= MOST_GAP_S;
            first = first.filter(|_| goes_on);
            if !height_m[i].is_finite() {
                continue;
            }
            match first {
                Some(start) if t_s[i] - t_s[start] >= WINDOW_S => {
                    (began[i], risen_m[i]) = (Some(start), height_m[i] - height_m[start]);
                    first = Some(i);
                }
                Some(_) => {}
                None => first = Some(i),
            }
        }
        let is_told = began.iter().flatten().count() >= LEAST_WINDOWS;
        is_told.then_some(Climb { began, risen_m, t_s })
    }

    /// Climbs by heights, average by average; NaN where none ends [m].
    pub(crate) fn risen_m(&self) -> &[f64] {
        &self.risen_m
    }

    /// What comes of a rate, average by average, from the beginning of each climb to its end; NaN where none ends.
    pub(crate) fn summed(&self, rate_per_s: &[f64]) -> Vec<f64> {
        let between = |i: usize| 0.5 * (rate_per_s[i] + rate_per_s[i + 1]) * (self.t_s[i + 1] - self.t_s[i]);
        let of = |(i, began): (usize, &Option<usize>)| {
            began.map_or(f64::NAN, |began| (began..i).map(between).sum())
        };
        self.began.iter().enumerate().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_rate_sums_to_is_told_where_a_climb_ends() {
        let climb = Climb {
            began: (0..600).map(|i| (i % 300 >= 20 && i % 20 == 0).then(|| i - 20)).collect(),
            risen_m: vec![f64::NAN; 600],
            t_s: (0..600).map(|i| (i % 300) as f64).collect(),
        };
        let driven_m = climb.summed(&[0.5; 600]);
        assert!((driven_m[40] - 10.0).abs() < 1e-12, "20 s at 0.5 m/s: {} m", driven_m[40]);
        assert!(driven_m[41].is_nan() && driven_m[300].is_nan(), "no climb ends there");
    }
}
