//! Commands whose output nobody reads, as of `joulepath plan ... | head -1`: they end without a word.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    collections::BTreeSet,
    io::{PipeWriter, pipe},
    net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream},
    path::Path,
    process::{Command, Output, Stdio},
};

use joulepath_tests::{drive_csv, file, program};
use serde_json::json;

/// A pipe whose reader has left.
fn unread() -> PipeWriter {
    let (reader, writer) = pipe().unwrap();
    drop(reader);
    writer
}

/// Runs a command in a folder; nobody reads what it prints.
fn unread_in(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(program()).args(arguments).current_dir(folder).stdout(unread()).output().unwrap()
}

fn assert_quiet(arguments: &[&str], output: &Output) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), said.as_ref()), (Some(0), ""), "{arguments:?}");
}

/// Level ground, a recording, a world and a drive.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    let map =
        json!({ "cell_size_m": 1.0, "rows": 20, "columns": 20, "elevation_m": vec![vec![0.5; 20]; 20] });
    write("map.json", map.to_string());
    // With pitch there is nothing to be said of the ground.
    let pitched = |(row, line): (usize, &str)| match row {
        0 => format!("{line},pitch_rad\n"),
        _ => format!("{line},{:.5}\n", 0.01 * (0.05 * row as f64).sin()),
    };
    write("drive.csv", drive_csv(3, 400).lines().enumerate().map(pitched).collect());
    write(
        "world.json",
        json!({"terrain": {"rolling": {"grade": 0.04}}, "seed": 1, "robot_seed": 5, "effects": []})
            .to_string(),
    );
    write("drive.json", json!({"kind": "rich", "duration_s": 60, "seed": 1}).to_string());
    folder
}

/// A command line for each command that prints an answer.
const COMMANDS: [&[&str]; 14] = [
    &["inspect", "drive.csv"],
    &["plan", "--map", "map.json", "--start", "4,4", "--goal", "15,15"],
    &["compare", "--map", "map.json", "--start", "4,4", "--goal", "15,15"],
    &["alternatives", "--map", "map.json", "--start", "4,4", "--goal", "15,15"],
    &["matrix", "--map", "map.json", "--source", "4,4", "--source", "15,15"],
    &["reachable", "--map", "map.json", "--start", "4,4", "--energy-j", "500"],
    &["range", "--map", "map.json", "--start", "4,4", "--goal", "15,15"],
    &["mission", "--map", "map.json", "--start", "4,4", "--waypoint", "15,15"],
    &["predict", "--recording", "drive.csv"],
    &["calibrate", "--recording", "drive.csv", "--out", "robot.json"],
    &["simulate", "--world", "world.json", "--drive", "drive.json", "--out", "made.csv"],
    &["bench", "--size", "60"],
    &["robot", "list"],
    &["demo", "--out", "demo.svg"],
];
/// What takes minutes, and the service, which prints before it serves. All print by the same function.
const OTHERS: [&str; 8] = ["completions", "diagnose", "fleet", "man", "open", "prove", "schema", "serve"];

#[test]
fn every_command_ends_without_a_word_when_nobody_reads() {
    let folder = folder();
    for arguments in COMMANDS {
        assert_quiet(arguments, &unread_in(folder.path(), arguments));
        if !["simulate", "demo"].contains(&arguments[0]) {
            let json = [arguments, &["--json"]].concat();
            assert_quiet(&json, &unread_in(folder.path(), &json));
        }
    }
    assert!(folder.path().join("robot.json").exists(), "what is written is written before");
}

#[test]
fn help_ends_without_a_word_too_and_no_command_is_left_out_here() {
    let folder = folder();
    let help = Command::new(program()).arg("--help").output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    let listed = help.lines().skip_while(|line| !line.starts_with("Commands:")).skip(1);
    let listed: BTreeSet<&str> = listed
        .take_while(|line| line.starts_with("  "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect();
    let known: BTreeSet<&str> = COMMANDS.iter().map(|arguments| arguments[0]).chain(OTHERS).collect();
    assert_eq!(listed, known);
    for name in known {
        let arguments = [name, "--help"];
        assert_quiet(&arguments, &unread_in(folder.path(), &arguments));
    }
    for arguments in [["--help"], ["--version"], ["help"]] {
        assert_quiet(&arguments, &unread_in(folder.path(), &arguments));
    }
}

#[test]
fn an_error_that_nobody_reads_still_sets_the_exit_status() {
    let folder = folder();
    for (arguments, status) in [
        (&["plan", "--map", "none.json", "--start", "4,4", "--goal", "15,15"][..], 2),
        (&["plan", "--map", "map.json", "--start", "400,4", "--goal", "15,15"], 2),
        (&["plan", "--no-such-flag"], 2),
        (&["predict", "--recording", "none.csv"], 2),
    ] {
        let ended = Command::new(program())
            .args(arguments)
            .current_dir(folder.path())
            .stdout(unread())
            .stderr(unread())
            .status();
        assert_eq!(ended.unwrap().code(), Some(status), "{arguments:?}");
    }
}

#[test]
fn a_full_disk_is_said() {
    let Ok(full) = std::fs::File::options().write(true).open("/dev/full") else { return };
    let folder = folder();
    let output =
        Command::new(program()).args(COMMANDS[0]).current_dir(folder.path()).stdout(full).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), said.lines().count()), (Some(1), 1), "{said}");
    assert!(said.contains("cannot write to standard output"), "{said}");
}

#[test]
fn a_service_goes_on_when_nobody_reads_its_log() {
    let address = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap().local_addr().unwrap();
    let mut service = Command::new(program())
        .args(["serve", "--bind", &address.to_string()])
        .stdin(Stdio::null())
        .stdout(unread())
        .stderr(unread())
        .spawn()
        .unwrap();
    let asked = (0..3).map(|_| healthz(address, &mut service)).collect::<Vec<_>>();
    service.kill().unwrap();
    service.wait().unwrap();
    // Each request is logged.
    assert_eq!(asked, ["HTTP/1.1 200 OK"; 3]);
}

/// The first line of an answer, once the service listens.
fn healthz(address: SocketAddr, service: &mut std::process::Child) -> String {
    use std::io::{BufRead, BufReader, Write};
    let mut stream = loop {
        assert_eq!(service.try_wait().unwrap(), None, "the service ended");
        match TcpStream::connect(address) {
            Ok(stream) => break stream,
            Err(_) => std::thread::yield_now(),
        }
    };
    write!(stream, "GET /healthz HTTP/1.1\r\nhost: {address}\r\nconnection: close\r\n\r\n").unwrap();
    let mut line = String::new();
    BufReader::new(stream).read_line(&mut line).unwrap();
    line.trim_end().to_owned()
}

#[test]
fn numbers_in_messages_are_short() {
    let map = file("maps/yard.json").display().to_string();
    for (value, shown) in [("1e300", "1e300"), ("-1e-300", "-1e-300")] {
        for flag in ["--timeout-s", "--bound", "--tolerance-m", "--snap-radius-m", "--speed-mps"] {
            let flag = format!("{flag}={value}");
            let asked = ["plan", "--map", &map, "--start", "4,8", "--goal", "20,12", &flag];
            let output = Command::new(program()).args(asked).output().unwrap();
            let said = String::from_utf8(output.stderr).unwrap();
            assert!(output.status.success() || said.contains(shown), "{flag}: {said}");
            assert!(!said.contains("00000"), "{flag}: {said}");
        }
    }
}
