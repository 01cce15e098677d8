//! What the store knows of jobs: what each is to do, who works on it, and what came of it.

use std::{
    cmp::Reverse,
    collections::{BTreeMap, BTreeSet},
    time::Duration,
};

use object_store::ObjectMeta;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use tokio::sync::Mutex;

use crate::{
    Tenant,
    job::{JobState, Progress},
    problem::{Problem, ProblemType},
    routes::jobs::{JobAnswer, JobSummary},
    store::{Beat, Lease, Notes, Owned, Store, id_of, is_id, shown},
};

/// When to ask again for a job that was refused because of others [s]: jobs take minutes.
const RETRY_TIME: Duration = Duration::from_secs(10);

/// What a job is to do: enough to do it again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Description {
    /// Who asked for it. The same job of two tenants is two jobs.
    #[serde(default, skip_serializing_if = "Tenant::is_default")]
    pub(crate) owner: Tenant,
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
    pub(crate) fn new(owner: &Tenant, kind: &str, request: Value, inputs: Value) -> Self {
        let (owner, kind) = (owner.clone(), kind.to_owned());
        Description { owner, kind, version: env!("CARGO_PKG_VERSION").to_owned(), request, inputs }
    }

    /// The hash of it, so that the same job asked twice is one.
    pub(crate) fn id(&self) -> Result<String, Problem> {
        let bytes = serde_json::to_vec(self).map_err(|error| {
            Problem::new(ProblemType::Internal, format!("the job cannot be written: {error}"))
        })?;
        Ok(id_of(Sha256::new_with_prefix(bytes)))
    }
}

/// The part of a description that is kept in memory.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct DescriptionHead {
    #[serde(default)]
    owner: Tenant,
}

/// The part of a report that is kept in memory.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct ReportHead {
    job: JobSummary,
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
    description_heads: Notes<DescriptionHead>,
    reports: Owned<Report>,
    report_heads: Owned<ReportHead>,
    /// Held while a job is counted and written down.
    asking: Mutex<()>,
}

impl JobRecords {
    pub(crate) fn new(store: &Store) -> Self {
        JobRecords {
            store: store.clone(),
            descriptions: Notes::new(store, "jobs"),
            description_heads: Notes::new(store, "jobs"),
            reports: Owned::new(store, "reports"),
            report_heads: Owned::new(store, "reports"),
            asking: Mutex::default(),
        }
    }

    /// Writes down what a job is to do, unless that stands already, or as many jobs of its owner are open as may.
    pub(crate) async fn describe(
        &self,
        id: &str,
        description: &Description,
        most_open: usize,
    ) -> Result<(), Problem> {
        let _asking = self.asking.lock().await;
        if self.descriptions.has(id).await? {
            return Ok(());
        }
        self.refuse_beyond(&description.owner, 1, most_open).await?;
        self.descriptions.put(id, description).await?;
        // Another service may have written one down since they were counted.
        if let Err(problem) = self.refuse_beyond(&description.owner, 0, most_open).await {
            self.close(id).await?;
            return Err(problem);
        }
        Ok(())
    }

    /// Refuses a tenant so many more open jobs. An administrator has no quota.
    async fn refuse_beyond(&self, owner: &Tenant, more: usize, most: usize) -> Result<(), Problem> {
        if owner.is_admin() || self.open_of(owner).await? + more <= most {
            return Ok(());
        }
        let detail = format!(
            "{most} jobs of the tenant `{}` wait or run already: try again when one has ended, or cancel one",
            owner.name()
        );
        Err(Problem::new(ProblemType::QuotaExceeded, detail).retry_after(RETRY_TIME))
    }

    pub(crate) async fn description(&self, id: &str) -> Result<Option<Description>, Problem> {
        self.descriptions.get(id).await
    }

    /// The report of a job that a tenant sees.
    pub(crate) async fn report(&self, tenant: &Tenant, id: &str) -> Result<Option<Report>, Problem> {
        self.reports.get(tenant, id).await
    }

    pub(crate) async fn has_report(&self, owner: &Tenant, id: &str) -> Result<bool, Problem> {
        self.reports.of(owner).has(id).await
    }

    /// The ids of jobs that have not ended, with their owners.
    pub(crate) async fn open(&self) -> Result<BTreeMap<String, Tenant>, Problem> {
        let heads = self.description_heads.list().await?;
        Ok(heads.into_iter().map(|(id, head)| (id, head.owner.clone())).collect())
    }

