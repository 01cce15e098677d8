//! The part of a diagnosis' report that is scored, as the contract states it; other fields are passed over.

use serde::{Deserialize, Serialize};

/// A diagnosis.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Report {
    /// Its one word.
    pub verdict: Verdict,
    /// How well the robot fits with nothing found.
    pub baseline: Fit,
    /// What it found.
    pub findings: Vec<Finding>,
    /// How well the robot fits with all of that.
    #[serde(default)]
    pub corrected: Fit,
    /// What it says would have been noticed.
    #[serde(default)]
    pub detectable: Vec<Least>,
    /// Sets of mechanisms that may be missing, likeliest first, where it has such.
    #[serde(default)]
    pub explanations: Vec<Explanation>,
}

/// A set of mechanisms that may be missing.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Explanation {
    /// Their names.
    pub mechanisms: Vec<String>,
}

/// The least size of a mechanism that would have been noticed.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Least {
    /// The mechanism.
    pub mechanism: String,
    /// Which of its numbers.
    pub parameter: String,
    /// How much of it.
    pub value: f64,
}

/// The one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing is wrong.
    Consistent,
    /// It is known what.
    Explained,
    /// It is one of several.
    Ambiguous,
    /// It is something else.
    Unexplained,
}

/// How well a robot fits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
pub struct Fit {
    /// Root mean square error on drives that were held out [W].
    #[serde(default)]
    pub held_out_rmse_w: Option<f64>,
    /// What of it no model could predict, with everything found, where the report says so [W].
    #[serde(default)]
    pub noise_floor_w: Option<f64>,
}

/// One mechanism.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Finding {
    /// Its name, or `unknown`.
    pub mechanism: String,
    /// How big it is.
    #[serde(default)]
    pub parameters: Vec<Estimate>,
    /// What it cannot be told from.
    #[serde(default)]
    pub indistinguishable_from: Vec<String>,
    /// What it does on drives that were held out.
    #[serde(default)]
    pub fit: HeldOut,
    /// When it acts, where the report says so.
    #[serde(default)]
    pub scope: Option<Scope>,
}

/// When a finding acts; nothing is given where it always does.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
pub struct Scope {
    /// From so long after the beginning of the drive on [s].
    #[serde(default)]
    pub from_s: Option<f64>,
    /// Until so long after it [s].
    #[serde(default)]
    pub until_s: Option<f64>,
    /// The drive; none where it is each one.
    #[serde(default)]
    pub run: Option<String>,
}

/// What a finding does on drives that were held out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
pub struct HeldOut {
    /// Without it [W].
    #[serde(default)]
    pub held_out_rmse_before_w: Option<f64>,
    /// With it [W].
    #[serde(default)]
    pub held_out_rmse_after_w: Option<f64>,
}

/// An estimated number.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Estimate {
    /// Of what.
    pub name: String,
    /// How much; none where the recording does not tell.
    pub value: Option<f64>,
    /// In what.
    pub unit: String,
    /// Where it lies with a chance of 95 %.
    #[serde(default)]
    pub interval_95: Option<[f64; 2]>,
}

/// Name of findings outside the list.
pub(crate) const UNKNOWN: &str = "unknown";

impl Report {
    /// Whether it says that something is wrong.
    pub fn alarms(&self) -> bool {
        self.verdict != Verdict::Consistent || !self.findings.is_empty()
    }

    /// Whether it gives a name.
    pub fn names(&self) -> bool {
        self.findings.iter().any(Finding::is_named)
    }

    /// Sets of names that it gives, each sorted, likeliest first; none where no finding has a name.
    pub fn sets(&self) -> Vec<Vec<&str>> {
        if !self.names() {
            return Vec::new();
        }
        let mut sets: Vec<Vec<&str>> = match self.explanations.is_empty() {
            false => self.explanations.iter().map(Explanation::names).collect(),
            true => self.sets_of_findings(),
        };
        sets.iter_mut().for_each(|set| set.sort_unstable());
        sets
    }

    /// The named findings, and the same with one of them replaced by what it cannot be told from.
    fn sets_of_findings(&self) -> Vec<Vec<&str>> {
        let named: Vec<&Finding> = self.findings.iter().filter(|finding| finding.is_named()).collect();
        let first: Vec<&str> = named.iter().map(|finding| finding.mechanism.as_str()).collect();
        let mut sets = vec![first.clone()];
        for (i, finding) in named.iter().enumerate() {
            for other in &finding.indistinguishable_from {
                let mut set = first.clone();
                set[i] = other;
                sets.push(set);
            }
        }
        sets
    }
}

impl Explanation {
    fn names(&self) -> Vec<&str> {
        self.mechanisms.iter().map(String::as_str).collect()
    }
}

impl Finding {
    /// It and everything that it cannot be told from, each once, it first.
    pub fn set(&self) -> Vec<&str> {
        let mut set = vec![self.mechanism.as_str()];
        for other in &self.indistinguishable_from {
            if !set.contains(&other.as_str()) {
                set.push(other);
            }
        }
        set
    }

    /// Whether it gives a name.
    pub fn is_named(&self) -> bool {
        self.mechanism != UNKNOWN
    }
}
