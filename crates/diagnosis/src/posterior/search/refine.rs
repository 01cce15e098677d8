//! Refits of the leading sets, their windows moved, their subsets compared, and the unlisted class beside them.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::posterior::{
    fit::joint::{Fitted, Joint, Member},
    hypothesis::{
        unlisted::{self, Block},
        window::Grid,
    },
    observations::Observations,
    search::{
        explanation::{Explanation, change_share, counted, log_prior, normalise},
        screen::{Scored, Screen},
    },
};
use crate::{Error, Span};

/// Names whose best candidates are refitted alone, in pairs and in threes.
const SINGLES: usize = 9;
const PAIRS: usize = 8;
const TRIPLES: usize = 3;
/// Singles that pairs are grown from, and pairs that threes are grown from.
const PAIR_SEEDS: usize = 12;
const TRIPLE_SEEDS: usize = 3;
/// Singles beside which something unlisted is tried.
const UNLISTED_BESIDE: usize = 4;
/// Log odds behind the best beyond which a set is not refitted.
const HOPELESS: f64 = 40.0;
/// Log odds behind the best of its size beyond which windows of a set are not moved.
const BEHIND: f64 = 12.0;
/// Moves of a window's edge that are tried, as shares of a piece of the grid.
const EDGE_MOVES: [f64; 4] = [-0.5, 0.5, -0.25, 0.25];

type Names = Vec<&'static str>;

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
}

