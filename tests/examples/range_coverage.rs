//! Whether intervals hold what robots draw, and probabilities of success what becomes of them, in the independent world.
//!
//! A seed draws ground, a way over it, a robot within its uncertainty, and a charge. The planner plans and range predicts with
//! the robot's file; the world drives the path with the robot as drawn. What the world adds beyond parameters (other tyres,
//! motors and driver, starts and stops) is estimated on development seeds, as `mission::MODEL_MEAN` and `MODEL_SIGMA`, and
//! scored on seeds that nothing was chosen by.
//!
//!     cargo run --release -p joulepath-tests --example range_coverage -- develop     # error of the model in the matched world
//!     cargo run --release -p joulepath-tests --example range_coverage -- score [N]   # coverage and reliability on fresh seeds

#[path = "range_coverage/drive.rs"]
mod drive;

use drive::{Case, Scored, score};
use rayon::prelude::*;

/// Seeds of the estimate of the model's own error.
const DEVELOPMENT: std::ops::Range<u64> = 0..400;
/// The first seed that is scored; none of them served any choice.
const SCORED_FROM: u64 = 2_000_000;
const SCORED: u64 = 300;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let what = arguments.next().unwrap_or_else(|| "score".into());
    let count = arguments.next().and_then(|n| n.parse().ok());
    if what == "develop" {
        let seeds = DEVELOPMENT.start..DEVELOPMENT.start + count.unwrap_or(DEVELOPMENT.end);
        return develop(&run(seeds, 0.0));
    }
    let seeds = SCORED_FROM..SCORED_FROM + count.unwrap_or(SCORED);
    println!("matched world: the robot is that of its file");
    errors(&run(seeds.clone(), 0.0));
    println!("robots drawn from the file's uncertainty");
    let scored = run(seeds, 1.0);
    errors(&scored);
    coverage(&scored);
    reliability(&scored);
}

fn run(seeds: std::ops::Range<u64>, scatter: f64) -> Vec<Scored> {
    let asked = seeds.end - seeds.start;
    let found: Vec<Scored> =
        seeds.into_par_iter().filter_map(|seed| score(&Case::draw(seed, scatter)?)).collect();
    println!("{} of {asked} missions driven", found.len());
    found
}

/// Driven over predicted energy as files say, less one, sorted.
fn relative(scored: &[Scored]) -> Vec<f64> {
    let mut errors: Vec<f64> = scored.iter().map(|s| s.driven_j / s.nominal_j - 1.0).collect();
    errors.sort_by(f64::total_cmp);
    errors
}

fn develop(scored: &[Scored]) {
    for s in scored {
        let (driven, nominal, gross) = (s.driven_j, s.nominal_j, s.gross_j);
        println!("  driven {driven:8.0} J, predicted {nominal:8.0} J, drawn and returned {gross:8.0} J");
    }
    let errors: Vec<f64> = scored.iter().map(|s| (s.driven_j - s.nominal_j) / s.gross_j).collect();
    let count = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / count;
    let square = errors.iter().map(|e| (e - mean) * (e - mean)).sum::<f64>() / (count - 1.0);
    println!(
        "error of the model over what is drawn and returned: mean {:+.2} %, one sigma {:.2} %",
        100.0 * mean,
        100.0 * square.sqrt()
    );
    self::errors(scored);
}

fn errors(scored: &[Scored]) {
    let errors = relative(scored);
    let mut sizes: Vec<f64> = errors.iter().map(|e| e.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let at = |values: &[f64], share: f64| 100.0 * values[((values.len() - 1) as f64 * share) as usize];
    println!(
        "  driven over predicted: median {:+.2} %, 5 to 95 %: {:+.2} to {:+.2} %; median size of the error {:.2} %",
        at(&errors, 0.5),
        at(&errors, 0.05),
        at(&errors, 0.95),
        at(&sizes, 0.5)
    );
}

fn coverage(scored: &[Scored]) {
    let inside = scored.iter().filter(|s| (s.p05_j..=s.p95_j).contains(&s.driven_j)).count();
    let below = scored.iter().filter(|s| s.driven_j < s.p05_j).count();
    let share = 100.0 * inside as f64 / scored.len() as f64;
    println!(
        "  5-95 % interval holds {inside} of {} ({share:.1} %), {below} below, {} above",
        scored.len(),
        scored.len() - inside - below
    );
}

fn reliability(scored: &[Scored]) {
    println!("  predicted success   missions  mean predicted  succeeded");
    let mut score = 0.0;
    for (low, high) in [(0.0, 0.05), (0.05, 0.25), (0.25, 0.5), (0.5, 0.75), (0.75, 0.95), (0.95, 1.01)] {
        let within: Vec<&Scored> =
            scored.iter().filter(|s| (low..high).contains(&s.success_probability)).collect();
        if within.is_empty() {
            continue;
        }
        let count = within.len() as f64;
        let predicted = within.iter().map(|s| s.success_probability).sum::<f64>() / count;
        let succeeded = within.iter().filter(|s| s.succeeded).count() as f64 / count;
        println!(
            "  {low:.2} to {:.2}        {:8}        {predicted:.3}          {succeeded:.3}",
            high.min(1.0),
            within.len()
        );
    }
    for s in scored {
        score += (s.success_probability - f64::from(u8::from(s.succeeded))).powi(2) / scored.len() as f64;
    }
    println!("  Brier score {score:.4}");
}
