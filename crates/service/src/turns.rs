//! The turns that are held, and until when each may be.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

/// How much longer than allowed a turn may be held before it counts as overdue: work looks at its deadline within a tenth of it.
const TOLERANCE: Duration = Duration::from_secs(1);

/// Turns that are held, by number, with the time at which each has to have ended.
#[derive(Clone, Debug, Default)]
pub(crate) struct HeldTurns(Arc<Mutex<Turns>>);

#[derive(Debug, Default)]
struct Turns {
    latest: u64,
    deadlines: BTreeMap<u64, Instant>,
}

/// A turn that is held until this is dropped.
#[derive(Debug)]
pub(crate) struct HeldTurn {
    turns: HeldTurns,
    number: u64,
}

impl HeldTurns {
    /// Holds a turn for so long at most.
    pub(crate) fn hold(&self, now: Instant, allowed: Duration) -> HeldTurn {
        let mut turns = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        turns.latest += 1;
        let number = turns.latest;
        turns.deadlines.insert(number, now + allowed + TOLERANCE);
        HeldTurn { turns: self.clone(), number }
    }

    /// Number of turns that are held longer than they may be.
    pub(crate) fn overdue(&self, now: Instant) -> usize {
        let turns = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        turns.deadlines.values().filter(|deadline| **deadline < now).count()
    }
}

impl Drop for HeldTurn {
    fn drop(&mut self) {
        self.turns.0.lock().unwrap_or_else(PoisonError::into_inner).deadlines.remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_is_overdue_from_its_time_on_until_it_ends() {
        let (turns, now) = (HeldTurns::default(), Instant::now());
        let short = turns.hold(now, Duration::from_secs(10));
        let _long = turns.hold(now, Duration::from_secs(100));
        let after = |seconds| turns.overdue(now + Duration::from_secs(seconds));
        assert_eq!((after(10), after(12), after(102)), (0, 1, 2));
        drop(short);
        assert_eq!((after(12), after(102)), (0, 1));
    }
}
