//! Effects outside the list: smooth functions of wide amplitude that act in the test drives alone.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::{
    evidence::{
        linear_model::{Group, LinearModel},
        reduced::log_sum,
    },
    fit::{baseline::Baseline, discrepancy::Components, features::Features, joint::Joint},
    observe::observations::{Observations, REGIME, REST},
};

/// What the functions are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    /// Speed, turning, pitch, roll, acceleration.
    Regime,
    /// Time driven.
    Time,
    /// Where the robot was.
    Place,
    /// Time since it began to move.
    SinceStart,
    /// How far the wheels have turned, where something repeats with it.
    Turn,
}

/// What the functions multiply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Component {
    /// Power of a force of rolling resistance's size.
    Rolling,
    /// Power of skid resistance.
    Skid,
    /// All power.
    Power,
    /// Mean power, whatever the robot does.
    Constant,
}

const FAMILIES: [Family; 5] = [Family::Regime, Family::Time, Family::Place, Family::SinceStart, Family::Turn];
const COMPONENTS: [Component; 4] =
    [Component::Rolling, Component::Skid, Component::Power, Component::Constant];
/// Amplitudes, as shares of the component: from what a model misses anyway to all of it, each about three times the one before.
pub(crate) const AMPLITUDES: [f64; 4] = [0.05, 0.15, 0.4, 1.0];
/// Functions of the regime, of which there are five quantities, and of anything else; twice as many of a place, which has two.
const REGIME_FUNCTIONS: usize = 16;
const FUNCTIONS: usize = 8;
/// Length scales: regime in its scatter, shorter than those of the discrepancy; time and place as shares
/// of all; time since a start in factors of e.
const REGIME_LENGTHS: [f64; REGIME] = [1.2; REGIME];
const TIME_LENGTH: f64 = 0.15;
const PLACE_LENGTH: f64 = 0.25;
const SINCE_START_LENGTH: f64 = 1.0;

/// One family on one component, left and right apart.
pub(crate) struct Block {
    /// What its functions are of.
    pub(crate) family: Family,
    /// What they multiply.
    pub(crate) component: Component,
    /// Its columns at amplitude one.
    pub(crate) columns: Group,
}

/// All blocks of drives.
pub(crate) fn blocks(joint: &Joint<'_>) -> Vec<Block> {
    let all = FAMILIES.into_iter().flat_map(|family| COMPONENTS.map(|component| (family, component)));
    some_blocks(joint, &all.collect::<Vec<_>>())
}

/// Some blocks of drives.
fn some_blocks(joint: &Joint<'_>, some: &[(Family, Component)]) -> Vec<Block> {
    let components = joint.baseline.components(joint.observed);
    let block = |&(family, component): &(Family, Component)| {
        let functions = functions(joint.observed, family)?;
        let raw = raw_columns(joint.observed, joint.baseline, &components, component, &functions);
        let columns: Vec<DVector<f64>> = joint.whiten(&raw);
        let is_any = !columns.is_empty();
        is_any.then(|| Block {
            family,
            component,
            columns: joint.model.group(DMatrix::from_columns(&columns)),
        })
    };
    some.par_iter().filter_map(block).collect()
}

/// Log evidence of every block and amplitude beside columns that are there already, and that of all: their mean.
pub(crate) fn log_evidence(
    model: &LinearModel,
    blocks: &[Block],
    beside: &Beside<'_>,
) -> (f64, Vec<(usize, f64, f64)>) {
    let of_block = |(i, block): (usize, &Block)| {
        let reduced = model.reduce(&[beside.columns, &block.columns, beside.left]);
        let fixed = beside.columns.columns.ncols();
        AMPLITUDES.map(|amplitude| {
            let mut factors = vec![1.0; fixed];
            factors.resize(fixed + block.columns.columns.ncols(), amplitude);
            (i, amplitude, reduced.scaled(&factors).evidence(beside.halves).log)
        })
    };
    let all: Vec<(usize, f64, f64)> = blocks.par_iter().enumerate().map(of_block).flatten_iter().collect();
    let mean = log_sum(all.iter().map(|one| one.2)) - (all.len().max(1) as f64).ln();
    (mean, all)
}

/// What an unlisted effect stands beside.
pub(crate) struct Beside<'a> {
    /// Columns of named effects.
    pub(crate) columns: &'a Group,
    /// Their signs.
    pub(crate) halves: &'a [crate::evidence::reduced::Half],
    /// The residual.
    pub(crate) left: &'a Group,
}

