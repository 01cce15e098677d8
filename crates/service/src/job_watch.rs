//! Takes up jobs that nobody works on any more.

use std::collections::{BTreeMap, BTreeSet};

use tokio::time::{MissedTickBehavior, interval};

use crate::{
    Engine, Tenant,
    job::JobState,
    job_records::{Description, Report},
    job_run::Attempt,
    problem::{Problem, ProblemType},
    routes::{self, jobs::JobAnswer},
    store::{Beat, Lease, Watched, leased},
};

/// How often the store is looked at while a lease lasts.
const LOOKS_OF_A_LEASE: u32 = 2;
/// Deaths of services after which a job that they worked on is not taken up again.
const MOST_DEATHS: u64 = 2;

impl Engine {
    /// Looks at the store's open jobs, at once and then for as long as the service runs.
    pub(crate) async fn watch_jobs(self) {
        let mut looks = interval(self.limits().lease_time / LOOKS_OF_A_LEASE);
        looks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let (mut watched, mut strays) = (BTreeMap::new(), BTreeSet::new());
        loop {
            looks.tick().await;
            // A store that is out of reach is looked at again.
            let _ = self.look(&mut watched).await;
            let _ = self.clear_strays(&mut strays).await;
        }
    }

    /// Removes leases without a job, which a holder wrote while the job was ended elsewhere.
    async fn clear_strays(&self, seen: &mut BTreeSet<String>) -> Result<(), Problem> {
        let mut strays = leased(&self.records().store).await?;
        let open = self.records().described().await?;
        strays.retain(|id| !open.contains(id) && self.jobs().get(id).is_none());
        for id in strays.intersection(seen) {
            Lease::clear(&self.records().store, id).await?;
        }
        *seen = strays;
        Ok(())
    }

    async fn look(&self, watched: &mut BTreeMap<String, Watched>) -> Result<(), Problem> {
        let open = self.records().open().await?;
        watched.retain(|id, _| open.contains_key(id));
        for (id, owner) in open {
            if self.jobs().get(&id).is_some() {
                continue;
            }
            if let Err(problem) = self.look_at(&id, &owner, watched).await {
                tracing::warn!(
                    job = id,
                    why = problem.detail,
                    "cannot look after a job: it is looked at again"
                );
            }
        }
        Ok(())
    }

    /// Takes one open job up if nobody works on it any more and there is a place for it.
    async fn look_at(
        &self,
        id: &str,
        owner: &Tenant,
        watched: &mut BTreeMap<String, Watched>,
    ) -> Result<(), Problem> {
        if self.records().has_report(owner, id).await? {
            // Its service was killed between the two.
            return self.records().close(id).await;
        }
        let (after, last) = match Lease::latest(&self.records().store, id).await? {
            Some((number, beat)) => {
                let seen = watched.entry(id.to_owned()).or_insert_with(|| Watched::new(number, &beat));
                if !seen.has_ended(number, &beat, self.limits().lease_time) {
                    return Ok(());
                }
                (number, beat)
            }
            None => (0, Beat { released: true, ..Beat::first(0) }),
        };
        if self.jobs().refuse_beyond(self.limits().open_jobs).is_err() {
            return Ok(());
        }
        let Some(description) = self.records().description(id).await? else { return Ok(()) };
        let beat = Beat { deaths: last.deaths_at_end(), ..Beat::first(last.sequence + 1) };
        self.take_up_again(Attempt { id, description: &description, after, beat }).await
    }

    /// Takes up a job that was begun before, or says why that cannot be.
    async fn take_up_again(&self, attempt: Attempt<'_>) -> Result<(), Problem> {
        let Attempt { id, description, after, .. } = attempt;
        let deaths = attempt.beat.deaths;
        if deaths >= MOST_DEATHS {
            tracing::warn!(job = id, deaths, "gives up a job whose services died");
            return self.fail(attempt, given_up(deaths)).await;
        }
        tracing::info!(job = id, kind = description.kind, attempt = after + 1, "takes up a job");
        match routes::jobs::work(self, description).await {
            Ok(work) => self.take_up(attempt, work).await.map(drop),
            Err(problem) if problem.kind == ProblemType::StoreUnavailable => Err(problem),
            Err(problem) => self.fail(attempt, problem).await,
        }
    }

    /// Ends a job that nobody works on with a problem.
    async fn fail(&self, attempt: Attempt<'_>, problem: Problem) -> Result<(), Problem> {
        let Attempt { id, description: Description { owner, .. }, beat, .. } = attempt;
        let (_, known) = self.records().look_up(owner, id).await?;
        let job = JobAnswer { state: JobState::Failed, problem: Some(problem), ..known.job };
        self.records().end(owner, id, &Report { sequence: beat.sequence, job }).await
    }
}

fn given_up(deaths: u64) -> Problem {
    let detail = format!(
        "the service died {deaths} times while it worked on the job, most likely for want of memory: ask again with shorter \
         recordings, or give the service more memory"
    );
    Problem::new(ProblemType::Abandoned, detail)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::Limits;

    #[tokio::test]
    async fn jobs_are_looked_after_beside_those_that_cannot_be_understood() {
        let engine = tokio::task::spawn_blocking(|| Engine::new(Limits::default(), None));
        let engine = engine.await.unwrap().unwrap();
        let (records, owner) = (engine.records(), Tenant::default());
        // A kind that this version does not know fails as soon as it is taken up.
        let description = Description::new(&owner, "unknown", json!(1), json!(null));
        let id = description.id().unwrap();
        records.describe(&id, &description, 1).await.unwrap();
        let [no_json, no_job, no_lease] = ["00", "01", "02"].map(|digits| digits.repeat(16));
        for (name, text) in [
            (format!("jobs/{no_json}.json"), "{"),
            (format!("jobs/{no_job}.json"), "{}"),
            (format!("jobs/{no_lease}.json"), "{}"),
            (format!("jobs/{no_lease}.lease-1"), "{"),
            (format!("jobs/{no_json}.lease-1"), "{"),
        ] {
            records.store.put(&name, text.into()).await.unwrap();
        }
        engine.look(&mut BTreeMap::new()).await.unwrap();
        let report = records.report(&owner, &id).await.unwrap().unwrap();
        assert_eq!(report.job.state, JobState::Failed);
        // Another service may understand the jobs, and hold these leases.
        let mut strays = BTreeSet::new();
        for _ in 0..3 {
            engine.clear_strays(&mut strays).await.unwrap();
        }
        assert_eq!(leased(&records.store).await.unwrap(), BTreeSet::from([no_json, no_lease]));
    }
}
