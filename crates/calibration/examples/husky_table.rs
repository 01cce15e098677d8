//! The table of the real Husky's recordings: every run judged by a fit that did not see it.
//!
//! `cargo run --release -p joulepath-calibration --example husky_table`, with the files in `../shared/recordings` beside the
//! workspace or where `JOULEPATH_RECORDINGS` says.

#![allow(clippy::unwrap_used)]

use std::path::PathBuf;

use calibration::{
    Calibration, Drives, Options, calibrate,
    current::YawSource,
    current_calibration::{CurrentCalibration, fit_currents},
    current_judge::judge,
};
use model::Robot;

const SURFACES: [&str; 4] = ["flooring", "asphalt", "ice", "sandy-loam"];

fn main() {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/recordings");
    let folder = std::env::var_os("JOULEPATH_RECORDINGS").map_or(beside, PathBuf::from);
    let file = |surface: &str| folder.join(format!("husky-{surface}.csv"));
    if !SURFACES.iter().chain(&["snow"]).all(|surface| file(surface).exists()) {
        println!("SKIPPED: the Husky's recordings are not in {}", folder.display());
        return;
    }
    let mut robot = model::builtin::husky_a200();
    // The built-in robot's sandy loam comes from this table and must not vouch for itself.
    robot.surfaces.remove("sandy_loam");
    let (recording, _) = recording::read_paths(&SURFACES.map(file), None).unwrap();
    let drives = Drives::new(&robot, &recording).unwrap();
    let options = Options { reference_surface: std::env::args().nth(1), ..Options::default() };
    let found = fit_currents(&robot, &drives, &options).unwrap();
    print_surfaces(&found);
    print_forces(&found);
    print_friction(&calibrate(&robot, &recording, &options).unwrap());
    print_files(&robot, &SURFACES.map(|surface| vec![file(surface)]));
    let (snow, _) = recording::read_paths(&[file("snow")], None).unwrap();
    print_snow(&found, &Drives::new(&found.robot, &snow).unwrap());
    println!(
        "\nThe paper fitted and judged on the same drives; here no run is judged by a fit that saw it.\n\
         The structure of the model, the prior widths and the stuck rule were chosen on all of these runs."
    );
}

fn print_surfaces(found: &CurrentCalibration) {
    println!("reference {}, slip track {:.3} m\n", found.reference, found.robot.slip_track_m);
    println!(
        "| surface | runs | R², first half judged, second | power, eq. 17 | energy by run, median | worst run |"
    );
    println!("| --- | --- | --- | --- | --- | --- |");
    for verdict in found.surfaces.iter().filter_map(|s| s.verdict.as_ref()) {
        let worst =
            verdict.energy_error_percent.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap();
        println!(
            "| {} | {} | {:.2}, {:.2} | {:.1} % | {:.1} % | {} {:+.0} % |",
            verdict.surface,
            verdict.runs,
            verdict.r2_a[1],
            verdict.r2_a[0],
            verdict.normalized_error_percent,
            verdict.median_energy_error_percent,
            worst.0,
            worst.1
        );
    }
    println!("| the paper's marble (Table IV) | | | 3.3 to 4.0 % | | |");
    println!("| the paper's soil (Table IV) | | | 11.9 % | | |");
}

fn print_forces(found: &CurrentCalibration) {
    println!("\nforce per ampere, each surface alone (95 %)");
    for surface in &found.surfaces {
        let [low, high] = surface.force_alone.force_interval_n_per_a(&found.robot);
        let force_n_per_a = surface.force_alone.force_n_per_a(&found.robot);
        println!("{:<11} {force_n_per_a:>6.1} N/A  [{low:.1}, {high:.1}]", surface.surface);
    }
}

/// How well robot files of half of the runs predict the others, as `calibrate` says and `predict` finds, each ground calibrated alone.
fn print_files(robot: &Robot, grounds: &[Vec<PathBuf>]) {
    println!(
        "\n| robot file of | R² of side current, held out | by half of the runs | RMSE | the file on its own runs |"
    );
    println!("| --- | --- | --- | --- | --- |");
    for files in grounds {
        let (recording, _) = recording::read_paths(files, None).unwrap();
        let found = calibrate(robot, &recording, &Options::default()).unwrap();
        let (held_out, written) = (found.held_out.unwrap(), found.as_written.unwrap());
        let [first, second] = [0, 1].map(|fold: usize| held_out.folds[fold].skill.r2_a.unwrap());
        println!(
            "| {} | {:.2} | {second:.2}, {first:.2} | {:.2} A | {:.2} |",
            recording.surface.unwrap().names.join(", "),
            held_out.r2_a.unwrap(),
            held_out.rmse_a.unwrap(),
            written.r2_a.unwrap()
        );
    }
}

/// What the robot file gets: friction as shares of the weight, at the reference's force per ampere.
fn print_friction(found: &Calibration) {
    println!("\nrobot file                                     value  95 %");
    for parameter in found.parameters.iter().filter(|p| !p.name.starts_with("current_model")) {
        let [low, high] = parameter.interval_95.unwrap_or([f64::NAN; 2]);
        let held = if parameter.determined { "" } else { "  not determined, held" };
        println!("{:<43} {:>8.3}  [{low:.3}, {high:.3}]{held}", parameter.name, parameter.value);
    }
}

fn print_snow(found: &CurrentCalibration, snow: &Drives) {
    println!("\nsnow, held out: rows judged and yaw rate from      R² 1→2  R² 2→1  pooled");
    for (label, drives) in [("all rows", snow.clone().including_stuck()), ("rows not stuck", snow.clone())] {
        for (source, yaw) in [("wheels", YawSource::Wheels), ("gyroscope", YawSource::Gyroscope)] {
            let (v, _) = judge(&found.robot, &drives, &found.reference_halves, false, yaw).unwrap();
            println!(
                "{label:<15} {source:<30} {:>10.3}  {:>6.3}  {:>6.3}",
                v.r2_a[0], v.r2_a[1], v.pooled_r2_a
            );
        }
    }
    println!("runs on snow in which the wheels turn and the robot does not, share of rows:");
    for (run, name) in snow.runs.iter().enumerate() {
        let rows: Vec<_> = snow
            .stretches
            .iter()
            .filter(|s| s.run == run)
            .flat_map(|s| snow.rows[s.rows.clone()].iter())
            .collect();
        let stuck = rows.iter().filter(|row| row.stuck).count();
        if rows.is_empty() {
            println!("  {name}: repeats the beginning of another run, left out");
        } else if stuck > 0 {
            println!("  {name}: {:.0} %", 100.0 * stuck as f64 / rows.len() as f64);
        }
    }
}
