//! Range against drives through the independent world: a few of the missions that `--example range_coverage` scores in full.

#[path = "../examples/range_coverage/drive.rs"]
mod drive;

use drive::{Case, Scored, score};
use rayon::prelude::*;

fn missions(seeds: std::ops::Range<u64>, scatter: f64) -> Vec<Scored> {
    seeds.into_par_iter().filter_map(|seed| score(&Case::draw(seed, scatter)?)).collect()
}

#[test]
fn the_energy_of_a_matched_drive_is_predicted_to_a_few_per_cent() {
    let scored = missions(500..512, 0.0);
    assert!(scored.len() >= 10, "{} of 12 were driven", scored.len());
    // A drive that returns nearly all it drew takes little; what it is off by counts against what was drawn and returned.
    let off = |s: &Scored| (s.driven_j - s.nominal_j).abs() / s.gross_j;
    let mut errors: Vec<f64> = scored.iter().map(off).collect();
    errors.sort_by(f64::total_cmp);
    assert!(errors[errors.len() / 2] <= 0.05, "{errors:?}");
}

#[test]
fn most_drives_of_drawn_robots_lie_in_their_intervals() {
    let scored = missions(600..624, 1.0);
    let inside = scored.iter().filter(|s| (s.p05_j..=s.p95_j).contains(&s.driven_j)).count();
    // Of 24 at 90 %, fewer than 17 has a chance below one in a hundred.
    assert!(scored.len() >= 20 && inside * 24 >= 17 * scored.len(), "{inside} of {}", scored.len());
    let success = |high: bool| {
        let of: Vec<&Scored> = scored.iter().filter(|s| (s.success_probability > 0.5) == high).collect();
        of.iter().filter(|s| s.succeeded).count() as f64 / of.len().max(1) as f64
    };
    assert!(success(true) > success(false), "{} {}", success(true), success(false));
}
