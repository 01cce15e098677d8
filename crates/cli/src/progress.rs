//! Bars on a terminal; nothing on a pipe, where indicatif draws nothing.

use std::{path::PathBuf, sync::Mutex, time::Duration};

use indicatif::{ProgressBar, ProgressFinish, ProgressStyle};
use prove::Stage;

/// A bar over the bytes of files that are about to be read.
pub(crate) fn reading(files: &[PathBuf]) -> ProgressBar {
    let bytes = files.iter().map(|file| recording::bytes_on_disk(file)).sum();
    let style = ProgressStyle::with_template("reading {wide_bar} {bytes} of {total_bytes}");
    ProgressBar::new(bytes).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// A sign of life for work whose length is not known; it goes when it is dropped, as by an error.
pub(crate) fn working(what: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {spinner} {elapsed}");
    let bar = ProgressBar::no_length()
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
        .with_finish(ProgressFinish::AndClear);
    bar.set_message(what);
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// A bar over all of a long computation, with the step that it is at.
pub(crate) fn steps() -> ProgressBar {
    let style = ProgressStyle::with_template("{wide_bar} {percent} % {msg} {elapsed}");
    let bar = ProgressBar::new(STEPS).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// Steps of a bar over shares.
pub(crate) const STEPS: u64 = 1000;

/// A bar over the cases of a trial, whose number is told later; told by several threads.
pub(crate) struct Cases(Mutex<ProgressBar>);

impl Cases {
    /// A bar over no cases yet.
    pub(crate) fn new() -> Self {
        let style = ProgressStyle::with_template("{msg} {wide_bar} {pos} of {len} {elapsed}");
        let bar = ProgressBar::new(0).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Cases(Mutex::new(bar))
    }

    /// So many of so many cases are done.
    pub(crate) fn show(&self, stage: Stage, done: usize, all: usize) {
        if let Ok(bar) = self.0.lock() {
            bar.set_message(match stage {
                Stage::Drawing => "drawing cases",
                Stage::Diagnosing => "diagnosing",
                Stage::Scoring => "opening keys",
            });
            bar.set_length(all as u64);
            bar.set_position(done as u64);
        }
    }

    /// Takes the bar away.
    pub(crate) fn end(&self) {
        if let Ok(bar) = self.0.lock() {
            bar.finish_and_clear();
        }
    }
}
