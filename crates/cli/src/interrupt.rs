//! The end by an interrupt (Ctrl-C) or a wish to end: half-written files go, and one line says so.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use crate::output;

/// Exit status after an interrupt: 128 and the number of SIGINT, as shells have it.
const INTERRUPTED: i32 = 130;

/// Files that are being written, and folders that were made for them.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Ends the command at an interrupt. The service has its own way to end, and does not call this.
pub(crate) fn end_on_interrupt() {
    // Where a parent has it ignored, as of `nohup`, it stays so; where no handler can be set, the system ends the process.
    let _ = ctrlc::try_set_handler(|| {
        let unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
        for path in unfinished.iter() {
            // A folder goes only while nothing is in it.
            let _ = fs::remove_file(path).or_else(|_| fs::remove_dir(path));
        }
        output::note("joulepath: interrupted; no file was left half-written");
        std::process::exit(INTERRUPTED);
    });
}

/// Has an interrupt told to whoever waits for it, in place of the end of the process.
///
/// # Errors
/// No handler can be set.
#[cfg(feature = "server")]
pub(crate) fn awaited() -> anyhow::Result<std::sync::mpsc::Receiver<()>> {
    let (sender, receiver) = std::sync::mpsc::channel();
    ctrlc::set_handler(move || {
        // Nobody waits any longer once the first has been heard.
        let _ = sender.send(());
    })?;
    Ok(receiver)
}

/// A file, or an empty folder, that an interrupt removes, until this is dropped.
pub(crate) struct Unfinished(PathBuf);

/// Has an interrupt remove a file, or a folder while it is empty.
pub(crate) fn forget_on_interrupt(path: &Path) -> Unfinished {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).push(path.to_owned());
    Unfinished(path.to_owned())
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).retain(|path| *path != self.0);
    }
}
