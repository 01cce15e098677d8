//! One case scored: what was said against what is true.

use serde::{Deserialize, Deserializer, Serialize};
use world::{EffectName, Family};

use crate::{
    Estimate, Finding, Kind, Least, Outcome, Parameter, PeerScore, Report, SealedKey, Truth, Verdict,
    matching::{self, Answer},
    report::UNKNOWN,
};

/// How the diagnosis did on one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseScore {
    /// The case.
    pub case: String,
    /// What kind it is.
    pub kind: Kind,
    /// The strength asked for, as a share of power.
    pub share: f64,
    /// What the diagnosis said, in one word.
    pub verdict: Option<Verdict>,
    /// Why it said nothing.
    pub error: Option<String>,
    /// Sets of names that it gave.
    pub said: Vec<Vec<String>>,
    /// Whether it said that something is wrong.
    pub alarmed: bool,
    /// Whether it gave a name.
    #[serde(default)]
    pub gave_a_name: bool,
    /// How many sets of names it gave.
    #[serde(default)]
    pub sets: usize,
    /// Which of them is the true one, from 1.
    #[serde(default)]
    pub rank: Option<usize>,
    /// Each effect that acted.
    pub truths: Vec<TruthScore>,
    /// Findings that give a name and answer to no truth.
    pub wrong_names: usize,
    /// Whether a name of the other family was given, where all truths are of one.
    pub swapped: bool,
    /// Root mean square error after correction over that of the drive without effects, both held out.
    pub rmse_ratio: Option<f64>,
    /// The same of the noise floor: of a robot that draws more power, noise is more.
    pub noise_ratio: Option<f64>,
    /// Share of the held-out mismatch that discovered terms explain together.
    pub discovered: Option<f64>,
    /// The same drive without the effects.
    pub twin: Option<Twin>,
    /// How others did.
    pub peers: Vec<PeerScore>,
}

/// The diagnosis of the same drive without the effects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Twin {
    /// Whether it said that something is wrong.
    pub alarmed: bool,
    /// Whether it gave a name.
    #[serde(default)]
    pub gave_a_name: bool,
    /// Why it said nothing.
    pub error: Option<String>,
    /// Held-out error of the robot fitted to it, with what was falsely found if that lowers it [W].
    pub held_out_rmse_w: Option<f64>,
    /// What of it no model could predict [W].
    pub noise_floor_w: Option<f64>,
}

/// How one effect fared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TruthScore {
    /// Its name.
    pub effect: EffectName,
    /// Its family.
    pub family: Family,
    /// How strong it is for a detector that knows it; not a number where that cannot be told.
    #[serde(deserialize_with = "number_or_none")]
    pub z: f64,
    /// Root mean square change of power over its mean, as it came out.
    pub power_change: f64,
    /// From when on it acted [s].
    #[serde(default)]
    pub onset_s: f64,
    /// Whether anything was found.
    pub detected: bool,
    /// Whether it was named, before all others.
    pub named_first: bool,
    /// Whether it is in a set of at most two.
    pub in_two: bool,
    /// Names in the set that holds it.
    pub set_size: Option<usize>,
    /// Whether it is less than the report says would have been noticed, if it says so of this effect.
    pub too_small: Option<bool>,
    /// Its numbers.
    pub parameters: Vec<ParameterScore>,
}

/// How one number of an effect fared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterScore {
    /// Of what.
    pub name: String,
    /// In what.
    pub unit: String,
    /// What is true.
    pub truth: f64,
    /// What was said.
    pub estimate: f64,
    /// Difference over the largest true number of the same unit.
    pub relative_error: Option<f64>,
    /// Whether the interval holds the truth, if there is one.
    pub covered: Option<bool>,
}

impl CaseScore {
    /// Whether the diagnosis ran to its end and found nothing.
    pub fn is_quiet(&self) -> bool {
        self.error.is_none() && !self.alarmed
    }

    /// Whether the diagnosis ran to its end and gave no name that is wrong.
    pub fn misnames_nothing(&self) -> bool {
        self.error.is_none() && self.wrong_names == 0
    }
}

impl Twin {
    /// Whether the diagnosis ran to its end and found nothing.
    pub fn is_quiet(&self) -> bool {
        self.error.is_none() && !self.alarmed
    }

    /// What came of the twin.
    pub fn new(outcome: &Outcome) -> Self {
        match outcome {
            Outcome::Report(report) => {
                let fits = [report.baseline, report.corrected];
                let rmse_w = fits.iter().filter_map(|fit| fit.held_out_rmse_w).reduce(f64::min);
                let noise_floor_w = report.baseline.noise_floor_w;
                let (alarmed, gave_a_name) = (report.alarms(), report.names());
                Twin { alarmed, gave_a_name, error: None, held_out_rmse_w: rmse_w, noise_floor_w }
            }
            Outcome::Failed(why) => {
                let error = Some(why.clone());
                Twin { alarmed: false, gave_a_name: false, error, held_out_rmse_w: None, noise_floor_w: None }
            }
        }
    }
}

