//! The rows of a table divided into drives, in each of which time increases.

use std::{mem, ops::Range};

use crate::{
    Error, Labels, ReadingReport, Recording, Repair, Run, TimeError, blank_runs::fill_blanks,
    error::Position, watch::Looks,
};

/// Share by which runs may hold more time than passed in all: where one ends within a step, the next begins.
const ROUNDING_SHARE: f64 = 0.01;

/// Divides the rows into runs. Rows of one run that lie apart are brought together, in their order; then the place of each
/// row in the file is returned.
pub(crate) fn divide(
    recording: &mut Recording,
    runs: Option<Labels>,
    name: &str,
    report: &mut ReadingReport,
    position: &dyn Fn(usize) -> Position,
    looks: &Looks,
) -> Result<Option<Vec<usize>>, Error> {
    let rows = recording.rows();
    let named = runs.and_then(|labels| fill_blanks(labels, &recording.t_s, &mut report.repairs));
    let Some(mut labels) = named else {
        recording.runs = vec![Run::new(name.to_owned(), 0..rows, &recording.t_s, None)];
        return Ok(None);
    };
    let scattered_at = scattered_at(&labels);
    // Rows of several clocks, put together by time, repeat times or are out of order.
    let is_one_clock = recording.t_s.windows(2).all(|pair| pair[0] < pair[1]);
    let order = if scattered_at.is_some() {
        let mut order: Vec<usize> = (0..rows).collect();
        order.sort_by_key(|&row| labels.index[row]);
        report.repairs.push(Repair {
            place: "column `run`".into(),
            what: "the rows of a run lie apart in the file; they were brought together".into(),
        });
        reorder(recording, &order, looks)?;
        labels.index = order.iter().map(|&row| labels.index[row]).collect();
        Some(order)
    } else {
        None
    };
    looks.go_on()?;
    recording.runs = stretches(&labels.index)
        .map(|(index, rows)| {
            let name = labels.names.get(index as usize).cloned().unwrap_or_default();
            Run::new(name, rows, &recording.t_s, None)
        })
        .collect();
    match scattered_at.filter(|_| is_one_clock) {
        Some(row) => refuse_turns(recording, position(row)).map(|()| order),
        None => Ok(order),
    }
}

/// Refuses runs that take turns on one clock, so that the same seconds would be counted in several of them.
fn refuse_turns(recording: &Recording, position: Position) -> Result<(), Error> {
    let of_run = |run: &Run| -> f64 { run.rows.clone().filter_map(|row| recording.step_s(run, row)).sum() };
    let counted_s: f64 = recording.runs.iter().map(of_run).sum();
    let times = || recording.t_s.iter().copied();
    let passed_s = times().fold(f64::NEG_INFINITY, f64::max) - times().fold(f64::INFINITY, f64::min);
    if counted_s <= (1.0 + ROUNDING_SHARE) * passed_s {
        return Ok(());
    }
    let runs = recording.runs.iter().map(|run| run.name.clone()).collect();
    Err(TimeError::RunsTakeTurns { position, runs, counted_s, passed_s }.into())
}

/// The first row of a run whose rows before lie apart from it.
fn scattered_at(labels: &Labels) -> Option<usize> {
    let mut seen = vec![false; labels.names.len()];
    let mut again = |index: u32| seen.get_mut(index as usize).is_some_and(|seen| mem::replace(seen, true));
    stretches(&labels.index).find(|(index, _)| again(*index)).map(|(_, rows)| rows.start)
}

/// Stretches of equal indices.
fn stretches(index: &[u32]) -> impl Iterator<Item = (u32, Range<usize>)> {
    let mut start = 0;
    index.chunk_by(|a, b| a == b).map(move |stretch| {
        let rows = start..start + stretch.len();
        start = rows.end;
        (stretch[0], rows)
    })
}

fn reorder(recording: &mut Recording, order: &[usize], looks: &Looks) -> Result<(), Error> {
    let sorted = |values: &[f64]| -> Vec<f64> { order.iter().map(|&row| values[row]).collect() };
    recording.t_s = sorted(&recording.t_s);
    for values in recording.channels.values_mut().chain(recording.aside.values_mut()) {
        looks.go_on()?;
        *values = sorted(values);
    }
    if let Some(surface) = &mut recording.surface {
        surface.index = order.iter().map(|&row| surface.index[row]).collect();
    }
    Ok(())
}
