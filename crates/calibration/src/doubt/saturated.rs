//! Power meters that stand at their limit while more is drawn.

use model::Robot;
use recording::{Channel, Recording, SuspicionKind, suspicions};

use super::{
    Doubt,
    cells::{Expected, power_channels},
};

/// Share of the energy that is worth a word, as for seconds that are left out.
const WORTH: f64 = 0.01;
/// Share of the rows at a limit in which the model has more, where readings are cut off: of readings that stand there by chance half have.
const LEAST_SHARE: f64 = 0.75;

/// Tells of a meter that is cut off at a value beyond which the robot drew more.
pub(super) fn saturated(robot: &Robot, recording: &Recording) -> Option<Doubt> {
    let found = suspicions(recording);
    let is_said = |channel: &Channel| {
        found.iter().any(|one| one.channel == *channel && one.kind == SuspicionKind::Saturated)
    };
    power_channels(recording)
        .into_iter()
        .filter(|channel| *channel != Channel::Voltage && is_said(channel))
        .find_map(|channel| cut_off(robot, recording, channel))
}

fn cut_off(robot: &Robot, recording: &Recording, channel: Channel) -> Option<Doubt> {
    let values = recording.channel(channel)?;
    let limit = values.iter().copied().filter(|x| x.is_finite()).fold(f64::NEG_INFINITY, f64::max);
    let expected = Expected::new(robot, recording)?;
    let rows = || (0..values.len()).filter(|row| values[*row].is_finite());
    let expected_w: Vec<f64> = (0..values.len()).map(|row| expected.of_channel(channel, row)).collect();
    let line = line(rows().filter(|row| values[*row] < limit).map(|row| [expected_w[row], values[row]]))?;
    let beyond = |row: usize| line[0] + line[1] * expected_w[row] - limit;
    let at: Vec<f64> =
        rows().filter(|row| values[*row] == limit).map(beyond).filter(|x| x.is_finite()).collect();
    let more = at.iter().filter(|x| **x > 0.0).count();
    let missed: f64 = at.iter().sum();
    let all: f64 = rows().map(|row| values[row].abs()).sum();
    (more as f64 > LEAST_SHARE * at.len() as f64 && missed > WORTH * all).then(|| Doubt {
        name: "meter_saturated",
        statement: format!(
            "`{}` stands at its limit of {limit} in {} of {} rows, and the model has more in {more} of these: about {:.0} % of what was drawn is cut off",
            channel.name(),
            at.len(),
            rows().count(),
            100.0 * missed / (all + missed)
        ),
        cure: "widen the range of the meter, or leave out the runs in which it is at its limit".to_owned(),
    })
}

/// Offset and factor of readings on what is expected of them: other ground and standing loads than the file's are no reason.
fn line(pairs: impl Iterator<Item = [f64; 2]>) -> Option<[f64; 2]> {
    let known: Vec<[f64; 2]> = pairs.filter(|pair| pair.iter().all(|x| x.is_finite())).collect();
    let count = known.len() as f64;
    let [x0, y0] = known.iter().fold([0.0; 2], |[x, y], pair| [x + pair[0] / count, y + pair[1] / count]);
    let [xx, xy] =
        known.iter().fold([0.0; 2], |[xx, xy], [x, y]| [xx + (x - x0).powi(2), xy + (x - x0) * (y - y0)]);
    let factor = xy / xx;
    (factor > 0.0).then_some([y0 - factor * x0, factor])
}
