//! The memory that requests share, and parts of it that are reserved.

use std::sync::Arc;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::{
    metrics::{Metrics, ShedLabels},
    problem::{Problem, ProblemType},
};

/// Memory is given out in pieces of so many bytes, because what is taken at once is counted in 32 bits.
const PIECE_BYTES: u64 = 1 << 16;

/// Memory that requests under way may take together; cheap to clone.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    pieces: Arc<Semaphore>,
    most_bytes: u64,
    metrics: Metrics,
}

impl Memory {
    pub(crate) fn new(most_bytes: u64, metrics: &Metrics) -> Self {
        let pieces = usize::try_from(pieces(most_bytes)).unwrap_or(Semaphore::MAX_PERMITS);
        let pieces = Arc::new(Semaphore::new(pieces.min(Semaphore::MAX_PERMITS)));
        Memory { pieces, most_bytes, metrics: metrics.clone() }
    }

    /// Returns the right to so many bytes; refused at once where others have them.
    pub(crate) fn reserve(&self, bytes: u64) -> Result<Reserved, Problem> {
        let mut reserved = Reserved { memory: self.clone(), bytes: 0, pieces: None };
        reserved.grow_to(bytes)?;
        Ok(reserved)
    }

    /// Returns the right to so many bytes while half of the memory is free, for what can be done without.
    pub(crate) fn spare(&self, bytes: u64) -> Option<Reserved> {
        if (self.pieces.available_permits() as u64) < pieces(self.most_bytes / 2) {
            return None;
        }
        let pieces = self.take(pieces(bytes))?;
        let mut reserved = Reserved { memory: self.clone(), bytes: 0, pieces: Some(pieces) };
        reserved.count(bytes);
        Some(reserved)
    }

    fn take(&self, count: u64) -> Option<OwnedSemaphorePermit> {
        let wanted = u32::try_from(count).unwrap_or(u32::MAX);
        Arc::clone(&self.pieces).try_acquire_many_owned(wanted).ok()
    }

    fn take_or_refuse(&self, count: u64) -> Result<OwnedSemaphorePermit, Problem> {
        self.take(count).ok_or_else(|| {
            self.metrics.shed.get_or_create(&ShedLabels { reason: "memory" }).inc();
            let detail =
                "requests under way have the memory that this one needs: try again when they are done";
            Problem::new(ProblemType::Overloaded, detail)
        })
    }

    fn refuse_beyond(&self, bytes: u64) -> Result<(), Problem> {
        if bytes <= self.most_bytes {
            return Ok(());
        }
        let detail = format!(
            "the request would take about {} MB, more than the {} MB that requests may: send a smaller map, or store it first",
            bytes.div_ceil(1_000_000),
            self.most_bytes / 1_000_000
        );
        Err(Problem::new(ProblemType::TooLarge, detail))
    }
}

/// The right to memory until it is dropped.
#[derive(Debug)]
pub(crate) struct Reserved {
    memory: Memory,
    bytes: u64,
    pieces: Option<OwnedSemaphorePermit>,
}

impl Reserved {
    /// Reserves more, so that it stands for so many bytes; what it has stays where there is no more.
    pub(crate) fn grow_to(&mut self, bytes: u64) -> Result<(), Problem> {
        if bytes <= self.bytes {
            return Ok(());
        }
        self.memory.refuse_beyond(bytes)?;
        let missing = pieces(bytes) - pieces(self.bytes);
        if missing > 0 {
            let more = self.memory.take_or_refuse(missing)?;
            match &mut self.pieces {
                Some(pieces) => pieces.merge(more),
                None => self.pieces = Some(more),
            }
        }
        self.count(bytes);
        Ok(())
    }

    /// Gives back what exceeds so many bytes.
    pub(crate) fn shrink_to(&mut self, bytes: u64) {
        if bytes >= self.bytes {
            return;
        }
        let spare = usize::try_from(pieces(self.bytes) - pieces(bytes)).unwrap_or(0);
        drop(self.pieces.as_mut().and_then(|pieces| pieces.split(spare)));
        self.count(bytes);
    }

    fn count(&mut self, bytes: u64) {
        let signed = |bytes| i64::try_from(bytes).unwrap_or(i64::MAX);
        self.memory.metrics.reserved_bytes.inc_by(signed(bytes) - signed(self.bytes));
        self.bytes = bytes;
    }
}

impl Drop for Reserved {
    fn drop(&mut self) {
        self.count(0);
    }
}

fn pieces(bytes: u64) -> u64 {
    bytes.div_ceil(PIECE_BYTES)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn memory() -> Memory {
        Memory::new(10_000_000, &Metrics::new())
    }

    #[test]
    fn memory_is_given_out_once_and_given_back() {
        let memory = memory();
        assert_eq!(memory.reserve(11_000_000).unwrap_err().kind, ProblemType::TooLarge);
        let most = memory.reserve(9_000_000).unwrap();
        assert_eq!(memory.reserve(2_000_000).unwrap_err().kind, ProblemType::Overloaded);
        drop(most);
        assert!(memory.reserve(2_000_000).is_ok());
        assert_eq!(memory.metrics.reserved_bytes.get(), 0);
    }

    #[test]
    fn only_half_of_the_memory_is_spare() {
        let memory = memory();
        let spare: Vec<Reserved> = std::iter::from_fn(|| memory.spare(1_000_000)).collect();
        assert_eq!(spare.len(), 5, "the last one began while half was free");
        assert!(memory.reserve(3_000_000).is_ok());
    }

    #[test]
    fn a_reservation_grows_and_shrinks_without_losing_any() {
        let memory = memory();
        let all = memory.pieces.available_permits();
        let mut reserved = memory.reserve(10).unwrap();
        for bytes in [70_000, 70_001, 5_000_000, 10_000_000] {
            reserved.grow_to(bytes).unwrap();
            assert_eq!((reserved.bytes, memory.metrics.reserved_bytes.get()), (bytes, bytes as i64));
        }
        assert_eq!(memory.reserve(100_000).unwrap_err().kind, ProblemType::Overloaded);
        assert_eq!(reserved.grow_to(10_000_001).unwrap_err().kind, ProblemType::TooLarge);
        reserved.shrink_to(65_537);
        assert_eq!(memory.pieces.available_permits(), all - 2);
        assert!(memory.reserve(9_000_000).is_ok());
        drop(reserved);
        assert_eq!(memory.pieces.available_permits(), all);
    }
}
