//! Figures of some of the cases: by mechanism and strength, by strength alone, and of other methods.

use std::collections::BTreeMap;

use serde::Serialize;
use world::{EffectName, Family};

use crate::{CaseScore, Kind, Rate, TruthScore, rate::median};

/// One mechanism, alone in its cases.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MechanismRow {
    /// Its name.
    pub mechanism: EffectName,
    /// Its family.
    pub family: Family,
    /// By strength asked for, weakest first.
    pub strengths: Vec<Cell>,
}

/// Some effects that belong together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// The strength asked for, as a share of power.
    pub share: f64,
    /// Median strength for a detector that knows the effect.
    pub z_median: Option<f64>,
    /// Something was found.
    pub detected: Rate,
    /// The truth came first.
    pub named_first: Rate,
    /// The truth was in a set of two at most.
    pub in_two: Rate,
    /// Mean number of names where the truth was among them.
    pub mean_set_size: Option<f64>,
    /// Median error of its numbers.
    pub parameter_error_median: Option<f64>,
    /// Intervals that hold the truth.
    pub interval_coverage: Rate,
}

/// All listed effects within bounds of strength, alone or in pairs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StrengthRow {
    /// From this z on, up to the next row's.
    pub from_z: f64,
    /// Something was found.
    pub detected: Rate,
    /// The truth was in a set of two at most.
    pub in_two: Rate,
}

/// All listed effects of about the same change of power, alone or in pairs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ShareRow {
    /// From this change of power over its mean on, up to the next row's.
    pub from_share: f64,
    /// Something was found.
    pub detected: Rate,
    /// The truth was in a set of two at most.
    pub in_two: Rate,
}

/// All listed effects that begin alike, alone or in pairs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OnsetRow {
    /// Whether they act from some time on, rather than from the start.
    pub late: bool,
    /// Something was found.
    pub detected: Rate,
    /// The truth was in a set of two at most.
    pub in_two: Rate,
}

/// Another method on the same files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PeerRow {
    /// Its name.
    pub peer: String,
    /// Healthy drives and decoys in which it found something, or on which it failed.
    pub false_alarms: Rate,
    /// Truths among as many of its first names.
    pub named: Rate,
    /// Effects without a name to which it gave one, or on which it failed.
    pub misnamed: Rate,
    /// Cases on which it failed.
    pub errors: usize,
}

/// Lower bounds of z; 32 is where the goals are set.
const FROM_Z: [f64; 5] = [0.0, 16.0, 32.0, 64.0, 128.0];

/// Lower bounds of the change of power; from 5 % on effects are strong.
const FROM_SHARE: [f64; 5] = [0.0, 0.02, 0.05, 0.10, 0.20];

/// The table of mechanisms, in the order of their names.
pub(crate) fn by_mechanism(cases: &[CaseScore]) -> Vec<MechanismRow> {
    let alone = |case: &&CaseScore| matches!(case.kind, Kind::One | Kind::Unlisted);
    let mut rows: BTreeMap<EffectName, BTreeMap<u64, Vec<&TruthScore>>> = BTreeMap::new();
    for case in cases.iter().filter(alone) {
        for truth in &case.truths {
            // Positive doubles sort as their bits do.
            rows.entry(truth.effect).or_default().entry(case.share.to_bits()).or_default().push(truth);
        }
    }
    let row = |(mechanism, cells): (EffectName, BTreeMap<u64, Vec<&TruthScore>>)| MechanismRow {
        mechanism,
        family: mechanism.family(),
        strengths: cells.into_iter().map(|(bits, truths)| cell(f64::from_bits(bits), &truths)).collect(),
    };
    rows.into_iter().map(row).collect()
}

