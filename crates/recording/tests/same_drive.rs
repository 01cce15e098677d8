//! Files that hold seconds of one drive twice, and drives that are alike and not the same.

#![allow(clippy::unwrap_used)]

use std::{fs, path::PathBuf};

use recording::{Error, read_paths};
use tempfile::TempDir;

/// How a file holds a drive.
#[derive(Clone, Copy)]
struct Copy {
    rows: [u32; 2],
    every: usize,
    start_s: f64,
    digits: usize,
    /// Which drive: phase of its motion and seed of its noise.
    drive: u32,
}

const WHOLE: Copy = Copy { rows: [0, 900], every: 1, start_s: 0.0, digits: 4, drive: 0 };

fn write(folder: &TempDir, name: &str, copy: Copy) -> PathBuf {
    let mut text = "t_s,v_left_mps,v_right_mps,power_w\n".to_owned();
    for row in (copy.rows[0]..copy.rows[1]).step_by(copy.every) {
        let t_s = 0.1 * f64::from(row);
        let noise = f64::from((row + 1).wrapping_mul(2_654_435_761 + 97 * copy.drive) >> 20) / 4096.0 - 0.5;
        let turn = (0.7 * t_s + f64::from(copy.drive)).sin();
        let (left, right, power) = (0.5 + 0.2 * turn, 0.5 - 0.2 * turn, 80.0 + 30.0 * turn + 20.0 * noise);
        let (t_s, digits) = (copy.start_s + t_s, copy.digits);
        text += &format!("{t_s:.1},{left:.digits$},{right:.digits$},{power:.digits$}\n");
    }
    let path = folder.path().join(name);
    fs::write(&path, text).unwrap();
    path
}

fn both(one: Copy, other: Copy) -> Result<usize, Error> {
    let folder = tempfile::tempdir().unwrap();
    let paths = [write(&folder, "one.csv", one), write(&folder, "other.csv", other)];
    read_paths(&paths, None).map(|(recording, _)| recording.runs.len())
}

#[test]
fn seconds_that_two_files_hold_are_refused() {
    let unix = Copy { start_s: 1.7e9, ..WHOLE };
    for (one, other) in [
        (Copy { rows: [0, 600], ..unix }, Copy { rows: [300, 900], ..unix }),
        (WHOLE, Copy { every: 2, ..WHOLE }),
        (Copy { every: 3, ..WHOLE }, WHOLE),
        (WHOLE, Copy { digits: 2, ..WHOLE }),
        (WHOLE, Copy { rows: [200, 700], ..WHOLE }),
    ] {
        let message = both(one, other).unwrap_err().to_string();
        assert!(message.contains("one.csv") && message.contains("other.csv"), "{message}");
        assert!(message.contains("hold the same drive from"), "{message}");
    }
}

#[test]
fn other_drives_and_rows_that_follow_are_read() {
    let unix = Copy { start_s: 1.7e9, ..WHOLE };
    for (one, other) in [
        (Copy { rows: [0, 450], ..unix }, Copy { rows: [450, 900], ..unix }),
        (WHOLE, Copy { drive: 1, ..WHOLE }),
        // Two robots at the same time.
        (unix, Copy { drive: 2, ..unix }),
        // Row by row the same: those who count leave it out and say so.
        (WHOLE, Copy { rows: [0, 500], ..WHOLE }),
    ] {
        assert_eq!(both(one, other).unwrap(), 2);
    }
}

#[test]
fn a_run_that_no_model_uses_counts_nothing_twice() {
    let folder = tempfile::tempdir().unwrap();
    let lean = write(&folder, "lean.csv", Copy { every: 2, ..WHOLE });
    let tilted = write(&folder, "tilted.csv", WHOLE);
    let lines: Vec<String> = fs::read_to_string(&tilted).unwrap().lines().map(str::to_owned).collect();
    let pitched =
        |(row, line): (usize, &String)| format!("{line},{}\n", if row == 0 { "pitch_rad" } else { "0.01" });
    fs::write(&tilted, lines.iter().enumerate().map(pitched).collect::<String>()).unwrap();
    let (recording, _) = read_paths(&[tilted, lean], None).unwrap();
    assert_eq!(recording.unused_runs().len(), 1);
}

#[test]
fn rows_whose_wheels_and_power_are_equal_are_a_copy_whatever_other_sensors_read() {
    let folder = tempfile::tempdir().unwrap();
    let with_yaw = |name: &str, copy: Copy, yaw: &str| {
        let path = write(&folder, name, copy);
        let text = fs::read_to_string(&path).unwrap();
        let of = |(row, line): (usize, &str)| {
            format!("{line},{}\n", if row == 0 { "yaw_rate_radps" } else { yaw })
        };
        fs::write(&path, text.lines().enumerate().map(of).collect::<String>()).unwrap();
        path
    };
    let paths =
        [with_yaw("one.csv", WHOLE, "0.01"), with_yaw("other.csv", Copy { rows: [0, 500], ..WHOLE }, "0.02")];
    assert_eq!(read_paths(&paths, None).unwrap().0.runs.len(), 2);
}
