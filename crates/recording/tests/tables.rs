//! CSV and Parquet tables: what is read, what is refused and in which words, what is repaired and told.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stderr)]

use std::{path::PathBuf, sync::Arc};

use ::parquet::{
    data_type::DoubleType, file::writer::SerializedFileWriter, schema::parser::parse_message_type,
};
use proptest::prelude::*;
use recording::{Channel, Format, Map, PowerForm, Reading, SuspicionKind, read, read_paths};

fn csv(text: &str) -> Result<Reading, recording::Error> {
    read(text.as_bytes().to_vec(), Format::Csv, "drive", None)
}

const SMALL: &str = "t_s,v_left_mps,v_right_mps,power_w,note,gear\n\
                     0.0,0.1,0.2,50,start,1\n0.1,0.2,,51,,2\n0.2,0.3,nan,52,turn,3\n";

#[test]
fn a_small_table_is_read_with_gaps_and_unknown_columns_aside() {
    let Reading { recording, report } = csv(SMALL).unwrap();
    assert_eq!(recording.t_s, [0.0, 0.1, 0.2]);
    let right = recording.channel(Channel::RightSpeed).unwrap();
    assert!(right[0] == 0.2 && right[1].is_nan() && right[2].is_nan());
    assert_eq!(recording.aside["gear"], [1.0, 2.0, 3.0]);
    assert_eq!(recording.runs[0].name, "drive");
    assert_eq!(report.power_form, Some(PowerForm::Battery));
    let note = report.ignored.iter().find(|ignored| ignored.name == "note").unwrap();
    assert!(note.reason.contains("line 2"), "{note:?}");
    let used = report.channels.iter().find(|used| used.channel == Channel::RightSpeed).unwrap();
    assert_eq!((used.present, used.gaps), (1, 1));
    assert!((report.runs[0].rate_hz.unwrap() - 10.0).abs() < 1e-9);
}

#[test]
fn semicolons_tabs_a_byte_order_mark_quotes_and_blank_lines_are_read() {
    for text in [
        SMALL.replace(',', ";"),
        SMALL.replace(',', "\t"),
        format!("\u{feff}{SMALL}"),
        SMALL.replace("start", "\"start, then\ngo\""),
        SMALL.replace("\n0.1", "\n\n0.1"),
        SMALL.replace('\n', "\r\n"),
    ] {
        assert_eq!(csv(&text).unwrap().recording.rows(), 3, "{text}");
    }
}

