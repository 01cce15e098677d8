//! Every candidate weighed beside everything that is fitted whatever the candidate.

mod systems;

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::{
    baseline::Baseline,
    candidates::{self, Candidate, Family},
    evidence::{Evidence, System},
    noise::Whitening,
    null::Null,
    plausible::is_plausible,
    series::{Applied, Look, Series},
    span::Span,
};

pub(crate) use systems::{
    BLOCK_S, Sizes, blocks, left, system, system_at, system_in_place, system_of, system_with, undelayed,
};

/// A candidate with what it explains.
#[derive(Clone)]
pub(crate) struct Weighed {
    pub(crate) candidate: Candidate,
    pub(crate) evidence: Evidence,
    /// How many of its mechanism were tried.
    pub(crate) tried: u32,
    /// Discounted evidence less what its parameters cost.
    pub(crate) score: f64,
    /// Squared errors that it takes, with one discount for all mechanisms, less what its parameters cost: by this they are held
    /// against each other.
    pub(crate) rank: f64,
    /// Chance of as much, corrected for all that was tried.
    pub(crate) p_value: f64,
    /// Whether it changes power by more than what models miss.
    pub(crate) is_strong: bool,
}

impl Weighed {
    /// Whose it is.
    pub(crate) fn name(&self) -> &'static str {
        name(&self.candidate)
    }

    /// Whether another is of the same mechanism, and in places only as it is or is not.
    pub(crate) fn is_like(&self, other: &Weighed) -> bool {
        self.name() == other.name() && self.is_in_place() == other.is_in_place()
    }

    /// Whether it acts in a part of the ground only.
    pub(crate) fn is_in_place(&self) -> bool {
        matches!(self.candidate.applied.span, Span::Within(_))
    }

    /// It in another part of the drives, with the evidence there.
    pub(crate) fn moved_to(&self, candidate: Candidate, evidence: Evidence, discount: f64) -> Weighed {
        let more = |of: fn(&Evidence) -> f64| (of(&evidence) - of(&self.evidence)) / discount;
        let (score, rank) = (self.score + more(|e| e.wald), self.rank + more(|e| e.explained));
        let Weighed { tried, p_value, is_strong, .. } = *self;
        Weighed { candidate, evidence, tried, score, rank, p_value, is_strong }
    }

    /// It with values of its linear parameters, within what a robot can have.
    pub(crate) fn at(&self, base: &Baseline, values: &[f64]) -> Applied {
        candidates::moved(&self.candidate.applied, &base.robot, &self.candidate.linear, values)
    }
}

fn name(candidate: &Candidate) -> &'static str {
    candidate.applied.mechanism.name()
}

/// Whether it has values that power does not follow in proportion, at some point of their grid.
fn is_from_grid(candidate: &Candidate) -> bool {
    let values = candidate.applied.values.iter().enumerate();
    values.into_iter().any(|(i, value)| *value != 0.0 && !candidate.linear.contains(&i))
}

/// What candidates are weighed on.
pub(crate) struct Scales<'a> {
    series: &'a Series,
    base: &'a Baseline,
    null: &'a Null,
    white: Whitening,
    all_fitted: System,
    delay_apart: System,
    /// How many were tried of each mechanism.
    tried: BTreeMap<&'static str, Tried>,
}

/// How many candidates of a mechanism were tried: that always act, and that do in a part of the drives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Tried {
    always: u32,
    in_part: u32,
}

impl Tried {
    fn all(self) -> u32 {
        self.always + self.in_part
    }

    /// By what the chance of one candidate is multiplied, of so many mechanisms: each mechanism has the same share of the chance that
    /// one of all is taken up where nothing acts, and what acts all the time has half of it (a weighted Bonferroni correction: Genovese,
    /// Roeder and Wasserman, Biometrika 93, 2006).
    fn correction(self, is_always: bool, mechanisms: usize) -> f64 {
        let (alike, others) =
            if is_always { (self.always, self.in_part) } else { (self.in_part, self.always) };
        let halves = if others == 0 { 1.0 } else { 2.0 };
        mechanisms as f64 * halves * f64::from(alike)
    }
}

impl<'a> Scales<'a> {
    pub(crate) fn new(series: &'a Series, base: &'a Baseline, null: &'a Null, families: &[Family]) -> Self {
        let mut tried: BTreeMap<&'static str, Tried> = BTreeMap::new();
        for family in families {
            let of = tried.entry(family.name()).or_default();
            let always = family.always_count() as u32;
            of.always += always;
            of.in_part += family.count() as u32 - always;
        }
        Scales {
            series,
            base,
            null,
            white: base.whitening(series),
            all_fitted: system(series, base),
            delay_apart: undelayed(series, base),
            tried,
        }
    }

