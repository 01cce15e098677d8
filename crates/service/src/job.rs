//! Long work that a request starts and others follow.

use std::{
    ops::ControlFlow,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

use recording::Watch;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use tokio::sync::{Mutex, watch};
use utoipa::ToSchema;

use crate::{
    Tenant,
    problem::Problem,
    store::{Beat, Lease},
};

/// Where a job stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
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
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
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
    /// How often the job has been taken up.
    pub(crate) attempt: u64,
    pub(crate) state: JobState,
    pub(crate) progress: Progress,
    pub(crate) result: Option<Arc<Value>>,
    pub(crate) problem: Option<Problem>,
    /// This service will say no more of it, though it has not ended.
    pub(crate) handed_back: bool,
}

/// A job that this service works on, shared between who does and who follows it.
#[derive(Debug)]
pub(crate) struct Job {
    /// Hash of what it is to do and with what.
    pub(crate) id: String,
    /// What it does, as `calibrate`.
    pub(crate) kind: String,
    /// Who asked for it.
    pub(crate) owner: Tenant,
    /// The right to work on it, held while it is written to the store; none once it was given up.
    pub(crate) lease: Mutex<Option<Lease>>,
    /// How often a service died that worked on it.
    deaths: u64,
    /// How often the lease has been written.
    beats: AtomicU64,
    called_off: AtomicBool,
    status: watch::Sender<Status>,
}

impl Job {
    /// A job that has been taken up, and whose followers have been told so much.
    pub(crate) fn new(id: &str, kind: &str, lease: Lease, beat: Beat) -> Self {
        let Beat { sequence, state, progress, deaths, .. } = beat;
        let (result, problem, handed_back) = (None, None, false);
        let attempt = lease.number;
        let status = Status { sequence, attempt, state, progress, result, problem, handed_back };
        Job {
            id: id.to_owned(),
            kind: kind.to_owned(),
            owner: Tenant::default(),
            lease: Mutex::new(Some(lease)),
            deaths,
            beats: AtomicU64::new(0),
            called_off: AtomicBool::new(false),
            status: watch::Sender::new(status),
        }
    }

    /// The same job of another owner.
    pub(crate) fn owned_by(self, owner: &Tenant) -> Self {
        Job { owner: owner.clone(), ..self }
    }

    pub(crate) fn status(&self) -> Status {
        self.status.borrow().clone()
    }

    pub(crate) fn follow(&self) -> watch::Receiver<Status> {
        self.status.subscribe()
    }

    /// Lets its work end because its time is over. What comes of it is still told.
    pub(crate) fn stop_work(&self) {
        self.called_off.store(true, Ordering::Relaxed);
    }

    /// The end of the time in which somebody wants its work.
    pub(crate) async fn unwanted(&self) {
        let mut changes = self.follow();
        // The job holds the other end.
        let _ = changes.wait_for(Status::is_last).await;
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

    /// Says what the job waits for, in the state that it is in.
    pub(crate) fn wait_for(&self, what: &str) {
        self.change(|status| {
            status.progress = Progress { step: format!("waiting for {what}"), fraction: None };
        });
    }

    /// Calls the job off. False: it had already ended.
    pub(crate) fn call_off(&self) -> bool {
        self.called_off.store(true, Ordering::Relaxed);
        self.change(|status| status.state = JobState::Cancelled)
    }

    /// Ends it with what came of it.
    pub(crate) fn end(&self, outcome: Result<Arc<Value>, Problem>) {
        self.change(|status| status.end(outcome));
    }

    /// Stops the work and says no more of the job, which another service, or this one after its restart, does anew.
    pub(crate) fn hand_back(&self) {
        self.called_off.store(true, Ordering::Relaxed);
        self.change(|status| {
            status.state = JobState::Queued;
            status.progress = Progress { step: "handed back".into(), fraction: None };
            status.handed_back = true;
        });
    }

    /// What the holder of its lease writes down next.
    pub(crate) fn beat(&self) -> Beat {
        let Status { sequence, state, progress, handed_back, .. } = self.status();
        let count = self.beats.fetch_add(1, Ordering::Relaxed) + 1;
        Beat { count, released: handed_back, deaths: self.deaths, sequence, state, progress }
    }

    /// Changes the status, unless nothing more is said of the job. Returns whether it did.
    fn change(&self, change: impl FnOnce(&mut Status)) -> bool {
        self.status.send_if_modified(|status| {
            if status.is_last() {
                return false;
            }
            change(status);
            status.sequence += 1;
            true
        })
    }
}

impl Status {
    /// Whether no other comes after it, here.
    pub(crate) fn is_last(&self) -> bool {
        self.state.is_final() || self.handed_back
    }

    /// Ends with what came of the job.
    pub(crate) fn end(&mut self, outcome: Result<Arc<Value>, Problem>) {
        match outcome {
            Ok(result) => {
                self.state = JobState::Done;
                self.result = Some(result);
            }
            Err(problem) => {
                self.state = JobState::Failed;
                self.problem = Some(problem);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job() -> Job {
        Job::new("0f", "test", Lease::first("0f"), Beat::first(0))
    }

    #[test]
    fn a_job_that_was_called_off_stays_so_whatever_its_work_still_says() {
        let job = job();
        job.tell("working", Some(0.5));
        assert!(job.call_off() && job.is_called_off());
        job.tell("still working", None);
        job.end(Ok(Value::Null.into()));
        assert!(!job.call_off(), "it can be called off once");
        let status = job.status();
        assert_eq!((status.state, status.result), (JobState::Cancelled, None));
        assert_eq!(status.progress.fraction, Some(0.5));
    }

    #[test]
    fn every_change_has_a_number_of_its_own() {
        let job = job();
        let before = job.status().sequence;
        job.tell("a", None);
        job.tell("b", None);
        job.end(Ok(Value::Null.into()));
        assert_eq!(job.status().sequence, before + 3);
    }

    #[test]
    fn a_job_that_was_handed_back_waits_again_and_its_lease_is_released() {
        let job = job();
        job.tell("working", Some(0.5));
        job.hand_back();
        job.end(Ok(Value::Null.into()));
        let beat = job.beat();
        assert!(beat.released && job.is_called_off());
        assert_eq!((beat.state, beat.count, beat.sequence), (JobState::Queued, 1, 2));
        assert_eq!(job.beat().count, 2, "every writing of a lease differs from the one before");
    }
}