/// Scores a case. A diagnosis that failed found nothing, and is told apart from one that kept quiet.
pub fn score(key: &SealedKey, strengths_z: &[f64], outcome: &Outcome, twin: Option<Twin>) -> CaseScore {
    let (report, error) = match outcome {
        Outcome::Report(report) => (Some(report), None),
        Outcome::Failed(why) => (None, Some(why.clone())),
    };
    let findings: &[Finding] = report.map_or(&[], |report| &report.findings);
    let names: Vec<String> = key.truths.iter().map(|truth| truth.effect.name()).collect();
    let matched = matching::best(findings, &names);
    let alarmed = report.is_some_and(Report::alarms);
    let truth = |(i, truth): (usize, &Truth)| {
        let z = strengths_z.get(i).copied().unwrap_or(f64::NAN);
        let least = report.map_or(&[][..], |report| &report.detectable);
        let too_small = is_too_small(truth, least);
        TruthScore { too_small, ..truth_score(truth, z, alarmed, matched[i].map(|j| &findings[j])) }
    };
    let wrong = |(j, finding): (usize, &Finding)| finding.is_named() && !matched.contains(&Some(j));
    let twin_w = twin.as_ref().and_then(|twin| twin.held_out_rmse_w);
    let twin_noise_w = twin.as_ref().and_then(|twin| twin.noise_floor_w);
    CaseScore {
        case: key.case.clone(),
        kind: key.kind,
        share: key.share,
        verdict: report.map(|report| report.verdict),
        error,
        said: findings.iter().map(|f| f.set().into_iter().map(str::to_owned).collect()).collect(),
        alarmed,
        gave_a_name: report.is_some_and(Report::names),
        sets: report.map_or(0, |report| report.sets().len()),
        rank: report.and_then(|report| rank(report, &names)),
        truths: key.truths.iter().enumerate().map(truth).collect(),
        wrong_names: findings.iter().enumerate().filter(|finding| wrong(*finding)).count(),
        swapped: is_swapped(key, findings, &matched),
        rmse_ratio: report
            .and_then(|r| ratio(r.corrected.held_out_rmse_w.or(r.baseline.held_out_rmse_w)?, twin_w?)),
        noise_ratio: report.and_then(|r| ratio(r.baseline.noise_floor_w?, twin_noise_w?)),
        discovered: discovered(findings, twin_w),
        twin,
        peers: Vec::new(),
    }
}

/// Place of the true set among those that a report gives, from 1.
fn rank(report: &Report, truths: &[String]) -> Option<usize> {
    let mut truth: Vec<&str> = truths.iter().map(String::as_str).collect();
    truth.sort_unstable();
    report.sets().iter().position(|set| *set == truth).map(|place| place + 1)
}

fn truth_score(truth: &Truth, z: f64, detected: bool, finding: Option<&Finding>) -> TruthScore {
    let answer = finding.map_or(Answer::None, |finding| matching::answer(finding, &truth.effect.name()));
    let named = finding.filter(|finding| finding.mechanism == truth.effect.name());
    TruthScore {
        effect: truth.effect,
        family: truth.family,
        z,
        power_change: truth.power_change,
        onset_s: truth.onset_s,
        detected,
        named_first: named.is_some(),
        in_two: answer >= Answer::OneOfTwo,
        set_size: finding.map(|finding| finding.set().len()),
        too_small: None,
        parameters: named.map_or_else(Vec::new, |finding| parameters(truth, finding)),
    }
}

/// Whether an effect's number is less than that from which it would have been noticed, if that is told.
fn is_too_small(truth: &Truth, least: &[Least]) -> Option<bool> {
    let least = least.iter().find(|one| one.mechanism == truth.effect.name())?;
    let own = truth.parameters.iter().find(|own| own.name == least.parameter)?;
    Some(own.value.abs() < least.value)
}

/// The numbers that key and finding have by the same name in the same unit.
fn parameters(truth: &Truth, finding: &Finding) -> Vec<ParameterScore> {
    let pair = |p: &Parameter| {
        let same = |e: &&Estimate| e.name == p.name && e.unit == p.unit;
        let estimate = finding.parameters.iter().find(same)?;
        let alike = truth.parameters.iter().filter(|other| other.unit == p.unit);
        let size = alike.map(|other| other.value.abs()).fold(0.0, f64::max);
        let value = estimate.value?;
        Some(ParameterScore {
            name: p.name.clone(),
            unit: p.unit.clone(),
            truth: p.value,
            estimate: value,
            relative_error: ratio((value - p.value).abs(), size),
            covered: estimate.interval_95.map(|[low, high]| low <= p.value && p.value <= high),
        })
    };
    truth.parameters.iter().filter_map(pair).collect()
}

/// Whether a finding that answers to no truth is of the family that no truth is of.
fn is_swapped(key: &SealedKey, findings: &[Finding], matched: &[Option<usize>]) -> bool {
    let Some(family) = key.truths.first().map(|truth| truth.family) else { return false };
    if family == Family::Unlisted || key.truths.iter().any(|truth| truth.family != family) {
        return false;
    }
    let other = |finding: &Finding| family_of(&finding.mechanism).is_some_and(|f| f != family);
    findings.iter().enumerate().any(|(j, finding)| !matched.contains(&Some(j)) && other(finding))
}

fn family_of(name: &str) -> Option<Family> {
    EffectName::all().find(|effect| effect.name() == name).map(EffectName::family)
}

/// Share of the held-out mismatch that `unknown` findings take, the noise of the twin drive set aside; all of it where they take as much
/// or more, as where the effect is hardly more than noise.
fn discovered(findings: &[Finding], twin_w: Option<f64>) -> Option<f64> {
    // Each is fitted beside those before it: from the first one's error to the last one's.
    let mut unknown =
        findings.iter().filter(|finding| finding.mechanism == UNKNOWN).map(|finding| finding.fit);
    let first = unknown.next()?;
    let last = unknown.next_back().unwrap_or(first);
    let (before_w, after_w) = (first.held_out_rmse_before_w?, last.held_out_rmse_after_w?);
    let floor_w2 = twin_w?.min(before_w).powi(2);
    ratio(before_w.powi(2) - after_w.powi(2), before_w.powi(2) - floor_w2).map(|share| share.min(1.0))
}

/// What JSON has no number for is none.
fn number_or_none<'a, D: Deserializer<'a>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
}

fn ratio(a: f64, b: f64) -> Option<f64> {
    (b > 0.0 && (a / b).is_finite()).then(|| a / b)
}