    /// Number of blocks.
    pub(crate) fn blocks(&self) -> usize {
        self.all_fitted.blocks()
    }

    /// How many candidates are best weighed in one go.
    pub(crate) fn together(&self) -> usize {
        self.all_fitted.together()
    }

    /// What candidates of one mechanism explain, each by itself.
    pub(crate) fn weigh_all(&self, candidates: Vec<Candidate>) -> Vec<Option<Weighed>> {
        let is_delay = candidates.iter().any(|one| name(one) == "clock_offset");
        let system = if is_delay { &self.delay_apart } else { &self.all_fitted };
        let white = |one: &Candidate| one.columns.iter().map(|c| self.white.of(c)).collect();
        let whitened: Vec<Vec<Vec<f64>>> = candidates.iter().map(white).collect();
        let evidence = system.weigh_all(&whitened).into_iter().zip(candidates);
        evidence.map(|(evidence, one)| self.judge(one, evidence?)).collect()
    }

    /// What a candidate explains; `None` where that is nothing, or more than can be.
    pub(crate) fn weigh(&self, candidate: Candidate) -> Option<Weighed> {
        self.weigh_all(vec![candidate]).pop().flatten()
    }

    /// A candidate with its evidence; `None` where that is more than can be.
    fn judge(&self, candidate: Candidate, mut evidence: Evidence) -> Option<Weighed> {
        let is_strong = share(self.series, self.base, &candidate.effect_w(&evidence.values)) > STRONG;
        evidence.discord = counted(evidence.discord, &candidate, (self.series.look, is_strong));
        if !is_plausible(&self.base.robot, &candidate, &evidence, self.series.row_s()) {
            return None;
        }
        let blocks = self.all_fitted.blocks();
        let speaking = speaking(&evidence, candidate.applied.span, blocks);
        let (wald, chance) = judged(&evidence, name(&candidate), self.null, (blocks, speaking))?;
        let cost = candidate.numbers() as f64 * (blocks as f64).ln();
        let rank = evidence.explained / self.null.common_discount(blocks) - cost;
        let tried = self.tried.get(name(&candidate)).copied().unwrap_or_default();
        let correction = tried.correction(candidate.applied.span.is_all(), self.tried.len());
        Some(Weighed {
            candidate,
            evidence,
            tried: tried.all(),
            score: wald - cost,
            rank,
            p_value: (chance * correction).min(1.0),
            is_strong,
        })
    }
}

/// A change of power over the power, both root mean square over the suspect drives.
pub(crate) fn share(series: &Series, base: &Baseline, effect_w: &[f64]) -> f64 {
    let (mut change, mut whole) = (0.0, 0.0);
    for (i, (predicted_w, effect_w)) in base.predicted_w.iter().zip(effect_w).enumerate() {
        if series.is_power(i) && series.averages[i].suspect {
            change += effect_w * effect_w;
            whole += predicted_w * predicted_w;
        }
    }
    f64::sqrt(change / whole.max(1e-300))
}

/// What counts of a scatter from regime to regime. A value of the grid is not the true one, and what that changes differs between regimes;
/// so does what is strong, which is not in proportion to its size, and more than models miss.
fn counted(discord: f64, candidate: &Candidate, (look, is_strong): (Look, bool)) -> f64 {
    match look {
        _ if is_strong || is_from_grid(candidate) => 1.0,
        Look::Usual => discord,
        Look::Closer => shrunk(discord),
    }
}

/// A scatter from regime to regime where nothing strong is missing: three regimes tell it no closer than its own size, so that it counts
/// half, as next to as many that agree.
fn shrunk(discord: f64) -> f64 {
    f64::midpoint(1.0, discord)
}

/// Changes of power beyond this share of it are not what a model misses of a robot in order.
const STRONG: f64 = 0.05;

/// How many blocks tell how far evidence scatters: of what acts in a part of the drives those among which it is spread, as few tell it but
/// roughly (Bell and McCaffrey, Survey Methodology 28, 2002), and the part that looks best is one of many.
pub(crate) fn speaking(evidence: &Evidence, span: Span, blocks: usize) -> f64 {
    if span.is_all() { blocks as f64 } else { evidence.spread.max(LEAST_SPEAKING).min(blocks as f64) }
}

