//! How long a question may take.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
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
}

impl Patience {
    /// Patience until a moment.
    pub fn until(deadline: Instant) -> Self {
        Patience { deadline: Some(deadline), cancelled: None }
    }

    /// Whether it is over.
    pub fn is_over(&self) -> bool {
        self.cancelled.as_ref().is_some_and(|c| c.load(Ordering::Relaxed))
            || self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
}
