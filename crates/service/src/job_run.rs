//! Jobs from the request that asks for one to the report of it.
//!
//! What a job is to do is in the store before it is accepted, and what came of it before it is told. In between the service
//! holds the job's lease; when it is killed, the lease ends, and whoever watches the store takes the job up.

use std::{sync::Arc, time::Duration};

use serde_json::Value;
use tokio::time::{MissedTickBehavior, interval, sleep};

use crate::{
    Engine,
    job::{Job, Status},
    job_records::{Description, Report, cancelled},
    problem::{Problem, ProblemType},
    routes::jobs::JobAnswer,
    store::{Beat, Lease},
};

/// How often a holder writes its lease anew before that would have ended.
const BEATS_OF_A_LEASE: u32 = 3;
/// First wait before a report is offered again to a store that is out of reach.
const FIRST_WAIT: Duration = Duration::from_millis(500);
/// Longest wait before a report is offered again to a store that is out of reach.
const LONGEST_WAIT: Duration = Duration::from_secs(30);

/// What a job does, once its request was found right.
pub(crate) trait Work: Send + 'static {
    /// Does it, on a thread for computations; tells the job how far it is, and ends soon after the job is called off.
    fn run(self: Box<Self>, engine: &Engine, job: &Arc<Job>) -> Result<Value, Problem>;
}

impl Engine {
    /// Accepts a job: it is in the store when this returns. The same job is the one that waits, runs or has ended already;
    /// one that was called off, or failed by a fault of the service, is done anew.
    pub(crate) async fn ask(
        &self,
        description: &Description,
        work: Box<dyn Work>,
    ) -> Result<JobAnswer, Problem> {
        let id = description.id()?;
        if let Some(job) = self.jobs().get(&id).filter(|job| !job.status().is_last()) {
            return Ok(JobAnswer::of(&job.id, &job.kind, job.status()));
        }
        if let Some(report) = self.records().report(&id).await? {
            if report.is_final() {
                return Ok(report.job);
            }
            self.records().close(&id).await?;
            self.records().forget(&id).await?;
        }
        self.jobs().refuse_beyond(self.limits().open_jobs)?;
        self.records().describe(&id, description).await?;
        match self.take_up(&id, &description.kind, 0, Beat::first(0), work).await? {
            Some(job) => Ok(JobAnswer::of(&job.id, &job.kind, job.status())),
            None => Ok(self.records().look_up(&id).await?.job),
        }
    }

    /// Takes a job up whose lease of this number has ended, if no other does.
    pub(crate) async fn take_up(
        &self,
        id: &str,
        kind: &str,
        after: u64,
        beat: Beat,
        work: Box<dyn Work>,
    ) -> Result<Option<Arc<Job>>, Problem> {
        let Some(lease) = Lease::take(&self.records().store, id, after, &beat).await? else {
            return Ok(None);
        };
        if self.records().has_report(id).await? {
            // It was asked here before it had ended elsewhere, and written down after.
            self.records().close(id).await?;
            return Ok(None);
        }
        let job = Arc::new(Job::new(id, kind, lease, beat));
        if let Err(problem) = self.jobs().add(&job, self.limits().open_jobs) {
            // Another request was faster to the last place. Whoever watches the store takes the job up later.
            self.hand_back(&job).await;
            return Err(problem);
        }
        let (engine, started) = (self.clone(), Arc::clone(&job));
        tokio::spawn(async move {
            let beating = tokio::spawn(engine.clone().beat(Arc::clone(&started)));
            let outcome = engine.run(&started, work).await;
            engine.conclude(&started, outcome.map(Arc::new)).await;
            beating.abort();
            engine.jobs().remove(&started);
        });
        Ok(Some(job))
    }

    /// Keeps the lease of a job until it is given up or lost.
    async fn beat(self, job: Arc<Job>) {
        let mut beats = interval(self.limits().lease_time / BEATS_OF_A_LEASE);
        beats.set_missed_tick_behavior(MissedTickBehavior::Delay);
        for count in 1.. {
            beats.tick().await;
            let mut held = job.lease.lock().await;
            let Some(lease) = held.as_ref() else { return };
            let beat = async {
                let ended = self.records().has_report(&job.id).await?;
                Ok::<_, Problem>(!ended && lease.beat(&self.records().store, &job.beat(count)).await?)
            };
            // A store that is out of reach now may be back before the lease ends.
            if let Ok(false) = beat.await {
                tracing::info!(job = job.id, "another service has ended the job or works on it");
                *held = None;
                job.hand_back();
                return;
            }
        }
    }

    /// Writes down what came of a job, then tells it.
    async fn conclude(&self, job: &Arc<Job>, outcome: Result<Arc<Value>, Problem>) {
        let mut wait = FIRST_WAIT;
        while !job.status().is_last() {
            let mut held = job.lease.lock().await;
            let mut status = job.status();
            status.end(outcome.clone());
            status.sequence += 1;
            if self.records().end(&job.id, &report(job, status)).await.is_ok() {
                *held = None;
                job.end(outcome);
                // Nobody waits for old reports to go.
                let _ = self.records().keep_latest(self.limits().kept_jobs).await;
                return;
            }
            drop(held);
            job.tell("waiting for the store to take the report", None);
            sleep(wait).await;
            wait = (2 * wait).min(LONGEST_WAIT);
        }
    }

    /// Calls a job off, wherever it is worked on, or forgets it if it has ended. `None`: it had ended.
    pub(crate) async fn call_off(&self, id: &str) -> Result<Option<JobAnswer>, Problem> {
        if let Some(job) = self.jobs().get(id)
            && job.call_off()
        {
            let mut held = job.lease.lock().await;
            let report = report(&job, job.status());
            self.records().cancel(id, &report).await?;
            *held = None;
            self.jobs().remove(&job);
            return Ok(Some(report.job));
        }
        let known = self.records().look_up(id).await?;
        if known.job.state.is_final() {
            self.records().forget(id).await?;
            return Ok(None);
        }
        let report = cancelled(known);
        self.records().cancel(id, &report).await?;
        Ok(Some(report.job))
    }

    /// Stops all work of this service and gives up its leases, so that the jobs are taken up at once by another, or by this
    /// one after its restart. Where the store ends with the service, they are called off.
    pub(crate) async fn hand_back_jobs(&self) {
        for job in self.jobs().all() {
            if !self.records().store.outlasts_service() {
                job.call_off();
                continue;
            }
            self.hand_back(&job).await;
        }
    }

    async fn hand_back(&self, job: &Job) {
        job.hand_back();
        if let Some(lease) = job.lease.lock().await.take() {
            // Without a word the lease ends by itself, only later.
            let _ = lease.beat(&self.records().store, &job.beat(u64::MAX)).await;
        }
    }
}

fn report(job: &Job, status: Status) -> Report {
    Report { sequence: status.sequence, job: JobAnswer::of(&job.id, &job.kind, status) }
}

/// What a job is told that was to begin after it was called off.
pub(crate) fn called_off() -> Problem {
    Problem::new(ProblemType::Internal, "the job was called off")
}
