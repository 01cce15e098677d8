//! How the service is told what to do, and to end.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{fs, process::Command};

use joulepath_tests::{Server, program};

#[test]
fn flags_stand_above_the_environment_and_that_above_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("joulepath.toml");
    fs::write(&file, "plan_time_s = 3\nbody_bytes = 300\nrecording_bytes = 3000\n").unwrap();
    let file = file.display().to_string();
    let environment = [("JOULEPATH_BODY_BYTES", "200"), ("JOULEPATH_RECORDING_BYTES", "2000")];
    let server =
        Server::start_in("127.0.0.1:0", &["--config", &file, "--recording-bytes", "1000"], &environment);
    let limits = server.get("/v1/status").json()["limits"].clone();
    assert_eq!(limits["plan_time_s"], 3.0, "from the file");
    assert_eq!(limits["body_bytes"], 200, "from the environment");
    assert_eq!(limits["recording_bytes"], 1000, "from the flag");
}

#[test]
fn a_file_that_is_wrong_is_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("joulepath.toml");
    let path = file.display().to_string();
    for (text, said) in [
        ("plan_time = 3\n", "plan_time_s"),
        ("plan_time_s = -3\n", "--plan-time-s"),
        ("plan_time_s = \"long\"\n", "--plan-time-s"),
        ("body_bytes = 1.5\n", "--body-bytes"),
        ("plan_time_s = \n", "joulepath.toml"),
    ] {
        fs::write(&file, text).unwrap();
        let output = Command::new(program()).args(["serve", "--config", &path]).output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{text}: {error}");
        assert!(
            error.lines().count() == 1 && error.contains(said) && error.contains(&path),
            "{text}: {error}"
        );
    }
}

#[test]
fn help_states_every_default() {
    let help = Command::new(program()).args(["serve", "--help"]).output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    let flags: Vec<&str> = help.lines().filter(|line| line.trim_start().starts_with("--")).collect();
    assert!(flags.len() > 20, "{help}");
    for flag in [
        "--bind",
        "--plan-time-s",
        "--kept-bytes",
        "--connections",
        "--log-format",
        "--store",
        "--cors-origin",
    ] {
        let at = help.find(&format!("{flag} ")).unwrap_or_else(|| panic!("{flag} is not in {help}"));
        let text = &help[at..];
        let end = text[2..].find("\n      --").map_or(text.len(), |end| end + 2);
        assert!(text[..end].contains("[default: "), "{}", &text[..end]);
        assert!(text[..end].contains("[env: JOULEPATH_"), "{}", &text[..end]);
    }
}

#[test]
fn a_service_that_is_asked_to_end_says_so_first_and_then_ends() {
    let mut server = Server::start_with(&["--unready-time-s", "1.5", "--drain-time-s", "5"]);
    assert_eq!(server.get("/readyz").status, 200);
    server.ask_to_end();
    while server.get("/readyz").status == 200 {
        std::thread::yield_now();
    }
    server.get("/readyz").problem(503, "not-ready");
    assert_eq!(server.get("/healthz").status, 200, "it is alive until it has ended");
    assert!(server.wait().success());
}

#[test]
fn a_check_tells_whether_a_service_is_ready() {
    let server = Server::start();
    let check =
        |bind: &str| Command::new(program()).args(["serve", "--check", "--bind", bind]).status().unwrap();
    let address = server.url.trim_start_matches("http://");
    assert_eq!(check(address).code(), Some(0));
    let address = address.to_owned();
    drop(server);
    assert_eq!(check(&address).code(), Some(1));
}
