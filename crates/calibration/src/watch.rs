//! Long computations that can be stopped from outside.

use std::{fmt, ops::ControlFlow};

use recording::Watch;

use crate::Error;

/// Who is asked whether to go on, where anybody is: the [`Watch`] of a reading, which is told of no bytes here.
#[derive(Clone, Default)]
pub(crate) struct Watched(Option<Watch>);

impl Watched {
    pub(crate) fn by(watch: &Watch) -> Self {
        Watched(Some(Watch::clone(watch)))
    }

    /// Asks whether to go on.
    pub(crate) fn go_on(&self) -> Result<(), Error> {
        match self.0.as_ref().map(|watch| watch(0)) {
            Some(ControlFlow::Break(())) => Err(Error::Stopped),
            Some(ControlFlow::Continue(())) | None => Ok(()),
        }
    }
}

impl fmt::Debug for Watched {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Watched" } else { "Unwatched" })
    }
}
