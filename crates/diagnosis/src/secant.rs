//! Candidates weighed by what they do at their own size, instead of by what a little of them does times the size.

use crate::{
    Error,
    baseline::Baseline,
    candidates::Candidate,
    foremost::Measure,
    series::{Applied, Series},
    weigh::Weighed,
};

/// Rounds in which sizes and what they do are worked out in turn.
const ROUNDS: usize = 3;
/// Sizes below this share of a parameter's probe are in proportion.
const SMALL: f64 = 0.1;

/// The same candidate with differences over its whole size for sensitivities, if that explains more.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn closer(
    series: &Series,
    base: &Baseline,
    others: &[Applied],
    (first, measure): (&Weighed, Measure),
    weigh: &dyn Fn(Candidate) -> Option<Weighed>,
) -> Result<Option<Weighed>, Error> {
    let mut best: Option<Weighed> = None;
    for _ in 0..ROUNDS {
        let last = best.as_ref().unwrap_or(first);
        let columns = secants(series, base, others, last)?;
        let candidate = Candidate {
            applied: first.candidate.applied.clone(),
            linear: first.candidate.linear.clone(),
            columns,
        };
        match weigh(candidate) {
            Some(next) if measure(&next) > measure(last) => best = Some(next),
            _ => break,
        }
    }
    Ok(best)
}

/// Change of predictions per unit of each parameter, between none of it and all of it, with the others at their size.
fn secants(
    series: &Series,
    base: &Baseline,
    others: &[Applied],
    at: &Weighed,
) -> Result<Vec<Vec<f64>>, Error> {
    let mechanism = at.candidate.applied.mechanism;
    let whole = at.at(base, &at.evidence.values);
    let predict =
        |applied: &Applied| series.predict(&base.robot, &[others, std::slice::from_ref(applied)].concat());
    let with = predict(&whole)?;
    let columns = at.candidate.linear.iter().zip(&at.candidate.columns);
    columns
        .map(|(&parameter, tangent)| {
            let size = whole.values[parameter] - at.candidate.applied.values[parameter];
            if size.abs() < SMALL * mechanism.parameters()[parameter].probe {
                return Ok(tangent.clone());
            }
            let mut without = whole.clone();
            without.values[parameter] = at.candidate.applied.values[parameter];
            let without = predict(&without)?;
            Ok(with.iter().zip(&without).map(|(a, b)| (a - b) / size).collect())
        })
        .collect()
}
