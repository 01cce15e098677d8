//! The runs of a ground split at random into a healthy and a suspect half.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

use crate::real::Ground;

/// Which runs are known to be healthy and which are diagnosed, by their places in the recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Split {
    /// Those that the robot is fitted on.
    pub healthy: Vec<usize>,
    /// The others.
    pub suspect: Vec<usize>,
}

/// Driving that each half has at least [s]: a diagnosis wants two minutes of averages, and standing ones count for none.
const LEAST_HALF_S: f64 = 140.0;
/// Runs that a healthy half has at least: each judges the fit of the other.
const LEAST_HEALTHY: usize = 2;
/// Random splits that are tried before the most even one of them is taken.
const TRIES: usize = 64;

/// Splits the runs of a ground. Where no half of them is as long as wanted, the most even split that was tried is taken.
pub fn split(ground: &Ground, random: &mut Pcg64Mcg) -> Split {
    let mut best = (f64::NEG_INFINITY, Split::default());
    for _ in 0..TRIES {
        let split = one(ground, random);
        let shorter_s = shorter_s(ground, &split);
        if shorter_s >= LEAST_HALF_S {
            return split;
        }
        if shorter_s > best.0 {
            best = (shorter_s, split);
        }
    }
    best.1
}

/// Each run on either side with the same chance.
fn one(ground: &Ground, random: &mut Pcg64Mcg) -> Split {
    let mut split = Split::default();
    for run in 0..ground.recording.runs.len() {
        let half = if random.random_bool(0.5) { &mut split.healthy } else { &mut split.suspect };
        half.push(run);
    }
    split
}

/// Driving in the shorter half [s]; less than none where a half has too few runs.
fn shorter_s(ground: &Ground, split: &Split) -> f64 {
    if split.healthy.len() < LEAST_HEALTHY || split.suspect.is_empty() {
        return -1.0;
    }
    let driven_s = |runs: &[usize]| runs.iter().map(|run| ground.duration_s(*run)).sum::<f64>();
    driven_s(&split.healthy).min(driven_s(&split.suspect))
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;
    use crate::real::ground::tests::drives;

    #[test]
    fn every_run_is_in_one_half_and_no_half_is_short() {
        let ground = Ground::new("marble".into(), drives(&[3000, 1000, 1000, 1000, 1000], 0.0)).unwrap();
        let mut seen = Vec::new();
        for seed in 0..20 {
            let split = split(&ground, &mut Pcg64Mcg::seed_from_u64(seed));
            let mut all = [split.healthy.clone(), split.suspect.clone()].concat();
            all.sort_unstable();
            assert_eq!(all, [0, 1, 2, 3, 4]);
            assert!(shorter_s(&ground, &split) >= LEAST_HALF_S && split.healthy.len() >= LEAST_HEALTHY);
            seen.push(split.healthy);
        }
        seen.sort();
        seen.dedup();
        assert!(seen.len() > 3, "{seen:?}");
    }

    #[test]
    fn where_one_run_is_nearly_all_the_most_even_split_is_taken() {
        let ground = Ground::new("marble".into(), drives(&[1000, 10, 20], 0.0)).unwrap();
        let split = split(&ground, &mut Pcg64Mcg::seed_from_u64(1));
        assert_eq!((split.healthy.len(), split.suspect.len()), (2, 1));
    }
}