    /// The ids of jobs that have not ended, those among them whose description cannot be understood here.
    pub(crate) async fn described(&self) -> Result<BTreeSet<String>, Problem> {
        Ok(self.descriptions.entries().await?.into_iter().map(|(id, _)| id).collect())
    }

    /// Number of a tenant's jobs that have not ended.
    pub(crate) async fn open_of(&self, owner: &Tenant) -> Result<usize, Problem> {
        Ok(self.open().await?.values().filter(|other| *other == owner).count())
    }

    /// Writes down what came of a job, unless that stands already, and that it is no longer open.
    pub(crate) async fn end(&self, owner: &Tenant, id: &str, report: &Report) -> Result<(), Problem> {
        self.reports.of(owner).create(id, report).await?;
        self.close(id).await
    }

    /// Writes down that a job was called off, whatever may have come of it in the meantime.
    pub(crate) async fn cancel(&self, owner: &Tenant, id: &str, report: &Report) -> Result<(), Problem> {
        self.reports.of(owner).put(id, report).await?;
        self.close(id).await
    }

    /// A job that has a report is no longer open, nor held by anyone.
    pub(crate) async fn close(&self, id: &str) -> Result<(), Problem> {
        self.descriptions.remove(id).await?;
        Lease::clear(&self.store, id).await
    }

    /// Forgets what came of a job.
    pub(crate) async fn forget(&self, owner: &Tenant, id: &str) -> Result<(), Problem> {
        self.reports.remove(owner, id).await
    }

    /// Forgets the reports of a tenant's jobs that ended first, beyond so many.
    pub(crate) async fn keep_latest(&self, owner: &Tenant, most: usize) -> Result<(), Problem> {
        let mut entries = self.reports.of(owner).entries().await?;
        let surplus = entries.len().saturating_sub(most);
        entries.sort_by_key(|(_, entry)| entry.last_modified);
        for (id, _) in entries.iter().take(surplus) {
            self.reports.remove(owner, id).await?;
        }
        Ok(())
    }

    /// A job that a tenant sees, with its owner, as the store knows it wherever it is worked on.
    pub(crate) async fn look_up(&self, tenant: &Tenant, id: &str) -> Result<(Tenant, Report), Problem> {
        if !is_id(id) {
            return Err(unknown(id));
        }
        if let Some(found) = self.reports.find(tenant, id).await? {
            return Ok(found);
        }
        let described = self.description(id).await?.filter(|described| tenant.sees(&described.owner));
        let Some(Description { owner, kind, .. }) = described else {
            // It may have ended between the two looks.
            return self.reports.find(tenant, id).await?.ok_or_else(|| unknown(id));
        };
        let (attempt, beat) = Lease::latest(&self.store, id).await?.unwrap_or((0, Beat::first(0)));
        let Beat { sequence, state, progress, .. } = beat;
        let job =
            JobAnswer { id: id.to_owned(), kind, state, attempt, progress, result: None, problem: None };
        Ok((owner, Report { sequence, job }))
    }

    /// All jobs that a tenant sees: those that are open, the latest first, then those that have ended, the latest first.
    pub(crate) async fn list(&self, tenant: &Tenant) -> Result<Vec<JobSummary>, Problem> {
        let owners = self.open().await?;
        let mut open = self.descriptions.entries().await?;
        open.retain(|(id, _)| owners.get(id).is_some_and(|owner| tenant.sees(owner)));
        let mut jobs = Vec::new();
        for id in latest_first(open) {
            match self.look_up(tenant, &id).await {
                Ok((_, report)) => jobs.push(JobSummary::from(&report.job)),
                // It was forgotten since it was listed.
                Err(problem) if problem.kind == ProblemType::UnknownJob => {}
                Err(problem) => return Err(problem),
            }
        }
        let listed: BTreeSet<String> = jobs.iter().map(|job| job.id.clone()).collect();
        let (mut ended, mut summaries) = (Vec::new(), BTreeMap::new());
        for owner in self.report_heads.visible(tenant).await? {
            let reports = self.report_heads.of(&owner);
            ended.extend(reports.entries().await?);
            summaries.extend(reports.list().await?);
        }
        let ended = latest_first(ended).into_iter().filter(|id| !listed.contains(id));
        jobs.extend(ended.filter_map(|id| Some(summaries.get(&id)?.job.clone())));
        Ok(jobs)
    }
}

/// Ids by when the store says that they were last written.
fn latest_first(mut entries: Vec<(String, ObjectMeta)>) -> Vec<String> {
    entries.sort_by_key(|(_, entry)| Reverse(entry.last_modified));
    entries.into_iter().map(|(id, _)| id).collect()
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
