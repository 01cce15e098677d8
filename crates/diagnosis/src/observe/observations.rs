//! Rows of all drives as the model sees them: regime, place in their series, and what they are of.

use std::ops::Range;

use model::{Robot, knowledge::Regimes};

use crate::{Average, Error, Series, evidence::noise::Place};

/// Channels beyond those of the sides' or the battery's power; see [`Average::channel`].
pub(crate) const REST: usize = 2;
pub(crate) const GROUND_SPEED: usize = 3;
pub(crate) const YAW_RATE: usize = 4;

/// Quantities that make up the regime: speed, difference of the sides' speeds, pitch, roll, acceleration.
pub(crate) const REGIME: usize = 5;

/// Longest step between neighbours of one series, in averages.
const LONGEST_STEP: f64 = 1.5;

/// Rows of all drives; those of the test drives come first.
pub(crate) struct Observations<'a> {
    /// The drives.
    pub(crate) series: &'a Series,
    /// Number of rows of the test drives.
    pub(crate) test_rows: usize,
    /// Place of each row in its series.
    pub(crate) places: Vec<Place>,
    /// Regime of each row, each quantity over its scatter in all drives.
    pub(crate) regimes: Vec<[f64; REGIME]>,
    /// Time driven at the middle of each row, all test drives behind one another and all healthy ones [s].
    pub(crate) driven_s: Vec<f64>,
    /// When each test drive begins on that scale, and the end of the last [s].
    pub(crate) begins_s: Vec<f64>,
}

impl<'a> Observations<'a> {
    /// Prepares the rows of drives of a robot.
    pub(crate) fn new(series: &'a Series, robot: &Robot) -> Self {
        let averages = &series.averages;
        let test_rows = averages.iter().filter(|average| average.suspect).count();
        let begins_s = begins_s(&averages[..test_rows]);
        let healthy_begins_s = self::begins_s(&averages[test_rows..]);
        let driven_s = averages
            .iter()
            .map(|a| if a.suspect { begins_s[a.run] } else { healthy_begins_s[a.run] } + a.t_s)
            .collect();
        let longest_step_s = LONGEST_STEP * series.average_s();
        let place = |i: usize| Place {
            channel: averages[i].channel,
            follows: i > 0 && follows(&averages[i - 1], &averages[i], longest_step_s),
        };
        Observations {
            series,
            test_rows,
            places: (0..averages.len()).map(place).collect(),
            regimes: regimes(averages, robot),
            driven_s,
            begins_s,
        }
    }

    /// Asks the watch of the drives whether to go on.
    ///
    /// # Errors
    /// [`calibration::Error::Stopped`] where it breaks.
    pub(crate) fn go_on(&self) -> Result<(), Error> {
        self.series.go_on()
    }

    /// Averages.
    pub(crate) fn averages(&self) -> &[Average] {
        &self.series.averages
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.series.averages.len()
    }

    /// Whether a row is of power that the robot draws, of its sides or its battery.
    pub(crate) fn is_power(&self, row: usize) -> bool {
        self.series.averages[row].channel < self.series.channels()
    }

    /// Whether any row is of a channel.
    pub(crate) fn has_channel(&self, channel: usize) -> bool {
        self.series.averages.iter().any(|average| average.channel == channel)
    }

    /// Numbers of the test drives, or of the healthy ones, which follow them.
    pub(crate) fn runs(&self, suspect: bool) -> Range<usize> {
        let runs = || self.averages().iter().filter(|a| a.suspect == suspect).map(|a| a.run);
        runs().min().unwrap_or(0)..runs().max().map_or(0, |last| last + 1)
    }

    /// Root mean square of values over rows of power of the test drives.
    pub(crate) fn power_rms(&self, values: &[f64]) -> f64 {
        let squares = (0..self.test_rows).filter(|i| self.is_power(*i)).map(|i| values[i] * values[i]);
        let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
        (sum / f64::max(count, 1.0)).sqrt()
    }

    /// Time driven in the test drives [s].
    pub(crate) fn total_s(&self) -> f64 {
        self.begins_s.last().copied().unwrap_or(0.0)
    }

    /// What some rows cover: the lowest and highest hundredth of each quantity.
    pub(crate) fn covered(&self, rows: Range<usize>) -> Regimes {
        let range = |of: fn(&crate::Input) -> f64| {
            let mut values: Vec<f64> = self.averages()[rows.clone()].iter().map(|a| of(&a.input)).collect();
            values.retain(|value| value.is_finite());
            values.sort_by(f64::total_cmp);
            let at = |share: f64| {
                values.get((share * values.len().saturating_sub(1) as f64) as usize).copied().unwrap_or(0.0)
            };
            [at(0.01), at(0.99)]
        };
        Regimes {
            speed_mps: range(|i| i.speed_mps),
            difference_mps: range(|i| i.difference_mps),
            pitch_rad: range(|i| i.pitch_rad),
        }
    }
}

fn follows(before: &Average, after: &Average, longest_step_s: f64) -> bool {
    before.run == after.run
        && before.channel == after.channel
        && before.suspect == after.suspect
        && after.t_s - before.t_s < longest_step_s
}

fn begins_s(averages: &[Average]) -> Vec<f64> {
    let drives = averages.iter().map(|a| a.run + 1).max().unwrap_or(0);
    let mut durations_s = vec![0.0; drives];
    for average in averages {
        durations_s[average.run] = f64::max(durations_s[average.run], average.t_s + 0.5);
    }
    let mut begins_s = vec![0.0];
    for duration_s in durations_s {
        begins_s.push(begins_s[begins_s.len() - 1] + duration_s);
    }
    begins_s
}

/// Regimes over the scatter of each quantity, at least a twentieth of what the robot can do.
fn regimes(averages: &[Average], robot: &Robot) -> Vec<[f64; REGIME]> {
    let raw: Vec<[f64; REGIME]> = averages
        .iter()
        .map(|a| {
            let i = &a.input;
            [i.speed_mps, i.difference_mps, i.pitch_rad, i.roll_rad, i.accel_mps2]
        })
        .collect();
    let speed_mps = robot.max_wheel_speed_mps;
    let least = [0.05 * speed_mps, 0.05 * speed_mps, 0.02, 0.02, 0.05 * speed_mps];
    let count = raw.len().max(1) as f64;
    let scale: Vec<f64> = (0..REGIME)
        .map(|q| {
            let mean = raw.iter().map(|r| r[q]).sum::<f64>() / count;
            let variance = raw.iter().map(|r| (r[q] - mean).powi(2)).sum::<f64>() / count;
            variance.sqrt().max(least[q])
        })
        .collect();
    raw.iter().map(|r| std::array::from_fn(|q| r[q] / scale[q])).collect()
}
