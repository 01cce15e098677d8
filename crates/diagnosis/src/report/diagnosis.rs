//! What a diagnosis says, as its report has it.

use calibration::DrivesCoverage;
use model::Robot;
use serde::Serialize;

use crate::observe::region::Region;

/// How a diagnosis ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The model describes the drives.
    Consistent,
    /// What was missing is named, and nothing else explains it as well.
    Explained,
    /// What was missing is one of several that these drives cannot tell apart.
    Ambiguous,
    /// Something is missing that no mechanism describes.
    Unexplained,
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Verdict::Consistent => "consistent",
            Verdict::Explained => "explained",
            Verdict::Ambiguous => "ambiguous",
            Verdict::Unexplained => "unexplained",
        })
    }
}

/// Where model and recording differ, which physics was left out, how big it is, and how sure that is.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// How it ends.
    pub verdict: Verdict,
    /// The same in one sentence.
    pub sentence: String,
    /// The robot's file as it is against the recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<FileReport>,
    /// Probabilities of nothing, of listed and of unlisted effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probability: Option<Probability>,
    /// The credible set of explanations, likeliest first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub explanations: Vec<ExplanationFigures>,
    /// The model before.
    pub baseline: BaselineFit,
    /// Where they differ; empty where they do not.
    #[serde(rename = "where")]
    pub places: Vec<Place>,
    /// What was left out.
    pub findings: Vec<Finding>,
    /// The model with all of it.
    pub corrected: CorrectedFit,
    /// The drive that would tell apart what stays ambiguous.
    pub next_drive: Option<String>,
    /// Least sizes that would have been noticed.
    pub detectable: Vec<Detectable>,
    /// Mechanisms of which these drives tell nothing.
    pub not_judged: Vec<&'static str>,
    /// Doubts, and what the corrected robot's file cannot hold.
    pub notes: Vec<String>,
    /// How many seconds of every drive were compared, and why the rest was not.
    pub coverage: DrivesCoverage,
    /// The same of the healthy drives, where there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_coverage: Option<DrivesCoverage>,
    /// The robot fitted to the drives, with those findings that a robot's file has fields for.
    #[serde(skip)]
    pub corrected_robot: Robot,
    /// Power over time, for drawing.
    #[serde(skip)]
    pub trace: Trace,
}

/// How far predictions by the robot's file are off, over seconds of the whole power.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FileError {
    /// Root mean square error [W].
    pub rmse_w: f64,
    /// Mean of recorded less predicted [W].
    pub bias_w: f64,
    /// Mean of recorded power [W].
    pub mean_power_w: f64,
    /// Noise of the recorded power, root mean square [W].
    pub noise_w: f64,
}

/// The robot's file as it is against the recording.
#[derive(Clone, Debug, Serialize)]
pub struct FileReport {
    /// How far its predictions are off.
    #[serde(flatten)]
    pub error: FileError,
    /// Mechanisms that healthy drives need beside the file: what it lacks of this robot. They do not set the verdict.
    pub findings: Vec<Finding>,
}

/// Posterior probabilities, which sum to one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Probability {
    /// Nothing is missing.
    pub nothing: f64,
    /// Mechanisms of the list alone are.
    pub listed: f64,
    /// Something outside the list is, alone or beside a mechanism.
    pub unlisted: f64,
}

/// One explanation with its posterior probability.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExplanationFigures {
    /// Its mechanisms, `unknown` among them where something unlisted acts; none where nothing is missing.
    pub mechanisms: Vec<String>,
    /// Its probability.
    pub probability: f64,
}

/// When and where a finding acts; nothing is given where it always acts.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Scope {
    /// From so long after the beginning of the drive on [s].
    pub from_s: Option<f64>,
    /// Until so long after it [s].
    pub until_s: Option<f64>,
    /// The drive that both count in, and all after or before it.
    pub run: Option<String>,
    /// A part of the ground, in words.
    pub region: Option<String>,
}

/// How far the model is off before anything is found, over averages of one second of each channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BaselineFit {
    /// Root mean square error of the robot's file as it is [W].
    pub rmse_w: f64,
    /// Mean of recorded less predicted of the robot's file as it is [W].
    pub bias_w: f64,
    /// Root mean square error of the refitted robot where it was not fitted [W].
    pub held_out_rmse_w: f64,
    /// Noise of the recorded power by quick differences, root mean square [W].
    pub noise_floor_w: f64,
}

/// How far the corrected model is off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CorrectedFit {
    /// Root mean square error [W].
    pub rmse_w: f64,
    /// The same where it was not fitted [W].
    pub held_out_rmse_w: f64,
}