/// Blocks that speak at least: a brake that binds for half a minute is in two, ten times as far off as any other, and all others tell that.
const LEAST_SPEAKING: f64 = 20.0;

/// Evidence beyond what models miss of healthy drives, of which so many blocks speak, and the chance of as much.
pub(crate) fn judged(
    evidence: &Evidence,
    name: &str,
    null: &Null,
    (blocks, speaking): (usize, f64),
) -> Option<(f64, f64)> {
    let parameters = evidence.values.len();
    let freedom = (speaking - parameters as f64 - 1.0).max(2.0);
    let wald = match null.variance(name, parameters) {
        Some(misfit_variance) => beyond(evidence, misfit_variance)?,
        None => evidence.wald / null.discount(name, blocks),
    };
    let (wald, count) = (wald / evidence.scatter(), parameters as f64);
    Some((wald, FisherSnedecor::new(count, freedom).ok()?.sf(wald / count)))
}

/// How many standard errors values are from nothing, squared, where misfit adds to their variance.
fn beyond(evidence: &Evidence, misfit_variance: Vec<f64>) -> Option<f64> {
    let values = DVector::from_column_slice(&evidence.values);
    let covariance = &evidence.covariance + DMatrix::from_diagonal(&DVector::from_vec(misfit_variance));
    Some(values.dot(&(covariance.try_inverse()? * &values)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chances_of_all_that_is_tried_add_up_to_one_and_what_always_acts_has_half_of_each_mechanisms() {
        let tried = [
            Tried { always: 1, in_part: 9 },
            Tried { always: 25, in_part: 225 },
            Tried { always: 6, in_part: 0 },
            Tried { always: 0, in_part: 9 },
        ];
        let shares = tried.map(|one| {
            let of = |count: u32, is_always| match count {
                0 => 0.0,
                _ => f64::from(count) / one.correction(is_always, tried.len()),
            };
            [of(one.always, true), of(one.in_part, false)]
        });
        assert!((shares.as_flattened().iter().sum::<f64>() - 1.0).abs() < 1e-12, "{shares:?}");
        assert_eq!(shares[0], shares[1]);
        assert_eq!(shares[0], [0.125, 0.125]);
        assert_eq!(shares[2], [0.25, 0.0]);
    }

    #[test]
    fn few_blocks_of_a_part_of_the_drives_tell_less_than_as_much_all_the_time() {
        let evidence = Evidence { spread: 20.0, ..Evidence::of_one(5.0, 1.0, DMatrix::zeros(0, 1)) };
        let chance = |evidence: &Evidence, span: Span| {
            let speaking = speaking(evidence, span, 100);
            judged(evidence, "payload", &Null::default(), (100, speaking)).unwrap().1
        };
        // Tables of F(1, 98) and F(1, 18).
        assert!(
            (chance(&evidence, Span::ALL) / 2.5e-6 - 1.0).abs() < 0.1,
            "{}",
            chance(&evidence, Span::ALL)
        );
        let in_part = Span::EachDrive(300.0);
        assert!((chance(&evidence, in_part) / 9.3e-5 - 1.0).abs() < 0.1, "{}", chance(&evidence, in_part));
        // Errors that hang together are so much less evidence.
        let lasting = Evidence { lasting: 2.0, ..evidence };
        assert!(chance(&lasting, Span::ALL) > 1e-4);
    }

    #[test]
    fn the_scatter_of_what_is_strong_or_from_a_grid_does_not_count() {
        let candidate = |name: &str, values: Vec<f64>| {
            let mechanism = model::mechanism::by_name(name).unwrap();
            let applied = Applied { mechanism, values, span: Span::ALL };
            Candidate { applied, linear: vec![0], columns: Vec::new() }
        };
        let load = candidate("payload", vec![1.0]);
        let warm = candidate("motor_heating", vec![1.0, 600.0]);
        assert_eq!(counted(3.0, &load, (Look::Usual, false)), 3.0);
        assert_eq!(counted(3.0, &load, (Look::Closer, false)), 2.0);
        assert_eq!(counted(3.0, &load, (Look::Usual, true)), 1.0);
        assert_eq!(counted(3.0, &warm, (Look::Usual, false)), 1.0);
    }

    #[test]
    fn a_scatter_that_three_regimes_tell_counts_half() {
        assert_eq!([1.0, 2.0, 5.0].map(shrunk), [1.0, 1.5, 3.0]);
    }
}
