//! What the store knows of jobs: what each is to do, who works on it, and what came of it.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};

use crate::{
    job::{JobState, Progress},
    problem::{Problem, ProblemType},
    routes::jobs::JobAnswer,
    store::{Beat, Lease, Notes, Store, id_of, is_id, shown},
};

/// What a job is to do: enough to do it again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Description {
    /// What it does, as `calibrate`.
    pub(crate) kind: String,
    /// Which program would do it: another may find something else.
    version: String,
    /// The request, with all that it named looked up.
    pub(crate) request: Value,
    /// What else its result depends on.
    inputs: Value,
}

impl Description {
    pub(crate) fn new(kind: &str, request: Value, inputs: Value) -> Self {
        Description { kind: kind.to_owned(), version: env!("CARGO_PKG_VERSION").to_owned(), request, inputs }
    }

    /// The hash of it, so that the same job asked twice is one.
    pub(crate) fn id(&self) -> Result<String, Problem> {
        let bytes = serde_json::to_vec(self).map_err(|error| {
            Problem::new(ProblemType::Internal, format!("the job cannot be written: {error}"))
        })?;
        Ok(id_of(Sha256::new_with_prefix(bytes)))
    }
}

/// What came of a job.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Report {
    /// The number of its last change.
    pub(crate) sequence: u64,
    /// The job, as it stays.
    pub(crate) job: JobAnswer,
}

impl Report {
    /// Whether the same would come of it again: neither called off nor failed by a fault of the service.
    pub(crate) fn is_final(&self) -> bool {
        let by_fault = self.job.problem.as_ref().is_some_and(|problem| problem.status >= 500);
        self.job.state != JobState::Cancelled && !by_fault
    }
}

/// The jobs of a store. A description says that a job is open; a report that it has ended.
#[derive(Debug)]
pub(crate) struct JobRecords {
    pub(crate) store: Store,
    descriptions: Notes<Description>,
    reports: Notes<Report>,
}

impl JobRecords {
    pub(crate) fn new(store: &Store) -> Self {
        let (descriptions, reports) = (Notes::new(store, "jobs"), Notes::new(store, "reports"));
        JobRecords { store: store.clone(), descriptions, reports }
    }

    /// Writes down what a job is to do.
    pub(crate) async fn describe(&self, id: &str, description: &Description) -> Result<(), Problem> {
        self.descriptions.put(id, description).await
    }

    pub(crate) async fn description(&self, id: &str) -> Result<Option<Description>, Problem> {
        self.descriptions.get(id).await
    }

    pub(crate) async fn report(&self, id: &str) -> Result<Option<Report>, Problem> {
        self.reports.get(id).await
    }

    pub(crate) async fn has_report(&self, id: &str) -> Result<bool, Problem> {
        self.reports.has(id).await
    }

    /// The ids of jobs that have not ended.
    pub(crate) async fn open(&self) -> Result<Vec<String>, Problem> {
        Ok(self.descriptions.entries().await?.into_iter().map(|(id, _)| id).collect())
    }

    /// Writes down what came of a job, unless that stands already, and that it is no longer open.
    pub(crate) async fn end(&self, id: &str, report: &Report) -> Result<(), Problem> {
        self.reports.create(id, report).await?;
        self.close(id).await
    }

    /// Writes down that a job was called off, whatever may have come of it in the meantime.
    pub(crate) async fn cancel(&self, id: &str, report: &Report) -> Result<(), Problem> {
        self.reports.put(id, report).await?;
        self.close(id).await
    }

    /// A job that has a report is no longer open, nor held by anyone.
    pub(crate) async fn close(&self, id: &str) -> Result<(), Problem> {
        self.descriptions.remove(id).await?;
        Lease::clear(&self.store, id).await
    }

    /// Forgets what came of a job.
    pub(crate) async fn forget(&self, id: &str) -> Result<(), Problem> {
        self.reports.remove(id).await
    }

    /// Forgets the reports of the jobs that ended first, beyond so many.
    pub(crate) async fn keep_latest(&self, most: usize) -> Result<(), Problem> {
        let mut entries = self.reports.entries().await?;
        let surplus = entries.len().saturating_sub(most);
        entries.sort_by_key(|(_, entry)| entry.last_modified);
        for (id, _) in &entries[..surplus] {
            self.reports.remove(id).await?;
        }
        Ok(())
    }

    /// A job as the store knows it, wherever it is worked on, with the number of its last change.
    pub(crate) async fn look_up(&self, id: &str) -> Result<Report, Problem> {
        if !is_id(id) {
            return Err(unknown(id));
        }
        if let Some(report) = self.report(id).await? {
            return Ok(report);
        }
        let Some(description) = self.description(id).await? else {
            // It may have ended between the two looks.
            return self.report(id).await?.ok_or_else(|| unknown(id));
        };
        let (attempt, beat) = Lease::latest(&self.store, id).await?.unwrap_or((0, Beat::first(0)));
        let Beat { sequence, state, progress, .. } = beat;
        let Description { kind, .. } = description;
        let job =
            JobAnswer { id: id.to_owned(), kind, state, attempt, progress, result: None, problem: None };
        Ok(Report { sequence, job })
    }
}

/// The report of a job that was called off before anyone told more of it.
pub(crate) fn cancelled(known: Report) -> Report {
    let Report { sequence, job } = known;
    let progress = Progress { step: job.progress.step, fraction: job.progress.fraction };
    Report { sequence: sequence + 1, job: JobAnswer { state: JobState::Cancelled, progress, ..job } }
}

pub(crate) fn unknown(id: &str) -> Problem {
    let detail = format!(
        "there is no job `{}`: it was deleted, or ended so long ago that it was forgotten",
        shown(id)
    );
    Problem::new(ProblemType::UnknownJob, detail)
}
