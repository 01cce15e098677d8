//! Everyday spellings of one table: all are read as the same drive, or refused by place and remedy.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{fmt::Write as _, fs};

use recording::{Error, Format, Map, Reading, read, read_path};

const HEADER: [&str; 4] = ["t_s", "v_left_mps", "v_right_mps", "power_w"];

fn rows() -> Vec<[String; 4]> {
    let row = |i: i32| {
        let t_s = 0.25 * f64::from(i);
        [
            format!("{t_s:.2}"),
            format!("{:.1}", 0.1 * f64::from(i)),
            "-0.5".into(),
            format!("{:.2}", 40.25 + t_s),
        ]
    };
    (0..40).map(row).collect()
}

fn table(separator: &str) -> String {
    let mut text = HEADER.join(separator) + "\n";
    rows().iter().for_each(|row| writeln!(text, "{}", row.join(separator)).unwrap());
    text
}

fn csv(text: impl Into<Vec<u8>>) -> Result<Reading, Error> {
    read(text.into(), Format::Csv, "drive", None)
}

fn utf16(text: &str) -> Vec<u8> {
    format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect()
}

fn calendar(separator: &str, shown: fn(f64) -> String) -> String {
    let mut text = HEADER.join(separator) + "\n";
    for [t_s, left, right, power] in rows() {
        let t_s = shown(t_s.parse().unwrap());
        writeln!(text, "{}", [t_s, left, right, power].join(separator)).unwrap();
    }
    text
}

#[test]
fn every_everyday_spelling_is_the_same_drive() {
    let whole = csv(table(",")).unwrap().recording;
    assert_eq!(whole.rows(), 40);
    let commas = |separator: &str| table(separator).replace('.', ",");
    for (what, text) in [
        ("a decimal comma", commas(";").into_bytes()),
        ("a decimal comma between tabs", commas("\t").into_bytes()),
        ("bars", table("|").into_bytes()),
        ("spaces", table(" ").into_bytes()),
        ("aligned spaces", format!("  {}", table("   ").replace('\n', " \n  ")).into_bytes()),
        ("Excel's separator", format!("sep=;\r\n{}", table(";").replace('\n', "\r\n")).into_bytes()),
        ("Excel in German", format!("sep=;\r\n{}", commas(";").replace('\n', "\r\n")).into_bytes()),
        ("UTF-16", utf16(&table(","))),
        ("UTF-16 of Excel", utf16(&commas("\t"))),
        ("remarks before", format!("# run 3\n% v2\n\n{}", table(",")).into_bytes()),
        ("remarks within", table(",").replace("\n1.00", "\n# a stone, here\n1.00").into_bytes()),
        ("a header behind a mark", format!("# {}", table(",")).into_bytes()),
        ("a header behind a mark and spaces", format!("# {}", table(" ")).into_bytes()),
        ("a header behind a percent sign", format!("%{}", table(",")).into_bytes()),
        ("trailing commas", table(",").replace('\n', ",,\n").into_bytes()),
        ("trailing commas of rows", table(",").replace('\n', ",\n").replacen("w,\n", "w\n", 1).into_bytes()),
        ("trailing commas of the header", table(",").replacen('\n', ",,\n", 1).into_bytes()),
        ("rows of commas", (table(",") + ",,,\n,,,\n").into_bytes()),
        ("units", table(",").replacen('\n', "\ns,m/s,mps,[W]\n", 1).into_bytes()),
        ("units of some", table(",").replacen('\n', "\nsec,,-,watts\n", 1).into_bytes()),
    ] {
        let read = csv(text).unwrap_or_else(|error| panic!("{what}: {error}")).recording;
        assert_eq!((&read.t_s, &read.channels), (&whole.t_s, &whole.channels), "{what}");
    }
}