#[test]
fn bad_tables_are_refused_by_place_and_remedy() {
    for (text, said) in [
        (SMALL.replace("0.1,0.2,,51", "0.1,fast,,51"), "line 3, column `v_left_mps`: `fast`"),
        (SMALL.replace("0.1,0.2,,51", "0.1,inf,,51"), "line 3, column `v_left_mps`: `inf`"),
        (SMALL.replace("\n0.2,0.3", "\n0.1,0.3"), "line 4: time repeats"),
        (SMALL.replace("\n0.2,0.3", "\n0.05,0.3"), "line 4: time goes back from 0.1 s to 0.05 s"),
        (SMALL.replace("\n0.2,0.3", "\n,0.3"), "line 4: there is no time in column `t_s`"),
        (SMALL.replace("\n0.2,0.3", "\n\n0.1,0.3"), "line 5: time repeats"),
        (SMALL.replace("\n0.2,0.3", "\n0.1,0.3").replace('\n', "\r\n"), "line 4: time repeats"),
        (SMALL.replace("start", "\"a\nb\"").replace("\n0.2,0.3", "\n0.1,0.3"), "line 5: time repeats"),
        (SMALL.replace("start", "\"start"), "line 2: a quotation mark opens in column 5"),
        (
            SMALL.replace("0.2,0.3", "0.2,\"0.3") + "0.3,0.4,0,50,,1\n",
            "line 4: a quotation mark opens in column 2",
        ),
        (format!("# a remark\n{SMALL}").replace("start", "\"start"), "line 3: a quotation mark opens"),
        (SMALL.replace("51,,2", "51,2"), "line 3: 5 cells, but the header has 6"),
        (SMALL.replace("power_w", "power_kw"), "did you mean `power_kw` for power_w"),
        (SMALL.replace("t_s", "time"), "t_s is missing; found: time, v_left_mps"),
        (SMALL.replace("v_left_mps", "v_left_kmph"), "`v_left_kmph` for v_left_mps"),
        (SMALL.replace("power_w", "power_left_w"), "power_right_w is missing"),
        (
            SMALL.replace("v_left_mps", "speed"),
            "v_left_mps is missing; found: t_s, speed, v_right_mps, power_w, note, gear; rename",
        ),
        (
            SMALL.replace("v_left_mps", "v_rechts_mps").replace("v_right_mps", "vr_right_mps"),
            "`v_rechts_mps` for v_left_mps, `vr_right_mps` for v_right_mps",
        ),
        (SMALL.replace("power_w", "voltage_v"), "power (power_left_w and power_right_w, or power_w, or"),
        (SMALL.replace("power_w", "current_a"), "voltage_v is missing"),
        (SMALL.replace("gear", "note"), "two columns give note"),
        (SMALL.replace("50", "").replace("51", "nan").replace("52", "NaN"), "power_w (without a number)"),
        ("t_s,v_left_mps,v_right_mps,power_w\n".into(), "no row"),
        (String::new(), "empty file"),
        ("\u{1}\u{2}\n".into(), "t_s is missing"),
        (SMALL.replace("0.1,0.2,,51", "#DIV/0!,0.2,,51"), "line 3, column `t_s`: `#DIV/0!`"),
        (SMALL.replace("\n0.1,0.2", "\ntime,left"), "the line looks like another header"),
        (SMALL.replace("0.1,0.2,,51", "0.1,\0\0\0,,51"), "zero bytes, as a loss of power leaves them"),
        (SMALL.replace("\n0.", "\n1,0."), "row.names = FALSE"),
    ] {
        let message = csv(&text).unwrap_err().to_string();
        assert!(message.contains(said), "{text}\n  said: {message}");
    }
}

#[test]
fn a_missing_value_in_the_first_column_is_no_remark() {
    let swapped =
        "power_w,t_s,v_left_mps,v_right_mps\n50,0,1,1\n#N/A,1,1,1\n52,2,1,1\n# a remark\n#53,3,1,1\n";
    let Reading { recording, report } = csv(swapped).unwrap();
    assert!(recording.rows() == 3 && recording.channel(Channel::Power).unwrap()[1].is_nan(), "{report}");
    assert!(report.repairs.iter().any(|repair| repair.what.starts_with("2 are remarks")), "{report}");
}

#[test]
fn the_sign_of_a_drawn_current_is_found_in_tables() {
    let map = Map::from_json(
        r#"{"name": "lab", "sources": [{"channel": "current_a", "column": "cur", "unit": "A", "sign": "drawn"}]}"#,
    )
    .unwrap();
    let mut text = "t_s,v_left_mps,v_right_mps,cur,voltage_v\n".to_owned();
    (0..50).for_each(|row| text += &format!("{row},0.5,0.5,-{}.5,24\n", row % 3));
    let Reading { recording, report } = read(text.into(), Format::Csv, "drive", Some(&map)).unwrap();
    assert!(recording.channel(Channel::Current).unwrap().iter().all(|current_a| *current_a > 0.0));
    assert!(report.repairs.iter().any(|repair| repair.place == "column `cur`"), "{report}");
}

#[test]
fn a_column_of_numbers_named_run_is_refused_rather_than_taken_for_as_many_drives() {
    let rows: String = (0..20_000).map(|row| format!("{row}.5,{row},1,1,1\n")).collect();
    let message = csv(&format!("run,t_s,v_left_mps,v_right_mps,power_w\n{rows}")).unwrap_err().to_string();
    assert!(message.contains("line 10002, column `run`: more than 10000 different names"), "{message}");
}

#[test]
fn a_run_without_a_number_among_others_is_told() {
    let rows =
        |run: &str, power: &str| -> String { (0..3).map(|t| format!("{run},{t},1,1,{power}\n")).collect() };
    let text = format!("run,t_s,v_left_mps,v_right_mps,power_w\n{}{}", rows("a", "40"), rows("b", ""));
    let report = csv(&text).unwrap().report;
    let doubt = report.suspicions.iter().find(|doubt| doubt.run.as_deref() == Some("b")).unwrap();
    assert!(doubt.channel == Channel::Power && doubt.statement.contains("no value in 3 rows"), "{report}");
}

