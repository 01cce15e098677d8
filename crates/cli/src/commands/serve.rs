//! `joulepath serve`.

use std::{net::TcpListener, time::Duration};

use clap::Args;
use service::{Engine, Limits, serve};
use tracing_subscriber::EnvFilter;

use crate::failure::BadInput;

/// Below it a busy disk could look like a service that is no more.
const SHORTEST_LEASE: Duration = Duration::from_millis(100);

#[derive(Args)]
pub(crate) struct Arguments {
    /// Address and port to listen on
    #[arg(long, default_value = "127.0.0.1:8080")]
    bind: String,
    /// Folder or s3://BUCKET/PREFIX that maps, robots, recordings, jobs and reports are kept in, shared by all services that
    /// are given it; AWS_ENDPOINT_URL, AWS_REGION, AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY and AWS_ALLOW_HTTP say where a
    /// bucket is and who asks [default: a folder that lasts as long as the service]
    #[arg(long)]
    store: Option<String>,
    /// How long a service that works on a job may be silent before another takes the job up
    #[arg(long, value_name = "SECONDS", default_value_t = 15.0)]
    lease_s: f64,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("info"));
    tracing_subscriber::fmt().json().with_env_filter(filter).with_writer(std::io::stderr).init();
    let listener = TcpListener::bind(&arguments.bind)
        .map_err(|error| BadInput(format!("cannot listen on --bind {}: {error}", arguments.bind)))?;
    let lease_time =
        Duration::try_from_secs_f64(arguments.lease_s).ok().filter(|time| *time >= SHORTEST_LEASE);
    let lease_time = lease_time.ok_or_else(|| {
        let least = SHORTEST_LEASE.as_secs_f64();
        BadInput(format!("--lease-s {} must be at least {least} s", arguments.lease_s))
    })?;
    let limits = Limits { lease_time, ..Limits::default() };
    let engine =
        Engine::new(limits, arguments.store.as_deref()).map_err(|error| BadInput(error.to_string()))?;
    println!("listening on http://{}", listener.local_addr()?);
    serve(listener, engine)?;
    Ok(())
}
