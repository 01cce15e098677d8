//! The clients in `examples/`, a dozen lines each, ask the running service and print what it answers.

#![allow(clippy::unwrap_used)]

use std::process::Command;

use joulepath_tests::{Server, file};

/// Asks with a client, and returns what it prints.
fn printed(interpreter: &str, example: &str, service: &str) -> String {
    let output = Command::new(interpreter)
        .args([file(&format!("examples/{example}")), file("maps/minnesota.tif")])
        .arg(service)
        .output()
        .unwrap();
    assert!(output.status.success(), "{example}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn both_clients_print_the_energy_of_the_same_path() {
    let server = Server::start();
    let [python, javascript] = [("python3", "plan.py"), ("node", "plan.mjs")]
        .map(|(interpreter, example)| printed(interpreter, example, &server.url));
    assert_eq!(python, javascript);
    let energy_kj: f64 = python.split(' ').next().unwrap().parse().unwrap();
    // 64 m on sandy loam: 90 kg times 9.81 m/s² times 0.157 is 139 N, 8.9 kJ without motors, electronics and hills.
    assert!(energy_kj > 8.9 && energy_kj < 60.0, "{python}");
}
