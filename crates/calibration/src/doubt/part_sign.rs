//! Power whose sign turns round in the middle of a drive.

use model::Robot;
use recording::{Channel, Recording, Watch};

use super::{
    Doubt,
    change::{is_believed, said_better},
    follow,
    follow::Followed,
    second::Second,
};
use crate::Error;

/// Tells of power that has its sign turned round for a part of a run.
///
/// # Errors
/// As [`crate::predict_watched()`].
pub(super) fn part_sign(
    robot: &Robot,
    recording: &Recording,
    (given, seconds): (&Followed, &[Second]),
    watch: &Watch,
) -> Result<Option<Doubt>, Error> {
    let parts: Vec<Part> = seconds.chunk_by(|a, b| a.run == b.run).filter_map(turned_part).collect();
    let Some(first) = parts.first() else { return Ok(None) };
    let other = follow::of(robot, &mended(recording, &parts), watch)?;
    Ok(is_believed(given, &other).then(|| Doubt {
        name: "power_sign_changes",
        statement: format!(
            "power seems to have the wrong sign from {:.0} to {:.0} s of run `{}`: {}",
            first.from_s,
            first.until_s,
            recording.runs.get(first.run).map_or("", |run| run.name.as_str()),
            said_better(given, &other)
        ),
        cure: "find out what changes the sign there (a cable, a driver that was started anew), and give power the sign that is positive when it is drawn from \
               the battery"
            .to_owned(),
    }))
}

/// A part of a run \[s\].
struct Part {
    run: usize,
    from_s: f64,
    until_s: f64,
}

/// The part of a run, up to its end or from its beginning, in which recorded and predicted power oppose each other most.
fn turned_part(run: &[Second]) -> Option<Part> {
    let mut sums = vec![0.0];
    for one in run {
        let both = one.recorded_w * one.predicted_w * one.duration_s;
        sums.push(sums.last()? + if both.is_finite() { both } else { 0.0 });
    }
    let total = *sums.last()?;
    let extreme = |sign: f64| (0..sums.len()).max_by(|a, b| (sign * sums[*a]).total_cmp(&(sign * sums[*b])));
    let (highest, lowest) = (extreme(1.0)?, extreme(-1.0)?);
    // Where the sum falls from its highest value on, or up to its lowest one, signs oppose.
    let rows = if total - sums[highest] < sums[lowest] { highest..run.len() } else { 0..lowest };
    let part = run.get(rows).filter(|part| !part.is_empty() && part.len() < run.len())?;
    let last = part.last()?;
    Some(Part { run: part[0].run, from_s: part[0].t_s, until_s: last.t_s + last.duration_s })
}

fn mended(recording: &Recording, parts: &[Part]) -> Recording {
    let mut mended = recording.clone();
    let channels = [Channel::LeftPower, Channel::RightPower, Channel::Power, Channel::Current];
    for (channel, part) in channels.iter().flat_map(|channel| parts.iter().map(move |part| (channel, part))) {
        let Some(run) = recording.runs.get(part.run) else { continue };
        let Some(values) = mended.channels.get_mut(channel) else { continue };
        let is_within = |row: &usize| (part.from_s..part.until_s).contains(&recording.t_s[*row]);
        run.rows.clone().filter(is_within).for_each(|row| values[row] = -values[row]);
    }
    mended
}
