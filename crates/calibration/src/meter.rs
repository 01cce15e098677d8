//! Readings of a power meter that is slower than the wheels, laid over the rows that they stand for.
//!
//! Most such meters tell the mean over their own period, some the power of one moment; stamps stand at the end, the middle or the beginning of
//! the period. No file says which, so that is taken by which the predictions follow best. A mean of what is predicted over the wrong window, or
//! a prediction of one moment for a mean, makes friction seem less than it is.

use model::Robot;
use recording::{PowerForm, Recording, Run};

use crate::{
    Drives, Error,
    field::with_new_ground,
    power::{by_row, seen_w},
};

/// What a reading tells, relative to its stamp.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Placement {
    /// The mean over the time since the reading before.
    #[default]
    Before,
    /// The mean over half a period before and half a period behind.
    Around,
    /// The mean over the time until the next reading.
    After,
    /// The power of the moment.
    Moment,
}

impl Placement {
    /// All, the usual one first.
    pub const ALL: [Placement; 4] =
        [Placement::Before, Placement::Around, Placement::After, Placement::Moment];

    /// It in words.
    pub fn words(self) -> &'static str {
        match self {
            Placement::Before => "as means over the time since the reading before",
            Placement::Around => "as means over one period about their stamps",
            Placement::After => "as means over the time until the next reading",
            Placement::Moment => "as the power of one moment",
        }
    }
}

/// The window of one row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Window {
    /// Number of the reading that the row belongs to, counted from 1; 0 for none.
    pub reading: u32,
    /// Rows that belong to that reading.
    pub rows: u32,
    /// Predictions of this row are compared with the reading.
    pub is_compared: bool,
}

/// Readings over rows.
pub(crate) struct Laid {
    /// What was recorded, by column and row.
    pub(crate) recorded: Vec<Vec<f64>>,
    /// By row; empty where no meter is slow.
    pub(crate) windows: Vec<Window>,
}

/// One reading: its value in each column and the rows since the reading before.
struct Reading {
    values: Vec<f64>,
    first: usize,
    last: usize,
}

impl Reading {
    fn rows(&self) -> usize {
        self.last + 1 - self.first
    }
}

/// Lays the readings of slow meters over the rows that they stand for.
pub(crate) fn laid(recording: &Recording, recorded: Vec<Vec<f64>>, placement: Placement) -> Laid {
    if recording.reading_ends.is_empty() {
        return Laid { recorded, windows: Vec::new() };
    }
    let mut laid = Laid { recorded, windows: vec![Window::default(); recording.rows()] };
    let mut number = 0;
    for run in recording.runs.iter().filter(|run| recording.has_slow_meter(run)) {
        let readings = readings(recording, run, &laid.recorded);
        laid.recorded.iter_mut().for_each(|column| column[run.rows.clone()].fill(f64::NAN));
        for (i, reading) in readings.iter().enumerate() {
            number += 1;
            let after = readings.get(i + 1).filter(|next| next.first == reading.last + 1);
            let after = after.unwrap_or(reading).rows();
            let (half, half_after) = (reading.rows() / 2, after - after / 2);
            let rows = match placement {
                Placement::Before => reading.first..reading.last + 1,
                // The row at the stamp begins the period.
                Placement::After => reading.last..reading.last + after,
                Placement::Around | Placement::Moment => {
                    reading.last + 1 - half..reading.last + 1 + half_after
                }
            };
            let rows = rows.start.min(run.rows.end)..rows.end.min(run.rows.end);
            for (column, value) in laid.recorded.iter_mut().zip(&reading.values) {
                column[rows.clone()].fill(*value);
            }
            let count = u32::try_from(rows.len()).unwrap_or(u32::MAX);
            for row in rows {
                let is_compared = placement != Placement::Moment || row == reading.last;
                laid.windows[row] = Window { reading: number, rows: count, is_compared };
            }
        }
    }
    laid
}

fn readings(recording: &Recording, run: &Run, recorded: &[Vec<f64>]) -> Vec<Reading> {
    let mut first = run.rows.start;
    let mut readings = Vec::new();
    for last in run.rows.clone().filter(|row| recording.reading_ends[*row]) {
        let is_told = |row: &usize| recorded.iter().all(|column| column[*row].is_finite());
        if let Some(first) = (first..=last).find(is_told) {
            let mean = |column: &Vec<f64>| {
                let own = column[first..=last].iter();
                own.sum::<f64>() / (last + 1 - first) as f64
            };
            readings.push(Reading { values: recorded.iter().map(mean).collect(), first, last });
        }
        first = last + 1;
    }
    readings
}

/// The placement that predictions of a robot follow best, as drives with the usual one show it.
///
/// # Errors
/// [`Error::Stopped`] when the drives' watch breaks.
pub(crate) fn best_placement(
    robot: &Robot,
    recording: &Recording,
    recorded: &[Vec<f64>],
    drives: &Drives,
) -> Result<Placement, Error> {
    let form = drives.form.unwrap_or(PowerForm::Battery);
    if form == PowerForm::MotorCurrents {
        return Ok(Placement::default());
    }
    let robot = &with_new_ground(robot, drives);
    let predicted_w =
        by_row(drives, robot, |i, power| seen_w(robot, form, &drives.rows[i], power).iter().sum::<f64>())?;
    let mut best = (Placement::default(), 0.0);
    for placement in Placement::ALL {
        drives.go_on()?;
        let r2 = followed(&laid(recording, recorded.to_vec(), placement), &predicted_w);
        if r2 > best.1 {
            best = (placement, r2);
        }
    }
    Ok(best.0)
}

impl Drives {
    /// What has to be said of a power meter that is slower than the wheels.
    pub fn meter_note(&self) -> Option<String> {
        let placement = self.placement?;
        Some(format!(
            "the power meter is slower than the wheels: its readings are compared over their own period, and predictions follow them best {}",
            placement.words()
        ))
    }
}

/// Squared correlation of readings with the means of a prediction over their windows.
fn followed(laid: &Laid, predicted_w: &[f64]) -> f64 {
    let (mut pairs, mut start) = (Vec::new(), 0);
    for window in laid.windows.chunk_by(|a, b| a.reading == b.reading) {
        let rows = start..start + window.len();
        start = rows.end;
        if window[0].reading == 0 {
            continue;
        }
        let compared = rows.clone().filter(|row| laid.windows[*row].is_compared);
        let (sum_w, count) = compared.fold((0.0, 0), |(sum, count), row| (sum + predicted_w[row], count + 1));
        let recorded_w: f64 = laid.recorded.iter().map(|column| column[rows.start]).sum();
        let predicted_w = sum_w / f64::from(count);
        if predicted_w.is_finite() && recorded_w.is_finite() {
            pairs.push((predicted_w, recorded_w));
        }
    }
    squared_correlation(&pairs)
}

fn squared_correlation(pairs: &[(f64, f64)]) -> f64 {
    let count = pairs.len().max(1) as f64;
    let (x0, y0) = pairs.iter().fold((0.0, 0.0), |(x0, y0), (x, y)| (x0 + x / count, y0 + y / count));
    let [xy, xx, yy] = pairs.iter().fold([0.0; 3], |[xy, xx, yy], (x, y)| {
        [xy + (x - x0) * (y - y0), xx + (x - x0).powi(2), yy + (y - y0).powi(2)]
    });
    if xx * yy > 0.0 { xy * xy / (xx * yy) } else { 0.0 }
}
