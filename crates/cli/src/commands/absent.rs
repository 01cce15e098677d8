//! `joulepath serve`, `open` and `demo` of the Python package, which has no server.

use std::ffi::OsString;

use clap::Args;

use crate::failure::BadInput;

#[derive(Args)]
pub(crate) struct Arguments {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    words: Vec<OsString>,
}

/// Says where they are.
pub(crate) fn run(_: &Arguments) -> anyhow::Result<()> {
    Err(BadInput("the Python package has no server: `joulepath serve`, `open` and `demo` are part of the program, cargo install --locked --path crates/cli".into()).into())
}
