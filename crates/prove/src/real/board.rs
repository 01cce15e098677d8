//! The scoreboard of real drives: all cases together, way by way.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::{
    Rate, Way,
    real::{Change, RealKind, RealScore},
};

/// The result of a trial on real drives, way by way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RealBoards {
    /// Cases.
    pub cases: usize,
    /// Seed that they were dealt from.
    pub seed: u64,
    /// SHA-256 of the list of the keys' hashes, published before the first diagnosis.
    pub commitment: String,
    /// All ways that were gone, in the order of [`Way::ALL`].
    pub ways: Vec<RealWayBoard>,
    /// Other methods on the same files, healthy drives included.
    pub peers: Vec<RealPeerRow>,
}

/// The result of one way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RealWayBoard {
    /// Which.
    pub way: Way,
    /// How it came out.
    pub board: RealBoard,
}

/// How a way came out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RealBoard {
    /// Diagnoses that failed; they count as finding nothing, and as alarms of healthy splits.
    pub errors: Rate,
    /// Healthy splits in which something was found, or whose diagnosis failed.
    pub false_alarms: Rate,
    /// Healthy splits to which a name was given, or whose diagnosis failed.
    pub false_names: Rate,
    /// Changes of z = 16 and more that were named or are in a set of three at most.
    pub strong_in_three: Rate,
    /// The same that were given other names.
    pub strong_wrong: Rate,
    /// By change and strength.
    pub changes: Vec<ChangeRow>,
    /// By when they begin.
    pub onsets: Vec<OnsetRow>,
    /// By ground.
    pub grounds: Vec<GroundRow>,
    /// Splices under a right name.
    pub splices_named: Rate,
    /// Splices with a right name beside a time near the border.
    pub splices_placed: Rate,
    /// Every case.
    pub scores: Vec<RealScore>,
}

/// What was said of some changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Answers {
    /// Right in the first two sets.
    pub named: usize,
    /// Right, further behind, in a set of three at most.
    pub in_three: usize,
    /// Other names.
    pub wrong: usize,
    /// No name, failures included.
    pub none: usize,
}

/// One kind of change at one strength; of all kinds together where it has none.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChangeRow {
    /// What was put in.
    pub change: Option<Change>,
    /// Strength asked for.
    pub asked_z: f64,
    /// Median strength as it came out.
    pub z_median: Option<f64>,
    /// Median change of power.
    pub power_change_median: Option<f64>,
    /// What was said.
    pub answers: Answers,
}

/// Changes that begin alike.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OnsetRow {
    /// Whether they act from some time on, rather than from the start.
    pub late: bool,
    /// What was said.
    pub answers: Answers,
}

/// One ground.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroundRow {
    /// Its name.
    pub ground: String,
    /// Healthy splits in which something was found.
    pub false_alarms: Rate,
    /// What was said of changes on it.
    pub answers: Answers,
}

/// Another method on the same files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RealPeerRow {
    /// Its name.
    pub peer: String,
    /// Healthy splits in which it found something, or on which it failed.
    pub false_alarms: Rate,
    /// Changes of z = 16 and more that its first name is right of.
    pub named: Rate,
    /// The same that it gave another first name.
    pub wrong: Rate,
    /// Splices that its first name is right of.
    pub splices_named: Rate,
    /// Cases on which it failed.
    pub errors: usize,
}

/// Strength from which on the goals hold; asked for to some per cent.
const STRONG_Z: f64 = 16.0;
const NEAR: f64 = 0.97;

impl Answers {
    fn of<'s>(scores: impl IntoIterator<Item = &'s RealScore>) -> Self {
        let mut answers = Answers::default();
        for score in scores {
            let place = match () {
                () if score.is_named() => &mut answers.named,
                () if score.is_in_three() => &mut answers.in_three,
                () if score.is_wrong() => &mut answers.wrong,
                () => &mut answers.none,
            };
            *place += 1;
        }
        answers
    }

    /// How many there are.
    pub fn all(&self) -> usize {
        self.named + self.in_three + self.wrong + self.none
    }
}

impl RealScore {
    /// Whether it is a change at or beyond the strength from which on the goals hold.
    pub fn is_strong(&self) -> bool {
        self.kind == RealKind::Changed && self.z.is_some_and(|z| z >= NEAR * STRONG_Z)
    }
}

/// Adds up the cases of one way; their order and names change nothing but the list of them.
pub fn board(scores: Vec<RealScore>) -> RealBoard {
    let of = |kind: RealKind| scores.iter().filter(move |score| score.kind == kind);
    let strong = || scores.iter().filter(|score| score.is_strong());
    let right = |score: &RealScore| score.is_named() || score.is_in_three();
    let onset = |late: bool| OnsetRow {
        late,
        answers: Answers::of(of(RealKind::Changed).filter(|score| score.late == late)),
    };
    RealBoard {
        errors: Rate::of(scores.iter().map(|score| score.error.is_some())),
        false_alarms: Rate::of(of(RealKind::Healthy).map(|score| !score.is_quiet())),
        false_names: Rate::of(of(RealKind::Healthy).map(|score| score.gave_a_name || score.error.is_some())),
        strong_in_three: Rate::of(strong().map(right)),
        strong_wrong: Rate::of(strong().map(RealScore::is_wrong)),
        changes: changes(&scores),
        onsets: [false, true].map(onset).into(),
        grounds: grounds(&scores),
        splices_named: Rate::of(of(RealKind::Spliced).map(right)),
        splices_placed: Rate::of(
            of(RealKind::Spliced).map(|score| right(score) && score.placed == Some(true)),
        ),
        scores,
    }
}

