//! One value to the last digit that stands between measured ones: zeros of a join, -1 or -9999 of a sensor that did not answer.

use model::{Robot, STANDARD_GRAVITY_MPS2};
use recording::{Channel, Recording, Run};

use super::{
    Doubt,
    cells::{Cells, Expected, between, near_s, power_channels, recorded_j, without},
    second::median,
};

/// Values that programs write where nothing was measured; others are told by lying farther from the rest than the rest is wide.
const USUAL: [f64; 2] = [0.0, -1.0];
/// Fewer cells alike are a chance.
const LEAST_CELLS: usize = 3;
/// Share of the cells of a value, where it would be missed, that have to stand apart: of measured values few do.
const LEAST_APART: f64 = 0.5;
/// Standard deviations by which measured values lie off the line between their neighbours at most, but for one in 16 000.
const SIGMAS: f64 = 4.0;
/// A standard deviation over the median of magnitudes, of normal errors.
const OVER_MEDIAN: f64 = 1.4826;
/// Share of the recorded energy that is worth a word, as for seconds that are left out.
const WORTH: f64 = 0.01;
/// Rims that turn \[m/s\]: a tenth of what a Husky drives at most.
const TURNS_MPS: f64 = 0.1;
/// Slowing down more than this may give power back \[m/s²\]: a hundredth of what friction on hard ground slows by.
const SLOWING_MPS2: f64 = 0.05;
/// Share of the usual power of driving that is missed where a meter tells none.
const LOADED: f64 = 0.5;
/// Times that each value comes on a coarse scale, at least; of a fine one hardly any comes twice.
const TIMES_EACH: usize = 10;
/// Cells that are looked at for what is usual.
const SAMPLE: usize = 4_000;

/// Placeholders in the channels of power and of wheel speeds, with the value of each.
pub(super) fn placeholders(robot: &Robot, recording: &Recording) -> Vec<(f64, Cells)> {
    let others = [Channel::LeftSpeed, Channel::RightSpeed, Channel::Pitch, Channel::Roll];
    let channels = power_channels(recording).into_iter().chain(others);
    let of = |channel: Channel| {
        let values = recording.channel(channel)?;
        let is_folded = matches!(channel, Channel::LeftMotorCurrent | Channel::RightMotorCurrent)
            && values.iter().all(|current_a| current_a.is_nan() || *current_a >= 0.0);
        // A current without a sign passes through zero wherever its force turns round, between values far from it.
        candidates(values).into_iter().filter(|value| !(is_folded && *value == 0.0)).find_map(|value| {
            let cells = Looked { robot, recording, channel, values, value }.cells()?;
            Some((value, cells))
        })
    };
    channels.filter_map(of).collect()
}

/// Values that may be placeholders of a channel: usual ones, and an extreme apart from all others.
fn candidates(values: &[f64]) -> Vec<f64> {
    let known = || values.iter().copied().filter(|value| value.is_finite());
    let ends = |left: &dyn Fn(f64) -> bool| {
        let kept = known().filter(|value| left(*value));
        kept.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let [least, greatest] = ends(&|_| true);
    let inner = |end: f64| ends(&|value| value != end);
    let is_apart = |end: f64| {
        let [low, high] = inner(end);
        let off = if end < low { low - end } else { end - high };
        off > high - low
    };
    let mut found = USUAL.to_vec();
    found.extend([least, greatest].into_iter().filter(|end| !USUAL.contains(end) && is_apart(*end)));
    found.retain(|value| known().filter(|other| other == value).count() >= LEAST_CELLS);
    found
}

/// A channel and a value that is looked at in it.
struct Looked<'a> {
    robot: &'a Robot,
    recording: &'a Recording,
    channel: Channel,
    values: &'a [f64],
    value: f64,
}

