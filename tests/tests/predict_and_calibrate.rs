//! `joulepath predict` and `joulepath calibrate` as a person and a program meet them.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr)]

use std::{
    path::{Path, PathBuf},
    process::{Command, Output},
};

use joulepath_tests::{drive_csv, program};
use serde_json::Value;

fn joulepath(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(program()).args(arguments).current_dir(folder).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn document(output: &Output) -> Value {
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A folder with a healthy drive.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("drive.csv"), drive_csv(4, 300)).unwrap();
    folder
}

fn assert_prediction(found: &Value, runs: usize, fields: &[&str]) {
    assert_eq!(found["runs"].as_array().unwrap().len(), runs, "{found}");
    let all = found["runs"].as_array().unwrap().iter().chain([&found["total"]]);
    for part in all {
        assert!(part["run"].is_string() && part["rows"].is_u64(), "{part}");
        for field in fields {
            assert!(part[field].is_f64(), "{field} in {part}");
        }
    }
}

fn assert_calibration(found: &Value) {
    let parameters = found["parameters"].as_array().unwrap();
    assert!(!parameters.is_empty());
    for parameter in parameters {
        assert!(parameter["name"].is_string() && parameter["unit"].is_string(), "{parameter}");
        assert!(parameter["value"].is_f64() && parameter["determined"].is_boolean(), "{parameter}");
        if let Some([low, high]) = parameter["interval_95"].as_array().map(Vec::as_slice) {
            assert!(low.as_f64() <= parameter["value"].as_f64(), "{parameter}");
            assert!(high.as_f64() >= parameter["value"].as_f64(), "{parameter}");
        }
    }
    assert!(found["held_out"]["rmse_w"].is_f64() && found["held_out"]["r2"].is_f64(), "{found}");
    assert!(found["robot"]["mass_kg"].is_number(), "{found}");
}

const POWER_FIELDS: [&str; 5] = ["bias_w", "rmse_w", "r2", "recorded_j", "predicted_j"];

#[test]
fn predict_and_calibrate_print_the_documents_of_the_contract() {
    let folder = folder();
    let run = |arguments: &[&str]| document(&joulepath(folder.path(), arguments));
    let before = run(&["predict", "--recording", "drive.csv", "--json"]);
    assert_prediction(&before, 4, &POWER_FIELDS);
    assert_calibration(&run(&["calibrate", "--recording", "drive.csv", "--out", "robot.json", "--json"]));
    let after = run(&["predict", "--robot", "robot.json", "--recording", "drive.csv", "--json"]);
    assert_prediction(&after, 4, &POWER_FIELDS);
    let rmse = |found: &Value| found["total"]["rmse_w"].as_f64().unwrap();
    assert!(rmse(&after) < rmse(&before), "{} W before, {} W after", rmse(&before), rmse(&after));
}

#[test]
fn without_json_a_short_summary_is_printed_and_a_report_is_written() {
    let folder = folder();
    let arguments = ["predict", "--recording", "drive.csv", "--html", "report.html"];
    let output = joulepath(folder.path(), &arguments);
    let printed = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    for word in ["drive-0", "drive-3", "total", "RMSE", "kJ"] {
        assert!(printed.contains(word), "{word} is missing in\n{printed}");
    }
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("<svg") && page.contains("drive-3"));
    let output = joulepath(folder.path(), &["calibrate", "--recording", "drive.csv", "--out", "robot.json"]);
    let printed = text(&output.stdout);
    assert!(printed.contains("mu_roll") && printed.contains("held-out runs"), "{printed}");
}

