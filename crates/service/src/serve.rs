//! Running the service.

use std::{
    io,
    net::{SocketAddr, TcpListener},
    thread::JoinHandle,
};

use tokio::sync::oneshot;

use crate::{Access, Engine, connections::accept, router};

/// Serves until the process is asked to end (interrupt or terminate), then finishes what is under way.
///
/// # Errors
/// When the listener or the runtime cannot be used.
pub fn serve(listener: TcpListener, engine: Engine, access: &Access) -> io::Result<()> {
    let runtime = runtime()?;
    let outcome = runtime.block_on(async { run(listener, engine, access, asked_to_end()?).await });
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
        let stopped = async {
            let _ = stopped.await;
        };
        let outcome = runtime.block_on(run(listener, engine, &Access::default(), stopped));
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
    access: &Access,
    stop: impl Future<Output = ()> + Send,
) -> io::Result<()> {
    listener.set_nonblocking(true)?;
    let listener = tokio::net::TcpListener::from_std(listener)?;
    let routes = router(engine.clone(), access);
    let stop = async {
        stop.await;
        tracing::info!("asked to end");
        engine.announce_end();
        tokio::time::sleep(engine.limits().unready_time).await;
    };
    tokio::spawn(engine.clone().watch_jobs());
    let open = accept(listener, routes, &engine, stop).await;
    // Who follows a job is told, and leaves.
    engine.hand_back_jobs().await;
    // A client that stalls must not keep the service from ending.
    if tokio::time::timeout(engine.limits().drain_time, open.shutdown()).await.is_err() {
        tracing::warn!("requests under way were cut off");
    }
    // Tasks that go with the runtime hold the store too, and the process may end before they are dropped.
    engine.records().store.end();
    Ok(())
}

/// The end of the wait for an interrupt or a wish to end, of which none that comes from now on is missed.
#[cfg(unix)]
fn asked_to_end() -> io::Result<impl Future<Output = ()> + Send> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    Ok(async move {
        tokio::select! {
            _ = interrupt.recv() => {}
            _ = terminate.recv() => {}
        }
    })
}

#[cfg(not(unix))]
fn asked_to_end() -> io::Result<impl Future<Output = ()> + Send> {
    Ok(async {
        if tokio::signal::ctrl_c().await.is_err() {
            std::future::pending::<()>().await;
        }
    })
}
