//! One case of real drives scored: what was said against what was done.

use serde::{Deserialize, Serialize};

use crate::{
    Finding, Outcome, Report, Verdict,
    real::{Change, Onset, RealKey, RealKind, RealPeerScore},
};

/// How the diagnosis did on one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RealScore {
    /// The case.
    pub case: String,
    /// What kind it is.
    pub kind: RealKind,
    /// The ground of both halves.
    pub ground: String,
    /// The ground that a run goes on over.
    pub onto: Option<String>,
    /// What was put in.
    pub change: Option<Change>,
    /// Whether that acts from some time on, rather than from the start.
    pub late: bool,
    /// Strength asked for.
    pub asked_z: Option<f64>,
    /// Strength as it came out.
    pub z: Option<f64>,
    /// Root mean square change of power over its mean.
    pub power_change: Option<f64>,
    /// Its size with its sign.
    pub size: Option<f64>,
    /// What the diagnosis said, in one word.
    pub verdict: Option<Verdict>,
    /// Why it said nothing.
    pub error: Option<String>,
    /// Sets of names that it gave, likeliest first.
    pub said: Vec<Vec<String>>,
    /// Whether it said that something is wrong.
    pub alarmed: bool,
    /// Whether it gave a name.
    pub gave_a_name: bool,
    /// Place of the first right set among those that it gave, from 1.
    pub rank: Option<usize>,
    /// Of splices: whether a right name stands beside a time within [`PLACED_S`] of the border.
    pub placed: Option<bool>,
    /// How others did.
    pub peers: Vec<RealPeerScore>,
}

/// Greatest distance from a border at which it counts as found [s].
pub const PLACED_S: f64 = 10.0;
/// A set that is the first or the second of those given is named: the rule of the concealed trial.
const NAMED_RANK: usize = 2;
/// Sets that an answer has at most.
const MOST_SETS: usize = 3;

impl RealScore {
    /// Whether the diagnosis ran to its end and found nothing.
    pub fn is_quiet(&self) -> bool {
        self.error.is_none() && !self.alarmed
    }

    /// Whether a right set is the first or second that was given.
    pub fn is_named(&self) -> bool {
        self.rank.is_some_and(|rank| rank <= NAMED_RANK)
    }

    /// Whether a right set is among three at most.
    pub fn is_in_three(&self) -> bool {
        self.rank.is_some() && self.said.len() <= MOST_SETS
    }

    /// Whether names were given, and the right one is neither named nor among three.
    pub fn is_wrong(&self) -> bool {
        self.gave_a_name && !self.is_named() && !self.is_in_three()
    }
}

/// Scores a case. A diagnosis that failed found nothing, and is told apart from one that kept quiet.
pub fn score(key: &RealKey, outcome: &Outcome) -> RealScore {
    let (report, error) = match outcome {
        Outcome::Report(report) => (Some(report), None),
        Outcome::Failed(why) => (None, Some(why.clone())),
    };
    let accepted = key.accepted();
    let sets = report.map(Report::sets).unwrap_or_default();
    let is_right = |set: &Vec<&str>| !set.is_empty() && set.iter().all(|name| accepted.contains(name));
    let rank = sets.iter().position(is_right).map(|place| place + 1);
    let put = key.put.as_ref();
    RealScore {
        case: key.case.clone(),
        kind: key.kind,
        ground: key.ground.clone(),
        onto: key.border.as_ref().map(|border| border.onto.clone()),
        change: put.map(|put| put.act.change),
        late: put.is_some_and(|put| put.act.onset != Onset::START),
        asked_z: put.map(|put| put.asked_z),
        z: put.map(|put| put.z),
        power_change: put.map(|put| put.power_change),
        size: put.map(|put| put.act.signed()),
        verdict: report.map(|report| report.verdict),
        error,
        said: sets.iter().map(|set| set.iter().map(|name| (*name).to_owned()).collect()).collect(),
        alarmed: report.is_some_and(Report::alarms),
        gave_a_name: report.is_some_and(Report::names),
        rank,
        placed: key.border.is_some().then(|| report.is_some_and(|report| is_placed(key, &report.findings))),
        peers: Vec::new(),
    }
}

/// Whether a finding with a right name begins or ends at the border.
fn is_placed(key: &RealKey, findings: &[Finding]) -> bool {
    let (Some(border), accepted) = (&key.border, key.accepted()) else { return false };
    let is_near = |finding: &Finding| {
        let Some(scope) = &finding.scope else { return false };
        // A time after the beginning of each drive is that of the border where there is one drive.
        let is_there = match &scope.run {
            Some(run) => *run == border.run,
            None => key.suspect.len() == 1,
        };
        let times_s = [scope.from_s, scope.until_s].into_iter().flatten();
        is_there && times_s.into_iter().any(|t_s| (t_s - border.t_s).abs() <= PLACED_S)
    };
    findings.iter().any(|finding| accepted.contains(&finding.mechanism.as_str()) && is_near(finding))
}

