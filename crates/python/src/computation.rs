//! Work beside the interpreter, which goes on meanwhile and may call it off.

use std::{
    ops::ControlFlow,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::{self, RecvTimeoutError},
    },
    thread,
    time::Duration,
};

use planner::Patience;
use pyo3::prelude::*;
use recording::Watch;

use crate::problem::{Failure, exception, internal};

/// Time between two looks for Ctrl-C: together with the 50 ms within which computations notice that they are called off, it stays
/// below the 0.1 s that a computation may go on.
const LOOK: Duration = Duration::from_millis(20);

/// Takes note of a step and of the share of all that is done.
type Tell = Box<dyn Fn(&str, f64) + Send + Sync>;

/// What a computation is told, and what it tells.
pub(crate) struct Computation {
    called_off: Arc<AtomicBool>,
    tell: Tell,
}

/// What comes from the thread that computes.
enum Told<T, E> {
    /// What is being done, and how much of all is done, 0 to 1.
    Step(String, f64),
    Done(thread::Result<Result<T, E>>),
}

impl Computation {
    /// The planner's way to learn that it is called off.
    pub(crate) fn patience(&self) -> Patience {
        let mut patience = Patience::default();
        patience.cancelled = Some(Arc::clone(&self.called_off));
        patience
    }

    /// The way of readers, fits and diagnoses to learn it.
    pub(crate) fn watch(&self) -> Watch {
        let called_off = Arc::clone(&self.called_off);
        Arc::new(move |_| match called_off.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        })
    }

    /// Whether it is called off.
    pub(crate) fn is_called_off(&self) -> bool {
        self.called_off.load(Ordering::Relaxed)
    }

    /// Tells what is being done and how much of all is done, 0 to 1.
    pub(crate) fn tell(&self, step: &str, share: f64) {
        (self.tell)(step, share);
    }
}

/// Does work on a thread of its own without the interpreter's lock. Ctrl-C calls it off and is raised once it has ended, as is what
/// `progress` raises, which is called with each step that the work tells and the share that is done.
pub(crate) fn beside<T: Send + 'static, E: Into<Failure> + Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Computation) -> Result<T, E> + Send,
) -> PyResult<T> {
    let called_off = Arc::new(AtomicBool::new(false));
    let (sender, receiver) = mpsc::channel();
    let receiver = Mutex::new(receiver);
    let steps = sender.clone();
    let tell = move |step: &str, share| drop(steps.send(Told::Step(step.to_owned(), share)));
    let computation = Computation { called_off: Arc::clone(&called_off), tell: Box::new(tell) };
    thread::scope(|scope| {
        scope.spawn(move || {
            let done = catch_unwind(AssertUnwindSafe(|| work(&computation)));
            drop(sender.send(Told::Done(done)));
        });
        let mut raised = None;
        loop {
            let told =
                py.detach(|| receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK));
            let step = match (told, raised.take()) {
                (Ok(Told::Done(_)), Some(error)) => return Err(error),
                (Ok(Told::Done(Ok(outcome))), None) => {
                    return outcome.map_err(|problem| exception(py, problem));
                }
                (Ok(Told::Done(Err(_))) | Err(RecvTimeoutError::Disconnected), _) => {
                    return Err(exception(py, internal("the computation did not finish: please report it")));
                }
                (_, Some(error)) => {
                    raised = Some(error);
                    continue;
                }
                (Ok(Told::Step(step, share)), None) => Some((step, share)),
                (Err(RecvTimeoutError::Timeout), None) => None,
            };
            let tell =
                |(step, share)| progress.map_or(Ok(()), |progress| progress.call1((step, share)).map(drop));
            raised = py.check_signals().and_then(|()| step.map_or(Ok(()), tell)).err();
            called_off.store(raised.is_some(), Ordering::Relaxed);
        }
    })
}
