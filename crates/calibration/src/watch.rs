//! Long computations that can be stopped from outside.

use std::{
    fmt,
    ops::{ControlFlow, Range},
};

use rayon::prelude::*;
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

/// Rows that are worked on between two looks at the watch: some milliseconds of the model's power.
pub(crate) const ROWS_A_LOOK: usize = 4096;

impl Watched {
    /// A value for each index below a count, side by side and in order, with a look at the watch before every so many of them.
    pub(crate) fn map<T: Send>(
        &self,
        count: usize,
        a_look: usize,
        value: impl Fn(usize) -> T + Sync,
    ) -> Result<Vec<T>, Error> {
        let piece = |from: usize| {
            self.go_on()?;
            Ok((from..(from + a_look).min(count)).map(&value).collect::<Vec<T>>())
        };
        let pieces = (0..count.div_ceil(a_look)).into_par_iter().map(|number| piece(number * a_look));
        let pieces = pieces.collect::<Result<Vec<Vec<T>>, Error>>()?;
        let mut values = Vec::with_capacity(count);
        pieces.into_iter().for_each(|piece| values.extend(piece));
        Ok(values)
    }

    /// Takes the pieces of a range one after another, with a look at the watch before each.
    pub(crate) fn pieces(&self, range: Range<usize>) -> impl Iterator<Item = Result<Range<usize>, Error>> {
        let end = range.end;
        range.step_by(ROWS_A_LOOK).map(move |from| {
            self.go_on()?;
            Ok(from..(from + ROWS_A_LOOK).min(end))
        })
    }
}

impl fmt::Debug for Watched {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Watched" } else { "Unwatched" })
    }
}
