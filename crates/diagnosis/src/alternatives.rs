//! What else a finding could be, fitted in its place, and the least sizes that would have been noticed at all.

use model::{Robot, mechanism};

use crate::{
    Error,
    baseline::Baseline,
    candidates,
    evidence::{Evidence, System},
    null::Null,
    report::Detectable,
    search::Found,
    series::{Applied, Series},
    span::Span,
    weigh::{judged, system},
};

/// An explanation with the robot fitted beside it.
pub(crate) struct Explanation {
    /// The mechanism in question.
    pub(crate) name: &'static str,
    /// All mechanisms that act.
    pub(crate) applied: Vec<Applied>,
    /// The robot.
    pub(crate) robot: Robot,
}

/// Alternatives that are compared at most; beyond, no single drive would decide.
const MOST_ALTERNATIVES: usize = 4;

/// The mechanisms that cannot be told from a finding, each fitted in its place.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn alternatives(
    series: &Series,
    file: &Robot,
    found: &[Found],
    which: usize,
) -> Result<Vec<Explanation>, Error> {
    let others: Vec<Applied> =
        found.iter().enumerate().filter(|(i, _)| *i != which).map(|(_, f)| f.applied.clone()).collect();
    let without = Baseline::fit(series, file, &others)?;
    let mut explanations = Vec::new();
    for name in found[which].indistinguishable_from.iter().take(MOST_ALTERNATIVES) {
        let Some(mechanism) = mechanism::by_name(name) else { continue };
        let span = found[which].applied.span;
        let Some(applied) = fitted(series, &without, &others, mechanism, span)? else { continue };
        let mut all = others.clone();
        all.push(applied);
        let robot = Baseline::fit(series, file, &all)?.robot;
        explanations.push(Explanation { name: mechanism.name(), applied: all, robot });
    }
    Ok(explanations)
}

/// A mechanism at its best values beside a baseline; `None` where the drives tell nothing of it.
pub(crate) fn fitted(
    series: &Series,
    base: &Baseline,
    others: &[Applied],
    mechanism: &'static dyn mechanism::Mechanism,
    span: Span,
) -> Result<Option<Applied>, Error> {
    let system = system(series, base);
    let mut best: Option<(f64, Applied)> = None;
    for (values, linear) in candidates::told_grids(series, mechanism) {
        let probe = Applied { mechanism, values, span };
        let at = candidates::of(series, &base.robot, others, &base.predicted_w, probe, linear)?;
        let Some(evidence) = system.weigh(&whitened(series, base, &at.columns)) else { continue };
        if best.as_ref().is_none_or(|(wald, _)| evidence.wald > *wald) {
            let applied = candidates::moved(&at.applied, &base.robot, &at.linear, &evidence.values);
            best = Some((evidence.wald, applied));
        }
    }
    Ok(best.map(|(_, applied)| applied))
}

fn whitened(series: &Series, base: &Baseline, columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let white = base.whitening(series);
    columns.iter().map(|c| white.of(c)).collect()
}

/// Standard errors that an effect needs to be noticed: some four for the correction for all that is tried, and one more for
/// it to happen in most drives.
const NOTICED_SIGMAS: f64 = 5.0;

/// For each mechanism the least size, from the beginning on, that would have been noticed, or its name where no size would. What models
/// miss of healthy drives is held against it as against what was found.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn detectable(
    series: &Series,
    base: &Baseline,
    applied: &[Applied],
    null: &Null,
) -> Result<(Vec<Detectable>, Vec<&'static str>), Error> {
    let system = system(series, base);
    let (mut sizes, mut none) = (Vec::new(), Vec::new());
    for mechanism in series.others(applied) {
        let least = least_size(series, base, applied, (&system, null), mechanism)?;
        match least {
            Some(size) => sizes.push(size),
            None => none.push(mechanism.name()),
        }
    }
    Ok((sizes, none))
}

/// The least size of a mechanism's first number that would have been noticed, over all grid values of the others.
fn least_size(
    series: &Series,
    base: &Baseline,
    applied: &[Applied],
    (system, null): (&System, &Null),
    mechanism: &'static dyn mechanism::Mechanism,
) -> Result<Option<Detectable>, Error> {
    let parameter = &mechanism.parameters()[0];
    let [_, most] = mechanism.bounds(&base.robot, 0);
    let mut least = most;
    for (values, _) in candidates::told_grids(series, mechanism) {
        let probe = Applied { mechanism, values, span: Span::ALL };
        let at = candidates::of(series, &base.robot, applied, &base.predicted_w, probe, vec![0])?;
        let of_one = system.weigh(&whitened(series, base, &at.columns)).and_then(|evidence| {
            let one = Evidence {
                values: vec![1.0],
                wald: 1.0 / evidence.covariance[(0, 0)],
                discord: 1.0,
                lasting: 1.0,
                ..evidence
            };
            judged(&one, mechanism.name(), null, (system.blocks(), system.blocks() as f64))
        });
        if let Some((wald, _)) = of_one {
            least = least.min(NOTICED_SIGMAS / wald.sqrt());
        }
    }
    let size = || Detectable {
        mechanism: mechanism.name(),
        parameter: parameter.name,
        value: least,
        unit: parameter.unit,
    };
    Ok((least < most).then(size))
}
