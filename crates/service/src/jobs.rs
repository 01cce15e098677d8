//! The jobs that this service works on: so many at most.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use crate::{
    job::{Job, JobState},
    problem::{Problem, ProblemType},
};

/// Jobs by id. Those that have ended are in the store.
#[derive(Debug, Default)]
pub(crate) struct Jobs {
    jobs: Mutex<BTreeMap<String, Arc<Job>>>,
}

impl Jobs {
    /// Refuses one more when so many are under way already.
    pub(crate) fn refuse_beyond(&self, most: usize) -> Result<(), Problem> {
        refuse_one_more(self.lock().len(), most)
    }

    /// Takes a job in, unless another of its id is under way (false) or so many of other ids are. One that has ended here, and
    /// is only being put away, makes room for it.
    pub(crate) fn add(&self, job: &Arc<Job>, most: usize) -> Result<bool, Problem> {
        let mut jobs = self.lock();
        match jobs.get(&job.id) {
            Some(other) if !other.status().is_last() => return Ok(false),
            Some(_) => {}
            None => refuse_one_more(jobs.len(), most)?,
        }
        jobs.insert(job.id.clone(), Arc::clone(job));
        Ok(true)
    }

    /// The job with an id, if this service works on it and has not handed it back.
    pub(crate) fn get(&self, id: &str) -> Option<Arc<Job>> {
        self.lock().get(id).filter(|job| !job.status().handed_back).cloned()
    }

    /// The state of every job at hand.
    pub(crate) fn states(&self) -> Vec<JobState> {
        self.all().iter().map(|job| job.status().state).collect()
    }

    /// Forgets a job, unless another has taken its id since.
    pub(crate) fn remove(&self, job: &Arc<Job>) {
        let mut jobs = self.lock();
        if jobs.get(&job.id).is_some_and(|held| Arc::ptr_eq(held, job)) {
            jobs.remove(&job.id);
        }
    }

    /// All of them.
    pub(crate) fn all(&self) -> Vec<Arc<Job>> {
        self.lock().values().cloned().collect()
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<String, Arc<Job>>> {
        self.jobs.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn refuse_one_more(open: usize, most: usize) -> Result<(), Problem> {
    if open < most {
        return Ok(());
    }
    let detail = format!("{open} jobs wait or run already: try again when one has ended, or cancel one");
    Err(Problem::new(ProblemType::TooManyJobs, detail))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{Beat, Lease};

    fn job(id: &str) -> Arc<Job> {
        Arc::new(Job::new(id, "test", Lease::first(id), Beat::first(0)))
    }

    #[test]
    fn no_more_jobs_are_under_way_than_allowed() {
        let jobs = Jobs::default();
        let first = job("a");
        jobs.add(&first, 2).unwrap();
        jobs.add(&job("b"), 2).unwrap();
        assert_eq!(jobs.add(&job("c"), 2).unwrap_err().kind, ProblemType::TooManyJobs);
        jobs.remove(&first);
        assert!(jobs.add(&job("c"), 2).is_ok());
    }

    #[test]
    fn who_ends_late_does_not_take_away_who_has_its_id_now() {
        let jobs = Jobs::default();
        let (cancelled, anew) = (job("a"), job("a"));
        assert!(jobs.add(&cancelled, 1).unwrap());
        cancelled.call_off();
        assert!(jobs.add(&anew, 1).unwrap(), "it takes the place of the other");
        jobs.remove(&cancelled);
        assert!(jobs.get("a").is_some_and(|held| Arc::ptr_eq(&held, &anew)));
    }

    #[test]
    fn a_job_that_is_under_way_is_not_replaced_by_another_of_its_id() {
        let jobs = Jobs::default();
        let (first, second) = (job("a"), job("a"));
        assert!(jobs.add(&first, 1).unwrap());
        assert!(!jobs.add(&second, 1).unwrap());
        assert!(jobs.get("a").is_some_and(|held| Arc::ptr_eq(&held, &first)));
    }

    #[test]
    fn of_many_who_add_jobs_at_the_same_time_as_many_do_as_may() {
        let (jobs, most) = (Jobs::default(), 3);
        let added = std::sync::atomic::AtomicUsize::new(0);
        std::thread::scope(|scope| {
            for i in 0..32 {
                let (jobs, added) = (&jobs, &added);
                scope.spawn(move || {
                    if jobs.add(&job(&i.to_string()), most).is_ok_and(|is_in| is_in) {
                        added.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                    }
                });
            }
        });
        assert_eq!((added.into_inner(), jobs.all().len()), (most, most));
    }
}
