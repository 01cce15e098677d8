//! The `joulepath` command as a library, by which the program and the Python package are the same command.

// Everything is printed by `output`, which does not panic where nobody reads.
#![deny(clippy::print_stdout, clippy::print_stderr)]

#[cfg(feature = "server")]
mod allocator;
mod areas_file;
mod arguments;
mod commands;
#[cfg(feature = "server")]
mod config;
mod failure;
mod files;
mod interrupt;
#[cfg(feature = "server")]
mod limit_arguments;
mod out_file;
mod output;
mod picture;
mod progress;
mod raster;
mod reach_picture;
mod real_scored;
mod recorded;
mod robot_arguments;
mod scenes;
mod scored;
mod steering;
mod table;

use std::{
    ffi::OsString,
    io::{self, Write},
    path::PathBuf,
};

use clap::{Parser, Subcommand};

/// The version, and the commit where it is known.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), env!("JOULEPATH_COMMIT_SUFFIX"));

/// Energy-minimal paths for skid-steered robots, and what they will cost.
#[derive(Parser)]
#[command(version = VERSION, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Plan one path over a map
    Plan(commands::plan::Arguments),
    /// Compare the energy-minimal, shortest and fastest paths over a map
    Compare(commands::compare::Arguments),
    /// Find paths that trade energy for time or length
    Alternatives(commands::alternatives::Arguments),
    /// Print energy, time and length between many places
    Matrix(commands::matrix::Arguments),
    /// Find the ground within energies or charges of a place
    Reachable(commands::reachable::Arguments),
    /// Tell whether the battery lasts to a goal and back
    Range(commands::range::Arguments),
    /// Plan many stops on a charge, in the best order
    Mission(commands::mission::Arguments),
    /// Compare the power that recorded drives drew with what the robot's model says
    Predict(commands::predict::Arguments),
    /// Fit a robot to its recordings
    Calibrate(commands::calibrate::Arguments),
    /// Tell what a log holds, and propose a map that reads it
    Inspect(commands::inspect::Arguments),
    /// Find where drives differ from the model, and which physics was left out
    Diagnose(commands::diagnose::Arguments),
    /// Record a drive through a world of its own, which may conceal effects
    Simulate(commands::simulate::Arguments),
    /// Conceal effects, diagnose the recordings without the keys, and score what was found
    Prove(commands::prove::Arguments),
    /// Ask a fleet's recordings on a cluster, and see which robots differ
    Fleet(commands::fleet::Arguments),
    /// Print what plans take, beside general-purpose searches on the same graphs
    Bench(commands::bench::Arguments),
    /// List robots, describe one from its data sheet, and tell what plans with it are worth
    Robot(commands::robot::Arguments),
    /// Print the JSON Schema of a robot, map, recording map or world file
    Schema(commands::schema::Arguments),
    /// Open the page with maps, robots and recordings
    #[cfg(feature = "server")]
    Open(commands::open::Arguments),
    /// Serve the HTTP API
    #[cfg(feature = "server")]
    Serve(Box<commands::serve::Arguments>),
    /// Start the service, compare paths over real terrain, and draw them
    #[cfg(feature = "server")]
    Demo(commands::demo::Arguments),
    /// What starts a server is part of the program alone
    #[cfg(not(feature = "server"))]
    #[command(hide = true, name = "serve", aliases = ["open", "demo"], disable_help_flag = true)]
    Absent(commands::absent::Arguments),
    /// Print what completes commands in a shell
    Completions(commands::completions::Arguments),
    /// Print the manual page
    Man(commands::man::Arguments),
}

/// How the command is called.
#[derive(Clone, Debug)]
pub struct Call {
    /// The words of the command line; the first is the name that the command was called by.
    pub words: Vec<OsString>,
    /// What calls the same command again: a program, and words that stand before all others.
    pub itself: (PathBuf, Vec<OsString>),
}

/// Runs the command and returns its exit status: 2 for wrong input, 3 where there is no path, none within limits or not enough charge, 1 for
/// anything else that failed.
///
/// An interrupt ends the process, with status 130, after what was half-written is removed.
///
/// ```
/// let call = cli::Call { words: vec!["joulepath".into(), "--version".into()], itself: ("joulepath".into(), Vec::new()) };
/// assert_eq!(cli::run(call), 0);
/// ```
pub fn run(call: Call) -> u8 {
    let Call { words, itself } = call;
    let outcome = parse(words).and_then(|arguments| obey(&arguments.command, &itself));
    // Where the process goes on, as Python does, nobody else empties the buffer.
    let _ = io::stdout().flush();
    match outcome {
        Ok(()) => 0,
        Err(error) if error.is::<output::ReaderLeft>() => 0,
        Err(error) => match error.downcast_ref::<clap::Error>() {
            // Help and the version are such an error too.
            Some(told) => {
                let _ = told.print();
                u8::try_from(told.exit_code()).unwrap_or(failure::BAD_INPUT)
            }
            None => {
                output::note(service::with_exponents(format!("joulepath: {error:#}")));
                failure::exit_code(&error)
            }
        },
    }
}

#[cfg(feature = "server")]
fn parse(words: Vec<OsString>) -> anyhow::Result<Arguments> {
    config::parse(words)
}

#[cfg(not(feature = "server"))]
fn parse(words: Vec<OsString>) -> anyhow::Result<Arguments> {
    Ok(Arguments::try_parse_from(words)?)
}

/// Whether it ends by itself at an interrupt, as what serves.
#[cfg(feature = "server")]
fn has_its_own_end(command: &Command) -> bool {
    matches!(command, Command::Serve(_) | Command::Open(_))
}

#[cfg(not(feature = "server"))]
fn has_its_own_end(_: &Command) -> bool {
    false
}

fn obey(command: &Command, itself: &(PathBuf, Vec<OsString>)) -> anyhow::Result<()> {
    if !has_its_own_end(command) {
        interrupt::end_on_interrupt();
    }
    match command {
        Command::Plan(arguments) => commands::plan::run(arguments),
        Command::Compare(arguments) => commands::compare::run(arguments),
        Command::Alternatives(arguments) => commands::alternatives::run(arguments),
        Command::Matrix(arguments) => commands::matrix::run(arguments),
        Command::Reachable(arguments) => commands::reachable::run(arguments),
        Command::Range(arguments) => commands::range::run(arguments),
        Command::Mission(arguments) => commands::mission::run(arguments),
        Command::Predict(arguments) => commands::predict::run(arguments),
        Command::Calibrate(arguments) => commands::calibrate::run(arguments),
        Command::Inspect(arguments) => commands::inspect::run(arguments),
        Command::Diagnose(arguments) => commands::diagnose::run(arguments),
        Command::Simulate(arguments) => commands::simulate::run(arguments),
        Command::Prove(arguments) => commands::prove::run(arguments, itself),
        Command::Fleet(arguments) => commands::fleet::run(arguments, itself),
        Command::Bench(arguments) => commands::bench::run(arguments),
        Command::Robot(arguments) => commands::robot::run(arguments),
        Command::Schema(arguments) => commands::schema::run(arguments),
        #[cfg(feature = "server")]
        Command::Open(arguments) => commands::open::run(arguments),
        #[cfg(feature = "server")]
        Command::Serve(arguments) => commands::serve::run(arguments),
        #[cfg(feature = "server")]
        Command::Demo(arguments) => commands::demo::run(arguments),
        #[cfg(not(feature = "server"))]
        Command::Absent(arguments) => commands::absent::run(arguments),
        Command::Completions(arguments) => commands::completions::run(arguments),
        Command::Man(arguments) => commands::man::run(arguments),
    }
}
