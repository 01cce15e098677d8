//! Which cases a trial has: kinds, effects and strengths, dealt from a seed.

use std::cmp::Ordering;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use world::{CaseKind, EffectName, Family};

use crate::Kind;

/// Strengths asked for: root mean square change of power over its mean. An ideal detector sees the
/// first at about z = 40 on a Husky's quarter of an hour; from 12 % on they are plain to the eye, and still they have to be named.
pub const SHARES: [f64; 6] = [0.012, 0.03, 0.06, 0.12, 0.20, 0.40];
/// Shares of healthy drives, decoys, one effect, two effects and effects without a name among the cases.
const MIX: [f64; 5] = [0.20, 0.10, 0.45, 0.15, 0.10];
/// Their kinds.
const KINDS: [Kind; 5] = [Kind::Healthy, Kind::Decoy, Kind::One, Kind::Two, Kind::Unlisted];

/// A case that is to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Dealt {
    /// Its name, which says nothing of what it holds.
    pub name: String,
    /// What is concealed.
    pub kind: CaseKind,
    /// How strongly, as a share of power; 0 where nothing is.
    pub share: f64,
    /// Seed of world, drive and effects.
    pub seed: u64,
}

/// Deals the cases of a trial, in random order: of all kinds, or only of one, and of all strengths or of one share of power.
///
/// Every mechanism comes up once before one comes up twice, and with every strength before one strength repeats, as each time round
/// every one has another.
pub fn deal(cases: usize, seed: u64, only: Option<Kind>, share: Option<f64>) -> Vec<Dealt> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let [healthy, decoys, ones, twos, unlisted] =
        only.map_or_else(|| counts(cases), |only| KINDS.map(|kind| if kind == only { cases } else { 0 }));
    let mut listed = names(|family| family != Family::Unlisted);
    let mut others = names(|family| family == Family::Unlisted);
    shuffle(&mut listed, &mut random);
    shuffle(&mut others, &mut random);
    let mut kinds = vec![(CaseKind::Healthy, 0.0); healthy];
    kinds.extend(vec![(CaseKind::Decoy, 0.0); decoys]);
    let strength = |i: usize, deck: usize| share.unwrap_or(SHARES[(i % deck + i / deck) % SHARES.len()]);
    kinds.extend((0..ones).map(|i| (CaseKind::One(listed[i % listed.len()]), strength(i, listed.len()))));
    kinds.extend((0..twos).map(|i| (two(&listed, &mut random), strength(i, listed.len()))));
    kinds.extend((0..unlisted).map(|i| (CaseKind::One(others[i % others.len()]), strength(i, others.len()))));
    shuffle(&mut kinds, &mut random);
    let numbered = kinds.into_iter().enumerate();
    numbered
        .map(|(i, (kind, share))| Dealt {
            name: format!("case-{:04}", i + 1),
            kind,
            share,
            // World files carry seeds as numbers that a double holds exactly.
            seed: random.random::<u64>() >> 12,
        })
        .collect()
}

fn names(wanted: impl Fn(Family) -> bool) -> Vec<EffectName> {
    EffectName::all().filter(|name| wanted(name.family())).collect()
}

/// Two effects that are not the same.
fn two(listed: &[EffectName], random: &mut Pcg64Mcg) -> CaseKind {
    let first = random.random_range(0..listed.len());
    let step = random.random_range(1..listed.len());
    CaseKind::Two(listed[first], listed[(first + step) % listed.len()])
}

/// How many of each kind: at least one where there are cases enough, the rest by largest remainders.
fn counts(cases: usize) -> [usize; 5] {
    let least = usize::from(cases >= MIX.len());
    let wanted = MIX.map(|share| share * cases as f64);
    let mut counts = wanted.map(|w| (w as usize).max(least));
    loop {
        let lack = |i: &usize| wanted[*i] - counts[*i] as f64;
        let by_lack = |a: &usize, b: &usize| lack(a).total_cmp(&lack(b));
        let (most, spare) = ((0..5).max_by(by_lack), (0..5).filter(|i| counts[*i] > least).min_by(by_lack));
        match (counts.iter().sum::<usize>().cmp(&cases), most, spare) {
            (Ordering::Less, Some(i), _) => counts[i] += 1,
            (Ordering::Greater, _, Some(i)) => counts[i] -= 1,
            _ => return counts,
        }
    }
}

/// Fisher and Yates.
pub(crate) fn shuffle<T>(cards: &mut [T], random: &mut Pcg64Mcg) {
    for i in (1..cards.len()).rev() {
        cards.swap(i, random.random_range(0..=i));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_deals_the_same_and_another_seed_something_else() {
        assert_eq!(deal(30, 7, None, None), deal(30, 7, None, None));
        assert_ne!(deal(30, 7, None, None), deal(30, 8, None, None));
    }

    #[test]
    fn every_kind_is_dealt_from_five_cases_on_and_no_case_is_lost() {
        for cases in 0..200 {
            let counts = counts(cases);
            assert_eq!(counts.iter().sum::<usize>(), cases);
            assert!(cases < 5 || counts.iter().all(|count| *count > 0), "{cases}: {counts:?}");
        }
        assert_eq!(counts(100), [20, 10, 45, 15, 10]);
    }

    #[test]
    fn mechanisms_and_strengths_come_round_evenly() {
        let dealt = deal(400, 1, None, None);
        for name in names(|family| family != Family::Unlisted) {
            let mut shares: Vec<f64> =
                dealt.iter().filter(|d| d.kind == CaseKind::One(name)).map(|d| d.share).collect();
            shares.sort_by(f64::total_cmp);
            shares.dedup();
            assert_eq!(shares, SHARES, "{name:?}");
        }
        assert!(dealt.iter().all(|d| !matches!(d.kind, CaseKind::Two(a, b) if a == b)));
    }

    #[test]
    fn only_cases_of_one_kind_are_dealt_where_it_is_asked_for() {
        let dealt = deal(20, 3, Some(Kind::Unlisted), None);
        let is_unlisted =
            |d: &Dealt| matches!(d.kind, CaseKind::One(name) if name.family() == Family::Unlisted);
        assert!(dealt.len() == 20 && dealt.iter().all(is_unlisted), "{dealt:?}");
        assert!(deal(20, 3, None, Some(0.02)).iter().all(|d| d.share == 0.0 || d.share == 0.02));
        assert!(deal(7, 3, Some(Kind::Decoy), None).iter().all(|d| d.kind == CaseKind::Decoy));
    }

    #[test]
    fn names_of_cases_tell_nothing() {
        let [a, b] = [deal(12, 1, None, None), deal(12, 2, None, None)].map(|dealt| {
            let names: Vec<String> = dealt.into_iter().map(|d| d.name).collect();
            names
        });
        assert_eq!(a, b);
    }
}
