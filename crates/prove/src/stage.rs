//! What a trial is doing, and work on all of its cases side by side.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::Error;

/// What a trial is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Cases are drawn and keys sealed.
    Drawing,
    /// Cases are diagnosed.
    Diagnosing,
    /// Keys are opened, and the same drives without effects diagnosed.
    Scoring,
}

/// Told of progress: stage, cases done, cases in all.
pub type Progress<'a> = dyn Fn(Stage, usize, usize) + Sync + 'a;

/// Works on every case, several at the same time, and tells how many are done; results are in the order of the cases.
pub(crate) fn each<T: Sync, U: Send>(
    progress: &Progress<'_>,
    stage: Stage,
    over: &[T],
    work: impl Fn(&T) -> Result<U, Error> + Sync,
) -> Result<Vec<U>, Error> {
    let done = AtomicUsize::new(0);
    progress(stage, 0, over.len());
    let one = |item: &T| {
        let result = work(item);
        progress(stage, done.fetch_add(1, Ordering::Relaxed) + 1, over.len());
        result
    };
    // One at a time to a thread: cases take seconds each.
    over.par_iter().with_max_len(1).map(one).collect()
}
