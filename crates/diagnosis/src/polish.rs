//! A candidate fitted together with the robot and everything found before, at its own nonlinear values.

use model::Robot;
use nalgebra::DMatrix;

use crate::{
    Error,
    baseline::Baseline,
    candidates,
    regime::Regime,
    series::{Applied, Series},
    weigh::{Weighed, misfit, system},
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
/// Shares of a step that are tried: beyond a kink, as where wheels begin to be driven, a whole one leads away.
const SHARES: [f64; 3] = [1.0, 0.3, 0.1];
/// Drop of squared errors, in sigma, that a move has to bring.
const LEAST_GAIN: f64 = 1.0;
/// 97.5 % quantile of the normal distribution.
const NORMAL_975: f64 = 1.959_964;

/// Fits a candidate beside mechanisms that act already, from a robot that is near the fit.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn polish(
    series: &Series,
    file: &Robot,
    (others, near): (&[Applied], &Robot),
    one: &Weighed,
) -> Result<Polished, Error> {
    let linear = one.candidate.linear.clone();
    let with = |applied: &Applied| [others, std::slice::from_ref(applied)].concat();
    let fitted_with =
        |applied: &Applied, near: &Robot| Baseline::fit_from(series, file, &with(applied), near);
    let mut applied = candidates::moved(&one.candidate.applied, file, &linear, &one.evidence.values);
    let mut base = fitted_with(&applied, near)?;
    let mut covariance = one.evidence.covariance.clone();
    for _ in 0..POLISHES {
        // Sensitivities are differences from what is predicted with the mechanism as it stands.
        let at = candidates::of_more(series, &base.robot, others, &base.predicted_w, &applied, &linear)?;
        let white = base.whitening(series);
        let columns: Vec<Vec<f64>> = at.iter().map(|c| white.of(c)).collect();
        let Some(evidence) = system(series, &base).weigh(&columns) else { break };
        covariance = evidence.covariance;
        let before = misfit(series, &base, &base);
        let mut better = None;
        for share in SHARES {
            let by: Vec<f64> = evidence.values.iter().map(|value| share * value).collect();
            let moved = candidates::moved(&applied, file, &linear, &by);
            let next = fitted_with(&moved, &base.robot)?;
            if misfit(series, &next, &base) < before {
                better = Some((moved, next));
                break;
            }
        }
        let Some(next) = better else { break };
        (applied, base) = next;
    }
    let mut fitted = linear;
    // Values from a grid are freed at last, as long as that explains more.
    if fitted.len() < applied.values.len() {
        for _ in 0..POLISHES {
            let grid = &one.candidate.linear;
            let Some(freed) = freed(series, file, others, (&applied, &base), grid)? else { break };
            (applied, base, covariance, fitted) = freed;
        }
    }
    // Where regimes disagree about a size by more than chance, it is told no better than they agree (the scale factor of the Particle
    // Data Group, Rosenfeld, Annu. Rev. Nucl. Sci. 25, 1975, p. 555).
    let wider = discord(series, others, (&applied, &base), &fitted)?.sqrt();
    let mut half_widths = vec![None; applied.values.len()];
    for (j, parameter) in fitted.iter().enumerate() {
        half_widths[*parameter] = Some(wider * NORMAL_975 * covariance[(j, j)].max(0.0).sqrt());
    }
    Ok(Polished { base, applied, half_widths })
}

/// How far the size of what was fitted scatters from regime to regime, over what chance makes of it, squared.
fn discord(
    series: &Series,
    others: &[Applied],
    (applied, base): (&Applied, &Baseline),
    fitted: &[usize],
) -> Result<f64, Error> {
    let at = candidates::of_more(series, &base.robot, others, &base.predicted_w, applied, fitted)?;
    let white = base.whitening(series);
    let columns: Vec<Vec<f64>> = at.iter().map(|c| white.of(c)).collect();
    let values: Vec<f64> = fitted.iter().map(|parameter| applied.values[*parameter]).collect();
    let (system, regime) =
        (system(series, base), series.averages.iter().map(Regime::on_slope).collect::<Vec<_>>());
    let Some(evidence) = system.weigh(&columns) else { return Ok(1.0) };
    Ok(system.discord_on_slopes(&evidence, &values, &regime))
}

/// Values, the fit with them, their covariance, and which of them that is of.
type Freed = (Applied, Baseline, DMatrix<f64>, Vec<usize>);

/// One step of all values together, or of those that are within their bounds; `None` where neither explains more.
fn freed(
    series: &Series,
    file: &Robot,
    others: &[Applied],
    (applied, base): (&Applied, &Baseline),
    linear: &[usize],
) -> Result<Option<Freed>, Error> {
    let all: Vec<usize> = (0..applied.values.len()).collect();
    let is_within = |parameter: &usize| {
        let [low, high] = candidates::range(applied.mechanism, file, *parameter);
        (low..high).contains(&applied.values[*parameter]) && applied.values[*parameter] > low
    };
    let within: Vec<usize> = all.iter().copied().filter(is_within).collect();
    let before = misfit(series, base, base);
    for free in [all, within] {
        let at = candidates::of_more(series, &base.robot, others, &base.predicted_w, applied, &free)?;
        let white = base.whitening(series);
        let columns: Vec<Vec<f64>> = at.iter().map(|c| white.of(c)).collect();
        let Some(evidence) = system(series, base).weigh(&columns) else { continue };
        let by = limited(applied, &free, &evidence.values, linear);
        let moved = candidates::moved(applied, file, &free, &by);
        let all = [others, std::slice::from_ref(&moved)].concat();
        let next = Baseline::fit_from(series, file, &all, &base.robot)?;
        if misfit(series, &next, base) < before - LEAST_GAIN {
            return Ok(Some((moved, next, evidence.covariance, free)));
        }
    }
    Ok(None)
}

/// A move of all values, in which those that come from a grid go no farther than to its next point: half their size.
fn limited(applied: &Applied, free: &[usize], by: &[f64], linear: &[usize]) -> Vec<f64> {
    let from_grid = || free.iter().zip(by).filter(|(parameter, _)| !linear.contains(parameter));
    let reach = 0.5 * from_grid().map(|(&parameter, _)| applied.values[parameter].abs()).fold(0.0, f64::max);
    let beyond = from_grid().map(|(_, by)| by.abs() / reach.max(1e-9)).fold(1.0, f64::max);
    by.iter().map(|by| by / beyond).collect()
}
