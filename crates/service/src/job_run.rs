//! Jobs from the request that asks for one to the report of it.
//!
//! What a job is to do is in the store before it is accepted, and what came of it before it is told. In between the service
//! holds the job's lease; when it is killed, the lease ends, and whoever watches the store takes the job up.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use serde_json::Value;
use tokio::time::{MissedTickBehavior, interval, sleep};

use crate::{
    Engine, Tenant,
    job::{Job, JobState, Status},
    job_records::{Description, Report, cancelled},
    problem::{Problem, ProblemType},
    routes::jobs::JobAnswer,
    store::{Beat, Lease},
};

/// How often a holder writes its lease anew before that would have ended.
const BEATS_OF_A_LEASE: u32 = 3;
/// Longest time until a job stops here that was called off elsewhere, and half of what it may take to free its place.
const LONGEST_LOOK: Duration = Duration::from_millis(500);
/// First wait before a report is offered again to a store that is out of reach.
const FIRST_WAIT: Duration = Duration::from_millis(500);
/// Longest wait before a report is offered again to a store that is out of reach.
const LONGEST_WAIT: Duration = Duration::from_secs(30);

/// What a job does, once its request was found right.
pub(crate) trait Work: Send + 'static {
    /// Does it, on a thread for computations; tells the job how far it is, and ends soon after the job is called off.
    fn run(self: Box<Self>, engine: &Engine, job: &Arc<Job>) -> Result<Value, Problem>;
}

/// A job that is to be taken up here.
pub(crate) struct Attempt<'a> {
    pub(crate) id: &'a str,
    pub(crate) description: &'a Description,
    /// Number of the lease that has ended, 0 where there was none.
    pub(crate) after: u64,
    /// What is written first.
    pub(crate) beat: Beat,
}

impl Engine {
    /// Accepts a job: it is in the store when this returns. The same job is the one that waits, runs or has ended already;
    /// one that was called off, or failed by a fault of the service, is done anew.
    pub(crate) async fn ask(
        &self,
        description: &Description,
        work: Box<dyn Work>,
    ) -> Result<JobAnswer, Problem> {
        let (id, owner) = (description.id()?, &description.owner);
        if let Some(job) = self.jobs().get(&id).filter(|job| !job.status().is_last()) {
            return Ok(JobAnswer::of(&job.id, &job.kind, job.status()));
        }
        if let Some(report) = self.records().report(owner, &id).await? {
            if report.is_final() {
                return Ok(report.job);
            }
            self.records().close(&id).await?;
            self.records().forget(owner, &id).await?;
        }
        self.jobs().refuse_beyond(self.limits().open_jobs)?;
        self.records().describe(&id, description, self.limits().tenant_jobs).await?;
        let attempt = Attempt { id: &id, description, after: 0, beat: Beat::first(0) };
        match self.take_up(attempt, work).await? {
            Some(job) => Ok(JobAnswer::of(&job.id, &job.kind, job.status())),
            None => Ok(self.records().look_up(owner, &id).await?.1.job),
        }
    }

