//! The scoreboard: all cases together.

use serde::Serialize;
use world::Family;

use crate::{
    CaseScore, Kind, MechanismRow, OnsetRow, PeerRow, Rate, ShareRow, StrengthRow, Verdict, Way,
    figures::{by_mechanism, by_onset, by_peer, by_share, by_strength, listed, mean},
    rate::median,
};

/// The result of a trial, way by way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Boards {
    /// With the most to go by.
    #[serde(flatten)]
    pub most: Scoreboard,
    /// All ways that were gone, in the order of [`Way::ALL`].
    pub ways: Vec<WayBoard>,
}

/// The result of a trial one way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WayBoard {
    /// Which.
    pub way: Way,
    /// How it came out.
    pub board: Scoreboard,
}

/// The result of a trial.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scoreboard {
    /// Cases.
    pub cases: usize,
    /// Seed that they were dealt from.
    pub seed: u64,
    /// SHA-256 of the list of the keys' hashes, published before the first diagnosis.
    pub commitment: String,
    /// Diagnoses that failed; they count as finding nothing.
    pub errors: Rate,
    /// Healthy drives in which something was found, or whose diagnosis failed.
    pub false_alarms_healthy: Rate,
    /// Decoys, in the same way.
    pub false_alarms_decoy: Rate,
    /// Drives of the cases with effects, driven again without, in the same way.
    pub false_alarms_twin: Rate,
    /// Healthy drives of all kinds to which a name was given, or whose diagnosis failed.
    pub false_names: Rate,
    /// Cases of listed effects whose true set is the first or second that was given.
    pub set_named: Rate,
    /// The same among three sets at most.
    pub set_in_three: Rate,
    /// The same that gave names, and the true set is not among three.
    pub set_wrong: Rate,
    /// The same that gave no name.
    pub set_none: Rate,
    /// Effects of the list, of all that acted, in whose drives something was found.
    pub detected: Rate,
    /// The same that were named before all others.
    pub named_first: Rate,
    /// The same that were in a set of two at most.
    pub in_two: Rate,
    /// The same that were not, and are less than the report says would have been noticed.
    pub missed_too_small: Rate,
    /// Cases with effects in which the diagnosis said `consistent`; they count against everything above.
    pub abstained: Rate,
    /// Names that were right, of all that were given; effects that have none included.
    pub naming_precision: Rate,
    /// Mean number of names where the truth was among them.
    pub mean_set_size: Option<f64>,
    /// Cases of two effects in which both were in sets of two at most.
    pub both_of_two: Rate,
    /// Sensor faults that were called physics.
    pub sensor_called_physics: Rate,
    /// Physics that was called a sensor fault.
    pub physics_called_sensor: Rate,
    /// Effects without a name to which none was given by a diagnosis that did not fail.
    pub unlisted_not_misnamed: Rate,
    /// The same of those that change power by 3 % and more.
    pub unlisted_strong_not_misnamed: Rate,
    /// Effects without a name that were found.
    pub unlisted_detected: Rate,
    /// Median share of the held-out mismatch that discovered terms explain.
    pub unlisted_explained_median: Option<f64>,
    /// The same where there are such terms.
    pub unlisted_terms_explain_median: Option<f64>,
    /// Median relative error of numbers.
    pub parameter_error_median: Option<f64>,
    /// Intervals that hold the truth.
    pub interval_coverage: Rate,
    /// Median of the held-out error after correction over that of the drive without effects, where effects of the list acted.
    pub rmse_ratio_listed_median: Option<f64>,
    /// Median of the noise floor over that of the drive without effects, in the same cases.
    pub noise_ratio_listed_median: Option<f64>,
    /// The errors' where effects without a name acted, of which terms take a part only.
    pub rmse_ratio_unlisted_median: Option<f64>,
    /// By mechanism and strength.
    pub mechanisms: Vec<MechanismRow>,
    /// By strength.
    pub strengths: Vec<StrengthRow>,
    /// By change of power.
    pub shares: Vec<ShareRow>,
    /// By when they begin.
    pub onsets: Vec<OnsetRow>,
    /// Other methods on the same files.
    pub peers: Vec<PeerRow>,
    /// Every case.
    pub scores: Vec<CaseScore>,
}

/// Share of power from which on an effect without a name counts as strong.
const STRONG: f64 = 0.03;

