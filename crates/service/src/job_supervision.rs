//! The work of a job on a thread of its own: when it has to end, and what becomes of its place when it does not.

use std::{
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use serde_json::Value;
use tokio::{
    task::JoinHandle,
    time::{sleep, timeout},
};

use crate::{
    Engine,
    job::Job,
    job_run::{Work, called_off},
    memory::Account,
    problem::{Problem, ProblemType},
};

/// How long work has to end after it was told to; then its place is given to others. Work that looks at its watch needs less than
/// a tenth of it.
const GRACE: Duration = Duration::from_millis(250);

/// Threads whose work does not end although it was told to.
#[derive(Clone, Debug, Default)]
pub(crate) struct StuckThreads(Arc<AtomicUsize>);

impl StuckThreads {
    pub(crate) fn count(&self) -> usize {
        self.0.load(Ordering::Relaxed)
    }

    /// Counts a thread until its work has ended after all.
    fn watch(&self, work: JoinHandle<Result<Value, Problem>>) {
        let count = Arc::clone(&self.0);
        count.fetch_add(1, Ordering::Relaxed);
        tokio::spawn(async move {
            // Nobody waits for its outcome any more.
            let _ = work.await;
            count.fetch_sub(1, Ordering::Relaxed);
        });
    }
}

impl Engine {
    /// Does a job's work, which takes its turn among jobs and among computations. Both turns end with the job, soon after it was
    /// called off or its time was over, whether its thread ends or not.
    pub(crate) async fn run(&self, job: &Arc<Job>, work: Box<dyn Work>) -> Result<Value, Problem> {
        let _turns = tokio::select! {
            turns = self.job_turns() => turns?,
            () = job.unwanted() => return Err(called_off()),
        };
        self.begin(job).await?;
        let (engine, running) = (self.clone(), Arc::clone(job));
        let account = Account::current();
        let mut work = tokio::task::spawn_blocking(move || account.during(|| work.run(&engine, &running)));
        let job_time = self.limits().job_time;
        let is_late = tokio::select! {
            outcome = &mut work => return self.outcome(outcome),
            () = job.unwanted() => false,
            () = sleep(job_time) => true,
        };
        job.stop_work();
        match timeout(GRACE, &mut work).await {
            Ok(Ok(Ok(result))) => return Ok(result),
            Ok(_) => {}
            Err(_) => {
                tracing::error!(job = job.id, kind = job.kind, "work does not end although it was told to");
                self.stuck_threads().watch(work);
            }
        }
        Err(if is_late { too_long(job_time) } else { called_off() })
    }
}

fn too_long(job_time: Duration) -> Problem {
    let detail = format!(
        "the job was stopped after {} s, the longest that a job may take here: ask again with fewer or shorter recordings",
        job_time.as_secs_f64()
    );
    Problem::new(ProblemType::Timeout, detail)
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, channel};

    use serde_json::json;

    use super::*;
    use crate::{
        Limits, Tenant,
        job::JobState,
        job_records::Description,
        routes::jobs::JobAnswer,
        store::{Beat, Lease},
    };

    /// Work that ends when its sender is dropped, and looks at nothing else.
    struct Deaf(Receiver<()>);

    impl Work for Deaf {
        fn run(self: Box<Self>, _: &Engine, _: &Arc<Job>) -> Result<Value, Problem> {
            let _ = self.0.recv();
            Ok(json!("late"))
        }
    }

    /// Work that is done at once.
    struct Quick;

    impl Work for Quick {
        fn run(self: Box<Self>, _: &Engine, _: &Arc<Job>) -> Result<Value, Problem> {
            Ok(json!("quick"))
        }
    }

    async fn engine(job_time: Duration) -> Engine {
        engine_over(job_time, None).await
    }

    /// An engine that does one thing at a time, and writes a lease so seldom that a test has ended before the second time.
    async fn engine_over(job_time: Duration, store: Option<&str>) -> Engine {
        let lease_time = Duration::from_secs(3600);
        let limits =
            Limits { job_time, lease_time, parallel_jobs: 1, parallel_plans: 1, ..Limits::default() };
        let store = store.map(str::to_owned);
        let opened = tokio::task::spawn_blocking(move || Engine::new(limits, store.as_deref()));
        opened.await.unwrap().unwrap()
    }

    async fn ask(engine: &Engine, number: u64, work: impl Work) -> JobAnswer {
        let description = Description::new(&Tenant::default(), "test", json!(number), json!(null));
        engine.ask(&description, Box::new(work)).await.unwrap()
    }

    async fn ended(engine: &Engine, id: &str) -> JobAnswer {
        if let Some(job) = engine.jobs().get(id) {
            job.unwanted().await;
        }
        engine.records().look_up(&Tenant::default(), id).await.unwrap().1.job
    }

    async fn is_running(engine: &Engine, id: &str) {
        let job = engine.jobs().get(id).unwrap();
        let mut changes = job.follow();
        changes.wait_for(|status| status.state == JobState::Running).await.unwrap();
    }

    #[tokio::test]
    async fn a_cancelled_job_frees_its_place_though_its_thread_does_not_end_and_readiness_tells() {
        let engine = engine(Duration::from_secs(3600)).await;
        let (held, receiver) = channel();
        let deaf = ask(&engine, 1, Deaf(receiver)).await;
        is_running(&engine, &deaf.id).await;
        let next = ask(&engine, 2, Quick).await;
        assert!(engine.check_ready().await.is_ok());
        let cancelled = engine.call_off(&Tenant::default(), &deaf.id).await.unwrap().unwrap();
        assert_eq!(cancelled.state, JobState::Cancelled);
        assert_eq!(ended(&engine, &next.id).await.result, Some(json!("quick")));
        assert_eq!(engine.stuck_threads().count(), 1);
        let problem = engine.check_ready().await.unwrap_err();
        assert_eq!(problem.kind, ProblemType::NotReady);
        assert!(problem.detail.contains("restart"), "{problem:?}");
        drop(held);
        while engine.stuck_threads().count() > 0 {
            tokio::task::yield_now().await;
        }
        assert!(engine.check_ready().await.is_ok());
        assert_eq!(ended(&engine, &deaf.id).await.state, JobState::Cancelled);
    }

    #[tokio::test]
    async fn a_job_beyond_its_time_fails_with_a_problem_and_frees_its_place() {
        let engine = engine(Duration::from_millis(1)).await;
        let (held, receiver) = channel();
        let deaf = ask(&engine, 1, Deaf(receiver)).await;
        let found = ended(&engine, &deaf.id).await;
        let problem = found.problem.unwrap();
        assert_eq!((found.state, problem.kind), (JobState::Failed, ProblemType::Timeout));
        assert!(problem.detail.contains("0.001 s"), "{problem:?}");
        assert_eq!(engine.stuck_threads().count(), 1);
        drop(held);
    }

    #[tokio::test]
    async fn a_job_that_is_cancelled_while_it_waits_frees_its_place_in_the_queue_at_once() {
        let engine = engine(Duration::from_secs(3600)).await;
        let (held, receiver) = channel();
        let deaf = ask(&engine, 1, Deaf(receiver)).await;
        is_running(&engine, &deaf.id).await;
        let waiting = ask(&engine, 2, Quick).await;
        engine.call_off(&Tenant::default(), &waiting.id).await.unwrap().unwrap();
        assert_eq!(engine.jobs().states(), [JobState::Running]);
        drop(held);
        assert_eq!(ended(&engine, &deaf.id).await.result, Some(json!("late")));
        assert_eq!(engine.stuck_threads().count(), 0);
    }

    /// An engine whose only turn is taken until the sender is dropped, with a job that waits behind it and has written its lease.
    async fn with_a_waiting_job(engine: &Engine) -> (std::sync::mpsc::Sender<()>, String) {
        let (held, receiver) = channel();
        let deaf = ask(engine, 1, Deaf(receiver)).await;
        is_running(engine, &deaf.id).await;
        let waiting = ask(engine, 2, Quick).await;
        let store = &engine.records().store;
        while Lease::latest(store, &waiting.id).await.unwrap().unwrap().1.count == 0 {
            tokio::task::yield_now().await;
        }
        (held, waiting.id)
    }

    #[tokio::test]
    async fn a_job_that_another_service_took_while_it_waited_is_left_to_that_service() {
        let engine = engine(Duration::from_secs(3600)).await;
        let (held, waiting) = with_a_waiting_job(&engine).await;
        let store = &engine.records().store;
        Lease::take(store, &waiting, 1, &Beat::first(7)).await.unwrap().unwrap();
        drop(held);
        while !engine.jobs().all().is_empty() {
            tokio::task::yield_now().await;
        }
        assert!(!engine.records().has_report(&Tenant::default(), &waiting).await.unwrap());
        assert_eq!(Lease::latest(store, &waiting).await.unwrap(), Some((2, Beat::first(7))));
        let told = engine.records().look_up(&Tenant::default(), &waiting).await.unwrap().1.job;
        assert_eq!((told.state, told.attempt), (JobState::Queued, 2));
    }

    #[cfg(unix)]
    #[tokio::test]
    async fn a_job_whose_turn_comes_while_the_store_is_out_of_reach_begins_when_it_is_back() {
        let folder = tempfile::tempdir().unwrap();
        let engine = engine_over(Duration::from_secs(3600), folder.path().to_str()).await;
        let (held, waiting) = with_a_waiting_job(&engine).await;
        let job = engine.jobs().get(&waiting).unwrap();
        let (place, aside) = (folder.path().join("jobs"), folder.path().join("aside"));
        std::fs::rename(&place, &aside).unwrap();
        // A link to itself cannot be listed.
        std::os::unix::fs::symlink(&place, &place).unwrap();
        drop(held);
        let mut changes = job.follow();
        changes
            .wait_for(|status| status.is_last() || status.progress.step == "waiting for the store")
            .await
            .unwrap();
        assert_eq!(job.status().state, JobState::Queued);
        std::fs::remove_file(&place).unwrap();
        std::fs::rename(&aside, &place).unwrap();
        assert_eq!(ended(&engine, &waiting).await.result, Some(json!("quick")));
    }
}