    /// Takes a job up whose last lease has ended, if no other does.
    pub(crate) async fn take_up(
        &self,
        attempt: Attempt<'_>,
        work: Box<dyn Work>,
    ) -> Result<Option<Arc<Job>>, Problem> {
        let Attempt { id, description: Description { owner, kind, .. }, after, beat } = attempt;
        let Some(lease) = Lease::take(&self.records().store, id, after, &beat).await? else {
            return Ok(None);
        };
        if self.records().has_report(owner, id).await? {
            // It was asked here before it had ended elsewhere, and written down after.
            self.records().close(id).await?;
            return Ok(None);
        }
        let job = Arc::new(Job::new(id, kind, lease, beat).owned_by(owner));
        let added = self.jobs().add(&job, self.limits().open_jobs);
        if !matches!(added, Ok(true)) {
            // Another request was faster to the last place, or work on the job has not yet found that its lease ended. Whoever
            // watches the store takes the job up later.
            self.hand_back(&job).await;
            return added.map(|_| None);
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

    /// Keeps the lease of a job until it is given up or lost, and stops the job soon after it has ended elsewhere.
    async fn beat(self, job: Arc<Job>) {
        let between_beats = self.limits().lease_time / BEATS_OF_A_LEASE;
        let mut looks = interval(between_beats.min(LONGEST_LOOK));
        looks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut beaten: Option<Instant> = None;
        loop {
            looks.tick().await;
            let mut held = job.lease.lock().await;
            let Some(lease) = held.as_ref() else { return };
            let is_due = beaten.is_none_or(|at| at.elapsed() >= between_beats);
            let beat = async {
                let ended = self.records().has_report(&job.owner, &job.id).await?;
                Ok::<_, Problem>(!ended && (!is_due || lease.beat(&self.records().store, &job.beat()).await?))
            };
            match beat.await {
                Ok(true) if is_due => beaten = Some(Instant::now()),
                // A store that is out of reach now may be back before the lease ends.
                Ok(true) | Err(_) => {}
                Ok(false) => {
                    give_up(&mut held, &job);
                    return;
                }
            }
        }
    }

    /// Writes down that work on a job begins, before it does: a service that dies of it is then known to have. Waits for a store
    /// that is out of reach for as long as the job is wanted.
    pub(crate) async fn begin(&self, job: &Job) -> Result<(), Problem> {
        let mut wait = FIRST_WAIT;
        loop {
            match self.write_beginning(job).await {
                Err(problem) if problem.kind == ProblemType::StoreUnavailable => {}
                written => return written,
            }
            job.wait_for("the store");
            tokio::select! {
                () = sleep(wait) => {}
                () = job.unwanted() => return Err(called_off()),
            }
            wait = (2 * wait).min(LONGEST_WAIT);
        }
    }

    async fn write_beginning(&self, job: &Job) -> Result<(), Problem> {
        let mut held = job.lease.lock().await;
        let Some(lease) = held.as_ref().filter(|_| !job.is_called_off()) else { return Err(called_off()) };
        let beat = Beat { state: JobState::Running, ..job.beat() };
        if !lease.beat(&self.records().store, &beat).await? {
            give_up(&mut held, job);
            return Err(called_off());
        }
        job.tell("starting", None);
        Ok(())
    }

    /// Writes down what came of a job, then tells it. Without the lease, that is for its new holder to do.
    async fn conclude(&self, job: &Arc<Job>, outcome: Result<Arc<Value>, Problem>) {
        let mut wait = FIRST_WAIT;
        while !job.status().is_last() {
            let mut held = job.lease.lock().await;
            let mut status = job.status();
            if held.is_none() || status.is_last() {
                return;
            }
            status.end(outcome.clone());
            status.sequence += 1;
            if self.records().end(&job.owner, &job.id, &report(job, status)).await.is_ok() {
                *held = None;
                job.end(outcome);
                // Nobody waits for old reports to go.
                let _ = self.records().keep_latest(&job.owner, self.limits().kept_jobs).await;
                return;
            }
            drop(held);
            job.tell("waiting for the store to take the report", None);
            sleep(wait).await;
            wait = (2 * wait).min(LONGEST_WAIT);
        }
    }

    /// Calls a job off that a tenant sees, wherever it is worked on, or forgets it if it has ended. `None`: it had ended.
    pub(crate) async fn call_off(&self, tenant: &Tenant, id: &str) -> Result<Option<JobAnswer>, Problem> {
        if let Some(job) = self.jobs().get(id).filter(|job| tenant.sees(&job.owner))
            && job.call_off()
        {
            let mut held = job.lease.lock().await;
            let report = report(&job, job.status());
            self.records().cancel(&job.owner, id, &report).await?;
            *held = None;
            self.jobs().remove(&job);
            return Ok(Some(report.job));
        }
        let (owner, known) = self.records().look_up(tenant, id).await?;
        if known.job.state.is_final() {
            self.records().forget(&owner, id).await?;
            return Ok(None);
        }
        let report = cancelled(known);
        self.records().cancel(&owner, id, &report).await?;
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
            let _ = lease.beat(&self.records().store, &job.beat()).await;
        }
    }
}

/// Leaves a job to the service that took it up since, or has ended it.
fn give_up(held: &mut Option<Lease>, job: &Job) {
    tracing::info!(job = job.id, "another service has ended the job or works on it");
    *held = None;
    job.hand_back();
}

fn report(job: &Job, status: Status) -> Report {
    Report { sequence: status.sequence, job: JobAnswer::of(&job.id, &job.kind, status) }
}

/// What a job is told that was to begin after it was called off.
pub(crate) fn called_off() -> Problem {
    Problem::new(ProblemType::Internal, "the job was called off")
}