#[test]
fn dates_and_clocks_are_seconds_a_quarter_apart() {
    let date: fn(f64) -> String = |t| format!("2023-11-14T22:13:{:06.3}", 20.0 + t);
    let spaced: fn(f64) -> String = |t| format!("2023-11-14 22:13:{:09.6}+00:00", 20.0 + t);
    let german: fn(f64) -> String = |t| format!("2023-11-14 22:13:{:05.2}", 20.0 + t).replace('.', ",");
    let duration: fn(f64) -> String = |t| format!("0 days 00:00:{t:09.6}");
    for (text, start_s) in [
        (calendar(",", date), 1.7e9),
        (calendar(";", spaced), 1.7e9),
        (calendar(";", german), 1.7e9),
        (calendar(",", duration), 0.0),
    ] {
        let Reading { recording, report } = csv(text).unwrap();
        let expected = (0..40).map(|i| start_s + 0.25 * f64::from(i));
        assert!(recording.t_s.iter().zip(expected).all(|(t, e)| (t - e).abs() < 1e-6), "{report}");
        assert!(report.repairs.iter().any(|repair| repair.what.contains("dates or times")), "{report}");
    }
    let map = |unit: &str| {
        let source = format!(r#"{{"channel": "t_s", "column": "t_s", "unit": "{unit}"}}"#);
        Map::from_json(&format!(r#"{{"name": "lab", "sources": [{source}]}}"#)).unwrap()
    };
    // The unit of a map is that of numbers.
    for unit in ["s", "ns"] {
        let read = read(calendar(",", date).into_bytes(), Format::Csv, "drive", Some(&map(unit))).unwrap();
        assert_eq!((read.recording.rows(), read.recording.t_s[4]), (40, 1.7e9 + 1.0), "{unit}");
    }
}

#[test]
fn missing_values_are_gaps_however_they_are_spelled() {
    for missing in ["NA", "N/A", "null", "None", "NaN", "-nan(ind)", "#N/A"] {
        let text = table(",").replace("\n1.00,0.4,", &format!("\n1.00,{missing},"));
        let report = csv(text).unwrap().report;
        let told = "empty cells: 1 of v_left_mps were interpolated";
        assert!(report.to_string().contains(told), "{missing}: {report}");
    }
}

#[test]
fn what_could_be_read_in_two_ways_is_refused_by_line_and_remedy() {
    let rounded = |digits: usize| {
        let mut text = HEADER.join(",") + "\n";
        (0..60).for_each(|i| writeln!(text, "{:.digits$},1,1,40", 0.04 * f64::from(i)).unwrap());
        text
    };
    for (text, said) in [
        (table(",").replace('.', ","), "write a decimal point, or separate cells by semicolons"),
        (
            table(";").replace("\n1.00", "\n1,00"),
            "line 6, column `t_s`: `1,00` is no finite number; decimals stand behind a point in line 2",
        ),
        (table(";").replace("40.25", "1.040,25"), "thousands"),
        (table(",").replace("40.25", "\"1,040.25\""), "groups thousands"),
        (
            table(",").replace("40.25", "40.25 W"),
            "line 2, column `power_w`: `40.25 W` is no finite number; write the number alone",
        ),
        (table(",").replace("\n0.00", "\n14.11.2023 22:13:20"), "ISO 8601"),
        (table(",").replace("\n1.00", "\n2023-11-14T22:13:20"), "write all times in one way"),
        (
            table(",").replacen('\n', "\ns,km/h,km/h,W\n", 1),
            "line 2, column `v_left_mps`: the row of units says `km/h`, but the column is taken to be in `m/s`",
        ),
        (
            table(",").replacen('\n', "\ntime,left speed,right speed,power\n", 1),
            "which is no unit that is known",
        ),
        (table(",")[HEADER.join(",").len() + 1..].into(), "line 1: there is no header"),
        (
            format!("Device: X1\nDate: 14.11.2023\n\n{}", table(",")),
            "line 1: the header seems to be line 4; remove what is above it",
        ),
        (table(",") + &table(","), "line 42: the header stands here again"),
        (
            rounded(0),
            "line 3: time repeats 0 s in run `drive`, whose 60 rows have 3 different times, 1 s apart: its times are rounded",
        ),
        (rounded(1), "0.1 s apart: its times are rounded"),
        (
            table(",").replace("\n1.00", "\n0.75"),
            "line 6: time repeats from 0.75 s to 0.75 s in run `drive`; remove one of the rows",
        ),
        (table(" ").replace(" -0.5 ", " - 0.5 "), "no space within a cell"),
    ] {
        let message = csv(text.clone()).unwrap_err().to_string();
        assert!(message.contains(said), "{}\n  said: {message}", &text[..120]);
    }
}

#[test]
fn packed_text_is_read_by_its_content_and_named_without_its_endings() {
    let folder = tempfile::tempdir().unwrap();
    let zstd = zstd::encode_all(table(",").as_bytes(), 1).unwrap();
    for (name, bytes) in [("drive.csv.zst", &zstd), ("drive.csv", &zstd), ("drive.csv.gz", &zstd)] {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        let recording = read_path(&path, None).unwrap().recording;
        assert_eq!((recording.rows(), recording.runs[0].name.as_str()), (40, "drive"), "{name}");
    }
    let broken = read(zstd[..zstd.len() - 20].to_vec(), Format::Csv, "drive", None).unwrap_err().to_string();
    assert!(broken.contains("pack it again"), "{broken}");
    let path = folder.path().join("drive.mcap.gz");
    fs::write(&path, b"").unwrap();
    let message = read_path(&path, None).unwrap_err().to_string();
    assert!(message.contains("`.mcap.gz` is no recording"), "{message}");
}
