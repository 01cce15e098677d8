//! What all requests share: limits, maps, and the right to compute.

use std::sync::Arc;

use tokio::sync::Semaphore;

use crate::{
    limits::Limits,
    problem::{Problem, ProblemType},
    store::MapStore,
};

/// The state behind the router; cheap to clone.
#[derive(Clone, Debug)]
pub struct Engine(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    limits: Limits,
    maps: MapStore,
    turns: Semaphore,
}

impl Engine {
    /// An engine without maps.
    pub fn new(limits: Limits) -> Self {
        let turns = Semaphore::new(limits.parallel_plans.max(1));
        Engine(Arc::new(Shared { limits, maps: MapStore::default(), turns }))
    }

    /// What one request may ask for.
    pub fn limits(&self) -> &Limits {
        &self.0.limits
    }

    pub(crate) fn maps(&self) -> &MapStore {
        &self.0.maps
    }

    /// Runs a computation on a thread of its own, in turn.
    pub(crate) async fn compute<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let stopped = || Problem::new(ProblemType::Internal, "the service is stopping");
        let _turn = self.0.turns.acquire().await.map_err(|_| stopped())?;
        tokio::task::spawn_blocking(work).await.unwrap_or_else(|failure| {
            tracing::error!(%failure, "a computation did not finish");
            Err(Problem::new(ProblemType::Internal, "the computation failed; the fault has been logged"))
        })
    }
}
