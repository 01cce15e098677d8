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
/// One sigma by which slopes by heights and by an inclinometer differ between drives before any were seen [rad]: what a calibrated
/// inclinometer of a ground robot drifts by from day to day, some hundredths of a degree.
const USUAL_CHANGE_RAD: f64 = 5e-4;

/// Climbs of drives of one kind.
pub(crate) struct Climb {
    /// By average: that from which the climb up to it counts, where one ends.
    began: Vec<Option<usize>>,
    /// Climb up to each average by heights; NaN where none ends [m].
    risen_m: Vec<f64>,
    /// Time and drive by average.
    t_s: Vec<f64>,
    run: Vec<usize>,
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
        is_told.then_some(Climb { began, risen_m, t_s, run })
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

    /// One sigma by which slopes by heights and as they were read differ between drives, by rates of climbing as they were read and by
    /// speeds, average by average [rad].
    pub(crate) fn change_rad(&self, climb_mps: &[f64], speed_mps: &[f64]) -> f64 {
        let (climbed_m, driven_m) = (self.summed(climb_mps), self.summed(speed_mps));
        let runs = self.run.iter().max().map_or(0, |last| last + 1);
        let mut sums = vec![[0.0; 2]; runs];
        for (i, risen_m) in self.risen_m.iter().enumerate() {
            let off_m = climbed_m[i] - risen_m;
            if off_m.is_finite() && driven_m[i].is_finite() {
                let [both, own] = &mut sums[self.run[i]];
                *both += off_m * driven_m[i];
                *own += driven_m[i] * driven_m[i];
            }
        }
        let off_rad: Vec<f64> =
            sums.iter().filter(|[_, own]| *own > 0.0).map(|[both, own]| both / own).collect();
        let count = off_rad.len().max(1) as f64;
        let mean_rad = off_rad.iter().sum::<f64>() / count;
        // What is usual counts as one drive more.
        let apart = off_rad.iter().map(|rad| (rad - mean_rad).powi(2)).sum::<f64>();
        ((USUAL_CHANGE_RAD.powi(2) + apart) / count).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two drives of 300 s at 0.5 m/s over hills, with the rates of climbing by slopes that were read too steep by so much.
    fn drives(too_steep_rad: [f64; 2]) -> (Climb, Vec<f64>, Vec<f64>) {
        let slope_rad = |i: usize| 0.05 * (0.1 * i as f64).sin();
        let climb_mps: Vec<f64> = (0..600).map(|i| 0.5 * (slope_rad(i) + too_steep_rad[i / 300])).collect();
        let true_mps: Vec<f64> = (0..600).map(|i| 0.5 * slope_rad(i)).collect();
        let mut climb = Climb {
            began: (0..600).map(|i| (i % 300 >= 20 && i % 20 == 0).then(|| i - 20)).collect(),
            risen_m: vec![f64::NAN; 600],
            t_s: (0..600).map(|i| (i % 300) as f64).collect(),
            run: (0..600).map(|i| i / 300).collect(),
        };
        climb.risen_m = climb.summed(&true_mps);
        (climb, climb_mps, vec![0.5; 600])
    }

    #[test]
    fn what_a_rate_sums_to_is_told_where_a_climb_ends() {
        let (climb, _, speed_mps) = drives([0.0; 2]);
        let driven_m = climb.summed(&speed_mps);
        assert!((driven_m[40] - 10.0).abs() < 1e-12, "20 s at 0.5 m/s: {} m", driven_m[40]);
        assert!(driven_m[41].is_nan() && driven_m[300].is_nan(), "no climb ends there");
    }

    #[test]
    fn slopes_differ_from_heights_as_they_do_between_drives_and_no_less_than_usual() {
        let (climb, climb_mps, speed_mps) = drives([0.003, 0.003]);
        let usual_rad = climb.change_rad(&climb_mps, &speed_mps);
        assert!((usual_rad - USUAL_CHANGE_RAD / 2.0_f64.sqrt()).abs() < 1e-9, "{usual_rad}");
        let (climb, climb_mps, speed_mps) = drives([0.003, 0.007]);
        let apart_rad = climb.change_rad(&climb_mps, &speed_mps);
        assert!((apart_rad - 0.002).abs() < 1e-4, "{apart_rad}");
    }
}