#[cfg(test)]
pub(crate) mod tests {
    use world::Side;

    use super::*;
    use crate::real::{Act, Border, Direction, Put};

    pub(crate) fn key(change: Option<Change>, border: Option<Border>) -> RealKey {
        let act = |change| Act {
            change,
            size: 2.0,
            direction: Direction::Up,
            side: Side::Left,
            onset: Onset::START,
        };
        let kind = match (change, &border) {
            (Some(_), _) => RealKind::Changed,
            (None, Some(_)) => RealKind::Spliced,
            (None, None) => RealKind::Healthy,
        };
        RealKey {
            case: "case-0001".into(),
            kind,
            seed: 1,
            ground: "flooring".into(),
            healthy: vec!["a".into(), "b".into()],
            suspect: vec!["c".into(), "d".into()],
            put: change.map(|change| Put { act: act(change), asked_z: 16.0, z: 16.0, power_change: 0.05 }),
            border,
            files: Default::default(),
        }
    }

    pub(crate) fn said(findings: &str, explanations: &str) -> Outcome {
        let text = format!(
            r#"{{"verdict": "explained", "baseline": {{}}, "findings": [{findings}], "explanations": [{explanations}]}}"#
        );
        Outcome::Report(serde_json::from_str(&text).unwrap())
    }

    fn explanations(sets: &[&str]) -> String {
        let one = |names: &&str| {
            let names: Vec<String> = names.split('+').map(|name| format!("\"{name}\"")).collect();
            format!(r#"{{"mechanisms": [{}]}}"#, names.join(", "))
        };
        sets.iter().map(one).collect::<Vec<_>>().join(", ")
    }

    #[test]
    fn the_right_name_alone_counts_first_second_or_among_three() {
        let payload = r#"{"mechanism": "payload"}"#;
        let of =
            |sets: &[&str]| score(&key(Some(Change::Payload), None), &said(payload, &explanations(sets)));
        assert!(of(&["wind", "payload", "inertia", "hotel_load"]).is_named());
        let third = of(&["wind", "inertia", "payload"]);
        assert!(!third.is_named() && third.is_in_three() && !third.is_wrong());
        assert!(of(&["wind", "inertia", "hotel_load", "payload"]).is_wrong());
        assert!(of(&["payload+wind", "inertia", "wind"]).is_wrong(), "beside another name it is no answer");
    }

    #[test]
    fn silence_is_neither_named_nor_wrong_and_a_failure_is_not_quiet() {
        let quiet = Outcome::Report(
            serde_json::from_str(r#"{"verdict": "consistent", "baseline": {}, "findings": []}"#).unwrap(),
        );
        let silent = score(&key(Some(Change::Gain), None), &quiet);
        assert!(!silent.is_named() && !silent.is_wrong() && silent.is_quiet());
        let failed = score(&key(None, None), &Outcome::Failed("gone".into()));
        assert!(!failed.is_quiet() && !failed.alarmed);
    }

    #[test]
    fn a_border_is_found_within_ten_seconds_in_its_own_drive_under_a_right_name() {
        let border = |onto: &str| Border { run: "drive-2".into(), t_s: 80.0, onto: onto.into() };
        let found =
            |onto: &str, finding: &str| score(&key(None, Some(border(onto))), &said(finding, "")).placed;
        let at = |name: &str, run: &str, t_s: f64| {
            format!(
                r#"{{"mechanism": "{name}", "scope": {{"from_s": {t_s}, "until_s": null, "run": "{run}"}}}}"#
            )
        };
        assert_eq!(found("ice", &at("surface_change", "drive-2", 89.0)), Some(true));
        assert_eq!(found("ice", &at("surface_change", "drive-2", 91.0)), Some(false));
        assert_eq!(found("ice", &at("surface_change", "drive-1", 80.0)), Some(false));
        assert_eq!(found("ice", &at("soft_soil", "drive-2", 80.0)), Some(false));
        assert_eq!(found("snow", &at("soft_soil", "drive-2", 80.0)), Some(true));
        assert_eq!(found("sandy_loam", &at("wheel_slip", "drive-2", 80.0)), Some(false));
        assert_eq!(found("ice", r#"{"mechanism": "surface_change"}"#), Some(false));
    }
}
