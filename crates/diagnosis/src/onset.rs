//! When a mechanism set in: the profile of its evidence over the time from which it acts.

use rayon::prelude::*;

use crate::{
    Error,
    baseline::Baseline,
    candidates::{self, Candidate},
    evidence::Evidence,
    series::{Applied, Series},
    weigh::{Weighed, system},
};

/// Times are looked at on both sides of the first guess, as far as the neighbouring guesses lie, as a share of the drive.
const AROUND: f64 = 0.1;
/// Number of times looked at on each side.
const STEPS: i32 = 30;
/// 95 % quantile of χ² of one degree of freedom: what evidence may fall short of the best within the interval.
const CHI_SQUARED_95: f64 = 3.841;

/// A candidate at the time from which its evidence is strongest.
pub(crate) struct Onset {
    pub(crate) weighed: Weighed,
    /// 95 % interval of the time, by the profile [s].
    pub(crate) interval_s: [f64; 2],
}

/// Finds when a candidate that set in during the drives did so; `None` for one that acts from the beginning.
///
/// A mechanism acts on every second by itself, so what it does from some time on is what it does all the time, cut off there.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn refine(
    series: &Series,
    base: &Baseline,
    others: &[Applied],
    first: &Weighed,
    discount: f64,
) -> Result<Option<Onset>, Error> {
    let guess = &first.candidate.applied;
    if guess.from_s == 0.0 {
        return Ok(None);
    }
    let linear = first.candidate.linear.clone();
    let always = Applied { from_s: 0.0, ..guess.clone() };
    let all = candidates::of(series, &base.robot, others, &base.predicted_w, always, linear)?.columns;
    let system = system(series, base);
    let step_s = AROUND * series.longest_s() / f64::from(STEPS);
    let at = |step: i32| -> Option<(f64, Vec<Vec<f64>>, Evidence)> {
        let from_s = guess.from_s + f64::from(step) * step_s;
        let columns: Vec<Vec<f64>> = all.iter().map(|column| cut(series, column, from_s)).collect();
        let white = base.whitening(series);
        let whitened: Vec<Vec<f64>> = columns.iter().map(|column| white.of(column)).collect();
        Some((from_s, columns, system.weigh(&whitened)?)).filter(|_| from_s > 0.0)
    };
    let profile: Vec<_> = (-STEPS..=STEPS).into_par_iter().filter_map(at).collect();
    let best = profile.iter().map(|(_, _, evidence)| evidence.wald).fold(f64::NEG_INFINITY, f64::max);
    let within = profile.iter().filter(|(_, _, e)| (best - e.wald) / discount <= CHI_SQUARED_95);
    let interval_s = within.fold([f64::INFINITY, 0.0], |[low, high], (s, ..)| [s.min(low), s.max(high)]);
    let Some((from_s, columns, evidence)) = profile.into_iter().find(|(_, _, e)| e.wald == best) else {
        return Ok(None);
    };
    let candidate = Candidate {
        applied: Applied { from_s, ..guess.clone() },
        linear: first.candidate.linear.clone(),
        columns,
    };
    let more = (evidence.wald - first.evidence.wald) / discount;
    let (score, rank) = (first.score + more, first.rank + more);
    let weighed = Weighed { candidate, evidence, tried: first.tried, score, rank, p_value: first.p_value };
    // A step is as close as a time is told.
    let interval_s = [interval_s[0] - step_s, interval_s[1] + step_s];
    Ok(Some(Onset { weighed, interval_s: interval_s.map(|s| s.max(0.0)) }))
}

/// A column without what comes before a time.
fn cut(series: &Series, column: &[f64], from_s: f64) -> Vec<f64> {
    let acts = |(value, a): (&f64, &crate::series::Average)| if a.t_s >= from_s { *value } else { 0.0 };
    column.iter().zip(&series.averages).map(acts).collect()
}
