//! A candidate fitted together with the robot and everything found before, at its own nonlinear values.

mod sureness;

use model::Robot;
use nalgebra::DMatrix;

use crate::{
    Error,
    baseline::Baseline,
    candidates::{self, apart},
    evidence::Evidence,
    misfit::misfit,
    off_middle,
    search::is_told,
    series::{Applied, Series},
    usual,
    weigh::{Sizes, Weighed, system_at},
};

/// A fit with mechanisms that act.
pub(crate) struct Polished {
    pub(crate) base: Baseline,
    /// The mechanisms at their fitted values, in the order in which they were given.
    pub(crate) applied: Vec<Applied>,
    /// Half widths of each one's values' 95 % intervals; `None` for those taken from a grid.
    pub(crate) half_widths: Vec<Vec<Option<f64>>>,
}

/// Rounds in which robot and mechanisms are fitted in turn.
const POLISHES: usize = 3;
/// Shares of a step that are tried: beyond a kink, as where wheels begin to be driven, a whole one leads away.
const SHARES: [f64; 3] = [1.0, 0.3, 0.1];
/// Moves of less than this share of one sigma are none.
const STILL: f64 = 0.03;
/// Drop of squared errors, in sigma, that a move has to bring.
const LEAST_GAIN: f64 = 1.0;
/// One sigma of what the form of a mechanism leaves open of all that it does, as a share, where the model misses something itself: in
/// concealed cases of worlds with forms of their own, on seeds that none is scored on, sizes that noise tells to 5 % were off by 8 %.
pub(crate) const FORM_SIGMA: f64 = 0.08;

/// One sigma of what the form of a mechanism leaves open of all that it does, as a share: nothing where the model is right.
pub(crate) fn form_sigma(series: &Series) -> f64 {
    if is_told(series) { 0.0 } else { FORM_SIGMA }
}

/// Fits a candidate together with mechanisms that act already, from a robot that is near the fit; it is the last of them then.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn polish(
    series: &Series,
    file: &Robot,
    (others, near): (&[Applied], &Robot),
    one: &Weighed,
) -> Result<Polished, Error> {
    let own = &one.candidate.linear;
    let mut applied = others.to_vec();
    applied.push(candidates::moved(&one.candidate.applied, file, own, &one.evidence.values));
    let mut free: Vec<Vec<usize>> = others.iter().map(candidates::sizes).collect();
    free.push(own.clone());
    let known = &one.evidence.covariance;
    let before: usize = free.iter().rev().skip(1).map(Vec::len).sum();
    let mut covariance = DMatrix::zeros(before + own.len(), before + own.len());
    covariance.view_mut((before, before), known.shape()).copy_from(known);
    let mut together = Together::settled(series, file, (applied, free), covariance, near)?;
    if let Some(next) = together.on_the_other_side(series, file)? {
        together = next;
    }
    // Values from a grid are freed at last, as long as that explains more; of what was found before as well, as it was fitted without
    // what it stands beside now.
    let last = others.len();
    if own.len() < together.applied[last].values.len() {
        together = together.freed_fully(series, file, last)?;
    }
    for which in 0..last {
        if together.has_grid(which) {
            together = together.freed_fully(series, file, which)?;
        }
    }
    together.polished(series, file)
}

/// Fits mechanisms that act together with each other and the robot.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn settle(
    series: &Series,
    file: &Robot,
    applied: &[Applied],
    near: &Robot,
) -> Result<Polished, Error> {
    let free: Vec<Vec<usize>> = applied.iter().map(candidates::sizes).collect();
    let count = free.iter().map(Vec::len).sum();
    let covariance = DMatrix::zeros(count, count);
    Together::settled(series, file, (applied.to_vec(), free), covariance, near)?.polished(series, file)
}

/// By how much to move all values that are fitted, one mechanism after the other, and their covariance.
type Step = (Vec<f64>, DMatrix<f64>);

/// Mechanisms with the robot fitted to them.
struct Together {
    applied: Vec<Applied>,
    /// Parameters of each that are fitted.
    free: Vec<Vec<usize>>,
    base: Baseline,
    /// Covariance of all that are fitted, one mechanism after the other.
    covariance: DMatrix<f64>,
}

impl Together {
    /// Fits robot and mechanisms in turn.
    fn settled(
        series: &Series,
        file: &Robot,
        (applied, free): (Vec<Applied>, Vec<Vec<usize>>),
        covariance: DMatrix<f64>,
        near: &Robot,
    ) -> Result<Self, Error> {
        let base = Baseline::fit_from(series, file, &applied, near)?;
        let mut last = Together { applied, free, base, covariance };
        for _ in 0..POLISHES {
            let Some((values, covariance)) = last.weighed(series)? else { break };
            let is_still = is_still(&values, &covariance);
            last.covariance = covariance;
            if is_still {
                break;
            }
            let before = cost(series, (&last.applied, &last.base), &last.base);
            let mut better = None;
            for share in SHARES {
                let by: Vec<f64> = values.iter().map(|value| share * value).collect();
                let moved = last.moved(file, &by);
                let next = Baseline::fit_near(series, file, &moved, &last.base)?;
                if cost(series, (&moved, &next), &last.base) < before {
                    better = Some((moved, next));
                    break;
                }
            }
            let Some(next) = better else { break };
            (last.applied, last.base) = next;
        }
        Ok(last)
    }

