//! What acts outside the list of mechanisms: a search for terms in recorded quantities, through the same gates.

use rayon::prelude::*;

use crate::{
    Error,
    baseline::Baseline,
    candidates::{self, Family},
    discovered::{Discovered, UNKNOWN},
    everywhere,
    evidence::{Evidence, System},
    gates::{LEVEL, cosine, passes, spread},
    noise::Whitening,
    null::Null,
    ranked::ranked,
    refused::Refused,
    search::TOLD,
    series::{Applied, Series},
    term::{self, Scale, Term},
    weigh::{judged, share, speaking, system_with},
    widths::NORMAL_975,
};

/// Terms that are taken up at most.
const MOST: usize = 4;
/// Terms that are judged, of those that explain most.
const MOST_JUDGED: usize = 500;
/// Standard errors by which a term's fit of blocks that were held out has to gain: one side's 5 %. Water in hollows gains by less than 2.5.
const LEAST_GAIN_OF_A_TERM_SIGMAS: f64 = 1.64;
/// Blocks over which a term is spread at least: one that fades over a minute is over three.
const LEAST_SPREAD: f64 = 2.5;
/// How many times surer a term that goes with the heading has to be: lanes of a field each have one heading and lie elsewhere, and what
/// models miss of their ground goes with it.
const OF_HEADING: f64 = 10.0;
/// Cosine from which a term resembles a mechanism.
const ALIKE: f64 = 0.8;

/// How sure a first term has to be, by the chance of as much corrected for all that was tried: as every candidate where mechanisms leave
/// something, and a hundred times surer where they leave nothing that is more than usual. Drag that was dealt anew against its inputs, so
/// that nothing goes with any of them, shows a term by chance with less.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sure {
    AsUsual,
    Very,
}

impl Sure {
    /// Largest chance that is sure enough.
    pub(crate) fn level(self) -> f64 {
        match self {
            Sure::AsUsual => LEVEL,
            Sure::Very => LEVEL / 100.0,
        }
    }
}

/// Terms that explain what is left beside a robot with mechanisms, the strongest first; none where none passes the gates.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn discover(
    series: &Series,
    base: &Baseline,
    applied: &[Applied],
    refused: &[Refused],
    (null, first): (&Null, Sure),
) -> Result<Vec<Discovered>, Error> {
    let of_mechanisms = applied.iter().map(|one| one.span).chain(refused.iter().map(|one| one.span));
    let mut terms = term::of_drives(series, &base.robot, of_mechanisms);
    // Alone, what the model itself misses would pass for a discovery; what repeats with every turn of the wheels does not.
    if !series.has_healthy() {
        terms.retain(Term::is_turn);
    }
    let mut found: Vec<Discovered> = Vec::new();
    while found.len() < MOST {
        let taken: Vec<Vec<f64>> = found.iter().map(|one| one.column_w.clone()).collect();
        // What spectra show comes first, and other terms beside it.
        let is_tried = |term: &&Term| series.turning.is_none() || !found.is_empty() || term.is_turn();
        let tried: Vec<&Term> = terms.iter().filter(is_tried).collect();
        let sure = if found.is_empty() && series.turning.is_none() { first } else { Sure::AsUsual };
        let beside = Beside::new(series, base, null, &taken, (Choices::of(&terms), sure));
        let Some(next) = beside.strongest(&tried) else { break };
        found.push(next);
    }
    let mechanisms = candidates::all(series, &base.robot, applied, &base.predicted_w)?;
    for one in &mut found {
        one.resembles = resembling(series, base, &one.column_w, &mechanisms);
    }
    Ok(found)
}

/// What a term is weighed beside.
struct Beside<'a> {
    series: &'a Series,
    base: &'a Baseline,
    null: &'a Null,
    system: System,
    white: Whitening,
    /// Among how many terms one is chosen.
    choices: Choices,
    /// How sure what passes has to be at last.
    sure: Sure,
}

/// How many terms are tried that go with one quantity at most and always act, and how many others.
#[derive(Clone, Copy)]
struct Choices {
    plain: usize,
    others: usize,
}

impl Choices {
    fn of(terms: &[Term]) -> Self {
        let plain = terms.iter().filter(|term| term.is_plain()).count();
        Choices { plain, others: terms.len() - plain }
    }

