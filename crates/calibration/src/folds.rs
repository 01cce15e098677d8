//! Which runs fit and which judge.

use crate::{Drives, Error};

/// Length of the blocks whose errors count as one piece of evidence \[s\]: several times the manoeuvres of a hand-driven robot.
pub(crate) const BLOCK_S: f64 = 15.0;

/// The runs of drives in two halves, alternately by name: first, third, … and second, fourth, …
///
/// Each half is fitted alone and judges the other, so no run is judged by a fit that saw it.
///
/// # Errors
/// [`Error::Stopped`] when the drives' watch breaks.
pub fn halves(drives: &Drives) -> Result<[Drives; 2], Error> {
    let mut parity_of_run = vec![None; drives.runs.len()];
    for (place, run) in drives.judged_runs().into_iter().enumerate() {
        parity_of_run[run] = Some(place % 2);
    }
    let half = |parity: usize| drives.select(|stretch| parity_of_run[stretch.run] == Some(parity));
    Ok([half(0)?, half(1)?])
}

/// The block of each average, for one column of what was recorded.
fn block_of_averages(drives: &Drives) -> Vec<usize> {
    let mut known = None;
    let mut block = 0;
    let number = |average: &crate::average::Average| {
        let key = (average.run, (average.t_s / BLOCK_S).floor() as i64);
        if known.is_some_and(|k| k != key) {
            block += 1;
        }
        known = Some(key);
        block
    };
    drives.averages.iter().map(number).collect()
}

/// The block of every recorded average, column behind column: both sides of one time are in one block.
pub fn blocks(drives: &Drives) -> Vec<usize> {
    let once = block_of_averages(drives);
    (0..drives.recorded.len()).flat_map(|_| once.iter().copied()).collect()
}

/// The run and column of every recorded average, numbered column behind column.
pub(crate) fn series(drives: &Drives) -> Vec<usize> {
    let runs = drives.runs.len();
    (0..drives.recorded.len())
        .flat_map(|column| drives.averages.iter().map(move |average| column * runs + average.run))
        .collect()
}
