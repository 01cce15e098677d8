//! What acts outside the list of mechanisms: a search for terms in recorded quantities, through the same gates.

use rayon::prelude::*;

use crate::{
    Error,
    baseline::Baseline,
    candidates::{self, Family},
    evidence::{Evidence, TOGETHER},
    gates::{LEAST_GAIN_SIGMAS, LEVEL, cosine, passes},
    null::Null,
    report::{EvidenceFigures, Finding, FindingFit, FoundParameter},
    series::{Applied, Series},
    term::{self, Scale, Term},
    weigh::{judged, system_with},
    words,
};

/// Terms that are taken up at most.
const MOST: usize = 3;
/// Cosine from which a term resembles a mechanism.
const ALIKE: f64 = 0.8;

/// A term that was discovered, with its size.
pub(crate) struct Discovered {
    pub(crate) term: Term,
    /// c, in no unit, or in watts where the scale is one watt.
    pub(crate) size: f64,
    /// Half width of its 95 % interval.
    pub(crate) half_width: f64,
    /// Chance of as much, corrected for all that was tried.
    pub(crate) p_value: f64,
    /// Discounted evidence less what the term costs.
    pub(crate) score: f64,
    /// Gain of held-out squared errors, as a share of them.
    pub(crate) held_out_gain: f64,
    /// Power per unit of c, average by average \[W\].
    pub(crate) column_w: Vec<f64>,
    /// The mechanism whose power is most like it, if any is much.
    pub(crate) resembles: Option<&'static str>,
}

/// Half width of a 95 % interval in standard errors.
const NORMAL_95: f64 = 1.96;

/// Terms that explain what is left beside a robot with mechanisms, the strongest first; none where none passes the gates.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn discover(
    series: &Series,
    base: &Baseline,
    applied: &[Applied],
    null: &Null,
) -> Result<Vec<Discovered>, Error> {
    let mut terms = term::all(series.channels());
    // Alone, what the model itself misses would pass for a discovery; what repeats with every turn of the wheels does not.
    if !series.has_healthy() {
        terms.retain(Term::is_turn);
    }
    let columns: Vec<Vec<f64>> =
        terms.par_iter().map(|term| term.column(&base.robot, &series.averages, &base.predicted_w)).collect();
    let library = Library { terms, columns };
    let mut found: Vec<Discovered> = Vec::new();
    while found.len() < MOST {
        let taken: Vec<Vec<f64>> = found.iter().map(|one| one.column_w.clone()).collect();
        // What spectra show comes first, and other terms beside it.
        let is_tried = |term: &Term| series.turning.is_none() || !found.is_empty() || term.is_turn();
        let tried: Vec<usize> = (0..library.terms.len()).filter(|i| is_tried(&library.terms[*i])).collect();
        let Some(next) = strongest(series, base, null, &library, (&tried, &taken)) else { break };
        found.push(next);
    }
    let mechanisms = candidates::all(series, &base.robot, applied, &base.predicted_w)?;
    for one in &mut found {
        one.resembles = resembling(series, base, &one.column_w, &mechanisms);
    }
    Ok(found)
}

/// Terms with their columns.
struct Library {
    terms: Vec<Term>,
    columns: Vec<Vec<f64>>,
}

/// The best term beside those taken that passes every gate.
fn strongest(
    series: &Series,
    base: &Baseline,
    null: &Null,
    Library { terms, columns }: &Library,
    (tried, taken): (&[usize], &[Vec<f64>]),
) -> Option<Discovered> {
    let system = system_with(series, base, taken);
    let white = base.whitening(series);
    let blocks = system.blocks();
    let weighed = tried.par_chunks(TOGETHER).flat_map_iter(|some| {
        let whitened: Vec<Vec<Vec<f64>>> = some.iter().map(|i| vec![white.of(&columns[*i])]).collect();
        system.weigh_all(&whitened).into_iter().zip(some.to_vec())
    });
    let mut weighed: Vec<(f64, f64, usize, Evidence)> = weighed
        .filter_map(|(evidence, i)| {
            let evidence = evidence?;
            let (wald, chance) = judged(&evidence, UNKNOWN, null, blocks)?;
            let p_value = (chance * terms.len() as f64).min(1.0);
            // Each further group is a further choice.
            let cost = (1 + terms[i].groups.len()) as f64 * (blocks as f64).ln();
            Some((wald - cost, p_value, i, evidence))
        })
        .collect();
    weighed.sort_by(|a, b| b.0.total_cmp(&a.0));
    weighed.into_iter().take_while(|(score, ..)| *score > 0.0).find_map(|(score, p_value, i, evidence)| {
        if p_value > LEVEL {
            return None;
        }
        let gain = passes(&system, series, &evidence, (&[white.of(&columns[i])], LEAST_GAIN_SIGMAS))?;
        Some(Discovered {
            term: terms[i].clone(),
            size: evidence.values[0],
            half_width: NORMAL_95 * evidence.covariance[(0, 0)].max(0.0).sqrt(),
            p_value,
            score,
            held_out_gain: gain,
            column_w: columns[i].clone(),
            resembles: None,
        })
    })
}

