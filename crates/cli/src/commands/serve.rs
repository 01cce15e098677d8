//! `joulepath serve`.

use std::net::TcpListener;

use clap::Args;
use service::{Engine, Limits, serve};
use tracing_subscriber::EnvFilter;

use crate::failure::BadInput;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Address and port to listen on
    #[arg(long, default_value = "127.0.0.1:8080")]
    bind: String,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("info"));
    tracing_subscriber::fmt().json().with_env_filter(filter).with_writer(std::io::stderr).init();
    let listener = TcpListener::bind(&arguments.bind)
        .map_err(|error| BadInput(format!("cannot listen on --bind {}: {error}", arguments.bind)))?;
    println!("listening on http://{}", listener.local_addr()?);
    serve(listener, Engine::new(Limits::default()))?;
    Ok(())
}