    /// By what a term's chance is multiplied: plain ones, of which there are few, have half of the chance that one of all is found where
    /// nothing acts, as mechanisms that always act have half of theirs.
    fn correction(self, term: &Term) -> f64 {
        let (alike, rest) =
            if term.is_plain() { (self.plain, self.others) } else { (self.others, self.plain) };
        let halves = if rest == 0 { 1.0 } else { 2.0 };
        halves * alike.max(1) as f64
    }
}

/// A term that was weighed and told.
struct Told<'a> {
    term: &'a Term,
    evidence: Evidence,
    /// Discounted evidence less what its choices cost.
    score: f64,
    /// Squared errors that it takes, with one discount for all, less what its choices cost: by this terms are held against each other.
    rank: f64,
    p_value: f64,
}

impl Told<'_> {
    /// Whether it is so sure that it alone tells that something acts.
    fn tells(&self, sure: Sure) -> bool {
        let surer = if self.term.is_of_heading() { OF_HEADING } else { 1.0 };
        self.term.scale != Scale::Moment && self.p_value <= sure.level() / surer
    }
}

impl<'a> Beside<'a> {
    fn new(
        series: &'a Series,
        base: &'a Baseline,
        null: &'a Null,
        taken: &[Vec<f64>],
        (choices, sure): (Choices, Sure),
    ) -> Self {
        let (system, white) = (system_with(series, base, taken), base.whitening(series));
        Beside { series, base, null, system, white, choices, sure }
    }

    /// What passes every gate and explains most, if what passes is sure enough.
    ///
    /// That something acts is known from whatever is sure, which may follow it here and there only; what it is, from what explains most. A
    /// moment is no evidence that something acts: drives turn for seconds only, in which it goes with all that the model misses of turns.
    fn strongest(&self, tried: &[&Term]) -> Option<Discovered> {
        let told = self.told(tried);
        if !is_told(&told, self.sure, |one| self.gain(one).is_some()) {
            return None;
        }
        let (mut best, mut held_out_gain) = self.closest(told)?;
        // Since when it acts, and what else it goes with, is looked for about what was tried.
        let mut near = [around(self.series, best.term), best.term.with_one_more()];
        near[1].retain(|term| term.is_reached(self.series, &self.base.robot));
        for near in &near {
            let closer = self.closest(self.told(&near.iter().collect::<Vec<_>>()));
            if let Some((closer, gain)) = closer.filter(|(closer, _)| closer.rank > best.rank) {
                (best, held_out_gain) = (closer, gain);
            }
        }
        let (size, column_w) = (best.evidence.values[0], self.column_w(best.term));
        let change_w: Vec<f64> = column_w.iter().map(|w| size * w).collect();
        // However surely long drives tell it: that little a model may miss.
        if self.sure == Sure::Very && share(self.series, self.base, &change_w) < TOLD {
            return None;
        }
        Some(Discovered {
            term: best.term.clone(),
            size,
            half_width: NORMAL_975 * best.evidence.covariance[(0, 0)].max(0.0).sqrt(),
            p_value: best.p_value,
            score: best.score,
            held_out_gain,
            column_w,
            resembles: None,
        })
    }

