//! What one request has reserved until nothing of it is at work any more.

use std::sync::{Arc, Mutex, PoisonError};

use axum::{extract::Request, middleware::Next, response::Response};

use super::Reserved;

tokio::task_local! {
    /// The account of the request that the running task answers.
    static CURRENT: Arc<Account>;
}

/// Reservations of a request: its document, the stored maps that it uses. They end when the last holder of the account is
/// dropped: the request itself, or work that outlasts it because its client left.
#[derive(Default)]
pub(crate) struct Account(Mutex<Vec<Arc<Reserved>>>);

impl Account {
    /// The account of the running request; a new one where there is none, as in a job.
    pub(crate) fn current() -> Arc<Account> {
        CURRENT.try_with(Arc::clone).unwrap_or_default()
    }

    /// Does work of the request on another thread, which holds the account meanwhile.
    pub(crate) fn during<T>(self: Arc<Self>, work: impl FnOnce() -> T) -> T {
        CURRENT.sync_scope(self, work)
    }
}

/// Keeps a reservation until the running request has ended and all work for it.
pub(crate) fn hold(reserved: Arc<Reserved>) {
    Account::current().0.lock().unwrap_or_else(PoisonError::into_inner).push(reserved);
}

/// Opens an account for a request.
pub(crate) async fn accounted(request: Request, next: Next) -> Response {
    CURRENT.scope(Arc::default(), next.run(request)).await
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{memory::Memory, metrics::Metrics};

    #[tokio::test]
    async fn what_is_held_lasts_as_long_as_the_request_and_its_work() {
        let metrics = Metrics::new();
        let memory = Memory::new(1 << 20, &metrics);
        let work = CURRENT
            .scope(Arc::default(), async {
                hold(Arc::new(memory.reserve(1000).unwrap()));
                Account::current()
            })
            .await;
        assert_eq!(metrics.reserved_bytes.get(), 1000, "the work goes on");
        drop(work);
        assert_eq!(metrics.reserved_bytes.get(), 0);
    }
}
