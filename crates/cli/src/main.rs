//! The `joulepath` program: energy-minimal paths for skid-steered robots.

use std::{env, process::ExitCode};

fn main() -> ExitCode {
    // Where the system does not tell where the program lies, its name is looked for.
    let itself = env::current_exe().unwrap_or_else(|_| "joulepath".into());
    ExitCode::from(cli::run(cli::Call { words: env::args_os().collect(), itself: (itself, Vec::new()) }))
}
