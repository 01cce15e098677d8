//! How long a question may take.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    time::Instant,
};

/// Work of what long steps do over and over, in cells of a map that are looked at: a few nanoseconds each.
pub mod work {
    /// A cell that is looked at.
    pub const CELL: u64 = 1;
    /// A state that is taken up with all its motions, or whose place the robot's outline is held against.
    pub const STATE: u64 = 32;
    /// A motion that is driven in double precision.
    pub const MOTION: u64 = 256;
    /// Work after which a step looks at the clock: a few tenths of a millisecond.
    pub const LOOK_EVERY: u64 = 1 << 16;
    /// Most work between two looks at the clock in any long step, with the last piece of it: a millisecond or so.
    pub const MOST_BETWEEN_LOOKS: u64 = 4 * LOOK_EVERY;
}

/// When to give up: at a deadline, or when the asker no longer wants the answer. The default waits for ever.
///
/// A long step looks at the clock every so often with [`Patience::is_over`], after [`work::MOST_BETWEEN_LOOKS`] at most,
/// whatever the size of the map. It reports what it does with [`Patience::worked`], so that tests can hold it to that.
#[derive(Clone, Debug, Default)]
pub struct Patience {
    /// The latest moment.
    pub deadline: Option<Instant>,
    /// Set from elsewhere to stop at once.
    pub cancelled: Option<Arc<AtomicBool>>,
    /// Looks at the clock that are left, whatever it shows.
    looks: Option<Arc<AtomicU64>>,
    meter: Option<Arc<Meter>>,
}

/// Work between looks at the clock, summed over all threads that share a patience.
#[derive(Debug, Default)]
pub struct Meter {
    since_look: AtomicU64,
    largest: AtomicU64,
    total: AtomicU64,
    overrun: AtomicU64,
    is_over: AtomicBool,
}

impl Meter {
    /// Most work between two looks, or since the last.
    pub fn largest(&self) -> u64 {
        self.largest.load(Ordering::Relaxed).max(self.since_look.load(Ordering::Relaxed))
    }

    /// All work so far.
    pub fn total(&self) -> u64 {
        self.total.load(Ordering::Relaxed)
    }

    /// Work after patience was found to be over.
    pub fn overrun(&self) -> u64 {
        self.overrun.load(Ordering::Relaxed)
    }

    fn worked(&self, amount: u64) {
        if self.is_over.load(Ordering::Relaxed) {
            self.overrun.fetch_add(amount, Ordering::Relaxed);
        }
        self.since_look.fetch_add(amount, Ordering::Relaxed);
        self.total.fetch_add(amount, Ordering::Relaxed);
    }

    fn look(&self, is_over: bool) {
        self.largest.fetch_max(self.since_look.swap(0, Ordering::Relaxed), Ordering::Relaxed);
        self.is_over.fetch_or(is_over, Ordering::Relaxed);
    }
}

impl Patience {
    /// Patience until a moment.
    pub fn until(deadline: Instant) -> Self {
        Patience { deadline: Some(deadline), ..Patience::default() }
    }

    /// Patience until a moment or until it is cancelled from elsewhere.
    pub fn until_or(deadline: Instant, cancelled: Arc<AtomicBool>) -> Self {
        Patience { cancelled: Some(cancelled), ..Patience::until(deadline) }
    }

    /// Patience for so many looks at the clock, which ends at the same place on every machine.
    pub fn for_looks(count: u64) -> Self {
        Patience { looks: Some(Arc::new(AtomicU64::new(count))), ..Patience::default() }
    }

    /// The same patience with a meter of the work between looks at the clock.
    pub fn metered(self) -> (Self, Arc<Meter>) {
        let meter = Arc::<Meter>::default();
        (Patience { meter: Some(Arc::clone(&meter)), ..self }, meter)
    }

    /// The same patience, over at a moment at the latest.
    #[must_use]
    pub fn no_later_than(&self, moment: Option<Instant>) -> Self {
        let deadline = [moment, self.deadline].into_iter().flatten().min();
        Patience { deadline, ..self.clone() }
    }

    /// Reports work, in the unit of [`work`].
    #[inline(always)]
    pub fn worked(&self, amount: u64) {
        if let Some(meter) = &self.meter {
            meter.worked(amount);
        }
    }

    /// A pacer that looks at the clock as work is done.
    pub fn pacer(&self) -> Pacer<'_> {
        Pacer { patience: self, done: 0 }
    }

    /// Whether it is over: a look at the clock.
    pub fn is_over(&self) -> bool {
        let is_over = self.has_ended();
        if let Some(meter) = &self.meter {
            meter.look(is_over);
        }
        is_over
    }

    fn has_ended(&self) -> bool {
        if let Some(looks) = &self.looks
            && looks.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_err()
        {
            return true;
        }
        self.cancelled.as_ref().is_some_and(|c| c.load(Ordering::Relaxed))
            || self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
}

/// Looks at the clock whenever a step has done enough work since the last look.
#[derive(Debug)]
pub struct Pacer<'p> {
    patience: &'p Patience,
    /// Work since the last look.
    done: u64,
}

impl Pacer<'_> {
    /// Counts work in the unit of [`work`]; `None` where it was time to look and patience is over.
    #[inline(always)]
    pub fn after(&mut self, amount: u64) -> Option<()> {
        self.done += amount;
        if self.done < work::LOOK_EVERY { Some(()) } else { self.look() }
    }

    #[cold]
    fn look(&mut self) -> Option<()> {
        self.patience.worked(std::mem::take(&mut self.done));
        (!self.patience.is_over()).then_some(())
    }
}

impl Drop for Pacer<'_> {
    fn drop(&mut self) {
        self.patience.worked(self.done);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pacer_looks_as_soon_as_enough_was_done_and_leaves_no_work_unreported() {
        let (patience, meter) = Patience::for_looks(3).metered();
        let mut pacer = patience.pacer();
        let mut done = 0;
        while pacer.after(1000).is_some() {
            done += 1000;
        }
        drop(pacer);
        assert!(meter.total() == done + 1000 && done > 3 * work::LOOK_EVERY, "{done}");
        assert!(meter.largest() >= work::LOOK_EVERY && meter.largest() < work::LOOK_EVERY + 1000);
    }
}
