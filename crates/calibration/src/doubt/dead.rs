//! A power sensor that tells one value in every row.

use recording::{Channel, Recording};

use super::{Doubt, cells::power_channels, driving::STANDS_MPS};

/// Driving in which no measured power stays the same to its last digit \[s\], as for sensors of one side.
const LEAST_S: f64 = 10.0;

/// Tells of power, or of a current, that stands at one value in all of a drive.
pub(super) fn dead(recording: &Recording) -> Option<Doubt> {
    if driven_s(recording) < LEAST_S {
        return None;
    }
    // The voltage of a battery may be its nominal one.
    let channels = power_channels(recording).into_iter().filter(|channel| *channel != Channel::Voltage);
    let stands = |channel: Channel| {
        let known = || recording.channel(channel).unwrap_or_default().iter().filter(|x| x.is_finite());
        let first = *known().next()?;
        known().all(|x| *x == first).then(|| (channel, first, known().count()))
    };
    let all: Option<Vec<_>> = channels.map(stands).collect();
    let said: Vec<String> = all?
        .into_iter()
        .map(|(channel, value, rows)| {
            format!("`{}` stands at {value} (it is {value} in every row of {rows})", channel.name())
        })
        .collect();
    (!said.is_empty()).then(|| Doubt {
        name: "power_stuck",
        statement: format!("{} while the wheels drive: its sensor seems dead", said.join(", ")),
        cure: "look at the sensor, its shunt and the field that the column is read from; take another source of power where there is one"
            .to_owned(),
    })
}

/// Time in which wheels turn \[s\].
fn driven_s(recording: &Recording) -> f64 {
    let sides =
        [Channel::LeftSpeed, Channel::RightSpeed].map(|side| recording.channel(side).unwrap_or_default());
    let turns =
        |row: &usize| sides.iter().any(|values| values.get(*row).is_some_and(|v| v.abs() > STANDS_MPS));
    let of_run = |run: &recording::Run| -> f64 {
        run.rows.clone().filter(turns).filter_map(|row| recording.step_s(run, row)).sum()
    };
    recording.runs.iter().map(of_run).sum()
}