    /// Of some terms, what passes every gate and explains most, with its gain on held-out blocks.
    fn closest<'b>(&self, mut told: Vec<Told<'b>>) -> Option<(Told<'b>, f64)> {
        told.sort_by(|a, b| b.rank.total_cmp(&a.rank));
        told.into_iter().find_map(|one| self.gain(&one).map(|gain| (one, gain)))
    }

    /// Of the terms that explain most, those that are sure enough; the surest first.
    fn told<'b>(&self, tried: &[&'b Term]) -> Vec<Told<'b>> {
        let ranked = ranked(self.series, self.base, (&self.system, self.null), tried);
        let most: Vec<(f64, &Term)> =
            ranked.into_iter().take_while(|(rank, _)| *rank > 0.0).take(MOST_JUDGED).collect();
        let pair = |term: &Term| everywhere::of_term(self.series, self.base, term).map(|c| self.white.of(&c));
        let judged = most.par_chunks(self.system.together()).flat_map_iter(|some| {
            let pairs: Vec<[Vec<f64>; 2]> = some.iter().map(|(_, term)| pair(term)).collect();
            let evidences = self.system.weigh_beyond(&pairs).into_iter().zip(some);
            evidences.filter_map(|(evidence, of)| self.judged(evidence?, *of)).collect::<Vec<_>>()
        });
        let mut told: Vec<Told<'b>> = judged.collect();
        told.sort_by(|a, b| b.score.total_cmp(&a.score));
        told
    }

    fn judged<'b>(&self, evidence: Evidence, (rank, term): (f64, &'b Term)) -> Option<Told<'b>> {
        let blocks = self.system.blocks();
        // What a term leaves hangs together by its form, which was not chosen for it, and is no reason to doubt it where much is left.
        let is_doubtful = self.sure == Sure::Very && !term.span.is_all();
        let lasting = if is_doubtful { evidence.lasting } else { 1.0 };
        let speaking = if is_doubtful { speaking(&evidence, term.span, blocks) } else { blocks as f64 };
        let evidence = Evidence { lasting, ..evidence };
        let (wald, chance) = judged(&evidence, UNKNOWN, self.null, (blocks, speaking))?;
        let score = wald - term.choices() as f64 * (blocks as f64).ln();
        let p_value = (chance * self.choices.correction(term)).min(1.0);
        (score > 0.0 && p_value <= LEVEL).then_some(Told { term, evidence, score, rank, p_value })
    }

    fn column_w(&self, term: &Term) -> Vec<f64> {
        term.column(&self.base.driven(self.series))
    }

    /// The gain on held-out blocks, if it passes and is spread over some: of what one block holds there is nothing to compare it with.
    fn gain(&self, one: &Told<'_>) -> Option<f64> {
        let columns = [self.white.of(&self.column_w(one.term))];
        if spread(&self.system, self.series, &one.evidence, &columns[0]) < LEAST_SPREAD {
            return None;
        }
        passes(&self.system, self.series, &one.evidence, (&columns, LEAST_GAIN_OF_A_TERM_SIGMAS))
    }
}

/// Whether any term that gains on held-out blocks is sure that something acts, whatever others score more.
fn is_told(told: &[Told<'_>], sure: Sure, gains: impl Fn(&Told<'_>) -> bool) -> bool {
    told.iter().any(|one| one.tells(sure) && gains(one))
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

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::{group::GROUPS, span::Span, term::On};

    fn term(scale: Scale, symbol: &str) -> Term {
        let groups = GROUPS.iter().filter(|group| group.symbol == symbol).collect();
        Term { scale, groups, on: On::Both, span: Span::ALL }
    }

    fn told(term: &Term, score: f64, p_value: f64) -> Told<'_> {
        let evidence = Evidence::of_one(1.0, 1.0, DMatrix::zeros(0, 1));
        Told { term, evidence, score, rank: 0.0, p_value }
    }

    #[test]
    fn headings_have_to_be_surer_and_moments_tell_nothing() {
        let tells = |scale: Scale, symbol: &str, p_value: f64| {
            let term = term(scale, symbol);
            [Sure::AsUsual, Sure::Very].map(|sure| told(&term, 0.0, p_value).tells(sure))
        };
        assert_eq!(tells(Scale::Force, "|v|/u_max", 1e-3), [true, false]);
        assert_eq!(tells(Scale::Force, "|v|/u_max", 1e-5), [true, true]);
        // Lanes have one heading each, and a moment goes with all that models miss of turns.
        assert_eq!(tells(Scale::Force, "cos ψ", 5e-3), [false, false]);
        assert_eq!(tells(Scale::Force, "cos ψ", 5e-6), [true, true]);
        assert_eq!(tells(Scale::Moment, "|v|/u_max", 1e-9), [false, false]);
    }

    #[test]
    fn what_is_sure_tells_that_something_acts_whatever_else_scores_more() {
        let speed = term(Scale::Force, "|v|/u_max");
        // Of what fewer blocks tell, more is less sure.
        let both = [told(&speed, 66.0, 9.6e-4), told(&speed, 63.8, 1.1e-10)];
        assert!(is_told(&both, Sure::Very, |_| true));
        assert!(!is_told(&both[..1], Sure::Very, |_| true) && is_told(&both[..1], Sure::AsUsual, |_| true));
        assert!(!is_told(&both, Sure::Very, |one| one.score > 65.0), "what is sure does not gain");
    }
}
