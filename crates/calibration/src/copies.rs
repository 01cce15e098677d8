//! Runs that were recorded twice.

use recording::{Recording, same_rows};

use crate::{Error, watch::Watched};

/// Runs whose wheel speeds and power repeat those of a longer or earlier run from its first row on.
pub(crate) fn copies(recording: &Recording, watch: &Watched) -> Result<Vec<usize>, Error> {
    let repeats = |(i, run): &(usize, &recording::Run)| {
        recording.runs.iter().enumerate().any(|(j, other)| {
            let longer = (other.rows.len(), *i) > (run.rows.len(), j);
            longer
                && run.rows.len() >= LEAST_COPY_ROWS
                && same_rows(recording, [run.rows.start, other.rows.start], run.rows.len())
        })
    };
    let mut found = Vec::new();
    for (i, run) in recording.runs.iter().enumerate() {
        watch.go_on()?;
        found.extend(repeats(&(i, run)).then_some(i));
    }
    Ok(found)
}

/// Fewer equal rows may be chance, such as two runs that begin at standstill.
const LEAST_COPY_ROWS: usize = 20;
