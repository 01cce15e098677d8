//! Looks at the deadline, spaced by counted work.

use planner::Patience;

use crate::Error;

/// Work between two looks at the deadline. A unit is one part of a journey or one comparison of two orders, which take 10 to 200 ns,
/// so that looks of some 50 ns each come every millisecond at most.
pub(crate) const WORK_PER_LOOK: usize = 4096;

/// Counted work of one long step, which ends with [`Error::Timeout`] when the patience does.
pub(crate) struct Meter<'p> {
    patience: &'p Patience,
    /// The step in the words of the error.
    step: &'static str,
    /// Work until the next look.
    left: usize,
}

impl<'p> Meter<'p> {
    /// A meter of a step, as `drawing samples`; the first work looks at the deadline.
    pub(crate) fn new(patience: &'p Patience, step: &'static str) -> Self {
        Meter { patience, step, left: 0 }
    }

    /// Counts work that is about to be done and looks at the deadline where enough has come together.
    ///
    /// # Errors
    /// Patience that is over.
    #[inline]
    pub(crate) fn spend(&mut self, work: usize) -> Result<(), Error> {
        if work < self.left {
            self.left -= work;
            return Ok(());
        }
        self.left = WORK_PER_LOOK;
        self.look()
    }

    /// Looks at the deadline.
    ///
    /// # Errors
    /// Patience that is over.
    pub(crate) fn look(&self) -> Result<(), Error> {
        if self.patience.is_over() { Err(Error::Timeout { step: self.step }) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_deadline_is_looked_at_once_for_each_unit_of_work() {
        let patience = Patience::for_looks(3);
        let mut meter = Meter::new(&patience, "testing");
        let done = (0..10 * WORK_PER_LOOK).take_while(|_| meter.spend(1).is_ok()).count();
        assert_eq!(done, 3 * WORK_PER_LOOK);
    }

    #[test]
    fn much_work_at_once_is_looked_at_before_it_is_done() {
        let over = Patience::for_looks(0);
        let refused = Meter::new(&over, "testing").spend(10 * WORK_PER_LOOK);
        assert_eq!(refused, Err(Error::Timeout { step: "testing" }));
    }
}
