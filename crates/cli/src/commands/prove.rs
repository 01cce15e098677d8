//! `joulepath prove`.

mod real;

use std::{
    ffi::OsString,
    path::{Path, PathBuf},
    thread::available_parallelism,
};

use clap::{Args, ValueEnum};
use diagnosis::{Plain, Series};
use model::Robot;
use prove::{Diagnosis, FileBeside, Kind, PeerAnswer, REFERENCE, ROBOT, Scoreboard, Trial, Way};
use recording::read_paths;

use crate::{failure::BadInput, files, output, progress::Cases, recorded::robot, scored::summary};

/// Shares of power that effects can be given.
const SHARES: [f64; 2] = [0.002, 0.5];
/// Most cases of a trial: at some ten seconds each on a core, a night's work.
const MOST_CASES: usize = 10_000;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Name of a built-in robot, or a robot file: the robot when it is healthy
    #[arg(long, default_value = "husky-a200")]
    robot: String,
    /// Cases to draw; healthy drives and decoys are three tenths of them
    #[arg(long, default_value_t = 40)]
    cases: usize,
    /// Seed of everything that is drawn
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Only cases of one kind, instead of all kinds
    #[arg(long)]
    only: Option<Only>,
    /// How strong every effect is, as a share of power; otherwise 1.2, 3, 6, 12, 20 and 40 % take turns
    #[arg(long)]
    share: Option<f64>,
    /// Recordings of a real robot, one for each ground: put known changes into some of their runs, instead of simulating
    #[arg(long, value_name = "RECORDING", num_args = 1.., conflicts_with_all = ["only", "share", "together"])]
    real: Vec<PathBuf>,
    /// With --real: how strong changes are, in standard deviations of a detector that knows them; otherwise 16, 32 and 64 take turns
    #[arg(long, value_delimiter = ',', requires = "real")]
    z: Vec<f64>,
    /// Only what a diagnosis is given this way, instead of all three
    #[arg(long)]
    way: Option<WayName>,
    /// Folder for cases, keys and scoreboard; it must be empty or not exist yet
    #[arg(long, required_unless_present = "together")]
    out: Option<PathBuf>,
    /// Folders of trials that were made before: add them up instead of making one
    #[arg(long, value_name = "FOLDER", num_args = 1.., conflicts_with_all = ["robot", "cases", "seed", "only", "share", "out"])]
    together: Vec<PathBuf>,
}

/// What a diagnosis is given beside the suspect drive.
#[derive(Clone, Copy, ValueEnum)]
enum WayName {
    /// The robot's file alone
    FileAlone,
    /// A file that was calibrated on the healthy drives, without these
    CalibratedFileAlone,
    /// The robot's file and the healthy drives
    HealthyDrives,
}

impl From<WayName> for Way {
    fn from(name: WayName) -> Self {
        match name {
            WayName::FileAlone => Way::FileAlone,
            WayName::CalibratedFileAlone => Way::CalibratedFileAlone,
            WayName::HealthyDrives => Way::HealthyDrives,
        }
    }
}

/// A kind of case.
#[derive(Clone, Copy, ValueEnum)]
enum Only {
    /// Healthy drives
    Healthy,
    /// Healthy drives that look as if something were wrong
    Decoys,
    /// One effect that has a name
    One,
    /// Two effects that have names
    Two,
    /// One effect that no mechanism describes
    Unlisted,
}

impl From<Only> for Kind {
    fn from(only: Only) -> Self {
        match only {
            Only::Healthy => Kind::Healthy,
            Only::Decoys => Kind::Decoy,
            Only::One => Kind::One,
            Only::Two => Kind::Two,
            Only::Unlisted => Kind::Unlisted,
        }
    }
}

