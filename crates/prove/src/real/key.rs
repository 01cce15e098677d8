//! The key of a case of real drives: what was done to them, and which files it speaks of.

use std::collections::BTreeMap;

use recording::{Recording, Run};
use serde::{Deserialize, Serialize};

use crate::{
    real::{Act, RealKind},
    sealed::Sealed,
};

/// What is kept apart until all diagnoses have ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RealKey {
    /// The case.
    pub case: String,
    /// What kind it is.
    pub kind: RealKind,
    /// Seed of its split and all else; secret, so that a hash cannot be guessed at.
    pub seed: u64,
    /// The ground of both halves.
    pub ground: String,
    /// Runs of the healthy half, by their names in the recording.
    pub healthy: Vec<String>,
    /// Runs of the suspect half, in the order in which they were given.
    pub suspect: Vec<String>,
    /// The change that was put in.
    pub put: Option<Put>,
    /// The border of two grounds.
    pub border: Option<Border>,
    /// SHA-256 of the files that the diagnosis gets.
    pub files: BTreeMap<String, String>,
}

impl RealKey {
    /// Names of mechanisms that are right; none where nothing was done.
    ///
    /// Where loam or snow begins, wheels sink in as well as find other friction; where ice or snow begins, they slip as well.
    pub fn accepted(&self) -> Vec<&'static str> {
        match (&self.put, &self.border) {
            (Some(put), _) => put.act.change.accepted().to_vec(),
            (None, Some(border)) => {
                let is = |grounds: &[&str]| grounds.iter().any(|ground| border.onto.contains(ground));
                let mut names = vec!["surface_change"];
                names.extend(is(&["loam", "snow"]).then_some("soft_soil"));
                names.extend(is(&["ice", "snow"]).then_some("wheel_slip"));
                names
            }
            (None, None) => Vec::new(),
        }
    }
}

/// A change that was put into a suspect half.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Put {
    /// What and how much.
    pub act: Act,
    /// Strength asked for, in standard deviations of the ideal detector.
    pub asked_z: f64,
    /// Strength as it came out.
    pub z: f64,
    /// Root mean square change of power while it acts, over mean power.
    pub power_change: f64,
}

/// Where one ground ends and another begins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Border {
    /// The run that goes over it, as the diagnosis gets its name.
    pub run: String,
    /// When, after the beginning of that run [s].
    pub t_s: f64,
    /// The ground after it.
    pub onto: String,
}

/// From when on a change acts: some time after the beginning of one run, and all through those that follow it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Onset {
    /// Which of the suspect runs, from 0.
    pub run: usize,
    /// Time since it began [s].
    pub t_s: f64,
}

impl Onset {
    /// All the time.
    pub const START: Onset = Onset { run: 0, t_s: 0.0 };

    /// Whether a change acts, by row.
    pub fn rows(self, recording: &Recording) -> Vec<bool> {
        let of_run = |(i, run): (usize, &Run)| {
            let times_s = &recording.t_s[run.rows.clone()];
            let began_s = times_s.first().copied().unwrap_or_default();
            let acts = move |t_s: &f64| i > self.run || i == self.run && t_s - began_s >= self.t_s;
            times_s.iter().map(acts).collect::<Vec<bool>>()
        };
        recording.runs.iter().enumerate().flat_map(of_run).collect()
    }

    /// The time that lies a share of all driving after the start.
    pub fn after_share(recording: &Recording, share: f64) -> Onset {
        let lasted_s = |run: &Run| super::ground::duration_s(recording, run);
        let mut left_s = share * recording.runs.iter().map(lasted_s).sum::<f64>();
        for (run, lasts_s) in recording.runs.iter().map(lasted_s).enumerate() {
            if left_s < lasts_s {
                return Onset { run, t_s: left_s.round() };
            }
            left_s -= lasts_s;
        }
        Onset::START
    }
}

impl Sealed for RealKey {
    fn files(&self) -> &BTreeMap<String, String> {
        &self.files
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::ground::tests::drives;

    #[test]
    fn a_share_of_the_driving_is_a_run_and_a_time_in_it() {
        // Runs of 19.9 s and 39.9 s: half of 59.8 s is 10 s into the second.
        let recording = drives(&[200, 400], 0.0);
        let onset = Onset::after_share(&recording, 0.5);
        assert_eq!(onset, Onset { run: 1, t_s: 10.0 });
        let acts = onset.rows(&recording);
        assert_eq!(acts.iter().position(|acts| *acts), Some(300));
        assert!(Onset::START.rows(&recording).iter().all(|acts| *acts));
    }
}