/// Adds up the cases; their order and names change nothing but the list of them.
pub fn scoreboard(seed: u64, commitment: String, scores: Vec<CaseScore>) -> Scoreboard {
    let of = |kind: Kind| scores.iter().filter(move |case| case.kind == kind);
    let concealing = || scores.iter().filter(|case| case.kind.conceals());
    let concealing_listed = || concealing().filter(|case| case.kind != Kind::Unlisted);
    let numbers = || listed(&scores).flat_map(|truth| &truth.parameters);
    let sizes: Vec<f64> = listed(&scores).filter_map(|t| t.set_size).map(|size| size as f64).collect();
    let (right, wrong) = names_given(&scores);
    Scoreboard {
        cases: scores.len(),
        seed,
        commitment,
        errors: Rate::of(scores.iter().map(|case| case.error.is_some())),
        false_alarms_healthy: Rate::of(of(Kind::Healthy).map(|case| !case.is_quiet())),
        false_alarms_decoy: Rate::of(of(Kind::Decoy).map(|case| !case.is_quiet())),
        false_alarms_twin: Rate::of(
            scores.iter().filter_map(|case| case.twin.as_ref()).map(|twin| !twin.is_quiet()),
        ),
        false_names: Rate::of(false_names(&scores)),
        set_named: Rate::of(concealing_listed().map(|case| case.rank.is_some_and(|rank| rank <= 2))),
        set_in_three: Rate::of(concealing_listed().map(is_in_three)),
        set_wrong: Rate::of(
            concealing_listed()
                .map(|case| case.gave_a_name && case.rank.is_none_or(|rank| rank > 2) && !is_in_three(case)),
        ),
        set_none: Rate::of(concealing_listed().map(|case| !case.gave_a_name)),
        detected: Rate::of(listed(&scores).map(|truth| truth.detected)),
        named_first: Rate::of(listed(&scores).map(|truth| truth.named_first)),
        in_two: Rate::of(listed(&scores).map(|truth| truth.in_two)),
        missed_too_small: Rate::of(
            listed(&scores).filter(|truth| !truth.in_two).map(|truth| truth.too_small == Some(true)),
        ),
        abstained: Rate::of(concealing().map(|case| case.verdict == Some(Verdict::Consistent))),
        naming_precision: Rate::new(right, right + wrong),
        mean_set_size: mean(&sizes),
        both_of_two: Rate::of(of(Kind::Two).map(|case| case.truths.iter().all(|truth| truth.in_two))),
        sensor_called_physics: swaps(&scores, Family::Measurement),
        physics_called_sensor: swaps(&scores, Family::Physics),
        unlisted_not_misnamed: Rate::of(of(Kind::Unlisted).map(CaseScore::misnames_nothing)),
        unlisted_strong_not_misnamed: Rate::of(
            of(Kind::Unlisted).filter(|case| case.share >= STRONG).map(CaseScore::misnames_nothing),
        ),
        unlisted_detected: Rate::of(of(Kind::Unlisted).map(|case| case.alarmed)),
        unlisted_explained_median: median(of(Kind::Unlisted).map(|case| case.discovered.unwrap_or(0.0))),
        unlisted_terms_explain_median: median(of(Kind::Unlisted).filter_map(|case| case.discovered)),
        parameter_error_median: median(numbers().filter_map(|number| number.relative_error)),
        interval_coverage: Rate::of(numbers().filter_map(|number| number.covered)),
        rmse_ratio_listed_median: median(concealing_listed().filter_map(|case| case.rmse_ratio)),
        noise_ratio_listed_median: median(concealing_listed().filter_map(|case| case.noise_ratio)),
        rmse_ratio_unlisted_median: median(of(Kind::Unlisted).filter_map(|case| case.rmse_ratio)),
        mechanisms: by_mechanism(&scores),
        strengths: by_strength(&scores),
        shares: by_share(&scores),
        onsets: by_onset(&scores),
        peers: by_peer(&scores),
        scores,
    }
}

/// Whether the true set is among three at most.
fn is_in_three(case: &CaseScore) -> bool {
    case.sets <= 3 && case.rank.is_some()
}

/// Whether healthy drives were given a name, drive by drive, those of cases without their effects included.
fn false_names(scores: &[CaseScore]) -> impl Iterator<Item = bool> + '_ {
    let healthy = scores.iter().filter(|case| !case.kind.conceals());
    let of_healthy = healthy.map(|case| case.gave_a_name || case.error.is_some());
    let twins = scores.iter().filter_map(|case| case.twin.as_ref());
    of_healthy.chain(twins.map(|twin| twin.gave_a_name || twin.error.is_some()))
}

/// Names that were right, and names that were wrong.
fn names_given(scores: &[CaseScore]) -> (usize, usize) {
    let right = listed(scores).filter(|truth| truth.named_first).count();
    // A set that holds the truth behind another name gave a wrong name all the same.
    let behind = listed(scores).filter(|truth| truth.set_size.is_some() && !truth.named_first).count();
    (right, behind + scores.iter().map(|case| case.wrong_names).sum::<usize>())
}

/// Diagnosed cases all of whose truths are of a family, and in which a name of the other was given.
fn swaps(scores: &[CaseScore], family: Family) -> Rate {
    let all = |case: &&CaseScore| {
        case.error.is_none()
            && !case.truths.is_empty()
            && case.truths.iter().all(|truth| truth.family == family)
    };
    Rate::of(scores.iter().filter(all).map(|case| case.swapped))
}