/// A row for each change and strength, then one for each strength.
fn changes(scores: &[RealScore]) -> Vec<ChangeRow> {
    // Positive doubles sort as their bits do.
    let mut rows: BTreeMap<(bool, Option<Change>, u64), Vec<&RealScore>> = BTreeMap::new();
    for score in scores {
        let (Some(change), Some(z)) = (score.change, score.asked_z) else { continue };
        for change in [Some(change), None] {
            rows.entry((change.is_none(), change, z.to_bits())).or_default().push(score);
        }
    }
    let row = |((_, change, z), scores): ((bool, Option<Change>, u64), Vec<&RealScore>)| ChangeRow {
        change,
        asked_z: f64::from_bits(z),
        z_median: crate::rate::median(scores.iter().filter_map(|score| score.z)),
        power_change_median: crate::rate::median(scores.iter().filter_map(|score| score.power_change)),
        answers: Answers::of(scores),
    };
    rows.into_iter().map(row).collect()
}

fn grounds(scores: &[RealScore]) -> Vec<GroundRow> {
    let mut names: Vec<&str> = scores.iter().map(|score| score.ground.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let row = |name: &str| {
        let of =
            |kind: RealKind| scores.iter().filter(move |score| score.ground == name && score.kind == kind);
        GroundRow {
            ground: name.to_owned(),
            false_alarms: Rate::of(of(RealKind::Healthy).map(|score| !score.is_quiet())),
            answers: Answers::of(of(RealKind::Changed)),
        }
    };
    names.into_iter().map(row).collect()
}

/// The table of other methods, in the order of their names.
pub(crate) fn peers(scores: &[RealScore]) -> Vec<RealPeerRow> {
    let mut names: Vec<&str> =
        scores.iter().flat_map(|score| &score.peers).map(|peer| peer.peer.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    names.into_iter().map(|name| peer_row(name, scores)).collect()
}

fn peer_row(name: &str, scores: &[RealScore]) -> RealPeerRow {
    let of = |wanted: fn(&RealScore) -> bool| {
        let scores = scores.iter().filter(move |score| wanted(score));
        scores.flat_map(|score| &score.peers).filter(|peer| peer.peer == name)
    };
    RealPeerRow {
        peer: name.to_owned(),
        false_alarms: Rate::of(
            of(|score| score.kind == RealKind::Healthy)
                .map(|peer| peer.error.is_some() || !peer.names.is_empty()),
        ),
        named: Rate::of(of(RealScore::is_strong).map(|peer| peer.named)),
        wrong: Rate::of(of(RealScore::is_strong).map(|peer| !peer.named && !peer.names.is_empty())),
        splices_named: Rate::of(of(|score| score.kind == RealKind::Spliced).map(|peer| peer.named)),
        errors: of(|_| true).filter(|peer| peer.error.is_some()).count(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::{
        Border,
        score::{
            score,
            tests::{key, said},
        },
    };

    #[test]
    fn changes_add_up_by_strength_and_onset_and_splices_need_a_name_and_a_place() {
        let right = said(r#"{"mechanism": "payload"}"#, "");
        let wrong = said(r#"{"mechanism": "wind"}"#, "");
        let border = Border { run: "drive-2".into(), t_s: 80.0, onto: "ice".into() };
        let placed = said(
            r#"{"mechanism": "surface_change", "scope": {"from_s": 84.0, "until_s": null, "run": "drive-2"}}"#,
            "",
        );
        let scores = vec![
            score(&key(Some(Change::Payload), None), &right),
            score(&key(Some(Change::Payload), None), &wrong),
            score(&key(None, Some(border.clone())), &placed),
            score(&key(None, Some(border)), &said(r#"{"mechanism": "surface_change"}"#, "")),
            score(&key(None, None), &wrong),
        ];
        let board = board(scores);
        assert_eq!((board.false_alarms.hits, board.false_alarms.of), (1, 1));
        assert_eq!(
            (board.strong_in_three.hits, board.strong_in_three.of, board.strong_wrong.hits),
            (1, 2, 1)
        );
        assert_eq!((board.splices_named.hits, board.splices_placed.hits, board.splices_placed.of), (2, 1, 2));
        assert_eq!(board.changes.len(), 2, "payload at z 16, and all at z 16");
        assert_eq!(board.changes[1].answers, Answers { named: 1, in_three: 0, wrong: 1, none: 0 });
        assert_eq!([board.onsets[0].answers.all(), board.onsets[1].answers.all()], [2, 0]);
    }
}
