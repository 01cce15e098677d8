//! How long a question may take.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    time::Instant,
};

/// When to give up: at a deadline, or when the asker no longer wants the answer. The default waits for ever.
#[derive(Clone, Debug, Default)]
pub struct Patience {
    /// The latest moment.
    pub deadline: Option<Instant>,
    /// Set from elsewhere to stop at once.
    pub cancelled: Option<Arc<AtomicBool>>,
    /// Looks at the clock that are left, whatever it shows.
    looks: Option<Arc<AtomicU64>>,
}

impl Patience {
    /// Patience until a moment.
    pub fn until(deadline: Instant) -> Self {
        Patience { deadline: Some(deadline), ..Patience::default() }
    }

    /// Patience until a moment or until it is cancelled from elsewhere.
    pub fn until_or(deadline: Instant, cancelled: Arc<AtomicBool>) -> Self {
        Patience { deadline: Some(deadline), cancelled: Some(cancelled), looks: None }
    }

    /// Patience for so many looks at the clock, which ends at the same place on every machine.
    pub fn for_looks(count: u64) -> Self {
        Patience { looks: Some(Arc::new(AtomicU64::new(count))), ..Patience::default() }
    }

    /// The same patience, over at a moment at the latest.
    #[must_use]
    pub fn no_later_than(&self, moment: Option<Instant>) -> Self {
        let deadline = [moment, self.deadline].into_iter().flatten().min();
        Patience { deadline, ..self.clone() }
    }

    /// Whether it is over.
    pub fn is_over(&self) -> bool {
        if let Some(looks) = &self.looks
            && looks.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_err()
        {
            return true;
        }
        self.cancelled.as_ref().is_some_and(|c| c.load(Ordering::Relaxed))
            || self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
}
