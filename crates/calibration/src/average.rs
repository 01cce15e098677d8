//! Averages over about one second: what is fitted and judged.

use std::ops::Range;

use rayon::prelude::*;

use crate::{Drives, drives::Stretch, row::Row};

/// Length of the averages that are fitted and judged \[s\]: longer than the delay between a motor's driver and an encoder
/// (0.1-0.2 s on a Husky), shorter than a manoeuvre.
pub const AVERAGE_S: f64 = 1.0;

/// About a second of one stretch: what is fitted and judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Average {
    /// Which run.
    pub run: usize,
    /// Which surface.
    pub surface: usize,
    /// Its rows, of which the used ones count.
    pub rows: Range<usize>,
    /// How many are used; at least one.
    pub used: usize,
    /// Time that they stand for \[s\].
    pub duration_s: f64,
    /// Beginning of the second \[s\].
    pub t_s: f64,
}

impl Drives {
    /// Renews the averages after rows were marked.
    pub(crate) fn average(&mut self) {
        self.averages = self.stretches.par_iter().flat_map_iter(|stretch| self.seconds(stretch)).collect();
    }

    /// The averages of one stretch.
    fn seconds(&self, stretch: &Stretch) -> Vec<Average> {
        let rhythm_s = rhythm_s(&self.rows[stretch.rows.clone()]);
        let second_of = |row: &Row| ((row.t_s + 1e-6) / AVERAGE_S).floor();
        let rows = &self.rows[stretch.rows.clone()];
        let mut seconds = Vec::new();
        let mut end = stretch.rows.start;
        // Every piece has a row, so that this ends whatever the times are.
        for piece in rows.chunk_by(|a, b| second_of(a) == second_of(b)) {
            let (start, second) = (end, second_of(&piece[0]));
            end += piece.len();
            let used = self.rows[start..end].iter().filter(|row| row.used && !row.stuck).count();
            if used > 0 {
                seconds.push(Average {
                    run: stretch.run,
                    surface: stretch.surface,
                    rows: start..end,
                    used,
                    duration_s: used as f64 * rhythm_s,
                    t_s: second * AVERAGE_S,
                });
            }
        }
        seconds
    }

    /// Averages of a quantity by row.
    pub fn averaged(&self, by_row: &[f64]) -> Vec<f64> {
        self.averaged_by(|row| by_row[row])
    }

    /// Averages of a function of the row.
    pub fn averaged_by(&self, value: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
        self.averages.par_iter().map(|average| self.mean(average, |row| [value(row)])[0]).collect()
    }

    /// Averages of several functions of the row at once.
    pub fn means<const N: usize>(&self, value: impl Fn(usize) -> [f64; N] + Sync) -> Vec<[f64; N]> {
        self.averages.par_iter().with_min_len(64).map(|average| self.mean(average, &value)).collect()
    }

    /// The mean of some quantities over the rows of one average that count.
    pub(crate) fn mean<const N: usize>(
        &self,
        average: &Average,
        value: impl Fn(usize) -> [f64; N],
    ) -> [f64; N] {
        let mut sums = [0.0; N];
        for row in average.rows.clone().filter(|&row| self.rows[row].used && !self.rows[row].stuck) {
            sums.iter_mut().zip(value(row)).for_each(|(sum, x)| *sum += x);
        }
        sums.map(|sum| sum / average.used as f64)
    }

    /// 100 (predicted − recorded) / recorded energy of a run, from averages of power \[%\].
    pub(crate) fn energy_error_percent(&self, run: usize, predicted_w: &[f64], recorded_w: &[f64]) -> f64 {
        let energy_j = |watts: &[f64]| -> f64 {
            let of_run = self.averages.iter().zip(watts).filter(|(average, _)| average.run == run);
            of_run.map(|(average, w)| w * average.duration_s).sum()
        };
        100.0 * (energy_j(predicted_w) / energy_j(recorded_w) - 1.0)
    }

    /// Averages of what was recorded, column behind column.
    pub fn recorded_averages(&self) -> Vec<f64> {
        self.recorded.iter().flat_map(|column| self.averaged(column)).collect()
    }
}

/// The mean step of a stretch \[s\]; a second for a lone row.
fn rhythm_s(rows: &[Row]) -> f64 {
    match rows {
        [first, .., last] => (last.t_s - first.t_s) / (rows.len() - 1) as f64,
        _ => AVERAGE_S,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn averages(t_s: &[f64]) -> Vec<Average> {
        let rows: Vec<Row> = t_s.iter().map(|t_s| Row { t_s: *t_s, used: true, ..Row::default() }).collect();
        let stretches = vec![Stretch { run: 0, surface: 0, rows: 0..rows.len() }];
        let mut drives = Drives { rows, stretches, ..Drives::default() };
        drives.average();
        drives.averages
    }

    #[test]
    fn rows_of_a_second_are_averaged_and_times_without_seconds_end_all_the_same() {
        let t_s: Vec<f64> = (0..25).map(|row| 3.0 + f64::from(row) * 0.1).collect();
        let found: Vec<(f64, usize)> = averages(&t_s).iter().map(|a| (a.t_s, a.used)).collect();
        assert_eq!(found, [(3.0, 10), (4.0, 10), (5.0, 5)]);
        for start_s in [1.7e18_f64, -1.7e18, 1e300] {
            let step_s = start_s.abs() * 1e-10;
            let t_s: Vec<f64> = (0..50).map(|row| start_s + f64::from(row) * step_s).collect();
            let found = averages(&t_s);
            assert_eq!(found.iter().map(|a| a.used).sum::<usize>(), 50, "{start_s}");
        }
    }
}