#[test]
fn time_that_goes_back_in_parquet_is_refused_by_row() {
    let schema = "message drive { required double t_s; required double v_left_mps; required double v_right_mps; required double power_w; }";
    let schema = Arc::new(parse_message_type(schema).unwrap());
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::default()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for values in [[0.0, 2.0, 1.0], [1.0; 3], [1.0; 3], [40.0; 3]] {
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(&values, None, None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
    let message = read(bytes, Format::Parquet, "drive", None).unwrap_err().to_string();
    assert!(message.starts_with("row 3: time goes back from 2 s to 1 s"), "{message}");
}

#[test]
fn a_last_line_that_breaks_off_is_left_out_and_told() {
    let Reading { recording, report } = csv(SMALL.trim_end_matches("an,52,turn,3\n")).unwrap();
    assert_eq!(recording.rows(), 2);
    assert!(report.repairs[0].what.contains("breaks off after 3 of 6"), "{report}");
}

#[test]
fn runs_that_lie_apart_are_brought_together_and_keep_their_own_time() {
    let text = "run,t_s,v_left_mps,v_right_mps,power_w,surface\n\
                a,0,1,1,1,ice\nb,0,2,2,2,mud\na,1,3,3,3,ice\nb,1,4,4,4,mud\n";
    let Reading { recording, report } = csv(text).unwrap();
    assert_eq!(recording.channel(Channel::Power).unwrap(), [1.0, 3.0, 2.0, 4.0]);
    assert_eq!((recording.runs[1].name.as_str(), recording.runs[1].rows.clone()), ("b", 2..4));
    assert_eq!(recording.surface.as_ref().unwrap().get(1), Some("ice"));
    assert_eq!(report.repairs.len(), 1);
    let wrong = text.replace("b,1,4", "b,0,4");
    assert!(
        csv(&wrong).unwrap_err().to_string().starts_with("line 5: time repeats"),
        "its own line is named"
    );
}

#[test]
fn a_map_names_columns_units_and_signs() {
    let text = "stamp,L,R,fl,P,nose_down_deg\n0,3.6,7.2,1,0.05,-90\n500,3.6,7.2,3,0.06,0\n";
    let map = r#"{"name": "lab", "wheel_radius_m": 0.1, "surface": "tiles", "sources": [
        {"channel": "t_s", "column": "stamp", "unit": "ms"},
        {"channel": "v_left_mps", "columns": ["L", "fl"], "combine": "product", "unit": "km/h"},
        {"channel": "v_right_mps", "column": "R", "unit": "rad/s"},
        {"channel": "power_w", "column": "P", "unit": "kW"},
        {"channel": "pitch_rad", "column": "nose_down_deg", "unit": "deg", "scale": -1},
        {"channel": "roll_rad", "column": "absent"}]}"#;
    let map = Map::from_json(map).unwrap();
    let Reading { recording, report } = read(text.into(), Format::Csv, "lab", Some(&map)).unwrap();
    assert_eq!(recording.t_s, [0.0, 0.5]);
    assert!((recording.channel(Channel::LeftSpeed).unwrap()[1] - 3.0).abs() < 1e-12);
    assert!((recording.channel(Channel::RightSpeed).unwrap()[0] - 0.72).abs() < 1e-12);
    assert!((recording.channel(Channel::Power).unwrap()[0] - 50.0).abs() < 1e-12);
    let pitch = recording.channel(Channel::Pitch).unwrap()[0];
    assert!((pitch - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    assert_eq!(recording.surface.unwrap().names, ["tiles"]);
    assert!(report.ignored.iter().any(|ignored| ignored.name == "absent"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_text_is_read_or_refused(text in "(t_s,v_left_mps,v_right_mps,power_w\n)?([-0-9.,;\"a\n\r]{0,200})") {
        let _ = csv(&text);
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        for format in [Format::Csv, Format::Parquet, Format::Mcap, Format::Bag] {
            let _ = read(bytes.clone(), format, "noise", None);
        }
    }
}

/// The real recordings: beside the workspace, or where `JOULEPATH_RECORDINGS` says.
fn real_files() -> Option<Vec<PathBuf>> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/recordings");
    let folder = std::env::var_os("JOULEPATH_RECORDINGS").map_or(beside, PathBuf::from);
    let names = ["asphalt", "flooring", "ice", "sandy-loam", "snow"];
    let files: Vec<PathBuf> = names.iter().map(|name| folder.join(format!("husky-{name}.csv"))).collect();
    if files.iter().all(|file| file.exists()) {
        return Some(files);
    }
    eprintln!("SKIPPED: the real recordings are not in {}", folder.display());
    None
}

#[test]
fn a_run_in_kilowatts_among_others_in_watts_is_suspicious() {
    let mut text = "run,t_s,v_left_mps,v_right_mps,power_w\n".to_owned();
    for (run, scale) in [("a", 1.0), ("b", 1.0), ("c", 0.001)] {
        for row in 0..60 {
            text += &format!("{run},{row},1,0.9,{}\n", scale * f64::from(100 + row));
        }
    }
    let report = csv(&text).unwrap().report;
    let mixed =
        report.suspicions.iter().filter(|d| d.kind == SuspicionKind::Unit && d.channel == Channel::Power);
    let runs: Vec<&str> = mixed.filter_map(|doubt| doubt.run.as_deref()).collect();
    assert_eq!(runs, ["c"], "{report}");
}

#[test]
fn the_real_recordings_are_read_whole_and_their_oddities_told() {
    let Some(files) = real_files() else { return };
    for map in [None, Map::built_in("borealtc")] {
        let (recording, reports) = read_paths(&files, map.as_ref()).unwrap();
        assert_eq!(recording.rows(), 2790 + 4780 + 3716 + 2233 + 4481);
        assert_eq!(recording.runs.len(), 4 + 5 + 5 + 8 + 14);
        assert_eq!(recording.power_form(), Some(PowerForm::MotorCurrents));
        for report in &reports {
            assert!(report.ignored.is_empty() && report.repairs.is_empty(), "{report}");
            assert!(report.runs.iter().all(|run| (run.rate_hz.unwrap() - 6.5).abs() < 0.1), "{report}");
            let of = |kind| report.suspicions.iter().filter(move |doubt| doubt.kind == kind);
            assert_eq!(of(SuspicionKind::Unsigned).count(), 2, "{report}");
            assert_eq!(of(SuspicionKind::Unit).count(), 0, "{report}");
        }
        if map.is_none() {
            reports.iter().for_each(|report| eprintln!("{report}"));
        }
        // On snow the wheels turn and the robot does not; on flooring it does.
        let slips =
            |at: usize| reports[at].suspicions.iter().filter(|d| d.kind == SuspicionKind::Slip).count();
        assert!(slips(4) > 0 && slips(1) == 0, "{} on snow, {} on flooring", slips(4), slips(1));
    }
}

#[test]
fn a_counter_that_goes_beyond_where_it_is_said_to_begin_anew_is_refused_with_both_numbers() {
    let counts = |i: u32| i * 700 % 65_536;
    let rows: String =
        (0..200).map(|i| format!("{}.{},{},{},60\n", i / 10, i % 10, counts(i), counts(i))).collect();
    let read_with = |wraps_at: f64| {
        let source = |side: &str| {
            format!(
                r#"{{"channel": "v_{side}_mps", "column": "{side}", "unit": "rad/s", "scale": 0.0015, "derivative": true, "wraps_at": {wraps_at}}}"#
            )
        };
        let map = format!(
            r#"{{"name": "counters", "wheel_radius_m": 0.165, "sources": [{}, {}]}}"#,
            source("left"),
            source("right")
        );
        let map = Map::from_json(&map).unwrap();
        read(format!("t_s,left,right,power_w\n{rows}").into_bytes(), Format::Csv, "drive", Some(&map))
    };
    let speeds = read_with(65_536.0).unwrap().recording;
    assert!(speeds.channel(Channel::LeftSpeed).unwrap().iter().all(|v| (v - 1.7325).abs() < 1e-6));
    let refused = read_with(98.3).unwrap_err().to_string();
    assert!(
        refused.contains("sources[0].wraps_at") && refused.contains("98.3") && refused.contains("65"),
        "{refused}"
    );
}
