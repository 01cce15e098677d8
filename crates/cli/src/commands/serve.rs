//! `joulepath serve`.

use std::{net::TcpListener, path::Path};

use clap::Args;
use service::{Engine, Limits, serve};
use tracing_subscriber::EnvFilter;

use crate::failure::BadInput;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Address and port to listen on
    #[arg(long, default_value = "127.0.0.1:8080")]
    bind: String,
    /// Folder that recordings are kept in [default: one that lasts as long as the service]
    #[arg(long)]
    store: Option<String>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("info"));
    tracing_subscriber::fmt().json().with_env_filter(filter).with_writer(std::io::stderr).init();
    let listener = TcpListener::bind(&arguments.bind)
        .map_err(|error| BadInput(format!("cannot listen on --bind {}: {error}", arguments.bind)))?;
    let store = arguments.store.as_deref().map(folder).transpose()?;
    let engine = Engine::new(Limits::default(), store).map_err(|error| {
        let place = arguments.store.as_deref().unwrap_or("the temporary folder");
        BadInput(format!(
            "cannot keep recordings in {place}: {error}; give --store a folder that can be written to"
        ))
    })?;
    println!("listening on http://{}", listener.local_addr()?);
    serve(listener, engine)?;
    Ok(())
}

fn folder(store: &str) -> Result<&Path, BadInput> {
    if store.contains("://") {
        let detail = format!("--store {store}: recordings can be kept in a folder only; give its path");
        return Err(BadInput(detail));
    }
    Ok(Path::new(store))
}
