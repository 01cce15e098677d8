//! What all requests share: limits, maps, and the right to compute.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

use planner::Patience;
use tokio::sync::Semaphore;

use crate::{
    limits::Limits,
    planners::Planners,
    problem::{Problem, ProblemType},
    store::MapStore,
};

/// The state behind the router; cheap to clone.
#[derive(Clone)]
pub struct Engine(Arc<Shared>);

struct Shared {
    limits: Limits,
    maps: MapStore,
    planners: Planners,
    turns: Arc<Semaphore>,
}

/// Cancels a computation when its request is dropped, as it is when the client leaves.
struct Asked(Arc<AtomicBool>);

impl Drop for Asked {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Engine {
    /// An engine without maps.
    pub fn new(limits: Limits) -> Self {
        let turns = Arc::new(Semaphore::new(limits.parallel_plans.max(1)));
        Engine(Arc::new(Shared { limits, maps: MapStore::default(), planners: Planners::default(), turns }))
    }

    /// What one request may ask for.
    pub fn limits(&self) -> &Limits {
        &self.0.limits
    }

    pub(crate) fn maps(&self) -> &MapStore {
        &self.0.maps
    }

    pub(crate) fn planners(&self) -> &Planners {
        &self.0.planners
    }

    /// Runs a computation on a thread of its own, in turn; its patience ends when the request does.
    pub(crate) async fn compute<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Patience) -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let deadline = Instant::now() + self.limits().plan_time;
        let stopped = |_| Problem::new(ProblemType::Internal, "the service is stopping");
        let turn = Arc::clone(&self.0.turns).acquire_owned().await.map_err(stopped)?;
        let cancelled = Arc::new(AtomicBool::new(false));
        let asked = Asked(Arc::clone(&cancelled));
        let patience = Patience::until_or(deadline, cancelled);
        let running = tokio::task::spawn_blocking(move || {
            // The turn ends with the work, not with the request: who leaves early makes no room before it is there.
            let _turn = turn;
            work(&patience)
        });
        let outcome = running.await;
        drop(asked);
        outcome.unwrap_or_else(|failure| {
            tracing::error!(%failure, "a computation did not finish");
            Err(Problem::new(ProblemType::Internal, "the computation failed; the fault has been logged"))
        })
    }
}
