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

/// Share of the time that each half has at least.
const LEAST_SHARE: f64 = 0.25;
/// Runs that a healthy half has at least: each judges the fit of the other.
const LEAST_HEALTHY: usize = 2;
/// Random splits that are tried before the most even one of them is taken.
const TRIES: usize = 64;

/// Splits the runs of a ground. Of a ground whose runs cannot be split as evenly as wanted, the most even split that was tried is taken.
pub fn split(ground: &Ground, random: &mut Pcg64Mcg) -> Split {
    let mut best = (f64::NEG_INFINITY, Split::default());
    for _ in 0..TRIES {
        let split = one(ground, random);
        let share = least_share(ground, &split);
        if share >= LEAST_SHARE {
            return split;
        }
        if share > best.0 {
            best = (share, split);
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

/// Share of the time in the shorter half; less than none where a half has too few runs.
fn least_share(ground: &Ground, split: &Split) -> f64 {
    if split.healthy.len() < LEAST_HEALTHY || split.suspect.is_empty() {
        return -1.0;
    }
    let time_s = |runs: &[usize]| runs.iter().map(|run| ground.duration_s(*run)).sum::<f64>();
    let [healthy_s, suspect_s] = [&split.healthy, &split.suspect].map(|runs| time_s(runs));
    healthy_s.min(suspect_s) / (healthy_s + suspect_s).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;
    use crate::real::ground::tests::drives;

    #[test]
    fn every_run_is_in_one_half_and_no_half_is_short() {
        let ground = Ground::new("marble".into(), drives(&[300, 100, 100, 100, 100], 0.0)).unwrap();
        let mut seen = Vec::new();
        for seed in 0..20 {
            let split = split(&ground, &mut Pcg64Mcg::seed_from_u64(seed));
            let mut all = [split.healthy.clone(), split.suspect.clone()].concat();
            all.sort_unstable();
            assert_eq!(all, [0, 1, 2, 3, 4]);
            assert!(least_share(&ground, &split) >= LEAST_SHARE && split.healthy.len() >= LEAST_HEALTHY);
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
