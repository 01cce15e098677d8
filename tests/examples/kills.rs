//! Kills the service at random moments while clients upload, delete and start jobs: nothing acknowledged may be lost, nothing
//! half-written listed or left.
//!
//! `cargo run --release -p joulepath-tests --example kills [KILLS] [SEED]`

#![allow(clippy::unwrap_used)]

use joulepath_tests::kills::kill_again_and_again;

fn main() {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<u64>().unwrap());
    let (kills, seed) = (arguments.next().unwrap_or(200), arguments.next().unwrap_or(1));
    let folder = tempfile::tempdir().unwrap();
    let outcome = kill_again_and_again(folder.path(), kills as usize, seed);
    println!(
        "{} kills: {} uploads, {} deletes and {} jobs acknowledged, {} requests cut off, {} jobs taken up again, {} given up; {} faults",
        outcome.kills,
        outcome.uploads,
        outcome.deletes,
        outcome.jobs,
        outcome.cut_off,
        outcome.taken_up_again,
        outcome.given_up,
        outcome.faults.len()
    );
    outcome.faults.iter().for_each(|fault| println!("{fault}"));
    std::process::exit(i32::from(!outcome.faults.is_empty()));
}