pub(crate) fn run(arguments: &Arguments, itself: &(PathBuf, Vec<OsString>)) -> anyhow::Result<()> {
    let Some(out) = &arguments.out else {
        output::line(summary(&[("", &prove::together(&arguments.together)?)]))?;
        return Ok(());
    };
    if !arguments.real.is_empty() {
        return real::run(arguments, out, itself);
    }
    check(arguments, out)?;
    let robot_json = serde_json::to_string_pretty(&robot(&arguments.robot)?)? + "\n";
    let bar = Cases::new();
    let trial = Trial {
        cases: arguments.cases,
        seed: arguments.seed,
        only: arguments.only.map(Kind::from),
        share: arguments.share,
        robot_json: &robot_json,
        out,
        // Cases side by side use the cores better than threads within one.
        diagnosis: Diagnosis { program: itself.clone(), threads: 1, beside: FileBeside::Raw },
        ways: &ways(arguments),
        peers: &peers,
        at_once: at_once(),
        progress: &|stage, done, all| bar.show(stage, done, all),
        // The commitment is in a file too; a reader that left ends the command at the summary.
        published: &|hash| drop(output::line(format_args!("committed to all keys: SHA-256 {hash}"))),
    };
    let boards = trial.run()?;
    let page = out.join("scoreboard.html");
    files::write(&page, report::scoreboard_page(&boards.most))?;
    bar.end();
    let columns: Vec<(&str, &Scoreboard)> =
        boards.ways.iter().map(|one| (one.way.words(), &one.board)).collect();
    output::line(summary(&columns))?;
    output::line(page.display())?;
    Ok(())
}

fn check(arguments: &Arguments, out: &Path) -> Result<(), BadInput> {
    if !(1..=MOST_CASES).contains(&arguments.cases) {
        return Err(BadInput(format!("--cases {} must lie in 1 to {MOST_CASES}", arguments.cases)));
    }
    let [low, high] = SHARES;
    if let Some(share) = arguments.share.filter(|share| !(low..=high).contains(share)) {
        return Err(BadInput(format!(
            "--share {share} must lie in {low} to {high}, such as 0.012 for 1.2 %"
        )));
    }
    let is_new = !out.exists() || out.read_dir().is_ok_and(|mut entries| entries.next().is_none());
    let fault = "it exists and is not an empty folder; name one that is new";
    if is_new { Ok(()) } else { Err(BadInput(format!("--out {}: {fault}", out.display()))) }
}

/// What a diagnosis is given: all, or what was asked for.
fn ways(arguments: &Arguments) -> Vec<Way> {
    arguments.way.map_or_else(|| Way::ALL.to_vec(), |way| vec![way.into()])
}

/// Cases that are worked on at the same time.
fn at_once() -> usize {
    available_parallelism().map_or(1, usize::from)
}

/// What simpler methods say of a case by the robot's raw file and the healthy drives.
fn peers(case: &Path) -> Vec<PeerAnswer> {
    peers_by(case, ROBOT)
}

/// What simpler methods say of a case by one of its robot files and the healthy drives.
fn peers_by(case: &Path, robot: &str) -> Vec<PeerAnswer> {
    let plain = plain(case, robot);
    let say = |peer, names: fn(&Plain) -> Vec<String>| PeerAnswer {
        peer,
        names: plain.as_ref().map(names).map_err(Clone::clone),
    };
    vec![say("plain BIC", Plain::by_information), say("sparse regression", Plain::by_sparse_regression)]
}

/// What they need of it.
fn plain(case: &Path, robot: &str) -> Result<Plain, String> {
    let robot = std::fs::read_to_string(case.join(robot)).map_err(|error| error.to_string())?;
    let robot = Robot::from_json(&robot).map_err(|error| error.to_string())?;
    let read = |name: &str| read_paths(&[case.join(name)], None).map_err(|error| error.to_string());
    let (suspect, healthy) = (read(prove::RECORDING)?.0, read(REFERENCE)?.0);
    let series = Series::new(&robot, &suspect, Some(&healthy)).map_err(|error| error.to_string())?;
    Plain::new(&series, &robot).map_err(|error| error.to_string())
}
