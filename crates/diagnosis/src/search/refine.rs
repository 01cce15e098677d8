//! Refits of the leading sets, their windows moved, their subsets compared, and the unlisted class beside them.

use std::{collections::BTreeMap, sync::Arc};

use rayon::prelude::*;

use crate::{
    Error, Span,
    fit::{
        joint::{Fitted, Joint},
        member::Member,
    },
    hypothesis::{
        unlisted::{self, Block},
        window::Grid,
    },
    observe::observations::Observations,
    search::{
        explanation::{Explanation, change_share, counted, log_prior, normalise},
        fits::{Fits, Kept, Names},
        screen::{Scored, Screen},
    },
};

/// Names whose best candidates are refitted alone, in pairs and in threes: each asks the forward model anew for every size.
const SINGLES: usize = 9;
const PAIRS: usize = 8;
const TRIPLES: usize = 3;
/// Singles that pairs are grown from, and pairs that threes are grown from: columns alone, which cost little.
const PAIR_SEEDS: usize = 12;
const TRIPLE_SEEDS: usize = 3;
/// Singles beside which something unlisted is tried, beside nothing also: each takes all blocks at all amplitudes.
const UNLISTED_BESIDE: usize = 4;
/// Log odds behind the best beyond which a set is not refitted: odds of 10¹⁷ to 1.
const HOPELESS: f64 = 40.0;
/// Log odds behind the best of its size beyond which windows of a set are not moved: odds of 160 000 to 1.
const BEHIND: f64 = 12.0;
/// Moves of a window's edge that are tried, as shares of a piece of the grid.
const EDGE_MOVES: [f64; 4] = [-0.5, 0.5, -0.25, 0.25];

/// A search over sets of mechanisms.
pub(crate) struct Search<'a> {
    /// The model.
    pub(crate) joint: &'a Joint<'a>,
    /// Candidates.
    pub(crate) screen: &'a Screen<'a>,
    /// Windows.
    pub(crate) grid: &'a Grid,
    /// What lies outside the list.
    pub(crate) blocks: &'a [Block],
    /// Share of power that the model misses.
    pub(crate) missed: f64,
}

