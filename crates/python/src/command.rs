//! The `joulepath` command, which comes with the package.

use std::{ffi::OsString, path::PathBuf};

use pyo3::prelude::*;

/// Runs the command with the words of a command line and returns its exit status; `itself` is what calls it again.
#[pyfunction]
pub(crate) fn command(py: Python<'_>, words: Vec<OsString>, itself: Vec<OsString>) -> u8 {
    let mut itself = itself.into_iter();
    let program = itself.next().map_or_else(|| PathBuf::from("joulepath"), PathBuf::from);
    let call = cli::Call { words, itself: (program, itself.collect()) };
    py.detach(|| cli::run(call))
}
