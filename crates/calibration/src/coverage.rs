//! How many seconds of a run are counted, and why the rest is not.

use std::collections::BTreeMap;

use recording::{Channel, PowerForm, Recording, Run};
use serde::Serialize;

use crate::Drives;

/// What of a run was counted.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Coverage {
    /// From the first row of the run to its last \[s\].
    pub recorded_s: f64,
    /// Time that is counted in energies \[s\].
    pub used_s: f64,
    /// Time in which slopes are missing and the ground is taken for level; it is counted \[s\].
    pub level_s: f64,
    /// Time that is not counted, by reason, the longest first.
    pub left_out: Vec<LeftOut>,
}

/// Time that is not counted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LeftOut {
    /// Why.
    pub reason: String,
    /// The channel at fault, if one is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// How long \[s\].
    pub duration_s: f64,
}

impl Coverage {
    /// All of several runs.
    pub(crate) fn of_all(runs: &[Coverage]) -> Coverage {
        let mut reasons = BTreeMap::new();
        for left in runs.iter().flat_map(|run| &run.left_out) {
            *reasons.entry((left.reason.clone(), left.channel)).or_insert(0.0) += left.duration_s;
        }
        let sum = |of: fn(&Coverage) -> f64| runs.iter().map(of).sum();
        Coverage {
            recorded_s: sum(|run| run.recorded_s),
            used_s: sum(|run| run.used_s),
            level_s: sum(|run| run.level_s),
            left_out: longest_first(reasons),
        }
    }

    /// It in words, where less than all is counted as it was recorded.
    pub fn words(&self) -> Option<String> {
        /// Ends of drives and single rows are not worth a word, as a share.
        const WORTH: f64 = 0.01;
        let Coverage { recorded_s, used_s, level_s, left_out } = self;
        let mut said = Vec::new();
        if *used_s < (1.0 - WORTH) * recorded_s {
            let why: Vec<String> =
                left_out.iter().map(|left| format!("{:.1} s {}", left.duration_s, left.reason)).collect();
            said.push(format!("{used_s:.1} of {recorded_s:.1} s are counted; left out: {}", why.join(", ")));
        }
        if *level_s > WORTH * recorded_s {
            said.push(format!("in {level_s:.1} s slopes are missing and the ground is taken for level"));
        }
        (!said.is_empty()).then(|| said.join("; "))
    }
}

/// What of one run was counted, with its name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunCoverage {
    /// Name of the run.
    pub run: String,
    /// What of it was counted.
    #[serde(flatten)]
    pub coverage: Coverage,
}

/// What of drives was counted, run by run and in all.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DrivesCoverage {
    /// Run by run, in the order of the recording.
    pub runs: Vec<RunCoverage>,
    /// All of them.
    pub total: Coverage,
}

impl DrivesCoverage {
    /// What of a recording the averages of its drives count.
    pub fn of(recording: &Recording, drives: &Drives) -> DrivesCoverage {
        let covered = coverage(recording, drives);
        let total = Coverage::of_all(&covered);
        let named = recording.runs.iter().zip(covered);
        let runs = named.map(|(run, coverage)| RunCoverage { run: run.name.clone(), coverage }).collect();
        DrivesCoverage { runs, total }
    }

    /// The runs of which less than all is counted as it was recorded, in words.
    pub fn words_by_run(&self) -> Vec<String> {
        let words = |run: &RunCoverage| Some(format!("run {}: {}", run.run, run.coverage.words()?));
        self.runs.iter().filter_map(words).collect()
    }
}

/// What of every run is counted.
pub(crate) fn coverage(recording: &Recording, drives: &Drives) -> Vec<Coverage> {
    let mut stretch_of = vec![usize::MAX; drives.rows.len()];
    for (number, stretch) in drives.stretches.iter().enumerate() {
        stretch_of[stretch.rows.clone()].fill(number);
    }
    let mut is_counted = vec![false; drives.rows.len()];
    for average in &drives.averages {
        for row in average.span.clone() {
            is_counted[row] = drives.rows[row].used && !drives.rows[row].stuck;
        }
    }
    let places = Places { recording, drives, stretch_of: &stretch_of, is_counted: &is_counted };
    recording.runs.iter().map(|run| places.of_run(run)).collect()
}

