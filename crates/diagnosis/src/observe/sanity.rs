//! Recordings that are not what they seem: sides swapped, signs turned round, another robot's file.

use calibration::{
    Drives,
    doubt::{charged, circumstances, mends, speeds},
};
use model::Robot;
use recording::{Channel, Recording, Run, Suspicion, SuspicionKind, suspicions};

use crate::{
    Error,
    observe::{series::Series, turning::Line},
};

/// Ratios of recorded to predicted power beyond which the file may be another robot's: friction of any hard ground is within.
const OTHER_ROBOT: [f64; 2] = [0.55, 1.8];
/// The same beyond which it is, whatever is missing: of what a real Husky draws on flooring it draws 0.30 on ice, and twice as much on loam.
const NOT_THIS_ROBOT: [f64; 2] = [0.1, 3.0];

/// What makes drives no drives of this robot as its file and its healthy drives have it, in sentences: sides swapped, signs turned round,
/// units or robots mistaken. Nothing else is told of them before that is mended. `said` are their [`contradictions`].
///
/// # Errors
/// As [`Series::new`] and [`Series::predict`].
pub(crate) fn mistakes(
    robot: &Robot,
    (recording, mut said): (&Recording, Vec<String>),
    series: &Series,
    of_healthy: &Robot,
) -> Result<Vec<String>, Error> {
    said.extend(speeds(robot, recording).iter().map(|doubt| format!("{}; {}", doubt.statement, doubt.cure)));
    let odd = circumstances(robot, recording, series.watch())?;
    said.extend(odd.iter().map(|doubt| format!("{}; {}", doubt.statement, doubt.cure)));
    // Healthy drives tell what this robot takes better than its file.
    let known = if series.has_healthy() { of_healthy } else { robot };
    let mended = mends(known, recording, series.watch())?;
    said.extend(mended.map(|doubt| format!("{}; {}", doubt.statement, doubt.cure)));
    if said.is_empty() {
        let charged = charged(robot, recording, series.watch())?;
        said.extend(charged.map(|doubt| format!("{}; {}", doubt.statement, doubt.cure)));
    }
    let kinds = [(true, "recorded power"), (false, "recorded power of the healthy drives")];
    for (suspect, which) in kinds.into_iter().filter(|(suspect, _)| *suspect || series.has_healthy()) {
        let ratio = ratio(robot, series, suspect)?;
        if said.is_empty() && !(NOT_THIS_ROBOT[0]..NOT_THIS_ROBOT[1]).contains(&ratio) {
            said.push(another(which, ratio));
        }
    }
    Ok(said)
}

/// What drives as they were recorded contradict whatever the robot, in sentences.
pub(crate) fn contradictions(suspect: &Recording, healthy: Option<&Recording>) -> Vec<String> {
    let mut said = of_motion(suspect);
    let of_healthy = healthy.map_or(Vec::new(), of_motion).into_iter();
    said.extend(of_healthy.map(|why| format!("of the healthy drives, {why}")));
    said
}

/// What channels of motion contradict: the sign of the yaw rate or heading, and sizes that another unit would explain.
fn of_motion(recording: &Recording) -> Vec<String> {
    let is_of_motion = |channel: Channel| {
        use Channel::{Heading, LeftSpeed, Pitch, RightSpeed, Roll, YawRate};
        matches!(channel, Pitch | Roll | LeftSpeed | RightSpeed | YawRate | Heading)
    };
    let all = suspicions(recording).into_iter();
    let told = all.filter(|one| {
        one.kind == SuspicionKind::Opposed || one.kind == SuspicionKind::Unit && is_of_motion(one.channel)
    });
    let mut said: Vec<String> = Vec::new();
    for Suspicion { channel, statement, .. } in told {
        // One channel is told once, however many drives it was wrong in.
        let name = format!("`{}`", channel.name());
        if !said.iter().any(|other| other.starts_with(&name)) {
            said.push(format!("{name}: {statement}"));
        }
    }
    said
}

/// Ratios of kilowatts to watts, as far as a robot may be off.
const KILOWATTS: [f64; 2] = [0.4e-3, 2.5e-3];

/// That power is another robot's, or in other units.
fn another(which: &str, ratio: f64) -> String {
    let unit = if (KILOWATTS[0]..KILOWATTS[1]).contains(&ratio) { "in kilowatts" } else { "in other units" };
    let ratio = if ratio.abs() < 0.01 { format!("{ratio:.1e}") } else { format!("{ratio:.2}") };
    format!(
        "{which} is {ratio} times what the robot's file predicts: the recording may be another robot's, or {unit}"
    )
}

/// What is doubtful about the drives under suspicion, in sentences, the mistakes among them first.
///
/// # Errors
/// As [`Series::new`] and [`Series::predict`].
pub(crate) fn doubts(
    robot: &Robot,
    recording: &Recording,
    series: &Series,
    mistakes: &[String],
) -> Result<Vec<String>, Error> {
    let mut said = mistakes.to_vec();
    let ratio = ratio(robot, series, true)?;
    let [least, most] = OTHER_ROBOT;
    if mistakes.is_empty() && !(least..most).contains(&ratio) {
        said.push(another("recorded power", ratio));
    }
    said.extend(stuck(robot, recording, series)?);
    said.extend(series.turning.as_ref().map(turning));
    Ok(said)
}

/// What repeats with every turn of the wheels.
fn turning(line: &Line) -> String {
    let side = ["left", "right"][line.side];
    format!(
        "what the {side} side takes goes up and down by {:.1} N at the rim once in every turn of its wheels, as it does with a bent \
         rim or a stone in a tyre (chance of as clear a line {:.0e})",
        line.force_n, line.p_value
    )
}

/// Share of a drive in which wheels that turn alone are told.
const OFTEN_STUCK: f64 = 0.05;

/// Drives in which the wheels turn against each other and the robot does not, which no mechanism describes.
fn stuck(robot: &Robot, recording: &Recording, series: &Series) -> Result<Option<String>, Error> {
    let drives = Drives::watched(robot, recording, series.watch())?;
    let share = |run: &Run| {
        let rows = drives.rows.get(run.rows.clone()).unwrap_or_default();
        rows.iter().filter(|row| row.stuck).count() as f64 / rows.len().max(1) as f64
    };
    let often = recording.runs.iter().map(|run| (share(run), run)).filter(|(share, _)| *share > OFTEN_STUCK);
    let named: Vec<String> =
        often.map(|(share, run)| format!("{:.0} % of {}", 100.0 * share, run.name)).collect();
    Ok((!named.is_empty()).then(|| {
        format!(
            "the wheels turn against each other and the robot does not, in {}: they slip, and what they draw there goes into the ground",
            named.join(", ")
        )
    }))
}

/// Recorded over predicted power at best, in drives under suspicion or in the healthy ones.
fn ratio(robot: &Robot, series: &Series, suspect: bool) -> Result<f64, Error> {
    let predicted = series.predict(robot, &[])?;
    let all = series.averages.iter().zip(series.recorded.iter().zip(&predicted));
    let pairs = all.filter(|(a, _)| a.suspect == suspect).map(|(_, pair)| pair);
    let [both, square] = pairs.fold([0.0, 0.0], |[both, square], (r, p)| [both + r * p, square + p * p]);
    Ok(both / square.max(f64::MIN_POSITIVE))
}
