//! Which cases a trial on real drives has, dealt from a seed.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};
use world::Side;

use crate::{
    deal::shuffle,
    real::{Change, Direction},
};

/// Strengths asked for, in standard deviations of the ideal detector; the goals begin at the first.
pub const STRENGTHS_Z: [f64; 3] = [16.0, 32.0, 64.0];

/// Shares of healthy splits, changes and splices among the cases.
const MIX: [f64; 3] = [0.25, 0.48, 0.27];

/// What kind of case it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RealKind {
    /// Both halves as they were recorded.
    Healthy,
    /// One known change in the suspect half.
    Changed,
    /// A run of the suspect half goes on over another ground.
    Spliced,
}

/// A case that is to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct RealCase {
    /// Its name, which says nothing of what it holds.
    pub name: String,
    /// What kind it is.
    pub kind: RealKind,
    /// The ground of both halves, by its place among the recordings.
    pub ground: usize,
    /// What is put in; of changes alone.
    pub wanted: Option<Wanted>,
    /// The ground that a run goes on over; of splices alone.
    pub onto: Option<usize>,
    /// Seed of the split, the onset and the border.
    pub seed: u64,
}

/// A change that is to be put in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// What.
    pub change: Change,
    /// How strong.
    pub z: f64,
    /// Which way.
    pub direction: Direction,
    /// On which side.
    pub side: Side,
    /// From when on.
    pub begins: Begins,
}

/// From when on a change acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begins {
    /// From the start.
    AtOnce,
    /// From some time on.
    Later,
}

/// Deals the cases over so many grounds, in random order. Changes, strengths, grounds and pairs of grounds take turns; a change comes up with
/// every strength before one strength repeats.
pub fn deal(cases: usize, seed: u64, grounds: usize, strengths_z: &[f64]) -> Vec<RealCase> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let pairs = pairs(grounds);
    let [healthy, changed, spliced] = counts(cases, !pairs.is_empty());
    let deck = Deck::new(grounds, pairs, &mut random);
    let blank =
        |kind, ground| RealCase { name: String::new(), kind, ground, wanted: None, onto: None, seed: 0 };
    let mut dealt: Vec<RealCase> = (0..healthy).map(|i| blank(RealKind::Healthy, deck.ground(i))).collect();
    for i in 0..changed {
        let wanted = Some(deck.wanted(i, strengths_z, &mut random));
        // On from where the healthy splits ended.
        dealt.push(RealCase { wanted, ..blank(RealKind::Changed, deck.ground(healthy + i)) });
    }
    for i in 0..spliced {
        let (ground, onto) = deck.pair(i);
        dealt.push(RealCase { onto: Some(onto), ..blank(RealKind::Spliced, ground) });
    }
    shuffle(&mut dealt, &mut random);
    for (i, case) in dealt.iter_mut().enumerate() {
        case.name = format!("case-{:04}", i + 1);
        case.seed = random.random::<u64>() >> 12;
    }
    dealt
}

/// Shuffled grounds, pairs of grounds and changes, and whether changes come late.
struct Deck {
    grounds: Vec<usize>,
    pairs: Vec<(usize, usize)>,
    changes: Vec<Change>,
}

impl Deck {
    fn new(grounds: usize, mut pairs: Vec<(usize, usize)>, random: &mut Pcg64Mcg) -> Self {
        let (mut grounds, mut changes) = ((0..grounds).collect::<Vec<_>>(), Change::ALL.to_vec());
        shuffle(&mut grounds, random);
        shuffle(&mut pairs, random);
        shuffle(&mut changes, random);
        Deck { grounds, pairs, changes }
    }

    fn ground(&self, i: usize) -> usize {
        self.grounds[i % self.grounds.len()]
    }

    fn pair(&self, i: usize) -> (usize, usize) {
        self.pairs[i % self.pairs.len()]
    }

    fn wanted(&self, i: usize, strengths_z: &[f64], random: &mut Pcg64Mcg) -> Wanted {
        let (round, place) = (i / self.changes.len(), i % self.changes.len());
        let change = self.changes[place];
        let down = random.random_bool(0.5) && change.goes_both_ways();
        Wanted {
            change,
            z: strengths_z[(place + round) % strengths_z.len()],
            direction: if down { Direction::Down } else { Direction::Up },
            side: if random.random_bool(0.5) { Side::Left } else { Side::Right },
            // Another one each time that a change has come up with every strength.
            begins: match (place + round / strengths_z.len()) % 2 {
                0 => Begins::AtOnce,
                _ => Begins::Later,
            },
        }
    }
}

/// All pairs of two different grounds.
fn pairs(grounds: usize) -> Vec<(usize, usize)> {
    (0..grounds).flat_map(|from| (0..grounds).map(move |onto| (from, onto))).filter(|(a, b)| a != b).collect()
}

/// How many of each kind; a single ground cannot be spliced to another.
fn counts(cases: usize, has_pairs: bool) -> [usize; 3] {
    let [healthy, _, spliced] = MIX.map(|share| (share * cases as f64).round() as usize);
    let spliced = if has_pairs { spliced } else { 0 };
    [healthy, cases - healthy - spliced, spliced]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_deals_the_same_and_another_seed_something_else() {
        assert_eq!(deal(30, 7, 5, &STRENGTHS_Z), deal(30, 7, 5, &STRENGTHS_Z));
        assert_ne!(deal(30, 7, 5, &STRENGTHS_Z), deal(30, 8, 5, &STRENGTHS_Z));
    }

    #[test]
    fn thirty_cases_are_eight_healthy_splits_fourteen_changes_and_eight_splices() {
        assert_eq!(counts(30, true), [8, 14, 8]);
        assert_eq!(counts(30, false), [8, 22, 0]);
        for cases in 0..100 {
            assert_eq!(counts(cases, true).iter().sum::<usize>(), cases);
        }
    }

    #[test]
    fn changes_strengths_and_onsets_come_round_evenly_and_nothing_is_spliced_to_itself() {
        let dealt = deal(900, 3, 5, &STRENGTHS_Z);
        for change in Change::ALL {
            let wanted: Vec<Wanted> = dealt
                .iter()
                .filter_map(|case| case.wanted)
                .filter(|wanted| wanted.change == change)
                .collect();
            assert_eq!(wanted.len(), 48, "{change:?}");
            for z in STRENGTHS_Z {
                assert_eq!(wanted.iter().filter(|wanted| wanted.z == z).count(), 16, "{change:?} {z}");
            }
            assert_eq!(
                wanted.iter().filter(|wanted| wanted.begins == Begins::Later).count(),
                24,
                "{change:?}"
            );
            let down = wanted.iter().any(|wanted| wanted.direction == Direction::Down);
            assert_eq!(down, change.goes_both_ways(), "{change:?}");
        }
        assert!(dealt.iter().all(|case| case.onto != Some(case.ground)));
    }
}
