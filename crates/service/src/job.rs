//! Long work that a request starts and others follow.

use std::{
    ops::ControlFlow,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use recording::Watch;
use serde::Serialize;
use serde_json::Value;
use tokio::sync::watch;
use utoipa::ToSchema;

use crate::problem::Problem;

/// Where a job stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum JobState {
    /// It waits for its turn.
    Queued,
    /// It is under way.
    Running,
    /// It has a result.
    Done,
    /// It has a problem instead.
    Failed,
    /// It was called off.
    Cancelled,
}

impl JobState {
    /// All states by the names that they are told by.
    pub(crate) const ALL: [(JobState, &str); 5] = [
        (JobState::Queued, "queued"),
        (JobState::Running, "running"),
        (JobState::Done, "done"),
        (JobState::Failed, "failed"),
        (JobState::Cancelled, "cancelled"),
    ];

    /// Whether nothing more will happen.
    pub fn is_final(self) -> bool {
        matches!(self, JobState::Done | JobState::Failed | JobState::Cancelled)
    }
}

/// What a job is busy with.
#[derive(Clone, Debug, Default, PartialEq, Serialize, ToSchema)]
pub struct Progress {
    /// The step, in words.
    #[schema(example = "reading recording 1 of 2")]
    pub step: String,
    /// How much of the step is done, 0 to 1; null where that is not known.
    pub fraction: Option<f64>,
}

/// A job as its state was at one moment.
#[derive(Clone, Debug)]
pub(crate) struct Status {
    /// Counts the changes, so that a client that comes back knows what it has seen.
    pub(crate) sequence: u64,
    pub(crate) state: JobState,
    pub(crate) progress: Progress,
    pub(crate) result: Option<Arc<Value>>,
    pub(crate) problem: Option<Problem>,
}

/// A job, shared between who works on it and who follows it.
#[derive(Debug)]
pub(crate) struct Job {
    pub(crate) id: String,
    /// What it does, as `calibrate`.
    pub(crate) kind: &'static str,
    called_off: AtomicBool,
    status: watch::Sender<Status>,
}

impl Job {
    pub(crate) fn new(kind: &'static str) -> Self {
        let progress = Progress { step: "waiting for its turn".into(), fraction: None };
        let status = Status { sequence: 0, state: JobState::Queued, progress, result: None, problem: None };
        Job {
            id: uuid::Uuid::new_v4().simple().to_string(),
            kind,
            called_off: AtomicBool::new(false),
            status: watch::Sender::new(status),
        }
    }

    pub(crate) fn status(&self) -> Status {
        self.status.borrow().clone()
    }

    pub(crate) fn follow(&self) -> watch::Receiver<Status> {
        self.status.subscribe()
    }

    /// Whether its work is no longer wanted. Work looks at this often and ends soon after.
    pub(crate) fn is_called_off(&self) -> bool {
        self.called_off.load(Ordering::Relaxed)
    }

    /// A watch that breaks when the work is no longer wanted.
    pub(crate) fn watch(self: &Arc<Self>) -> Watch {
        let job = Arc::clone(self);
        Arc::new(
            move |_| if job.is_called_off() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) },
        )
    }

    /// Says what the job is busy with.
    pub(crate) fn tell(&self, step: &str, fraction: Option<f64>) {
        self.change(|status| {
            status.state = JobState::Running;
            status.progress = Progress { step: step.to_owned(), fraction };
        });
    }

    /// Calls the job off. False: it had already ended.
    pub(crate) fn call_off(&self) -> bool {
        self.called_off.store(true, Ordering::Relaxed);
        self.change(|status| status.state = JobState::Cancelled)
    }

    pub(crate) fn end(&self, outcome: Result<Value, Problem>) {
        self.change(|status| match outcome {
            Ok(result) => {
                status.state = JobState::Done;
                status.result = Some(Arc::new(result));
            }
            Err(problem) => {
                status.state = JobState::Failed;
                status.problem = Some(problem);
            }
        });
    }

    /// Changes the status, unless it is final. Returns whether it did.
    fn change(&self, change: impl FnOnce(&mut Status)) -> bool {
        self.status.send_if_modified(|status| {
            if status.state.is_final() {
                return false;
            }
            change(status);
            status.sequence += 1;
            true
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_that_was_called_off_stays_so_whatever_its_work_still_says() {
        let job = Job::new("test");
        job.tell("working", Some(0.5));
        assert!(job.call_off() && job.is_called_off());
        job.tell("still working", None);
        job.end(Ok(Value::Null));
        assert!(!job.call_off(), "it can be called off once");
        let status = job.status();
        assert_eq!((status.state, status.result), (JobState::Cancelled, None));
        assert_eq!(status.progress.fraction, Some(0.5));
    }

    #[test]
    fn every_change_has_a_number_of_its_own() {
        let job = Job::new("test");
        let before = job.status().sequence;
        job.tell("a", None);
        job.tell("b", None);
        job.end(Ok(Value::Null));
        assert_eq!(job.status().sequence, before + 3);
    }
}
