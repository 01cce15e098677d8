//! Running the service.

use std::{
    io,
    net::{SocketAddr, TcpListener},
    thread::JoinHandle,
};

use tokio::sync::oneshot;

use crate::{Engine, router};

/// Serves until the process is asked to end (interrupt or terminate), then finishes what is under way.
///
/// # Errors
/// When the listener or the runtime cannot be used.
pub fn serve(listener: TcpListener, engine: Engine) -> io::Result<()> {
    let runtime = runtime()?;
    let outcome = runtime.block_on(run(listener, engine, asked_to_end()));
    // Computations that outlast the drain have no one to answer.
    runtime.shutdown_background();
    outcome
}

/// A service on a thread of its own, for a program that talks to it.
pub struct Running {
    /// Where it listens.
    pub address: SocketAddr,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<io::Result<()>>>,
}

/// Starts a service in the background.
///
/// # Errors
/// When the listener or the runtime cannot be used.
pub fn start(listener: TcpListener, engine: Engine) -> io::Result<Running> {
    let address = listener.local_addr()?;
    let runtime = runtime()?;
    let (stop, stopped) = oneshot::channel();
    let thread = std::thread::spawn(move || {
        let outcome = runtime.block_on(run(listener, engine, async {
            let _ = stopped.await;
        }));
        runtime.shutdown_background();
        outcome
    });
    Ok(Running { address, stop: Some(stop), thread: Some(thread) })
}

impl Drop for Running {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn runtime() -> io::Result<tokio::runtime::Runtime> {
    tokio::runtime::Builder::new_multi_thread().enable_all().build()
}

async fn run(
    listener: TcpListener,
    engine: Engine,
    stop: impl Future<Output = ()> + Send + 'static,
) -> io::Result<()> {
    listener.set_nonblocking(true)?;
    let listener = tokio::net::TcpListener::from_std(listener)?;
    let drain_time = engine.limits().drain_time;
    let (draining, drained) = oneshot::channel();
    let ending = engine.clone();
    let stop = async move {
        stop.await;
        let _ = draining.send(());
        // Who follows a job is told, and leaves.
        ending.hand_back_jobs().await;
    };
    tokio::spawn(engine.clone().watch_jobs());
    let serving = axum::serve(listener, router(engine)).with_graceful_shutdown(stop);
    tokio::select! {
        outcome = serving.into_future() => outcome,
        // A client that stalls must not keep the service from ending.
        () = async {
            let _ = drained.await;
            tokio::time::sleep(drain_time).await;
        } => Ok(()),
    }
}

async fn asked_to_end() {
    let interrupt = async {
        if tokio::signal::ctrl_c().await.is_err() {
            std::future::pending::<()>().await;
        }
    };
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        let Ok(mut terminate) = signal(SignalKind::terminate()) else { return interrupt.await };
        tokio::select! {
            () = interrupt => {}
            _ = terminate.recv() => {}
        }
    }
    #[cfg(not(unix))]
    interrupt.await;
}