#[test]
fn wrong_input_ends_with_2_and_one_line_that_says_what_where_and_how_to_mend_it() {
    let folder = folder();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let good = drive_csv(2, 100);
    let lines: Vec<&str> = good.lines().collect();
    write("back.csv", &[&lines[..9], &[lines[5]], &lines[9..]].concat().join("\n"));
    write("word.csv", &good.replacen("0.1,", "soon,", 1));
    write("kilowatts.csv", &good.replace("power_left_w", "power_left_kw"));
    write("lava.csv", &good.replace("marble", "lava"));
    write("one.csv", &drive_csv(1, 3));
    write("robot.json", "{\"name\": \"x\"}");
    write("map.json", r#"{"name": "m", "sources": [{"channel": "power_w", "column": "p", "unit": "A"}]}"#);
    write("lift.csv", "side,force_n,rim_speed_mps,power_w\nleft,much,0.1,4\n");
    write("drive.dat", "");
    for (arguments, said) in [
        (
            "predict --recording back.csv",
            ["back.csv: line 10: time goes back from 0.7 s to 0.4 s", "sort the rows"],
        ),
        ("predict --recording word.csv", ["word.csv: line 3, column `t_s`: `soon`", "leave the cell empty"]),
        ("predict --recording kilowatts.csv", ["kilowatts.csv: power_left_w is missing", "`power_left_kw`"]),
        (
            "predict --recording lava.csv",
            ["lava.csv: run `drive-0`, row 1 of it: surface `lava`", "knows marble"],
        ),
        ("predict --recording drive.csv none.csv", ["none.csv: ", "No such file"]),
        ("predict --recording drive.dat", ["drive.dat: `.dat`", ".parquet, .mcap, .db3, .bag or .ulg"]),
        ("predict --recording drive.csv --robot r2d2", ["r2d2", "husky-a200"]),
        ("predict --recording drive.csv --robot robot.json", ["robot.json: ", "mass_kg"]),
        ("predict --recording drive.csv --map map.json", ["map.json: map, sources[0].unit: `A`", "W, kW"]),
        ("predict --recording drive.csv --columns rover", ["--columns rover", "husky, clearpath-a200"]),
        ("predict --recording drive.csv --map rover", ["--columns rover", "husky, clearpath-a200"]),
        (
            "calibrate --method dogru-marques --recording one.csv --out o.json",
            ["one.csv: ", "constant wheel speeds"],
        ),
        (
            "calibrate --recording drive.csv --out o.json --lift lift.csv",
            ["lift.csv: line 2, column `force_n`", "`much`"],
        ),
        (
            "calibrate --recording drive.csv --out none/robot.json",
            ["--out none/robot.json", "folder does not exist"],
        ),
        ("calibrate --recording drive.csv", ["--out", "required"]),
    ] {
        let output = joulepath(folder.path(), &arguments.split(' ').collect::<Vec<_>>());
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {error}");
        assert!(said.iter().all(|said| error.contains(said)), "{arguments}: {error}");
        assert!(output.stdout.is_empty(), "{arguments}");
        assert!(error.contains("required") || error.lines().count() == 1, "{arguments}: {error}");
        assert!(!folder.path().join("o.json").exists(), "{arguments}");
    }
}

#[test]
fn calibrate_adds_a_surface_that_predict_did_not_know() {
    let folder = folder();
    std::fs::write(folder.path().join("lava.csv"), drive_csv(4, 300).replace("marble", "lava")).unwrap();
    let arguments = ["calibrate", "--recording", "lava.csv", "--out", "robot.json"];
    assert!(joulepath(folder.path(), &arguments).status.success());
    let arguments = ["predict", "--robot", "robot.json", "--recording", "lava.csv", "--json"];
    assert_prediction(&document(&joulepath(folder.path(), &arguments)), 4, &POWER_FIELDS);
}

#[test]
fn what_was_mended_left_out_or_looks_wrong_is_told_beside_the_answer() {
    let folder = folder();
    let power_kw = |line: &str| -> String {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        for cell in &mut cells[5..7] {
            *cell = cell.parse::<f64>().map_or(cell.clone(), |w| format!("{}", w / 1000.0));
        }
        cells.join(",") + ",hello,7\n"
    };
    let head = "run,t_s,v_left_mps,v_right_mps,yaw_rate_radps,power_left_w,power_right_w,surface,note,gear\n";
    let rows: String = drive_csv(2, 100).lines().skip(1).map(power_kw).collect();
    std::fs::write(folder.path().join("odd.csv"), head.to_owned() + &rows + "drive-1,99").unwrap();
    let output = joulepath(folder.path(), &["predict", "--recording", "odd.csv", "--json"]);
    assert_prediction(&document(&output), 2, &POWER_FIELDS);
    let told = text(&output.stderr);
    for said in [
        "odd.csv: kept aside: gear",
        "odd.csv: not used: note (no channel, and not a number in line 2)",
        "odd.csv: line 202, the last: it breaks off after 2 of 10 cells; it was left out",
        "power_left_w: its 99th percentile is 0.",
        "is the unit right?",
    ] {
        assert!(told.contains(said), "{said} is missing in\n{told}");
    }
}

#[test]
fn runs_that_tell_nothing_are_named_and_a_few_rows_leave_what_was_known_before() {
    let folder = folder();
    let row = |run: &str, t: usize, power: &str| format!("{run},{t},0.5,0.5,{power}\n");
    let short: String = (0..4).map(|t| row("short", t, "100")).collect();
    let table = format!(
        "run,t_s,v_left_mps,v_right_mps,power_w\n{short}{}{}{}",
        row("single", 0, "90"),
        row("empty", 0, ""),
        row("empty", 1, "nan")
    );
    std::fs::write(folder.path().join("few.csv"), table).unwrap();
    let output = joulepath(folder.path(), &["predict", "--recording", "few.csv"]);
    let (printed, told) = (text_of(&output), text(&output.stderr));
    assert!(printed.contains("short") && printed.contains("single") && !printed.contains("NaN"), "{printed}");
    assert!(told.contains("few.csv, run empty: power_w: it has no value in 2 rows"), "{told}");
    let arguments = ["calibrate", "--recording", "few.csv", "--out", "robot.json", "--json"];
    let found = document(&joulepath(folder.path(), &arguments));
    let parameters = found["parameters"].as_array().unwrap();
    // Five rows at one speed may tell of a standing load, of which next to nothing was known, and of nothing else; even then its
    // interval holds what was known.
    let is_known_before = |parameter: &Value| {
        parameter["determined"] == false
            || ["drive_electronics_w", "hotel_power_w"].contains(&parameter["name"].as_str().unwrap())
                && parameter["interval_95"][0] == 0.0
    };
    assert!(parameters.iter().all(is_known_before), "{found}");
    std::fs::write(
        folder.path().join("flood.csv"),
        drive_csv(2, 100).replace(",0.", ",nan").replace(",0,", ",nan,"),
    )
    .unwrap();
    let flood = joulepath(folder.path(), &["calibrate", "--recording", "flood.csv", "--out", "o.json"]);
    assert_eq!(flood.status.code(), Some(2), "{}", text(&flood.stderr));
}

fn text_of(output: &Output) -> String {
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

#[test]
fn progress_is_shown_on_a_terminal_and_nothing_of_it_on_a_pipe() {
    let folder = folder();
    let arguments = ["calibrate", "--recording", "drive.csv", "--out", "robot.json"];
    let piped = joulepath(folder.path(), &arguments);
    assert!(piped.status.success());
    assert!(!text(&piped.stderr).contains(['\u{1b}', '\r']), "{}", text(&piped.stderr));
    // `script` (util-linux) runs a command on a terminal of its own.
    let command = format!("{} {}", program().display(), arguments.join(" "));
    let shown =
        Command::new("script").args(["-qec", &command, "/dev/null"]).current_dir(folder.path()).output();
    let Ok(shown) = shown else {
        eprintln!("SKIPPED: there is no `script` to make a terminal with");
        return;
    };
    let shown = text(&shown.stdout);
    assert!(shown.contains('\u{1b}') && shown.contains("fitting"), "{shown}");
    assert!(shown.contains("mu_roll"), "{shown}");
}

/// The real recordings: beside the repository, or where `JOULEPATH_RECORDINGS` says.
fn real(surface: &str) -> Option<String> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/recordings");
    let folder = std::env::var_os("JOULEPATH_RECORDINGS").map_or(beside, PathBuf::from);
    let file = folder.join(format!("husky-{surface}.csv"));
    if file.exists() {
        return Some(file.display().to_string());
    }
    eprintln!("SKIPPED: the real recordings are not in {}", folder.display());
    None
}

#[test]
fn a_real_husky_is_fitted_and_then_predicted_from_its_motor_currents() {
    let Some(file) = real("flooring") else { return };
    let folder = folder();
    let unfitted = joulepath(folder.path(), &["predict", "--recording", &file]);
    assert_eq!(unfitted.status.code(), Some(2));
    assert!(
        text(&unfitted.stderr).lines().last().unwrap().contains("force_n_per_a"),
        "{}",
        text(&unfitted.stderr)
    );
    let arguments = ["calibrate", "--recording", &file, "--out", "robot.json", "--json"];
    let found = document(&joulepath(folder.path(), &arguments));
    assert_calibration(&found);
    assert!(found["held_out"]["r2_a"].as_f64().unwrap() >= 0.85, "{}", found["held_out"]);
    let arguments = ["predict", "--robot", "robot.json", "--recording", &file, "--json"];
    let output = joulepath(folder.path(), &arguments);
    let fields = [&POWER_FIELDS[..], &["rmse_a", "r2_a"]].concat();
    assert_prediction(&document(&output), 5, &fields);
    assert!(text(&output.stderr).contains("never negative, although the wheels turn backwards"));
}

/// The drive with its times in another unit.
fn in_unit(per_s: f64) -> String {
    let line = |line: &str| {
        let cells: Vec<&str> = line.splitn(3, ',').collect();
        match cells[1].parse::<f64>() {
            Ok(t_s) => format!("{},{:.0},{}\n", cells[0], t_s * per_s, cells[2]),
            Err(_) => format!("{line}\n"),
        }
    };
    drive_csv(2, 700).lines().map(line).collect()
}

#[test]
fn every_command_refuses_times_in_another_unit_before_it_computes_anything() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    write("good.csv", drive_csv(2, 700));
    write(
        "lift.csv",
        "side,force_n,rim_speed_mps,power_w\nleft,60,0.1,20\nleft,60,0.3,40\nleft,60,0.5,60\n".into(),
    );
    for (per_s, unit) in [(1e3, "milliseconds"), (1e6, "microseconds"), (1e9, "nanoseconds")] {
        write("bad.csv", in_unit(per_s));
        let commands: [&[&str]; 5] = [
            &["predict", "--recording", "bad.csv"],
            &["calibrate", "--recording", "good.csv", "bad.csv", "--out", "robot.json"],
            &["calibrate", "--recording", "bad.csv", "--lift", "lift.csv", "--out", "robot.json"],
            &["diagnose", "--recording", "bad.csv", "--out", "report"],
            &["diagnose", "--recording", "good.csv", "--reference", "bad.csv", "--out", "report"],
        ];
        for command in commands {
            let output = joulepath(folder.path(), command);
            let said = text(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{command:?}: {said}");
            assert!(
                said.contains("bad.csv: line ") && said.contains("run `drive-0`: "),
                "{command:?}: {said}"
            );
            assert!(
                said.contains(" s apart") && said.contains("`t_s` must be in seconds") && said.contains(unit),
                "{command:?}: {said}"
            );
        }
    }
    assert!(!folder.path().join("robot.json").exists() && !folder.path().join("report").exists());
}

/// Six hundred rows at 10 Hz, which pandas and polars stored as durations; 6123.47 J by pandas' own units.
#[test]
fn durations_in_parquet_give_the_energy_of_the_same_drive_in_seconds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/recording/tests/files");
    for name in ["drive-pandas.parquet", "drive-polars.parquet"] {
        let found = document(&joulepath(&folder, &["predict", "--recording", name, "--json"]));
        let energy_j = found["total"]["recorded_j"].as_f64().unwrap();
        assert!((energy_j - 6123.47).abs() < 0.01, "{name}: {energy_j}");
    }
}