    /// The fit with the last of them on the other side of what it shows alike about, if that explains more.
    fn on_the_other_side(&self, series: &Series, file: &Robot) -> Result<Option<Self>, Error> {
        let (one, mut applied) = apart(&self.applied, self.applied.len() - 1);
        let Some(mirrored) = off_middle::mirrored(&one, file) else { return Ok(None) };
        applied.push(mirrored);
        let fitted = (applied, self.free.clone());
        let other = Together::settled(series, file, fitted, self.covariance.clone(), &self.base.robot)?;
        let costs = [&other, self].map(|one| cost(series, (&one.applied, &one.base), &self.base));
        Ok((costs[0] < costs[1] - LEAST_GAIN).then_some(other))
    }

    /// The step that the drives ask for; `None` where the drives do not tell them.
    fn weighed(&self, series: &Series) -> Result<Option<Step>, Error> {
        let white = self.base.whitening(series);
        let mut columns = Vec::new();
        for which in 0..self.applied.len() {
            // Sensitivities are differences from what is predicted with the mechanism as it stands.
            columns.extend(self.columns(series, which)?.iter().map(|column| white.of(column)));
        }
        let evidence = system_at(series, &self.base, Sizes::Fixed, &[]).weigh(&columns);
        let told = |evidence: Evidence| (evidence.values, evidence.covariance);
        Ok(evidence
            .map(|evidence| usual::informed(told(evidence), &self.applied, &self.free, &self.base.robot)))
    }

    /// Sensitivities to what is fitted of one.
    fn columns(&self, series: &Series, which: usize) -> Result<Vec<Vec<f64>>, Error> {
        let (one, others) = apart(&self.applied, which);
        let base = &self.base;
        candidates::of_more(series, &base.robot, &others, &base.predicted_w, &one, &self.free[which])
    }

    /// All mechanisms moved, within bounds.
    fn moved(&self, file: &Robot, by: &[f64]) -> Vec<Applied> {
        let mut first = 0;
        let moved = |(one, free): (&Applied, &Vec<usize>)| {
            let own = &by[first..first + free.len()];
            first += free.len();
            candidates::moved(one, file, free, own)
        };
        self.applied.iter().zip(&self.free).map(moved).collect()
    }

    /// The fit with all values of one free, step by step as long as that explains more.
    fn freed_fully(mut self, series: &Series, file: &Robot, which: usize) -> Result<Self, Error> {
        let linear = self.free[which].clone();
        for _ in 0..POLISHES {
            let Some(next) = self.freed(series, file, which, &linear)? else { break };
            self = next;
        }
        Ok(self)
    }

    /// One step of all values of one together, or of those that are within their bounds; `None` where neither explains more.
    /// `linear` are those that do not come from a grid.
    fn freed(
        &self,
        series: &Series,
        file: &Robot,
        which: usize,
        linear: &[usize],
    ) -> Result<Option<Self>, Error> {
        let applied = self.applied[which].clone();
        let all: Vec<usize> = (0..applied.values.len()).collect();
        let is_within = |parameter: &usize| {
            let [low, high] = candidates::range(&applied, file, *parameter);
            (low..high).contains(&applied.values[*parameter]) && applied.values[*parameter] > low
        };
        let within: Vec<usize> = all.iter().copied().filter(is_within).collect();
        let before = cost(series, (&self.applied, &self.base), &self.base);
        let mut ways = vec![all, within];
        ways.dedup();
        for own in ways {
            let mut free = self.free.clone();
            free[which] = own.clone();
            let first: usize = free.iter().take(which).map(Vec::len).sum();
            let with = Together {
                applied: self.applied.clone(),
                free,
                base: self.base.clone(),
                covariance: DMatrix::zeros(0, 0),
            };
            let Some((values, covariance)) = with.weighed(series)? else { continue };
            let whole = limited(&applied, &own, &values[first..first + own.len()], linear);
            for share in SHARES {
                let by: Vec<f64> = whole.iter().map(|by| share * by).collect();
                let mut moved = self.applied.clone();
                moved[which] = candidates::moved(&applied, file, &own, &by);
                if moved[which].values == applied.values {
                    break;
                }
                let next = Baseline::fit_near(series, file, &moved, &self.base)?;
                if cost(series, (&moved, &next), &self.base) < before - LEAST_GAIN {
                    return Ok(Some(Together { applied: moved, base: next, covariance, ..with }));
                }
            }
        }
        Ok(None)
    }
}

/// Whether a step is none.
fn is_still(values: &[f64], covariance: &DMatrix<f64>) -> bool {
    values.iter().zip(&covariance.diagonal()).all(|(by, variance)| by.abs() < STILL * variance.sqrt())
}

/// How well mechanisms with a robot explain the drives, and how usual they are, by the noise of another fit.
fn cost(series: &Series, (applied, fit): (&[Applied], &Baseline), by: &Baseline) -> f64 {
    misfit(series, fit, by) + usual::cost(applied, &fit.robot)
}

/// A move of all values, in which those that come from a grid go no farther than to its next point: half their size.
fn limited(applied: &Applied, free: &[usize], by: &[f64], linear: &[usize]) -> Vec<f64> {
    let from_grid = || free.iter().zip(by).filter(|(parameter, _)| !linear.contains(parameter));
    let reach = 0.5 * from_grid().map(|(&parameter, _)| applied.values[parameter].abs()).fold(0.0, f64::max);
    let beyond = from_grid().map(|(_, by)| by.abs() / reach.max(1e-9)).fold(1.0, f64::max);
    by.iter().map(|by| by / beyond).collect()
}
