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
    /// The rows that it stands for: its own, or those of the whole period of a slow meter.
    pub span: Range<usize>,
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
        let rows = &self.rows[stretch.rows.clone()];
        let readings_a_second = readings_a_second(rows, rhythm_s);
        let piece_of = |row: &Row| match row.window.reading {
            0 => (true, ((row.t_s + 1e-6) / AVERAGE_S).floor()),
            reading => (false, f64::from((reading - 1) / readings_a_second)),
        };
        let mut seconds = Vec::new();
        let mut end = stretch.rows.start;
        // Every piece has a row, so that this ends whatever the times are.
        for piece in rows.chunk_by(|a, b| piece_of(a) == piece_of(b)) {
            let span = end..end + piece.len();
            end = span.end;
            let average = match piece_of(&piece[0]) {
                (true, second) => self.second(stretch, span, (second * AVERAGE_S, rhythm_s)),
                (false, _) => self.reading(stretch, span, rhythm_s),
            };
            seconds.extend(average);
        }
        seconds
    }

    fn is_counted(&self, row: usize) -> bool {
        self.rows[row].used && !self.rows[row].stuck
    }

    /// The rows of one second.
    fn second(&self, stretch: &Stretch, span: Range<usize>, (t_s, rhythm_s): (f64, f64)) -> Option<Average> {
        let used = span.clone().filter(|row| self.is_counted(*row)).count();
        let Stretch { run, surface, .. } = *stretch;
        let duration_s = used as f64 * rhythm_s;
        (used > 0).then(|| Average { run, surface, rows: span.clone(), span, used, duration_s, t_s })
    }

    /// The rows of whole periods of a slow meter; nothing of periods that are not there as a whole.
    fn reading(&self, stretch: &Stretch, span: Range<usize>, rhythm_s: f64) -> Option<Average> {
        let pieces = self.rows[span.clone()].chunk_by(|a, b| a.window.reading == b.window.reading);
        let whole: usize = pieces.map(|piece| piece[0].window.rows as usize).sum();
        if span.len() < whole || !span.clone().all(|row| self.is_counted(row)) {
            return None;
        }
        let is_compared = |row: &usize| self.rows[*row].window.is_compared;
        let first = span.clone().find(is_compared)?;
        let last = span.clone().rfind(is_compared)?;
        let used = (first..=last).filter(is_compared).count();
        // Rows of one moment each would have others between them.
        let rows = if used == last + 1 - first { first..last + 1 } else { first..first + 1 };
        let Stretch { run, surface, .. } = *stretch;
        let (t_s, duration_s) = (self.rows[span.start].t_s, span.len() as f64 * rhythm_s);
        Some(Average { run, surface, used: rows.len(), rows, span, duration_s, t_s })
    }

    /// Length of the averages \[s\]: a second, or the period of a meter that is slower.
    pub fn average_s(&self) -> f64 {
        match self.placement {
            Some(_) => self.averages.iter().map(|average| average.duration_s).fold(AVERAGE_S, f64::max),
            None => AVERAGE_S,
        }
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

/// Readings of a slow meter that are compared together, so that an average is as long as others are.
fn readings_a_second(rows: &[Row], rhythm_s: f64) -> u32 {
    let longest = rows.iter().map(|row| row.window.rows).max().unwrap_or(0);
    let period_s = f64::from(longest) * rhythm_s;
    if period_s > 0.0 { (AVERAGE_S / period_s).round().clamp(1.0, 1000.0) as u32 } else { 1 }
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
