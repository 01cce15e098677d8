//! `joulepath robot`: robots at hand, and files for others.

mod ask;
mod check;
mod compare;
mod list;
mod new;
mod show;

use clap::{Args, Subcommand};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// List the built-in robots
    List(list::Arguments),
    /// Print the file of a robot
    Show(show::Arguments),
    /// Write the file of a robot from its data sheet
    New(Box<new::Arguments>),
    /// Tell what plans with a robot are worth, and which drive would make them better
    Check(check::Arguments),
    /// Print two robots side by side
    Compare(compare::Arguments),
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    match &arguments.command {
        Command::List(arguments) => list::run(arguments),
        Command::Show(arguments) => show::run(arguments),
        Command::New(arguments) => new::run(arguments),
        Command::Check(arguments) => check::run(arguments),
        Command::Compare(arguments) => compare::run(arguments),
    }
}
