//! Commands that run until they are interrupted: `open`, and long work whose files must not stay half-written.

#![allow(clippy::unwrap_used)]
#![cfg(target_os = "linux")]

use std::{
    fs,
    io::{BufRead, BufReader},
    path::Path,
    process::{Child, Command, Stdio},
};

use serde_json::Value;

/// A command that takes interrupts whatever the tests' own parents made of them.
fn joulepath(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new("env");
    command.args(["--default-signal=INT", env!("CARGO_BIN_EXE_joulepath")]).args(arguments);
    command.current_dir(folder).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// A command that does not outlive a test that fails.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // One that has ended is past killing.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn interrupt(child: &Child) {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

fn fifo(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

#[test]
fn an_interrupt_ends_the_work_with_one_line_and_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("drive.csv");
    fifo(&log);
    let child = joulepath(folder.path(), &["diagnose", "--recording", "drive.csv", "--out", "found"])
        .spawn()
        .unwrap();
    // Opens once the command reads the log, which it never gets to the end of.
    let held = fs::File::options().write(true).open(&log).unwrap();
    assert!(folder.path().join("found").is_dir(), "the folder is made before the work");
    interrupt(&child);
    let output = child.wait_with_output().unwrap();
    drop(held);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), said.lines().count()), (Some(130), 1), "{said}");
    assert!(said.contains("interrupted"), "{said}");
    assert!(!folder.path().join("found").exists(), "nothing is left behind");
}

#[test]
fn open_serves_the_files_it_is_given_in_the_browser_until_an_interrupt() {
    let folder = tempfile::tempdir().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    fs::copy(root.join("maps/yard.json"), folder.path().join("yard.json")).unwrap();
    let robot = fs::read_to_string(root.join("crates/model/robots/jackal.json")).unwrap();
    fs::write(folder.path().join("mine.json"), robot.replace("\"jackal\"", "\"mine\"")).unwrap();
    fs::write(folder.path().join("drive.csv"), DRIVE).unwrap();
    // A browser that tells where it was sent.
    let told = folder.path().join("told");
    fifo(&told);
    let browser = folder.path().join("xdg-open");
    fs::write(&browser, format!("#!/bin/sh\necho \"$1\" > '{}'\n", told.display())).unwrap();
    assert!(Command::new("chmod").arg("+x").arg(&browser).status().unwrap().success());
    let path = format!("{}:{}", folder.path().display(), std::env::var("PATH").unwrap());
    let child = joulepath(folder.path(), &["open", "yard.json", "mine.json", "drive.csv"])
        .env("PATH", path)
        .env("DISPLAY", ":0")
        .spawn()
        .unwrap();
    let mut running = Running(child);
    let mut lines = BufReader::new(running.0.stdout.take().unwrap()).lines().map(Result::unwrap);
    let page = lines.find_map(|line| line.strip_prefix("page       ").map(str::to_owned)).unwrap();
    assert_eq!(fs::read_to_string(&told).unwrap().trim(), page);
    let (url, asked) = page.split_once("/#plan?map=").unwrap();
    let (map, robot) = asked.split_once("&robot=").unwrap();
    let get = |path: &str| -> Value {
        ureq::get(format!("{url}{path}")).call().unwrap().body_mut().read_json().unwrap()
    };
    assert_eq!(get(&format!("/v1/maps/{map}"))["name"], "yard");
    assert_eq!(get(&format!("/v1/robots/{robot}"))["name"], "mine");
    assert_eq!(get("/v1/recordings")["recordings"].as_array().unwrap().len(), 1);
    interrupt(&running.0);
    assert!(running.0.wait().unwrap().success());
}

/// A short drive with power.
const DRIVE: &str = "t_s,v_left_mps,v_right_mps,power_w\n0,0.5,0.5,60\n0.1,0.5,0.5,61\n0.2,0.5,0.5,60\n0.3,0.5,0.5,62\n0.4,0.5,0.5,61\n";

#[test]
fn open_refuses_what_the_page_does_not_show() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("notes.txt"), "x").unwrap();
    fs::write(folder.path().join("other.json"), "{\"a\": 1}").unwrap();
    fs::write(folder.path().join("bad.json"), "{\"mass_kg\": -1}").unwrap();
    for (file, said) in [
        ("notes.txt", "recordings (.csv"),
        ("other.json", "neither a map"),
        ("none.tif", "No such file"),
        ("bad.json", "bad.json: "),
    ] {
        let output = joulepath(folder.path(), &["open", "--no-browser", file]).output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), error.lines().count()), (Some(2), 1), "{error}");
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn completions_and_manual_pages_know_every_command() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish"] {
        let output = joulepath(folder.path(), &["completions", shell]).output().unwrap();
        let script = String::from_utf8(output.stdout).unwrap();
        assert!(script.contains("reachable") && script.contains("payload-kg"), "{shell}");
    }
    let output = joulepath(folder.path(), &["man", "--out", "man"]).output().unwrap();
    assert!(output.status.success());
    for page in ["joulepath.1", "joulepath-plan.1", "joulepath-robot-new.1"] {
        assert!(
            fs::read_to_string(folder.path().join("man").join(page)).unwrap().starts_with(".ie"),
            "{page}"
        );
    }
    let version = joulepath(folder.path(), &["--version"]).output().unwrap();
    assert!(
        String::from_utf8(version.stdout)
            .unwrap()
            .starts_with(concat!("joulepath ", env!("CARGO_PKG_VERSION")))
    );
}
