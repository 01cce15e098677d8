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
    /// How long \[s\].
    pub duration_s: f64,
}

impl Coverage {
    /// All of several runs.
    pub(crate) fn of_all(runs: &[Coverage]) -> Coverage {
        let mut reasons = BTreeMap::new();
        for left in runs.iter().flat_map(|run| &run.left_out) {
            *reasons.entry(left.reason.clone()).or_insert(0.0) += left.duration_s;
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

/// What of every run is counted.
pub(crate) fn coverage(recording: &Recording, drives: &Drives) -> Vec<Coverage> {
    let mut stretch_of = vec![usize::MAX; drives.rows.len()];
    for (number, stretch) in drives.stretches.iter().enumerate() {
        stretch_of[stretch.rows.clone()].fill(number);
    }
    recording.runs.iter().map(|run| of_run(recording, drives, run, &stretch_of)).collect()
}

fn of_run(recording: &Recording, drives: &Drives, run: &Run, stretch_of: &[usize]) -> Coverage {
    let mut coverage = Coverage::default();
    let mut reasons = BTreeMap::<String, f64>::new();
    for i in run.rows.clone().skip(1) {
        let step_s = recording.t_s[i] - recording.t_s[i - 1];
        coverage.recorded_s += step_s;
        let [before, row] = [&drives.rows[i - 1], &drives.rows[i]];
        if stretch_of[i] != usize::MAX && stretch_of[i] == stretch_of[i - 1] && before.used && row.used {
            coverage.used_s += step_s;
            if before.level || row.level {
                coverage.level_s += step_s;
            }
            continue;
        }
        let why = missing(recording, i).or_else(|| missing(recording, i - 1)).unwrap_or_else(|| {
            if step_s > run.gap_s {
                format!("between rows farther apart than {:.2} s", run.gap_s)
            } else if stretch_of[i] == usize::MAX {
                "of a run that repeats another".to_owned()
            } else {
                "where the surface changes".to_owned()
            }
        });
        *reasons.entry(why).or_insert(0.0) += step_s;
    }
    coverage.left_out = longest_first(reasons);
    coverage
}

/// The first needed channel that has no value in a row.
fn missing(recording: &Recording, row: usize) -> Option<String> {
    let power = recording.power_form().map(PowerForm::channels);
    let needed = [Channel::LeftSpeed, Channel::RightSpeed].into_iter().chain(power.into_iter().flatten());
    let lacks = |channel: &Channel| recording.channel(*channel).is_some_and(|values| values[row].is_nan());
    needed.into_iter().find(lacks).map(|channel| format!("`{}` has no value", channel.name()))
}

fn longest_first(reasons: BTreeMap<String, f64>) -> Vec<LeftOut> {
    let mut all: Vec<LeftOut> =
        reasons.into_iter().map(|(reason, duration_s)| LeftOut { reason, duration_s }).collect();
    all.sort_by(|a, b| b.duration_s.total_cmp(&a.duration_s));
    all
}
