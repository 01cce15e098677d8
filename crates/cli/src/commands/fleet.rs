//! `joulepath fleet`: the Python package's command, which spreads work over a cluster.

use std::{
    env,
    ffi::OsString,
    path::PathBuf,
    process::{Command, Stdio},
};

use clap::Args;

use crate::{failure::BadInput, output};

/// Variable that names the Python interpreter.
const PYTHON: &str = "JOULEPATH_PYTHON";
/// Variable by which the package finds this program.
const PROGRAM: &str = "JOULEPATH";
/// Ends with success where the package is installed.
const IS_INSTALLED: &str =
    "import importlib.util, sys; sys.exit(importlib.util.find_spec('joulepath') is None)";

#[derive(Args)]
#[command(disable_help_flag = true)]
pub(crate) struct Arguments {
    /// diagnose, calibrate, matrix, prove, report or example, with its own arguments; --help lists them
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "ARGUMENTS")]
    words: Vec<OsString>,
}

/// Goes on as `python3 -m joulepath.fleet`, or says how to install it.
pub(crate) fn run(arguments: &Arguments, itself: &(PathBuf, Vec<OsString>)) -> anyhow::Result<()> {
    let python = env::var_os(PYTHON).unwrap_or_else(|| "python3".into());
    let named = python.to_string_lossy().into_owned();
    let looked = Command::new(&python).args(["-c", IS_INSTALLED]).stdin(Stdio::null()).output();
    let installed = looked.map_err(|error| {
        BadInput(format!(
            "cannot run `{named}`: {error}; install Python 3.10 or later, or let {PYTHON} name it"
        ))
    })?;
    let asks_for_help = arguments.words.iter().any(|word| word == "--help" || word == "-h");
    if !installed.status.success() && asks_for_help {
        return output::line(format_args!(
            "Many recordings of many robots, on a Ray cluster: diagnose, calibrate, matrix, prove, report, example.\n\n\
             It is part of the Python package: {named} -m pip install 'joulepath[ray]'. With it, this lists the arguments of each."
        ));
    }
    if !installed.status.success() {
        let detail = format!(
            "fleets are part of the Python package, which `{named}` does not have: {named} -m pip install 'joulepath[ray]', or let {PYTHON} \
             name an interpreter that has it"
        );
        return Err(BadInput(detail).into());
    }
    let mut command = Command::new(&python);
    command.args(["-m", "joulepath.fleet"]).args(&arguments.words);
    // Where the package itself was called, it finds itself.
    if let (program, []) = (&itself.0, &itself.1[..])
        && env::var_os(PROGRAM).is_none()
    {
        command.env(PROGRAM, program);
    }
    go_on_as(command, &named)
}

/// Puts the command in the place of this process, so that its status, signals and output are its own.
#[cfg(unix)]
fn go_on_as(mut command: Command, named: &str) -> anyhow::Result<()> {
    use std::os::unix::process::CommandExt;

    Err(anyhow::Error::new(command.exec()).context(format!("cannot run `{named}`")))
}

/// Runs the command and ends with its status.
#[cfg(not(unix))]
fn go_on_as(mut command: Command, named: &str) -> anyhow::Result<()> {
    use anyhow::Context;

    let status = command.status().with_context(|| format!("cannot run `{named}`"))?;
    std::process::exit(status.code().unwrap_or(1))
}
