//! The jobs at hand: so many at most under way, so many kept after their end.

use std::{
    collections::VecDeque,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use crate::{
    job::{Job, JobState},
    problem::{Problem, ProblemType},
};

/// Jobs in the order in which they were started.
#[derive(Debug, Default)]
pub(crate) struct Jobs {
    jobs: Mutex<VecDeque<Arc<Job>>>,
}

impl Jobs {
    /// Takes a job in, if so many are not under way already, and forgets the oldest that ended beyond so many.
    pub(crate) fn open(
        &self,
        kind: &'static str,
        most_open: usize,
        most_kept: usize,
    ) -> Result<Arc<Job>, Problem> {
        let mut jobs = self.lock();
        let open = jobs.iter().filter(|job| !job.status().state.is_final()).count();
        if open >= most_open {
            let detail =
                format!("{open} jobs wait or run already: try again when one has ended, or cancel one");
            return Err(Problem::new(ProblemType::TooManyJobs, detail));
        }
        let job = Arc::new(Job::new(kind));
        jobs.push_back(Arc::clone(&job));
        let mut surplus = (jobs.len() - open - 1).saturating_sub(most_kept);
        jobs.retain(|job| {
            let forget = surplus > 0 && job.status().state.is_final();
            surplus -= usize::from(forget);
            !forget
        });
        Ok(job)
    }

    /// The job with an id.
    pub(crate) fn get(&self, id: &str) -> Result<Arc<Job>, Problem> {
        self.lock().iter().find(|job| job.id == id).cloned().ok_or_else(|| unknown(id))
    }

    /// The state of every job at hand.
    pub(crate) fn states(&self) -> Vec<JobState> {
        self.lock().iter().map(|job| job.status().state).collect()
    }

    /// Forgets a job.
    pub(crate) fn forget(&self, id: &str) {
        self.lock().retain(|job| job.id != id);
    }

    /// Calls off whatever is under way.
    pub(crate) fn call_off_all(&self) {
        self.lock().iter().for_each(|job| {
            job.call_off();
        });
    }

    fn lock(&self) -> MutexGuard<'_, VecDeque<Arc<Job>>> {
        self.jobs.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn unknown(id: &str) -> Problem {
    let shown: String = id.chars().take(64).collect();
    let detail =
        format!("there is no job `{shown}`: it was deleted, or ended so long ago that it was forgotten");
    Problem::new(ProblemType::UnknownJob, detail)
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;

    #[test]
    fn no_more_jobs_are_under_way_than_allowed() {
        let jobs = Jobs::default();
        let first = jobs.open("test", 2, 8).unwrap();
        jobs.open("test", 2, 8).unwrap();
        assert_eq!(jobs.open("test", 2, 8).unwrap_err().kind, ProblemType::TooManyJobs);
        first.end(Ok(Value::Null));
        assert!(jobs.open("test", 2, 8).is_ok());
    }

    #[test]
    fn the_oldest_jobs_that_ended_are_forgotten_and_none_that_is_under_way() {
        let jobs = Jobs::default();
        let running = jobs.open("test", 100, 2).unwrap();
        let ended: Vec<Arc<Job>> = (0..4)
            .map(|_| {
                let job = jobs.open("test", 100, 2).unwrap();
                job.end(Ok(Value::Null));
                job
            })
            .collect();
        jobs.open("test", 100, 2).unwrap();
        let known: Vec<bool> = ended.iter().map(|job| jobs.get(&job.id).is_ok()).collect();
        assert_eq!(known, [false, false, true, true]);
        assert!(jobs.get(&running.id).is_ok());
    }
}
