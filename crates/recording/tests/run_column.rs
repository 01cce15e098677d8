//! The column `run`: what names a drive, and what would count one twice.

#![allow(clippy::unwrap_used)]

use recording::{Format, Reading, read};

/// A drive of 60 s at 10 Hz whose rows name their runs so.
fn drive(run: impl Fn(usize) -> &'static str) -> Result<Reading, recording::Error> {
    let mut text = "run,t_s,v_left_mps,v_right_mps,power_w\n".to_owned();
    (0..600).for_each(|row| text += &format!("{},{:.1},0.5,0.5,80\n", run(row), 0.1 * row as f64));
    read(text.into(), Format::Csv, "drive", None)
}

fn seconds(reading: &Reading) -> f64 {
    reading.recording.duration_s()
}

#[test]
fn blank_cells_and_other_spellings_of_a_number_count_no_second_twice() {
    for run in [
        |row: usize| if row % 20 == 7 { "" } else { "1" },
        |row| if row % 2 == 0 { "1" } else { "1.0" },
        |row| if row == 0 { "1" } else { "" },
        |row| if row % 3 == 0 { "NA" } else { "01" },
        |_| "",
    ] {
        let reading = drive(run).unwrap();
        assert_eq!(reading.recording.runs.len(), 1);
        assert!((seconds(&reading) - 59.9).abs() < 1e-9);
    }
    let told = drive(|row| if row % 20 == 7 { "" } else { "1" }).unwrap().report.repairs;
    assert!(told[0].what.starts_with("30 rows have no name"), "{told:?}");
}

#[test]
fn runs_that_take_turns_on_one_clock_are_refused_by_line() {
    let message = drive(|row| if row % 7 == 3 { "b" } else { "a" }).unwrap_err().to_string();
    assert!(message.starts_with("line 6: the runs `a`, `b` take turns"), "{message}");
    assert!(message.contains("of the 59.9 s that passed"), "{message}");
}

#[test]
fn a_run_that_goes_on_behind_another_is_one_run_with_a_gap() {
    let reading = drive(|row| if (200..400).contains(&row) { "b" } else { "a" }).unwrap();
    assert_eq!(reading.recording.runs.len(), 2);
    assert_eq!(reading.report.runs[0].gaps, 1);
}

#[test]
fn two_robots_in_one_table_sorted_by_time_stay_two_runs() {
    let mut text = "run,t_s,v_left_mps,v_right_mps,power_w\n".to_owned();
    (0..600).for_each(|row| {
        text += &format!("{},{:.1},0.5,0.5,80\n", ["a", "b"][row % 2], 0.1 * (row / 2) as f64);
    });
    let reading = read(text.into(), Format::Csv, "drive", None).unwrap();
    assert_eq!(reading.recording.runs.len(), 2);
}