/// The name that a discovery goes by.
pub(crate) const UNKNOWN: &str = "unknown";

/// The mechanism whose own power is most like a column's.
fn resembling(
    series: &Series,
    base: &Baseline,
    column_w: &[f64],
    mechanisms: &[Family],
) -> Option<&'static str> {
    let system = system_with(series, base, &[]);
    let white = base.whitening(series);
    let own = system.weigh(&[white.of(column_w)])?;
    let rows = series.recorded.len();
    let alike =
        mechanisms.par_iter().flat_map_iter(|family| family.candidates(series)).filter_map(|candidate| {
            let columns: Vec<Vec<f64>> = candidate.columns.iter().map(|column| white.of(column)).collect();
            let other = system.weigh(&columns)?;
            Some((cosine(&own, &other, rows), candidate.applied.mechanism.name()))
        });
    let (most, name) = alike.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (most > ALIKE).then_some(name)
}

impl Discovered {
    /// As the report has it, with held-out errors without and with it \[W\].
    pub(crate) fn finding(&self, series: &Series, [before_w, after_w]: [f64; 2]) -> Finding {
        // The scale of one watt is the unit of c.
        let unit = if self.term.scale == Scale::Watt { "W" } else { "1" };
        let interval_95 = Some([self.size - self.half_width, self.size + self.half_width]);
        Finding {
            mechanism: UNKNOWN.to_owned(),
            statement: words::capital(&self.statement(series)),
            equation: self.term.equation(),
            parameters: vec![FoundParameter { name: "c", value: self.size, unit, interval_95 }],
            evidence: EvidenceFigures {
                p_value: self.p_value,
                delta_bic: self.score,
                held_out_gain: self.held_out_gain,
            },
            indistinguishable_from: Vec::new(),
            fit: FindingFit { held_out_rmse_before_w: before_w, held_out_rmse_after_w: after_w },
        }
    }

    /// The sentence a person reads: what it goes with, how much it is, and where most of it lies.
    fn statement(&self, series: &Series) -> String {
        let counts = |i: &usize| series.averages[*i].suspect && series.is_power(*i);
        let sizes: Vec<f64> =
            (0..self.column_w.len()).filter(counts).map(|i| self.size * self.column_w[i]).collect();
        let mean_w = sizes.iter().sum::<f64>() / sizes.len().max(1) as f64 * series.channels() as f64;
        let more = if mean_w >= 0.0 { "more" } else { "less" };
        let mut text = format!(
            "something outside the list takes {:.1} W {more} on average: {}",
            mean_w.abs(),
            self.term.words()
        );
        if let Some(where_w) = self.regime(series) {
            text += &where_w;
        }
        if let Some(name) = self.resembles {
            text += &format!("; it resembles {}", words::plain(name));
        }
        text
    }

    /// Between which values of its first quantity nine tenths of it lie.
    fn regime(&self, series: &Series) -> Option<String> {
        let (name, of, unit) = self.term.groups.iter().find(|group| !group.is_turn())?.quantity;
        let parts = self.column_w.iter().zip(&series.averages).filter(|(w, a)| **w != 0.0 && a.suspect);
        let mut parts: Vec<(f64, f64)> = parts.map(|(w, a)| (of(a), (self.size * w).powi(2))).collect();
        parts.retain(|(value, _)| value.is_finite());
        parts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let whole: f64 = parts.iter().map(|(_, size)| size).sum();
        let mut sum = 0.0;
        let mut at = |share: f64| {
            sum = 0.0;
            parts.iter().find(|(_, size)| {
                sum += size;
                sum >= share * whole
            })
        };
        let (low, high) = (at(0.05)?.0, at(0.95)?.0);
        Some(format!(", nine tenths of it where {name} is {low:.2} to {high:.2} {unit}"))
    }
}