impl Search<'_> {
    /// The posterior over explanations, likeliest first.
    ///
    /// # Errors
    /// A surface that the robot does not know; a watch that breaks.
    pub(crate) fn posterior(&self) -> Result<Vec<Explanation>, Error> {
        let mut fits = Fits::default();
        fits.keep(Vec::new(), Kept { fitted: self.joint.fit(&[])?.into(), spread: 0.0 });
        let all = self.screen.singles();
        let singles = self.screen.by_names(&all);
        self.refit(&singles, SINGLES, &mut fits)?;
        let pairs = self.grown(singles.iter().take(PAIR_SEEDS).map(|one| &one.1), &all)?;
        self.refit(&pairs, PAIRS, &mut fits)?;
        let triples = self.grown(pairs.iter().take(TRIPLE_SEEDS).map(|one| &one.1), &all)?;
        self.refit(&triples, TRIPLES, &mut fits)?;
        self.fit_subsets(&mut fits)?;
        Ok(self.explanations(&fits))
    }

    /// Fits the first of some ranked sets in full.
    fn refit(&self, ranked: &[(Names, Scored, f64)], most: usize, fits: &mut Fits) -> Result<(), Error> {
        let best = ranked.first().map_or(0.0, |one| one.1.log);
        let hopeful: Vec<_> = ranked.iter().take(most).filter(|one| one.1.log > best - HOPELESS).collect();
        let fit = |one: &&(Names, Scored, f64)| self.joint.fit(&self.screen.members(&one.1.set));
        let fitted: Vec<Fitted> = hopeful.par_iter().map(fit).collect::<Result<_, Error>>()?;
        let best = fitted.iter().map(|fitted| fitted.log).fold(f64::NEG_INFINITY, f64::max);
        let moved = |fitted: Fitted| {
            if fitted.log > best - BEHIND { self.with_moved_edges(fitted) } else { Ok(fitted) }
        };
        let fitted: Vec<Fitted> = fitted.into_par_iter().map(moved).collect::<Result<_, Error>>()?;
        for ((names, _, spread), fitted) in hopeful.into_iter().zip(fitted) {
            fits.keep(names.clone(), Kept { fitted: fitted.into(), spread: *spread });
        }
        Ok(())
    }

    /// Sets with one candidate more, by names.
    fn grown<'s>(
        &self,
        sets: impl Iterator<Item = &'s Scored>,
        singles: &[Scored],
    ) -> Result<Vec<(Names, Scored, f64)>, Error> {
        let mut seen = std::collections::BTreeSet::new();
        let mut all = Vec::new();
        for scored in sets {
            self.joint.observed.go_on()?;
            all.extend(self.screen.grown(&scored.set, singles));
        }
        let is_new = |one: &Scored| {
            let mut set = one.set.clone();
            set.sort_unstable();
            seen.insert(set)
        };
        let all: Vec<Scored> = all.into_iter().filter(is_new).collect();
        Ok(self.screen.by_names(&all))
    }

    /// Fits the subsets of every leading set from where it ended: a good pair must not beat a single that is stuck elsewhere. Subsets that
    /// differ in where their sizes begin end at the same ones, and are fitted once.
    fn fit_subsets(&self, fits: &mut Fits) -> Result<(), Error> {
        for size in [3, 2] {
            let mut parts: Vec<(Vec<Member>, f64)> = Vec::new();
            for kept in fits.leading(size, BEHIND) {
                for without in 0..size {
                    let mut members = kept.fitted.members.clone();
                    members.remove(without);
                    members.sort_by_key(|member| member.mechanism.name());
                    let alike = |part: &&mut (Vec<Member>, f64)| {
                        part.0.iter().zip(&members).all(|(a, b)| a.differs_in_size_only(b))
                    };
                    match parts.iter_mut().find(alike) {
                        Some((_, spread)) => *spread = spread.max(kept.spread),
                        None => parts.push((members, kept.spread)),
                    }
                }
            }
            let fit = |(members, spread): &(Vec<Member>, f64)| {
                Ok((names(members), Kept { fitted: self.joint.fit(members)?.into(), spread: *spread }))
            };
            let fitted: Vec<(Names, Kept)> = parts.par_iter().map(fit).collect::<Result<_, Error>>()?;
            fitted.into_iter().for_each(|(names, kept)| fits.keep(names, kept));
        }
        Ok(())
    }

    /// A fit with each onset or end moved to where it explains most.
    fn with_moved_edges(&self, mut fitted: Fitted) -> Result<Fitted, Error> {
        let piece_s = self.joint.observed.total_s() / self.grid.pieces() as f64;
        for m in 0..fitted.members.len() {
            let span = fitted.members[m].span;
            let moves = EDGE_MOVES
                .iter()
                .filter_map(|share| moved(self.grid, self.joint.observed, span, share * piece_s));
            let spans: Vec<Span> = std::iter::once(span).chain(moves).collect();
            if spans.len() == 1 {
                continue;
            }
            let logs = self.joint.in_spans(&fitted.members, m, &spans)?;
            let best = (1..spans.len()).max_by(|a, b| logs[*a].total_cmp(&logs[*b])).unwrap_or(0);
            if logs[best] <= logs[0] {
                continue;
            }
            let mut members: Vec<Member> = fitted.members.clone();
            members[m].span = spans[best];
            let next = self.joint.fit(&members)?;
            if next.log > fitted.log {
                fitted = next;
            }
        }
        Ok(fitted)
    }

    /// All explanations with their posterior.
    fn explanations(&self, fits: &Fits) -> Vec<Explanation> {
        let counted = self.counted(fits);
        let listed = |(names, log): (&Names, &f64)| Explanation {
            names: names.clone(),
            unlisted: false,
            log: log + log_prior(names.len(), false),
            fitted: fits.get(names).map(|kept| kept.fitted.clone()),
            block: None,
            probability: 0.0,
        };
        let mut all: Vec<Explanation> = counted.iter().map(listed).collect();
        let mut singles: Vec<(&Names, f64)> =
            counted.iter().filter(|(names, _)| names.len() <= 1).map(|(names, log)| (names, *log)).collect();
        singles.sort_by(|a, b| b.1.total_cmp(&a.1));
        let tried = singles.iter().filter(|one| one.0.len() == 1).take(UNLISTED_BESIDE);
        for (names, log) in tried.chain(singles.iter().filter(|one| one.0.is_empty())) {
            if let Some(kept) = fits.get(names) {
                all.push(self.unlisted_beside(names, *log, &kept.fitted));
            }
        }
        normalise(&mut all);
        all
    }

    fn unlisted_beside(&self, names: &Names, log: f64, fitted: &Arc<Fitted>) -> Explanation {
        let beside =
            unlisted::Beside { columns: &fitted.columns, halves: &fitted.halves, left: &fitted.left };
        let (mean, each) = unlisted::log_evidence(&self.joint.model, self.blocks, &beside);
        let best = each.iter().max_by(|a, b| a.2.total_cmp(&b.2));
        let gain = mean - fitted.log_beside;
        Explanation {
            names: names.clone(),
            unlisted: true,
            log: log + gain + log_prior(names.len(), true),
            fitted: Some(Arc::clone(fitted)),
            block: best.map(|one| (one.0, one.1)),
            probability: 0.0,
        }
    }

    /// Log evidence of every set with the gain of each member counted by what it changes.
    fn counted(&self, fits: &Fits) -> BTreeMap<Names, f64> {
        let mut logs = BTreeMap::<Names, f64>::new();
        for names in fits.by_size() {
            let Some(kept) = fits.get(names) else { continue };
            let without = |which: usize| {
                let mut rest = names.clone();
                rest.remove(which);
                let part = fits.get(&rest)?;
                let gain = kept.log() - part.log();
                logs.get(&rest)
                    .map(|log| log + counted(gain, self.share(&kept.fitted, &part.fitted), self.missed))
            };
            let least = (0..names.len()).filter_map(without).fold(f64::INFINITY, f64::min);
            logs.insert(names.clone(), if names.is_empty() { kept.log() } else { least.min(kept.log()) });
        }
        logs
    }

    /// Share of power by which a fit changes the prediction of one of its subsets.
    fn share(&self, whole: &Fitted, part: &Fitted) -> f64 {
        let (observed, predicted) = (self.joint.observed, &self.joint.baseline.predicted);
        // A lone effect that the robot's parameters imitate is an effect all the same.
        if part.members.is_empty() {
            return change_share(observed, predicted, &whole.effect, &part.effect);
        }
        change_share(observed, predicted, &whole.change, &part.change)
    }
}

/// Names of members, sorted.
fn names(members: &[Member]) -> Names {
    let mut names: Names = members.iter().map(|member| member.mechanism.name()).collect();
    names.sort_unstable();
    names
}

/// A span with its onset or end later; none where it has neither, or would leave the drives.
fn moved(grid: &Grid, observed: &Observations<'_>, span: Span, by_s: f64) -> Option<Span> {
    let at = |run: usize, t_s: f64| {
        let driven_s = observed.begins_s[run] + t_s + by_s;
        (driven_s > 0.0 && driven_s < observed.total_s()).then(|| grid.onward(driven_s))
    };
    match span {
        Span::From { run, t_s } => at(run, t_s),
        Span::Until { run, t_s } => match at(run, t_s)? {
            Span::From { run, t_s } => Some(Span::Until { run, t_s }),
            other => Some(other),
        },
        Span::EachDrive(_) | Span::Within(_) => None,
    }
}
