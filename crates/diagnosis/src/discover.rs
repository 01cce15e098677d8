//! What acts outside the list of mechanisms: a search for terms in recorded quantities, through the same gates.

use rayon::prelude::*;

use crate::{
    Error,
    baseline::Baseline,
    candidates::{self, Family},
    evidence::{Evidence, System, TOGETHER},
    gates::{LEAST_GAIN_SIGMAS, LEVEL, cosine, passes},
    noise::Whitening,
    null::Null,
    refused::Refused,
    report::{EvidenceFigures, Finding, FindingFit, FoundParameter},
    series::{Applied, Series},
    term::{self, Scale, Term},
    weigh::{judged, system_with},
    words,
};

/// Terms that are taken up at most.
const MOST: usize = 4;
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
    refused: &[Refused],
    null: &Null,
) -> Result<Vec<Discovered>, Error> {
    let of_mechanisms = applied.iter().map(|one| one.span).chain(refused.iter().map(|one| one.span));
    let mut terms = term::all(series.channels(), &term::onsets(series, of_mechanisms));
    // Alone, what the model itself misses would pass for a discovery; what repeats with every turn of the wheels does not.
    if !series.has_healthy() {
        terms.retain(Term::is_turn);
    }
    let library = Library::of(series, base, terms);
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

impl Library {
    fn of(series: &Series, base: &Baseline, terms: Vec<Term>) -> Self {
        let column = |term: &Term| term.column(&base.robot, &series.averages, &base.predicted_w);
        let columns = terms.par_iter().map(column).collect();
        Library { terms, columns }
    }
}

/// A term that was weighed.
struct Weighed {
    /// Which of its library.
    which: usize,
    evidence: Evidence,
    /// Discounted evidence less what its choices cost.
    score: f64,
    p_value: f64,
}

/// The best term beside those taken that passes every gate.
fn strongest(
    series: &Series,
    base: &Baseline,
    null: &Null,
    library: &Library,
    (tried, taken): (&[usize], &[Vec<f64>]),
) -> Option<Discovered> {
    let system = system_with(series, base, taken);
    let white = base.whitening(series);
    let weighed = weigh(&system, &white, null, (library, tried, library.terms.len()));
    let told = weighed.into_iter().take_while(|one| one.score > 0.0).filter(|one| one.p_value <= LEVEL);
    let passed = |library: &Library, one: &Weighed| {
        let columns = [white.of(&library.columns[one.which])];
        passes(&system, series, &one.evidence, (&columns, LEAST_GAIN_SIGMAS))
    };
    let (first, gain) = told.into_iter().find_map(|one| passed(library, &one).map(|gain| (one, gain)))?;
    // Since when it acts is looked for about the time that was tried.
    let around = around(series, &library.terms[first.which]);
    let all: Vec<usize> = (0..around.len()).collect();
    let around = Library::of(series, base, around);
    let closer = weigh(&system, &white, null, (&around, &all, library.terms.len()));
    let closer = closer.into_iter().next().filter(|one| one.score > first.score);
    let closer = closer.and_then(|one| passed(&around, &one).map(|gain| (&around, one, gain)));
    let (library, Weighed { which, evidence, score, p_value }, held_out_gain) =
        closer.unwrap_or((library, first, gain));
    Some(Discovered {
        term: library.terms[which].clone(),
        size: evidence.values[0],
        half_width: NORMAL_95 * evidence.covariance[(0, 0)].max(0.0).sqrt(),
        p_value,
        score,
        held_out_gain,
        column_w: library.columns[which].clone(),
        resembles: None,
    })
}

/// Terms of a library, the best first; `choices` is among how many they were chosen.
fn weigh(
    system: &System,
    white: &Whitening,
    null: &Null,
    (library, tried, choices): (&Library, &[usize], usize),
) -> Vec<Weighed> {
    let blocks = system.blocks();
    let evidences = tried.par_chunks(TOGETHER).flat_map_iter(|some| {
        let whitened: Vec<Vec<Vec<f64>>> =
            some.iter().map(|i| vec![white.of(&library.columns[*i])]).collect();
        system.weigh_all(&whitened).into_iter().zip(some.to_vec())
    });
    let weighed = evidences.filter_map(|(evidence, which)| {
        let evidence = evidence?;
        let (wald, chance) = judged(&evidence, UNKNOWN, null, blocks)?;
        let cost = library.terms[which].choices() as f64 * (blocks as f64).ln();
        let p_value = (chance * choices as f64).min(1.0);
        Some(Weighed { which, evidence, score: wald - cost, p_value })
    });
    let mut weighed: Vec<Weighed> = weighed.collect();
    weighed.sort_by(|a, b| b.score.total_cmp(&a.score));
    weighed
}

/// Times that are looked at on each side of a first guess, and how far apart they lie [s].
const STEPS: i32 = 9;
const STEP_S: f64 = 10.0;

/// A term from other times on; none of one that always acts.
fn around(series: &Series, term: &Term) -> Vec<Term> {
    let line = series.timeline();
    if term.span.is_all() {
        return Vec::new();
    }
    let guess_s = line.driven_s(term.span);
    let times_s = (-STEPS..=STEPS).map(|step| guess_s + STEP_S * f64::from(step));
    let within = times_s.filter(|driven_s| *driven_s > 0.0 && *driven_s < line.total_s());
    within.map(|driven_s| Term { span: line.at(driven_s), ..term.clone() }).collect()
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
        let mut parameters = vec![FoundParameter { name: "c", value: self.size, unit, interval_95 }];
        let bounds = series.bounds(self.term.span).into_iter();
        parameters.extend(bounds.map(|(name, value, unit)| FoundParameter {
            name,
            value,
            unit,
            interval_95: None,
        }));
        Finding {
            mechanism: UNKNOWN.to_owned(),
            statement: words::capital(&self.statement(series)),
            equation: self.term.equation(),
            parameters,
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
        if !self.term.span.is_all() {
            text += &format!(", {}", self.term.span.words(&series.names));
        }
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