impl Search<'_> {
    /// The posterior over explanations, likeliest first.
    ///
    /// # Errors
    /// A surface that the robot does not know; a watch that breaks.
    pub(crate) fn posterior(&self) -> Result<Vec<Explanation>, Error> {
        let nothing = self.joint.fit(&[])?;
        let singles = self.screen.singles();
        let by_name = self.screen.by_names(&singles);
        let mut fits = BTreeMap::<Names, (Fitted, f64)>::new();
        fits.insert(Vec::new(), (nothing, 0.0));
        let mut keep = |names: Names, fitted: Fitted, spread: f64| {
            let is_better =
                fits.get(&names).is_none_or(|(known, more)| fitted.log + spread > known.log + more);
            if is_better {
                fits.insert(names, (fitted, spread));
            }
        };
        let mut refit = |ranked: &[(Names, Scored, f64)], most: usize| -> Result<(), Error> {
            let best = ranked.first().map_or(0.0, |one| one.1.log);
            let hopeful: Vec<_> =
                ranked.iter().take(most).filter(|one| one.1.log > best - HOPELESS).collect();
            let fits: Vec<Fitted> = hopeful
                .par_iter()
                .map(|(_, scored, _)| self.joint.fit(&self.screen.members(&scored.set)))
                .collect::<Result<_, Error>>()?;
            let best = fits.iter().map(|fitted| fitted.log).fold(f64::NEG_INFINITY, f64::max);
            for ((names, _, spread), mut fitted) in hopeful.into_iter().zip(fits) {
                if fitted.log > best - BEHIND {
                    fitted = self.with_moved_edges(fitted)?;
                }
                keep(names.clone(), fitted, *spread);
            }
            Ok(())
        };
        refit(&by_name, SINGLES)?;
        let pairs = self.grown(by_name.iter().take(PAIR_SEEDS).map(|one| &one.1), &singles);
        refit(&pairs, PAIRS)?;
        let triples = self.grown(pairs.iter().take(TRIPLE_SEEDS).map(|one| &one.1), &singles);
        refit(&triples, TRIPLES)?;
        self.with_subsets(&mut fits)?;
        Ok(self.explanations(&fits))
    }

    /// Sets with one candidate more, by names.
    fn grown<'s>(
        &self,
        sets: impl Iterator<Item = &'s Scored>,
        singles: &[Scored],
    ) -> Vec<(Names, Scored, f64)> {
        let mut seen = std::collections::BTreeSet::new();
        let all = sets.flat_map(|scored| self.screen.grown(&scored.set, singles));
        let is_new = |one: &Scored| {
            let mut set = one.set.clone();
            set.sort_unstable();
            seen.insert(set)
        };
        let all: Vec<Scored> = all.collect::<Vec<_>>().into_iter().filter(is_new).collect();
        self.screen.by_names(&all)
    }

    /// Fits the subsets of every fitted set from where it ended, until nothing is better.
    fn with_subsets(&self, fits: &mut BTreeMap<Names, (Fitted, f64)>) -> Result<(), Error> {
        let best =
            fits.values().map(|(fitted, spread)| fitted.log + spread).fold(f64::NEG_INFINITY, f64::max);
        for size in [3, 2] {
            let leads = |(fitted, spread): &&(Fitted, f64)| {
                fitted.members.len() == size && fitted.log + spread > best - BEHIND
            };
            let sets: Vec<(Fitted, f64)> = fits.values().filter(leads).cloned().collect();
            for (fitted, spread) in sets {
                for without in 0..size {
                    let mut members = fitted.members.clone();
                    members.remove(without);
                    let names = names(&members);
                    let part = self.joint.fit(&members)?;
                    let is_better =
                        fits.get(&names).is_none_or(|(known, more)| part.log + spread > known.log + more);
                    if is_better {
                        fits.insert(names, (part, spread));
                    }
                }
            }
        }
        Ok(())
    }

    /// A fit with each onset or end moved to where it explains most.
    fn with_moved_edges(&self, mut fitted: Fitted) -> Result<Fitted, Error> {
        let piece_s = self.joint.observed.total_s() / self.grid.pieces() as f64;
        for m in 0..fitted.members.len() {
            for share in EDGE_MOVES {
                let Some(span) =
                    moved(self.grid, self.joint.observed, fitted.members[m].span, share * piece_s)
                else {
                    break;
                };
                let mut members: Vec<Member> = fitted.members.clone();
                members[m].span = span;
                let next = self.joint.fit(&members)?;
                if next.log > fitted.log {
                    fitted = next;
                }
            }
        }
        Ok(fitted)
    }

    /// All explanations with their posterior.
    fn explanations(&self, fits: &BTreeMap<Names, (Fitted, f64)>) -> Vec<Explanation> {
        let counted = self.counted(fits);
        let mut all: Vec<Explanation> = counted
            .iter()
            .map(|(names, log)| Explanation {
                names: names.clone(),
                unlisted: false,
                log: log + log_prior(names.len(), false),
                fitted: fits.get(names).map(|one| one.0.clone()),
                block: None,
                probability: 0.0,
            })
            .collect();
        let mut singles: Vec<(&Names, f64)> =
            counted.iter().filter(|(names, _)| names.len() <= 1).map(|(names, log)| (names, *log)).collect();
        singles.sort_by(|a, b| b.1.total_cmp(&a.1));
        let tried = singles.iter().filter(|one| one.0.len() == 1).take(UNLISTED_BESIDE);
        for (names, log) in tried.chain(singles.iter().filter(|one| one.0.is_empty())) {
            let Some((fitted, _)) = fits.get(*names) else { continue };
            all.push(self.unlisted_beside(names, *log, fitted));
        }
        normalise(&mut all);
        all
    }

    fn unlisted_beside(&self, names: &Names, log: f64, fitted: &Fitted) -> Explanation {
        let beside =
            unlisted::Beside { columns: &fitted.columns, halves: &fitted.halves, left: &fitted.left };
        let (mean, each) = unlisted::log_evidence(&self.joint.model, self.blocks, &beside);
        let best = each.iter().max_by(|a, b| a.2.total_cmp(&b.2));
        let gain = mean - fitted.evidence.log;
        Explanation {
            names: names.clone(),
            unlisted: true,
            log: log + gain + log_prior(names.len(), true),
            fitted: Some(fitted.clone()),
            block: best.map(|one| (one.0, one.1)),
            probability: 0.0,
        }
    }

    /// Log evidence of every set with the gain of each member counted by what it changes.
    fn counted(&self, fits: &BTreeMap<Names, (Fitted, f64)>) -> BTreeMap<Names, f64> {
        let mut logs = BTreeMap::<Names, f64>::new();
        let predicted = &self.joint.baseline.predicted;
        let mut sets: Vec<&Names> = fits.keys().collect();
        sets.sort_by_key(|names| names.len());
        for names in sets {
            let (fitted, spread) = &fits[names];
            let own = fitted.log + spread;
            let without = |which: usize| {
                let mut rest = names.clone();
                rest.remove(which);
                let (part, more) = fits.get(&rest)?;
                // A lone effect that the robot's parameters imitate is an effect all the same.
                let share = match rest.is_empty() {
                    true => change_share(self.joint.observed, predicted, &fitted.effect, &part.effect),
                    false => change_share(self.joint.observed, predicted, &fitted.change, &part.change),
                };
                let gain = own - (part.log + more);
                logs.get(&rest).map(|log| log + counted(gain, share))
            };
            let least = (0..names.len()).filter_map(without).fold(f64::INFINITY, f64::min);
            logs.insert(names.clone(), if names.is_empty() { own } else { least.min(own) });
        }
        logs
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
