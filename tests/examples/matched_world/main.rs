//! Concealed cases in a world that is the model's own: how well the diagnosis does where no model errs.
//!
//! `cargo run --profile ci -p joulepath-tests --example matched_world -- [--z Z] [--healthy N] [--each N] [--pairs N] [--seed S] [NAME...]`
//!
//! Drives are driven in the independent world without effects; powers, yaw rates and positions are the model's, with the noise of
//! that world's sensors. Strengths are such that a detector that knows the truth sees each effect at z standard deviations.

#![allow(clippy::unwrap_used, clippy::panic)]

mod case;
#[path = "../../shared/logs.rs"]
mod logs;
mod score;

use diagnosis::{Diagnosis, Question, Verdict, diagnose};
use model::mechanism::{self, Mechanism};
use rayon::prelude::*;

use case::{Case, Kind, draw};
use score::Board;

/// What is asked for on the command line.
struct Asked {
    z: f64,
    healthy: u64,
    each: u64,
    pairs: u64,
    seed: u64,
    names: Vec<String>,
}

fn main() {
    let asked = asked();
    let kinds = kinds(&asked);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let answers: Vec<(Case, Diagnosis)> = pool.install(|| {
        let answer = |(i, kind): (usize, &Kind)| {
            let case = draw(asked.seed.wrapping_add(i as u64), kind, asked.z);
            let found = diagnose(&Question::new(&case.robot, &case.suspect, Some(&case.healthy)), &|_, _| {});
            let found = found.unwrap();
            println!("{}", line(&case, &found));
            (case, found)
        };
        kinds.par_iter().enumerate().with_max_len(1).map(answer).collect()
    });
    let mut board = Board::default();
    answers.iter().for_each(|(case, found)| board.add(case, found));
    println!("{board}");
}

fn asked() -> Asked {
    let mut asked = Asked { z: 32.0, healthy: 20, each: 1, pairs: 10, seed: 1, names: Vec::new() };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        if !word.starts_with("--") {
            asked.names.push(word);
            continue;
        }
        let value: f64 = words.next().unwrap().parse().unwrap();
        match word.as_str() {
            "--z" => asked.z = value,
            "--healthy" => asked.healthy = value as u64,
            "--each" => asked.each = value as u64,
            "--pairs" => asked.pairs = value as u64,
            "--seed" => asked.seed = value as u64,
            _ => panic!("{word} is not known"),
        }
    }
    asked
}

/// All cases, in order.
fn kinds(asked: &Asked) -> Vec<Kind> {
    let all: Vec<&'static dyn Mechanism> = mechanism::ALL
        .into_iter()
        .filter(|one| asked.names.is_empty() || asked.names.iter().any(|name| name == one.name()))
        .collect();
    let mut kinds = Vec::new();
    // A third of them are decoys: more noise, or a robot at the edge of its file.
    kinds.extend((0..asked.healthy).map(|i| if i % 3 == 2 { Kind::Decoy } else { Kind::Healthy }));
    kinds.extend((0..asked.each).flat_map(|_| all.iter().map(|one| Kind::Conceals(vec![*one]))));
    let count = all.len() as u64;
    let pair = |i: u64| {
        let first = (i * 7 + asked.seed) % count;
        let second = (first + 1 + (i * 5 + asked.seed) % (count - 1)) % count;
        Kind::Conceals(vec![all[first as usize], all[second as usize]])
    };
    kinds.extend((0..asked.pairs).filter(|_| count > 1).map(pair));
    kinds
}

fn line(case: &Case, found: &Diagnosis) -> String {
    let truths: Vec<String> = case.truths.iter().map(|truth| format!("{truth:?}")).collect();
    let named = |f: &diagnosis::report::Finding| {
        let sure = |[low, high]: [f64; 2]| format!(" ({low:.3} to {high:.3})");
        let value = |p: &diagnosis::report::FoundParameter| {
            format!("{:.3}{}", p.value, p.interval_95.map_or(String::new(), sure))
        };
        let values: Vec<String> = f.parameters.iter().map(value).collect();
        format!("{} [{}] or {:?}", f.mechanism, values.join(", "), f.indistinguishable_from)
    };
    let findings: Vec<String> = found.findings.iter().map(named).collect();
    let is_right = match found.verdict {
        Verdict::Consistent => case.truths.is_empty(),
        _ => {
            case.truths.iter().all(|truth| score::is_in_two(truth.mechanism.name(), found))
                && !case.truths.is_empty()
        }
    };
    format!(
        "{} {} {truths:?}: {:?} {} | {:.2} -> {:.2} W, floor {:.2} W",
        if is_right { "+" } else { "-" },
        case.name,
        found.verdict,
        findings.join("; "),
        found.baseline.held_out_rmse_w,
        found.corrected.held_out_rmse_w,
        found.baseline.noise_floor_w,
    )
}
