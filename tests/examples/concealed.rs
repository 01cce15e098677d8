//! Cases that conceal an effect, diagnosed, for development; the score that counts is `joulepath prove`'s, on seeds never used here.
//!
//! `cargo run --profile ci -p joulepath-tests --example concealed -- SHARE FIRST_SEED SEEDS [KIND...]`
//!
//! With the variable `RULED` set, what was named is diagnosed once more with its mechanism ruled out.

#![allow(clippy::unwrap_used)]

#[path = "../shared/logs.rs"]
mod logs;

use std::{collections::BTreeMap, time::Instant};

use diagnosis::{Diagnosis, Question, Verdict, diagnose};
use logs::read_back;
use model::{
    Robot,
    mechanism::{self, Mechanism},
};
use world::{Case, CaseKind, EffectName, Family, RobotFile, simulate};

/// Cases of one family: all, not `consistent`, and with the truth alone or beside one other.
#[derive(Default)]
struct Count {
    cases: u32,
    noticed: u32,
    named: u32,
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: f64| arguments.next().and_then(|a| a.parse().ok()).unwrap_or(default);
    let (share, first, seeds) = (number(0.06), number(1.0) as u64, number(1.0) as u64);
    let only: Vec<String> = arguments.collect();
    let text = serde_json::to_string(&model::builtin::husky_a200()).unwrap();
    let (file, robot) = (RobotFile::from_json(&text).unwrap(), Robot::from_json(&text).unwrap());
    let mut kinds = vec![CaseKind::Healthy, CaseKind::Decoy];
    kinds.extend(EffectName::all().map(CaseKind::One));
    kinds.retain(|kind| only.is_empty() || only.iter().any(|only| format!("{kind:?}").contains(only)));
    let mut counts: BTreeMap<&str, Count> = BTreeMap::new();
    for kind in kinds {
        for seed in first..first + seeds {
            let case = match Case::draw(seed, kind, share, &file) {
                Ok(case) => case,
                Err(error) => {
                    println!("{kind:?} {seed}: {error}");
                    continue;
                }
            };
            let suspect = read_back(&simulate(&case.world, &file, &case.drive).unwrap()).recording;
            let healthy = read_back(&case.reference(&file).unwrap()).recording;
            let began = Instant::now();
            let found = diagnose(&Question::new(&robot, &suspect, Some(&healthy)), &|_, _| {}).unwrap();
            say(kind, seed, &case, &found, began);
            if let Some(truth) =
                mechanism_of(kind).filter(|_| std::env::var_os("RULED").is_some() && is_named(kind, &found))
            {
                let question = Question::new(&robot, &suspect, Some(&healthy));
                let without = diagnose(&Question { ruled_out: &[truth], ..question }, &|_, _| {}).unwrap();
                print!("    ruled out: ");
                say(kind, seed, &case, &without, began);
            }
            let count = counts.entry(family(kind)).or_default();
            count.cases += 1;
            count.noticed += u32::from(found.verdict != Verdict::Consistent);
            count.named += u32::from(is_named(kind, &found));
        }
    }
    for (family, Count { cases, noticed, named }) in counts {
        println!("{family}: {noticed} of {cases} noticed, {named} named in a set of at most two");
    }
}

fn family(kind: CaseKind) -> &'static str {
    match kind {
        CaseKind::Healthy => "healthy",
        CaseKind::Decoy => "decoy",
        CaseKind::One(effect) if effect.family() == Family::Unlisted => "outside the list",
        _ => "listed",
    }
}

/// The mechanism that a case conceals, if the library holds it.
fn mechanism_of(kind: CaseKind) -> Option<&'static dyn Mechanism> {
    let CaseKind::One(effect) = kind else { return None };
    mechanism::by_name(serde_json::to_value(effect).unwrap().as_str()?)
}

fn is_named(kind: CaseKind, found: &Diagnosis) -> bool {
    let CaseKind::One(effect) = kind else { return found.findings.is_empty() };
    let truth = serde_json::to_value(effect).unwrap();
    let first = found.findings.first();
    first.is_some_and(|f| {
        f.indistinguishable_from.len() < 2
            && (f.mechanism == truth || f.indistinguishable_from.iter().any(|name| *name == truth))
    })
}

fn say(kind: CaseKind, seed: u64, case: &Case, found: &Diagnosis, began: Instant) {
    let findings: Vec<String> = found
        .findings
        .iter()
        .map(|f| {
            let values: Vec<String> =
                f.parameters.iter().map(|p| format!("{:.3} {}", p.value, p.unit)).collect();
            format!(
                "{} [{}] bic {:.0} gain {:.3} also {:?}",
                f.mechanism,
                values.join(", "),
                f.evidence.delta_bic,
                f.evidence.held_out_gain,
                f.indistinguishable_from
            )
        })
        .collect();
    println!(
        "{}{kind:?} {seed} {:?} {:?}: {:?} {} | floor {:.2} W, {:.2} -> {:.2} W, {:.1} s",
        if is_named(kind, found) { "+" } else { "-" },
        case.drive.kind,
        case.world.effects.iter().map(|e| (e.strength, e.onset_s)).collect::<Vec<_>>(),
        found.verdict,
        findings.join("; "),
        found.baseline.noise_floor_w,
        found.baseline.held_out_rmse_w,
        found.corrected.held_out_rmse_w,
        began.elapsed().as_secs_f64(),
    );
    if found.verdict == Verdict::Unexplained {
        println!("    {} {:?}", found.sentence, found.notes);
    }
}