/// A part of the drives in which more than its share of the difference lies.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// `time`, `place`, `regime` or `channel`.
    pub kind: &'static str,
    /// In plain words.
    pub statement: String,
    /// What bounds it.
    pub range: Range,
    /// Share of the squared errors beyond noise that lies in it.
    pub share_of_excess: f64,
}

/// What bounds a place: a quantity between two values, or a name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Range {
    /// The quantity, with its unit, as `t_s` (in a drive), `driven_s` (all drives behind one another) or `speed_mps`; `position_m` for
    /// a place; `side` for a channel.
    pub quantity: &'static str,
    /// Least value; none where it is not bounded.
    pub from: Option<f64>,
    /// Greatest value; none where it is not bounded.
    pub to: Option<f64>,
    /// The drive, or the side.
    pub name: Option<String>,
    /// Of `position_m`: from west to east, and from south to north; none where that is not bounded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x_m: Option<[Option<f64>; 2]>,
    /// See [`Range::x_m`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y_m: Option<[Option<f64>; 2]>,
}

impl Range {
    /// Of a quantity from one value to another.
    pub(crate) fn of(quantity: &'static str, [from, to]: [Option<f64>; 2]) -> Self {
        Range { quantity, from, to, name: None, x_m: None, y_m: None }
    }

    /// Of a drive, or a side.
    pub(crate) fn named(self, name: Option<String>) -> Self {
        Range { name, ..self }
    }

    /// Of a part of the ground.
    pub(crate) fn within(region: &Region) -> Self {
        let bound = |pair: [f64; 2]| Some(pair.map(|m| m.is_finite().then_some(m)));
        let range = Range::of("position_m", [None, None]);
        Range { x_m: bound(region.x_m), y_m: bound(region.y_m), ..range }
    }
}

/// A mechanism that was left out.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// Its name.
    pub mechanism: String,
    /// In plain words: what was left out, and how big it is.
    pub statement: String,
    /// Its equation.
    pub equation: String,
    /// Its numbers.
    pub parameters: Vec<FoundParameter>,
    /// How sure it is.
    pub evidence: EvidenceFigures,
    /// Mechanisms that these drives cannot tell from it.
    pub indistinguishable_from: Vec<String>,
    /// Errors without and with it.
    pub fit: FindingFit,
    /// Probability of its mechanism, summed over explanations.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    /// When and where it acts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scope: Option<Scope>,
}

/// A number of a mechanism.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoundParameter {
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Its unit, `1` for none.
    pub unit: &'static str,
    /// Between which values it lies; none where it was taken from a grid.
    pub interval_95: Option<[f64; 2]>,
}

/// How sure a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EvidenceFigures {
    /// Posterior probability that it does not act; the name is that of reports of before.
    pub p_value: f64,
    /// Twice the log posterior odds of the likeliest explanation with it against the likeliest without.
    pub delta_bic: f64,
    /// Gain of held-out squared errors, as a share of them, by all findings together.
    pub held_out_gain: f64,
}

/// Root mean square errors where nothing was fitted, without and with a finding.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FindingFit {
    /// Without it and those found after it [W].
    pub held_out_rmse_before_w: f64,
    /// With it [W].
    pub held_out_rmse_after_w: f64,
}

/// The least size of a mechanism that would have been noticed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Detectable {
    /// Its name.
    pub mechanism: &'static str,
    /// The number.
    pub parameter: &'static str,
    /// The size.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
}

/// Power of the drives under suspicion over the time driven, all channels together.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Trace {
    /// Drive of each point.
    pub run: Vec<usize>,
    /// Time since that drive began [s].
    pub t_s: Vec<f64>,
    /// Recorded [W].
    pub recorded_w: Vec<f64>,
    /// Predicted by the robot's file [W].
    pub filed_w: Vec<f64>,
    /// Predicted by the corrected model [W].
    pub corrected_w: Vec<f64>,
    /// Names of the drives.
    pub runs: Vec<String>,
    /// Where the robot was, where that is known [m].
    pub position_m: Vec<Option<[f64; 2]>>,
}

impl Trace {
    /// At most so many points of it, evenly taken.
    #[must_use]
    pub fn thinned(&self, most: usize) -> Trace {
        let stride = self.t_s.len().div_ceil(most.max(1)).max(1);
        fn every<T: Clone>(values: &[T], stride: usize) -> Vec<T> {
            values.iter().step_by(stride).cloned().collect()
        }
        Trace {
            run: every(&self.run, stride),
            t_s: every(&self.t_s, stride),
            recorded_w: every(&self.recorded_w, stride),
            filed_w: every(&self.filed_w, stride),
            corrected_w: every(&self.corrected_w, stride),
            runs: self.runs.clone(),
            position_m: every(&self.position_m, stride),
        }
    }
}
