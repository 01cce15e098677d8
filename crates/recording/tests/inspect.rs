//! `inspect` proposes a map by which the log is then read.

#![allow(clippy::unwrap_used)]

mod written;

use std::fs;

use recording::{Channel, Map, inspect::inspect, read_path};
use written::{DRIVE, Type, mcap_of_topics};

fn folder(name: &str) -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("joulepath-inspect-{name}-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn a_table_of_a_teams_own_names_is_read_by_the_map_that_is_proposed() {
    let folder = folder("own");
    let path = folder.join("drive.csv");
    let mut text = "stamp_ms,FL_rpm,RL_rpm,FR_rpm,RR_rpm,Pitch (deg),P_bat [kW],note\n".to_owned();
    for i in 0..200 {
        let turn = (0.05 * f64::from(i)).sin();
        text += &format!(
            "{},60,62,{},{},{:.2},0.{:03},ok\n",
            100 * i,
            64.0 + turn,
            66.0 + turn,
            5.0 * turn,
            90 + i % 40
        );
    }
    fs::write(&path, text).unwrap();
    let found = inspect(&path).unwrap();
    let of = |name: &str| found.fields.iter().find(|field| field.name == name).unwrap();
    assert_eq!((of("FL_rpm").samples, of("FL_rpm").unit.as_deref()), (200, Some("rpm")));
    assert!((of("FR_rpm").rate_hz.unwrap() - 10.0).abs() < 1e-9);
    let map = Map::from_value(&found.map).unwrap();
    let read = read_path(&path, Some(&map)).unwrap().recording;
    assert!((read.t_s[199] - read.t_s[0] - 19.9).abs() < 1e-9);
    // 61 turns a minute of a wheel of 0.165 m.
    assert!((read.channel(Channel::LeftSpeed).unwrap()[7] - 1.054).abs() < 1e-3);
    assert!((read.channel(Channel::Power).unwrap()[0] - 90.0).abs() < 1e-9);
    assert!(read.channel(Channel::Pitch).unwrap().iter().all(|rad| rad.abs() < 0.1));
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_log_that_no_built_in_map_reads_is_listed_and_read_by_what_its_names_tell() {
    const NUMBER: Type<'static> =
        Type { name: "std_msgs/msg/Float64", definition: b"float64 data\n", ..DRIVE };
    let messages = |of: &dyn Fn(f64) -> f64| -> Vec<(u64, Vec<u8>)> {
        let message = |row: u64| [&[0, 1, 0, 0][..], &of(0.1 * row as f64).to_le_bytes()].concat();
        (0..300).map(|row| (1_000_000_000_000 + 100_000_000 * row, message(row))).collect()
    };
    let speed = messages(&|t_s| 0.5 + 0.1 * t_s.sin());
    let power = messages(&|t_s| 80.0 + 9.0 * t_s.sin());
    let topics = [("/left/vel", &speed), ("/right/vel", &speed), ("/power", &power), ("/left/slip", &speed)];
    let bytes = mcap_of_topics(&topics.map(|(name, messages)| (name, NUMBER, messages.as_slice())));
    let folder = folder("unmapped");
    let path = folder.join("own.mcap");
    fs::write(&path, bytes).unwrap();
    let found = inspect(&path).unwrap();
    assert_eq!(found.fields.len(), 4);
    let slip = found.fields.iter().find(|field| field.name == "/left/slip data").unwrap();
    assert!(slip.samples == 300 && (slip.rate_hz.unwrap() - 10.0).abs() < 1e-6 && slip.channel.is_none());
    assert!(slip.reason.contains("std_msgs/msg/Float64"), "{slip:?}");
    assert!(found.notes[0].contains("no built-in map reads it"), "{:?}", found.notes);
    let read = read_path(&path, Some(&Map::from_value(&found.map).unwrap())).unwrap();
    let from: Vec<&str> = read.report.channels.iter().map(|channel| channel.from.as_str()).collect();
    assert_eq!(from, ["/left/vel data", "/right/vel data", "/power data"]);
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn what_is_not_recognised_is_said() {
    let folder = folder("unknown");
    let path = folder.join("drive.csv");
    fs::write(&path, "alpha,beta\n1,2\n2,3\n").unwrap();
    let found = inspect(&path).unwrap();
    assert!(found.map.is_null() && found.notes[0].contains("alpha, beta"), "{found:?}");
    let mut text = "time,omega,P_bat [W]\n".to_owned();
    (0..50).for_each(|i| text += &format!("{},1,{}\n", 0.1 * f64::from(i), 50 + i));
    fs::write(&path, text).unwrap();
    let found = inspect(&path).unwrap();
    assert!(found.notes.iter().any(|note| note.contains("`v_left_mps`")), "{:?}", found.notes);
    fs::remove_dir_all(&folder).unwrap();
}
