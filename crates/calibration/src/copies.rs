//! Runs that were recorded twice.

use recording::{Channel, Recording};

use crate::{Error, watch::Watched};

/// Runs whose wheel speeds and power repeat those of a longer or earlier run from its first row on.
pub(crate) fn copies(recording: &Recording, watch: &Watched) -> Result<Vec<usize>, Error> {
    let channels = [
        Channel::LeftSpeed,
        Channel::RightSpeed,
        Channel::LeftMotorCurrent,
        Channel::Power,
        Channel::LeftPower,
    ];
    let columns: Vec<&[f64]> = channels.iter().filter_map(|channel| recording.channel(*channel)).collect();
    let same = |a: usize, b: usize, count: usize| {
        columns.iter().all(|column| (0..count).all(|i| column[a + i].to_bits() == column[b + i].to_bits()))
    };
    let repeats = |(i, run): &(usize, &recording::Run)| {
        recording.runs.iter().enumerate().any(|(j, other)| {
            let longer = (other.rows.len(), *i) > (run.rows.len(), j);
            longer
                && run.rows.len() >= LEAST_COPY_ROWS
                && same(run.rows.start, other.rows.start, run.rows.len())
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
