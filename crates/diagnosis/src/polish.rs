//! A candidate fitted together with the robot and everything found before, at its own nonlinear values.

use model::Robot;

use crate::{
    Error,
    baseline::Baseline,
    candidates,
    series::{Applied, Series},
    weigh::{Weighed, system},
};

/// A fit with a mechanism more.
pub(crate) struct Polished {
    pub(crate) base: Baseline,
    /// The mechanism at its fitted values.
    pub(crate) applied: Applied,
    /// Half widths of the values' 95 % intervals; `None` for those taken from a grid.
    pub(crate) half_widths: Vec<Option<f64>>,
}

/// Rounds in which robot and mechanism are fitted in turn.
const POLISHES: usize = 3;
/// 97.5 % quantile of the normal distribution.
const NORMAL_975: f64 = 1.959_964;

/// Fits a candidate beside mechanisms that act already.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn polish(
    series: &Series,
    file: &Robot,
    others: &[Applied],
    one: &Weighed,
) -> Result<Polished, Error> {
    let linear = one.candidate.linear.clone();
    let mut applied = one.candidate.applied.clone();
    add(&mut applied, file, &linear, &one.evidence.values);
    let with = |applied: &Applied| [others, std::slice::from_ref(applied)].concat();
    let mut base = Baseline::fit(series, file, &with(&applied))?;
    let mut covariance = one.evidence.covariance.clone();
    for _ in 0..POLISHES {
        // Sensitivities are differences from what is predicted with the mechanism as it stands.
        let at = candidates::of_more(series, &base.robot, others, &base.predicted_w, &applied, &linear)?;
        let white = base.whitening(series);
        let columns: Vec<Vec<f64>> = at.iter().map(|c| white.of(c)).collect();
        let Some(evidence) = system(series, &base).weigh(&columns) else { break };
        add(&mut applied, file, &linear, &evidence.values);
        covariance = evidence.covariance;
        base = Baseline::fit(series, file, &with(&applied))?;
    }
    let mut half_widths = vec![None; applied.values.len()];
    for (j, parameter) in linear.iter().enumerate() {
        half_widths[*parameter] = Some(NORMAL_975 * covariance[(j, j)].max(0.0).sqrt());
    }
    Ok(Polished { base, applied, half_widths })
}

/// Moves values, within what a mechanism can have.
fn add(applied: &mut Applied, robot: &Robot, linear: &[usize], by: &[f64]) {
    for (parameter, by) in linear.iter().zip(by) {
        let [low, high] = applied.mechanism.bounds(robot, *parameter);
        applied.values[*parameter] = (applied.values[*parameter] + by).clamp(low, high);
    }
}
