//! `joulepath prove --real`.

use std::{
    ffi::OsString,
    path::{Path, PathBuf},
};

use prove::{
    CALIBRATED, Diagnosis, FileBeside, PeerAnswer, ROBOT,
    real::{Ground, RealTrial, STRENGTHS_Z},
};

use super::{Arguments, at_once, check, peers_by, ways};
use crate::{failure::BadInput, files, output, progress::Cases, real_scored::summary, recorded::robot};

/// Strengths that changes can be given: below, no detector sees them; above, none of a robot's size is as strong.
const RANGE_Z: [f64; 2] = [1.0, 1000.0];

pub(super) fn run(
    arguments: &Arguments,
    out: &Path,
    itself: &(PathBuf, Vec<OsString>),
) -> anyhow::Result<()> {
    check(arguments, out)?;
    let strengths_z = if arguments.z.is_empty() { STRENGTHS_Z.to_vec() } else { arguments.z.clone() };
    let [low, high] = RANGE_Z;
    if let Some(z) = strengths_z.iter().find(|z| !(low..=high).contains(*z)) {
        return Err(BadInput(format!("--z {z} must lie in {low} to {high}, such as 16")).into());
    }
    let read = |path| Ground::read(path).map_err(|error| BadInput(format!("--real {error}")));
    let grounds = arguments.real.iter().map(|path| read(path)).collect::<Result<Vec<_>, _>>()?;
    let robot = robot(&arguments.robot)?;
    let bar = Cases::new();
    let trial = RealTrial {
        grounds: &grounds,
        cases: arguments.cases,
        seed: arguments.seed,
        strengths_z: &strengths_z,
        robot: &robot,
        out,
        // Cases side by side use the cores better than threads within one.
        diagnosis: Diagnosis { program: itself.clone(), threads: 1, beside: FileBeside::Calibrated },
        ways: &ways(arguments),
        peers: &peers,
        at_once: at_once(),
        progress: &|stage, done, all| bar.show(stage, done, all),
        // The commitment is in a file too; a reader that left ends the command at the summary.
        published: &|hash| drop(output::line(format_args!("committed to all keys: SHA-256 {hash}"))),
    };
    let boards = trial.run()?;
    let page = out.join("scoreboard.html");
    files::write(&page, report::real_scoreboard_page(&boards))?;
    bar.end();
    output::line(summary(&boards))?;
    output::line(page.display())?;
    Ok(())
}

/// What simpler methods say of a case by the file that stands beside the healthy drives, where it could be calibrated.
fn peers(case: &Path) -> Vec<PeerAnswer> {
    let is_calibrated = case.join(CALIBRATED).is_file();
    peers_by(case, if is_calibrated { CALIBRATED } else { ROBOT })
}