/// Where each row of drives lies, and whether it is counted.
struct Places<'a> {
    recording: &'a Recording,
    drives: &'a Drives,
    /// By row, its stretch; `usize::MAX` for none.
    stretch_of: &'a [usize],
    is_counted: &'a [bool],
}

impl Places<'_> {
    fn of_run(&self, run: &Run) -> Coverage {
        let mut coverage = Coverage::default();
        let mut reasons = BTreeMap::<(String, Option<Channel>), f64>::new();
        for i in run.rows.clone().skip(1) {
            let step_s = self.recording.t_s[i] - self.recording.t_s[i - 1];
            coverage.recorded_s += step_s;
            let of_one_stretch =
                self.stretch_of[i] != usize::MAX && self.stretch_of[i] == self.stretch_of[i - 1];
            if of_one_stretch && self.is_counted[i - 1] && self.is_counted[i] {
                coverage.used_s += step_s;
                if self.drives.rows[i - 1].level || self.drives.rows[i].level {
                    coverage.level_s += step_s;
                }
                continue;
            }
            *reasons.entry(self.why_not(run, i, step_s)).or_insert(0.0) += step_s;
        }
        coverage.left_out = longest_first(reasons);
        coverage
    }

    /// Why the step to a row is not counted, and the channel at fault if one is.
    fn why_not(&self, run: &Run, i: usize, step_s: f64) -> (String, Option<Channel>) {
        if let Some(channel) = missing(self.recording, i).or_else(|| missing(self.recording, i - 1)) {
            return (format!("`{}` has no value", channel.name()), Some(channel));
        }
        if self.recording.step_s(run, i - 1).is_none() {
            let reason = match step_s > run.gap_s {
                true => format!("between rows farther apart than {:.2} s", run.gap_s),
                false => "between rows farther apart than those around them".to_owned(),
            };
            return (reason, None);
        }
        if self.stretch_of[i] == usize::MAX {
            return ("of a run that repeats another".to_owned(), None);
        }
        if self.stretch_of[i] != self.stretch_of[i - 1] {
            return ("where the surface changes".to_owned(), None);
        }
        let rows = [i, i - 1];
        if rows.iter().any(|row| self.drives.rows[*row].level && !self.drives.rows[*row].used) {
            let attitude = [Channel::Pitch, Channel::Roll];
            let channel = rows.iter().find_map(|row| lacking(self.recording, &attitude, *row));
            let name = channel.map_or("pitch_rad", Channel::name);
            return (format!("`{name}` has no value"), channel);
        }
        if rows.iter().any(|row| self.drives.rows[*row].stuck) {
            return (
                "with wheels that turn against each other while the robot does not turn".to_owned(),
                None,
            );
        }
        if rows.iter().any(|row| self.drives.rows[*row].window.reading > 0) {
            return ("in periods of the power meter that are not there as a whole".to_owned(), None);
        }
        ("in seconds that are left out of the comparison".to_owned(), None)
    }
}

/// The first needed channel that has no value in a row.
fn missing(recording: &Recording, row: usize) -> Option<Channel> {
    let power = recording.power_form().map(PowerForm::channels);
    let needed = [Channel::LeftSpeed, Channel::RightSpeed].into_iter().chain(power.into_iter().flatten());
    lacking(recording, &needed.collect::<Vec<_>>(), row)
}

/// The first of some channels that has no value in a row.
fn lacking(recording: &Recording, channels: &[Channel], row: usize) -> Option<Channel> {
    let lacks = |channel: &Channel| recording.channel(*channel).is_some_and(|values| values[row].is_nan());
    channels.iter().copied().find(lacks)
}

fn longest_first(reasons: BTreeMap<(String, Option<Channel>), f64>) -> Vec<LeftOut> {
    let of = |((reason, channel), duration_s)| LeftOut { reason, channel, duration_s };
    let mut all: Vec<LeftOut> = reasons.into_iter().map(of).collect();
    all.sort_by(|a, b| b.duration_s.total_cmp(&a.duration_s));
    all
}