/// Functions of a family, row by row of the test drives, the constant first.
fn functions(observed: &Observations<'_>, family: Family) -> Option<Vec<Vec<f64>>> {
    let rows = 0..observed.test_rows;
    let averages = observed.averages();
    let of = |count: usize, value: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
        let constant = vec![1.0; observed.test_rows];
        let others = (0..count).map(|k| rows.clone().map(|i| value(k, i)).collect());
        std::iter::once(constant).chain(others).collect()
    };
    match family {
        Family::Regime => {
            let features = Features::<REGIME>::new(REGIME_FUNCTIONS, REGIME_LENGTHS);
            Some(of(REGIME_FUNCTIONS, &|k, i| features.at(k, &observed.regimes[i])))
        }
        Family::Time => {
            let (features, total_s) =
                (Features::<1>::new(FUNCTIONS, [TIME_LENGTH]), observed.total_s().max(1.0));
            Some(of(FUNCTIONS, &|k, i| features.at(k, &[observed.driven_s[i] / total_s])))
        }
        Family::SinceStart => {
            let features = Features::<1>::new(FUNCTIONS, [SINCE_START_LENGTH]);
            Some(of(FUNCTIONS, &|k, i| features.at(k, &[averages[i].input.moving_s.max(0.0).ln_1p()])))
        }
        Family::Turn => {
            let swing = |_, i: usize| 2.0 * averages[i].input.nearness - 1.0;
            observed.series.turning.is_some().then(|| of(1, &swing))
        }
        Family::Place => {
            let known = |i: &usize| averages[*i].input.position_m.iter().all(|m| m.is_finite());
            let size_m = [0, 1].map(|axis| {
                let values = rows.clone().filter(known).map(|i| averages[i].input.position_m[axis]);
                let [low, high] =
                    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], m| [l.min(m), h.max(m)]);
                high - low
            });
            let is_told = size_m.iter().all(|m| m.is_finite() && *m > 1.0);
            let features = Features::<2>::new(2 * FUNCTIONS, [PLACE_LENGTH; 2]);
            is_told.then(|| {
                of(2 * FUNCTIONS, &|k, i| {
                    let at = averages[i].input.position_m;
                    if !known(&i) {
                        return 0.0;
                    }
                    features.at(k, &[at[0] / size_m[0], at[1] / size_m[1]])
                })
            })
        }
    }
}

/// Functions times a component, channel by channel of power.
fn raw_columns(
    observed: &Observations<'_>,
    baseline: &Baseline,
    components: &Components,
    component: Component,
    functions: &[Vec<f64>],
) -> Vec<Vec<f64>> {
    let mean_w = observed.power_rms(&baseline.predicted);
    let size = |i: usize| match component {
        Component::Rolling => components.rolling[i],
        Component::Skid => components.skid[i],
        Component::Power => components.total[i],
        Component::Constant => mean_w,
    };
    let mut channels: Vec<usize> = (0..observed.series.channels()).collect();
    // What the battery gives beyond both sides has no friction.
    if observed.has_channel(REST) && matches!(component, Component::Constant | Component::Power) {
        channels.push(REST);
    }
    let column = |channel: usize, function: &Vec<f64>| -> Vec<f64> {
        let value =
            |i: usize| if observed.averages()[i].channel == channel { size(i) * function[i] } else { 0.0 };
        (0..observed.test_rows).map(value).collect()
    };
    channels
        .iter()
        .flat_map(|channel| functions.iter().map(move |function| column(*channel, function)))
        .collect()
}

/// Families and components whose functions make the most flexible fit.
const FLEXIBLE: [(Family, Component); 2] =
    [(Family::Time, Component::Power), (Family::Regime, Component::Power)];

/// The whitened residual that is left by the basis and smooth functions of time and regime in the test drives.
pub(crate) fn left_by_all(joint: &Joint<'_>) -> DVector<f64> {
    let blocks = some_blocks(joint, &FLEXIBLE);
    let used: Vec<&Group> = blocks.iter().map(|block| &block.columns).collect();
    let residual = joint.model.group(DMatrix::from_columns(std::slice::from_ref(&joint.residual)));
    let groups: Vec<&Group> = used.iter().copied().chain([&residual]).collect();
    let reduced = joint.model.reduce(&groups);
    let mean = reduced.evidence(&[]).mean;
    let mut left = joint.residual.clone();
    let mut first = 0;
    for group in used {
        let count = group.columns.ncols();
        let fitted = &group.columns * mean.rows(first, count);
        left.rows_mut(0, fitted.len()).axpy(-1.0, &fitted, 1.0);
        first += count;
    }
    let weights = joint.model.basis_weights(&reduced, &left);
    left - joint.model.transposed().tr_mul(&weights)
}
