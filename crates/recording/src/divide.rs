//! The rows of a table divided into drives, in each of which time increases.

use std::{mem, ops::Range};

use crate::{Error, Labels, ReadingReport, Recording, Repair, Run, watch::Looks};

/// Divides the rows into runs. Rows of one run that lie apart are brought together, in their order; then the place of each
/// row in the file is returned.
pub(crate) fn divide(
    recording: &mut Recording,
    runs: Option<Labels>,
    name: &str,
    report: &mut ReadingReport,
    looks: &Looks,
) -> Result<Option<Vec<usize>>, Error> {
    let rows = recording.rows();
    let Some(mut labels) = runs else {
        recording.runs = vec![Run::new(name.to_owned(), 0..rows, &recording.t_s, None)];
        return Ok(None);
    };
    if labels.index.contains(&Labels::NONE) {
        let unnamed = u32::try_from(labels.names.len()).unwrap_or(Labels::NONE);
        labels.names.push("unnamed".into());
        labels.index.iter_mut().filter(|index| **index == Labels::NONE).for_each(|index| *index = unnamed);
    }
    let order = if scattered(&labels) {
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
    Ok(order)
}

fn scattered(labels: &Labels) -> bool {
    let mut seen = vec![false; labels.names.len()];
    stretches(&labels.index)
        .any(|(index, _)| seen.get_mut(index as usize).is_some_and(|seen| mem::replace(seen, true)))
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