fn cell(share: f64, truths: &[&TruthScore]) -> Cell {
    let sizes: Vec<f64> = truths.iter().filter_map(|t| t.set_size).map(|size| size as f64).collect();
    let numbers = || truths.iter().flat_map(|t| &t.parameters);
    Cell {
        share,
        z_median: median(truths.iter().map(|t| t.z)),
        detected: Rate::of(truths.iter().map(|t| t.detected)),
        named_first: Rate::of(truths.iter().map(|t| t.named_first)),
        in_two: Rate::of(truths.iter().map(|t| t.in_two)),
        mean_set_size: mean(&sizes),
        parameter_error_median: median(numbers().filter_map(|p| p.relative_error)),
        interval_coverage: Rate::of(numbers().filter_map(|p| p.covered)),
    }
}

/// The table of strengths.
pub(crate) fn by_strength(cases: &[CaseScore]) -> Vec<StrengthRow> {
    let ends = FROM_Z.iter().skip(1).copied().chain([f64::INFINITY]);
    let row = |(&from_z, to_z): (&f64, f64)| {
        let within: Vec<&TruthScore> = listed(cases).filter(|t| t.z >= from_z && t.z < to_z).collect();
        StrengthRow {
            from_z,
            detected: Rate::of(within.iter().map(|t| t.detected)),
            in_two: Rate::of(within.iter().map(|t| t.in_two)),
        }
    };
    FROM_Z.iter().zip(ends).map(row).collect()
}

/// The table of changes of power.
pub(crate) fn by_share(cases: &[CaseScore]) -> Vec<ShareRow> {
    let ends = FROM_SHARE.iter().skip(1).copied().chain([f64::INFINITY]);
    let row = |(&from_share, to): (&f64, f64)| {
        let within = || listed(cases).filter(move |t| (from_share..to).contains(&t.power_change));
        ShareRow {
            from_share,
            detected: Rate::of(within().map(|t| t.detected)),
            in_two: Rate::of(within().map(|t| t.in_two)),
        }
    };
    FROM_SHARE.iter().zip(ends).map(row).collect()
}

/// The table of onsets.
pub(crate) fn by_onset(cases: &[CaseScore]) -> Vec<OnsetRow> {
    let row = |late: bool| {
        let alike = || listed(cases).filter(move |t| (t.onset_s > 0.0) == late);
        OnsetRow {
            late,
            detected: Rate::of(alike().map(|t| t.detected)),
            in_two: Rate::of(alike().map(|t| t.in_two)),
        }
    };
    [false, true].map(row).into()
}

/// The table of other methods, in the order of their names.
pub(crate) fn by_peer(cases: &[CaseScore]) -> Vec<PeerRow> {
    let mut names: Vec<&str> = cases.iter().flat_map(|c| &c.peers).map(|p| p.peer.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    names.into_iter().map(|name| peer_row(name, cases)).collect()
}

fn peer_row(name: &str, cases: &[CaseScore]) -> PeerRow {
    let of = |wanted: fn(Kind) -> bool| {
        let cases = cases.iter().filter(move |case| wanted(case.kind));
        cases.flat_map(|case| &case.peers).filter(|peer| peer.peer == name)
    };
    PeerRow {
        peer: name.to_owned(),
        false_alarms: Rate::of(of(|kind| !kind.conceals()).map(|p| p.error.is_some() || !p.names.is_empty())),
        named: Rate::new(of(|_| true).map(|p| p.named).sum(), of(|_| true).map(|p| p.truths).sum()),
        misnamed: Rate::of(
            of(|kind| kind == Kind::Unlisted).map(|p| p.error.is_some() || !p.names.is_empty()),
        ),
        errors: of(|_| true).filter(|p| p.error.is_some()).count(),
    }
}

/// Effects of the list, alone or in pairs.
pub(crate) fn listed(cases: &[CaseScore]) -> impl Iterator<Item = &TruthScore> {
    cases.iter().filter(|case| matches!(case.kind, Kind::One | Kind::Two)).flat_map(|case| &case.truths)
}

/// The mean; none of no numbers.
pub(crate) fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}