impl Looked<'_> {
    /// The cells of the value that stand apart, where enough of them do.
    fn cells(&self) -> Option<Cells> {
        let tells_power = self.channel.tells_power() || self.channel == Channel::Voltage;
        let expected = if tells_power { Some(Expected::new(self.robot, self.recording)?) } else { None };
        let usual_w = match &expected {
            Some(expected) => self.usual_w(expected)?,
            None => 0.0,
        };
        let least = SIGMAS * self.scatter()?.max(self.rung() / 2.0) + self.rung();
        let (mut rows, mut missed, mut missed_apart) = (Vec::new(), 0, 0);
        let (mut changed, mut rest) = (0.0, 0.0);
        for run in &self.recording.runs {
            for row in run.rows.clone() {
                if self.values[row] != self.value {
                    rest += Some(self.values[row].abs()).filter(|x| x.is_finite()).unwrap_or(0.0);
                    continue;
                }
                let Some([before, middle, after]) = self.between(run, row) else { continue };
                let off = (middle - self.value).abs();
                // A slope passes through every angle between those around it.
                let is_between = self.is_angle() && (before - self.value) * (after - self.value) <= 0.0;
                let is_apart = off > least && !is_between;
                let is_missed = match &expected {
                    Some(expected) => {
                        expected.of_channel(self.channel, row) > LOADED * usual_w
                            && !self.is_slowing(run, row)
                    }
                    // An angle is not asked for: its cells have to lie apart from those around them.
                    None if self.is_angle() => true,
                    None => self.is_impossible(run, row, [before, after]),
                };
                missed += usize::from(is_missed);
                missed_apart += usize::from(is_missed && is_apart);
                rest += middle.abs();
                if is_apart {
                    changed += off;
                    rows.push(row);
                }
            }
        }
        let is_placeholder = missed_apart >= LEAST_CELLS
            && missed_apart as f64 > LEAST_APART * missed as f64
            && changed > WORTH * rest;
        is_placeholder.then_some(Cells { channel: self.channel, rows })
    }

    fn is_angle(&self) -> bool {
        matches!(self.channel, Channel::Pitch | Channel::Roll)
    }

    /// Step of the scale of a coarse meter, whose values come back again and again; nothing of a fine one. Rounding hides a scatter of half a step
    /// and takes readings apart by a whole one.
    fn rung(&self) -> f64 {
        let mut known: Vec<f64> = self.values.iter().copied().filter(|x| x.is_finite()).collect();
        let rows = known.len();
        known.sort_by(f64::total_cmp);
        known.dedup();
        if known.len() * TIMES_EACH > rows {
            return 0.0;
        }
        known.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min).min(f64::MAX)
    }

    fn between(&self, run: &Run, row: usize) -> Option<[f64; 3]> {
        between(self.recording, run, self.values, row, |other| other != self.value)
    }

    /// How far other cells lie off the line between their neighbours, one standard deviation.
    fn scatter(&self) -> Option<f64> {
        let rows = self.recording.runs.iter().flat_map(|run| run.rows.clone().map(move |row| (run, row)));
        let others = rows.filter(|(_, row)| self.values[*row].is_finite() && self.values[*row] != self.value);
        let every = self.values.len().div_ceil(SAMPLE).max(1);
        let off = others.step_by(every).filter_map(|(run, row)| {
            let [_, middle, _] = self.between(run, row)?;
            Some((middle - self.values[row]).abs())
        });
        Some(OVER_MEDIAN * median(off.collect())?)
    }

    /// Median of what the robot's file expects of the channel while wheels turn \[W\].
    fn usual_w(&self, expected: &Expected<'_>) -> Option<f64> {
        let every = self.values.len().div_ceil(SAMPLE).max(1);
        let turns = (0..self.values.len()).step_by(every).filter(|row| self.rim_mps(*row) > TURNS_MPS);
        median(turns.map(|row| expected.of_channel(self.channel, row)).collect()).filter(|watts| *watts > 0.0)
    }

    /// Mean magnitude of both rim speeds \[m/s\].
    fn rim_mps(&self, row: usize) -> f64 {
        let at = |channel| self.recording.channel(channel).map_or(f64::NAN, |values| values[row].abs());
        (at(Channel::LeftSpeed) + at(Channel::RightSpeed)) / 2.0
    }

    /// Whether wheels slow down about a row, so that power may be given back or cut.
    fn is_slowing(&self, run: &Run, row: usize) -> bool {
        let ends = [row.max(run.rows.start + 1) - 1, (row + 1).min(run.rows.end - 1)];
        let span_s = self.recording.t_s[ends[1]] - self.recording.t_s[ends[0]];
        self.rim_mps(ends[1]) - self.rim_mps(ends[0]) < -SLOWING_MPS2 * span_s
    }

    /// Whether wheels would leave a speed and come back to it faster than tyres can push.
    fn is_impossible(&self, run: &Run, row: usize, [before, after]: [f64; 2]) -> bool {
        let t_s = &self.recording.t_s;
        let is_lone = [row.wrapping_sub(1), row + 1]
            .iter()
            .all(|other| run.rows.contains(other) && self.values[*other] != self.value);
        let steps_s = [
            t_s[row] - t_s[row.max(run.rows.start + 1) - 1],
            t_s[(row + 1).min(run.rows.end - 1)] - t_s[row],
        ];
        let rates = [(before - self.value) / steps_s[0], (after - self.value) / steps_s[1]];
        is_lone
            && steps_s.iter().all(|step_s| *step_s > 0.0 && *step_s <= near_s(run))
            && rates.iter().all(|rate| rate.abs() > STANDARD_GRAVITY_MPS2)
            && before * after > 0.0
    }
}

/// A doubt about placeholders, with the energies with and without them.
pub(super) fn doubt(recording: &Recording, found: &[(f64, Cells)]) -> Option<Doubt> {
    let of = |(value, cells): &(f64, Cells)| {
        format!(
            "`{}` is {value} to the last digit in {} between others far from it, first in {}",
            cells.channel.name(),
            cells.count(recording),
            cells.first(recording)
        )
    };
    let said: Vec<String> = found.iter().map(of).collect();
    let cells: Vec<Cells> = found.iter().map(|(_, cells)| cells.clone()).collect();
    let energies = recorded_j(recording).zip(recorded_j(&without(recording, &cells)));
    let energies = energies.filter(|(with, left)| with != left).map_or(String::new(), |(with, left)| {
        format!("; recorded energy is {:.1} kJ with them and {:.1} kJ without", with / 1e3, left / 1e3)
    });
    (!said.is_empty()).then(|| Doubt {
        name: "placeholders",
        statement: format!("{}{energies}: nothing was measured there", said.join("; ")),
        cure: "leave these cells empty, which makes gaps of them (join tables without filling holes; of several publishers read one)"
            .to_owned(),
    })
}
