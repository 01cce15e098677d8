//! The best candidates of every mechanism.

use rayon::prelude::*;

use crate::{
    Error,
    baseline::Baseline,
    candidates::{self, Candidate, Family},
    null::Null,
    secant,
    series::{Applied, Series},
    weigh::{Scales, Weighed},
};

/// Candidates that are looked at more closely.
const CLOSER: usize = 6;

/// The best candidate of every mechanism, and its best in a place, by two measures: what acts in a place only has more to pass, and
/// something else has to be there if it does not.
pub(crate) struct Foremost {
    /// Those whose evidence is surest, block by block, best first: what speaks in one block is an event.
    pub(crate) surest: Vec<Weighed>,
    /// Those that take most of the errors, best first: where and since when something acts is told by squares, whereas evidence may
    /// be surest in a part of that in which models miss little.
    pub(crate) closest: Vec<Weighed>,
    /// Number of blocks.
    pub(crate) blocks: usize,
}

/// A measure of candidates.
pub(crate) type Measure = fn(&Weighed) -> f64;

/// The measures of [`Foremost::surest`] and [`Foremost::closest`].
const MEASURES: [Measure; 2] = [|one| one.score, |one| one.rank];

impl Foremost {
    /// Weighs every candidate beside mechanisms that act.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub(crate) fn of(
        series: &Series,
        base: &Baseline,
        applied: &[Applied],
        null: &Null,
    ) -> Result<Foremost, Error> {
        let families = candidates::all(series, &base.robot, applied, &base.predicted_w)?;
        let scales = Scales::new(series, base, null, &families);
        let best_of = |family: &Family| {
            let mut candidates = family.candidates(series);
            let mut best = [Vec::new(), Vec::new()];
            // All at once would take gigabytes of long drives.
            loop {
                let some: Vec<Candidate> = candidates.by_ref().take(scales.together()).collect();
                if some.is_empty() {
                    break Ok(best);
                }
                series.go_on()?;
                for one in scales.weigh_all(some).iter().flatten() {
                    best.iter_mut().zip(MEASURES).for_each(|(best, measure)| take(best, one, measure));
                }
            }
        };
        let of_families: Vec<[Vec<Weighed>; 2]> =
            families.par_iter().map(best_of).collect::<Result<_, Error>>()?;
        let best_by = |which: usize, measure: Measure| -> Result<Vec<Weighed>, Error> {
            let mut best = Vec::new();
            of_families.iter().flat_map(|some| &some[which]).for_each(|one| take(&mut best, one, measure));
            sort(&mut best, measure);
            // What is strong is not in proportion to what little of it does.
            let closer: Vec<Option<Weighed>> = best
                .par_iter()
                .take(CLOSER)
                .map(|one| secant::closer(series, base, applied, (one, measure), &|one| scales.weigh(one)))
                .collect::<Result<_, _>>()?;
            closer.iter().flatten().for_each(|one| take(&mut best, one, measure));
            sort(&mut best, measure);
            Ok(best)
        };
        let [surest, closest] = [best_by(0, MEASURES[0])?, best_by(1, MEASURES[1])?];
        Ok(Foremost { surest, closest, blocks: scales.blocks() })
    }
}

/// Keeps of those that are alike only the best.
fn take(best: &mut Vec<Weighed>, one: &Weighed, measure: Measure) {
    match best.iter_mut().find(|other| other.is_like(one)) {
        Some(last) if measure(one) > measure(last) => *last = one.clone(),
        Some(_) => {}
        None => best.push(one.clone()),
    }
}

/// Best first.
fn sort(some: &mut [Weighed], measure: Measure) {
    some.sort_by(|a, b| measure(b).total_cmp(&measure(a)));
}

#[cfg(test)]
mod tests {
    use model::mechanism;
    use nalgebra::DMatrix;

    use super::*;
    use crate::{evidence::Evidence, span::Span};

    /// A mechanism from some time on, with its score and rank.
    fn weighed(name: &str, from_s: f64, score: f64, rank: f64) -> Weighed {
        let mechanism = mechanism::by_name(name).unwrap();
        let applied = Applied { mechanism, values: vec![0.0], span: Span::EachDrive(from_s) };
        Weighed {
            candidate: Candidate { applied, linear: vec![0], columns: Vec::new() },
            evidence: Evidence::of_one(1.0, 1.0, DMatrix::zeros(0, 1)),
            tried: 1,
            score,
            rank,
            p_value: 1.0,
            is_strong: false,
        }
    }

    #[test]
    fn the_surest_and_the_closest_of_a_mechanism_may_set_in_at_different_times() {
        // From 360 s on, where models miss little, a gain is surer than from 270 s on, where it takes more of the errors.
        let all = [
            weighed("power_scale", 360.0, 137.0, 295.0),
            weighed("power_scale", 270.0, 110.0, 320.0),
            weighed("soft_soil", 270.0, 188.0, 316.0),
        ];
        let best = MEASURES.map(|measure| {
            let mut best = Vec::new();
            all.iter().for_each(|one| take(&mut best, one, measure));
            sort(&mut best, measure);
            best.iter().map(|one| (one.name(), one.candidate.applied.span)).collect::<Vec<_>>()
        });
        let at = Span::EachDrive;
        assert_eq!(best[0], [("soft_soil", at(270.0)), ("power_scale", at(360.0))]);
        assert_eq!(best[1], [("power_scale", at(270.0)), ("soft_soil", at(270.0))]);
    }
}
