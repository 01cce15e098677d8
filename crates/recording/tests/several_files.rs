//! Several files: runs behind one another whatever form of power each has, and tables of one drive joined on time.

#![allow(clippy::unwrap_used)]

use std::{fmt::Write as _, fs, path::PathBuf};

use recording::{Channel, PowerForm, ReadingReport, Recording, read_paths};
use tempfile::TempDir;

struct Folder(TempDir);

impl Folder {
    fn new() -> Folder {
        Folder(tempfile::tempdir().unwrap())
    }

    /// Writes a table of so many rows, each made of its time.
    fn write(&self, name: &str, header: &str, step_s: f64, start_s: f64, row: fn(f64) -> String) -> PathBuf {
        let mut text = format!("t_s,{header}\n");
        let count = (30.0 / step_s) as usize;
        for t_s in (0..count).map(|i| start_s + step_s * i as f64) {
            writeln!(text, "{t_s:.4},{}", row(t_s)).unwrap();
        }
        let path = self.0.path().join(name);
        fs::write(&path, text).unwrap();
        path
    }

    fn joined(&self, names: &[&str]) -> PathBuf {
        let paths: Vec<String> =
            names.iter().map(|name| self.0.path().join(name).display().to_string()).collect();
        paths.join("+").into()
    }
}

fn told(reports: &[ReadingReport]) -> String {
    reports.iter().map(|report| format!("{report}\n")).collect()
}

const WHEELS: &str = "v_left_mps,v_right_mps";

fn power_w(t_s: f64) -> f64 {
    100.0 + 30.0 * (0.4 * t_s).sin()
}

fn energy_j(recording: &Recording) -> f64 {
    let power_w = recording.channel(Channel::Power).unwrap();
    let run = &recording.runs[0];
    let area = |row: usize| Some(recording.step_s(run, row)? * (power_w[row] + power_w[row + 1]) / 2.0);
    (0..recording.rows()).filter_map(area).filter(|joules| joules.is_finite()).sum()
}

#[test]
fn runs_that_tell_power_in_another_form_are_used_or_said_to_be_left_out() {
    let folder = Folder::new();
    let sides = folder.write("sides.csv", &format!("{WHEELS},power_left_w,power_right_w"), 0.1, 0.0, |_| {
        "1,1,20,21".into()
    });
    let battery = folder.write("battery.csv", &format!("{WHEELS},power_w"), 0.1, 0.0, |_| "1,1,41".into());
    let cells = folder
        .write("cells.csv", &format!("{WHEELS},current_a,voltage_v"), 0.1, 0.0, |_| "1,1,1.5,24".into());
    let tilted = folder.write("tilted.csv", &format!("{WHEELS},power_w,pitch_rad"), 0.1, 0.0, |t| {
        format!("1,1,41,{}", 0.01 * t)
    });
    let (joined, reports) = read_paths(&[&battery, &cells], None).unwrap();
    assert_eq!((joined.power_form(), joined.unused_runs()), (Some(PowerForm::Battery), vec![]));
    assert!((joined.channel(Channel::Power).unwrap()[joined.rows() - 1] - 36.0).abs() < 1e-9);
    assert!(!told(&reports).contains("left out"));
    let (joined, reports) = read_paths(&[&sides, &battery, &cells], None).unwrap();
    assert_eq!(joined.unused_runs().len(), 2);
    for run in ["battery", "cells"] {
        let said = told(&reports);
        assert!(
            said.contains(run) && said.contains("left out: it has no power_left_w, power_right_w"),
            "{said}"
        );
        assert!(said.contains("sides.csv"), "{said}");
    }
    for files in [[&battery, &tilted], [&tilted, &battery]] {
        let said = told(&read_paths(&files, None).unwrap().1);
        assert!(said.contains("left out: it has no pitch_rad"), "{said}");
    }
}

#[test]
fn wheels_and_power_in_two_tables_are_one_drive_at_any_rates() {
    let truth_j: f64 = (0..30_000).map(|i| 1e-3 * power_w(1e-3 * f64::from(i))).sum();
    for (wheels_s, power_s, offset_s) in [
        (0.1, 0.1, 0.0),
        (0.1, 0.1, 0.043),
        (0.1, 1.0, 0.01),
        (0.02, 0.1, 0.003),
        (1.0, 0.1, 0.0),
        (0.5, 0.04, 0.001),
    ] {
        let folder = Folder::new();
        folder.write("wheels.csv", WHEELS, wheels_s, 0.0, |t| format!("{},1", 0.01 * t));
        folder.write("power.csv", "power_w", power_s, offset_s, |t| power_w(t).to_string());
        let (recording, reports) = read_paths(&[folder.joined(&["wheels.csv", "power.csv"])], None).unwrap();
        let lost = 1.0 - energy_j(&recording) / truth_j;
        assert!(lost.abs() < 0.05, "{wheels_s} s, {power_s} s: {lost}\n{}", told(&reports));
        let left = recording.channel(Channel::LeftSpeed).unwrap();
        let known = (0..recording.rows()).filter(|row| !left[*row].is_nan());
        assert!(known.clone().count() as f64 > 0.9 * recording.rows() as f64, "{}", told(&reports));
        assert!(known.clone().all(|row| (left[row] - 0.01 * recording.t_s[row]).abs() < 1e-9));
        assert_eq!((recording.runs.len(), recording.runs[0].name.as_str()), (1, "wheels"));
    }
}

#[test]
fn tables_that_cannot_be_joined_are_refused_by_name_and_reason() {
    let folder = Folder::new();
    folder.write("wheels.csv", WHEELS, 0.1, 0.0, |_| "1,1".into());
    folder.write("power.csv", "power_w", 0.1, 0.0, |_| "40".into());
    folder.write("later.csv", "power_w", 0.1, 1.7e9, |_| "40".into());
    folder.write("pitch.csv", "pitch_rad", 0.1, 0.0, |t| format!("{}", 0.001 * t));
    let runs = "run,t_s,power_w\na,0,40\na,1,40\nb,0,40\n";
    fs::write(folder.0.path().join("runs.csv"), runs).unwrap();
    fs::write(folder.0.path().join("drive.mcap"), "").unwrap();
    for (names, said) in [
        (&["wheels.csv", "later.csv"][..], "do not meet; both must count from the same moment"),
        (&["wheels.csv", "power.csv", "power.csv"], "give power_w; remove or rename"),
        (&["wheels.csv", "runs.csv"], "has the runs `wheels` and"),
        (&["wheels.csv", "drive.mcap"], "only tables, .csv or .parquet, can be joined"),
        (&["wheels.csv", "gone.csv"], "gone.csv: "),
        (&["wheels.csv", "pitch.csv"], "power (power_left_w and power_right_w, or"),
    ] {
        let message = read_paths(&[folder.joined(names)], None).unwrap_err().to_string();
        assert!(message.contains(said), "{said}: {message}");
    }
    let three = read_paths(&[folder.joined(&["wheels.csv", "power.csv", "pitch.csv"])], None).unwrap().0;
    assert!(three.channel(Channel::Pitch).is_some());
    let plus = folder.write("a+b.csv", &format!("{WHEELS},power_w"), 0.1, 0.0, |_| "1,1,40".into());
    assert_eq!(read_paths(&[plus], None).unwrap().0.runs[0].name, "a+b", "a file of such a name is itself");
}
