//! Cases that conceal an effect, diagnosed: `cargo run --profile ci -p joulepath-tests --example concealed -- SHARE SEEDS`.

#![allow(clippy::unwrap_used)]

use diagnosis::{Series, search};
use model::Robot;
use recording::{Recording, read_paths};
use world::{Case, CaseKind, Drive, EffectName, Family, RobotFile, World, simulate};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: f64| arguments.next().and_then(|a| a.parse().ok()).unwrap_or(default);
    let (share, seeds) = (number(0.06), number(1.0) as u64);
    let only = arguments.next();
    let folder = tempfile::tempdir().unwrap();
    let text = serde_json::to_string(&model::builtin::husky_a200()).unwrap();
    let (file, robot) = (RobotFile::from_json(&text).unwrap(), Robot::from_json(&text).unwrap());
    let mut kinds = vec![CaseKind::Healthy, CaseKind::Decoy];
    kinds.extend(EffectName::all().map(CaseKind::One));
    for kind in kinds {
        let name = format!("{kind:?}");
        if only.as_ref().is_some_and(|only| !name.contains(only)) {
            continue;
        }
        for seed in 1..=seeds {
            let began = std::time::Instant::now();
            let case = match Case::draw(seed, kind, share, &file) {
                Ok(case) => case,
                Err(error) => {
                    println!("{name} {seed}: {error}");
                    continue;
                }
            };
            let drawn_s = began.elapsed().as_secs_f64();
            let read = |world: &World, drive: &Drive, name: &str| -> Recording {
                let path = folder.path().join(name);
                simulate(world, &file, drive)
                    .unwrap()
                    .write_csv(std::fs::File::create(&path).unwrap())
                    .unwrap();
                read_paths(&[path], None).unwrap().0
            };
            let suspect = read(&case.world, &case.drive, "suspect.csv");
            let healthy = read(&case.reference_world, &case.reference_drive, "healthy.csv");
            let began = std::time::Instant::now();
            if matches!(kind, CaseKind::One(effect) if effect.family() == Family::Unlisted) {
                let found = diagnosis::diagnose(&robot, &suspect, Some(&healthy), &|_, _| {}).unwrap();
                println!(
                    "{name} {seed}: {} ({:.1} s) {:.2} W -> {:.2} W, floor {:.2} W, explainable {:.2?}",
                    found.sentence,
                    began.elapsed().as_secs_f64(),
                    found.baseline.held_out_rmse_w,
                    found.corrected.held_out_rmse_w,
                    found.baseline.noise_floor_w,
                    found.explainable,
                );
                continue;
            }
            let series = Series::new(&robot, &suspect, Some(&healthy)).unwrap();
            let found = search(&series, &robot, Some(&healthy), &|_, _| {}).unwrap();
            let named: Vec<String> = found
                .found
                .iter()
                .map(|f| {
                    format!(
                        "{:?} bic {:.0} gain {:.2} also {:?}",
                        f.applied, f.delta_bic, f.held_out_gain, f.indistinguishable_from
                    )
                })
                .collect();
            println!(
                "{name} {seed}: {} ({drawn_s:.1} + {:.1} s) from {:?}",
                if named.is_empty() { "nothing".into() } else { named.join("; ") },
                began.elapsed().as_secs_f64(),
                case.world.effects.iter().map(|e| (e.strength, e.onset_s)).collect::<Vec<_>>(),
            );
        }
    }
}
