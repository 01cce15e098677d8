//! The commands of a page in one shell session, in a folder of their own beside the shipped maps.

use std::{
    fmt::Write as _,
    fs,
    net::TcpListener,
    os::unix::fs::symlink,
    path::Path,
    process::{Command, Stdio},
};

use joulepath_tests::{file, program};

use super::block::{Block, steps};

/// Parts what commands print; no command prints it.
const MARK: char = '\u{1e}';

/// Address of the service in all pages.
const DOCUMENTED_PORT: &str = ":8080";

/// Longest that the commands of a page may take together, on a machine that does much else \[s\].
const LONGEST_S: u32 = 400;

/// What one command printed, and its exit status.
#[derive(Debug)]
pub(crate) struct Printed {
    pub output: String,
    pub status: i32,
}

/// Runs every block of a page that can run, and returns what each of its commands printed, block by block.
pub(crate) fn run(blocks: &[Block]) -> Vec<Vec<Printed>> {
    let folder = tempfile::tempdir().unwrap();
    for shipped in ["maps", "examples"] {
        symlink(fs::canonicalize(file(shipped)).unwrap(), folder.path().join(shipped)).unwrap();
    }
    let programs = folder.path().join(".programs");
    fs::create_dir(&programs).unwrap();
    symlink(program(), programs.join("joulepath")).unwrap();
    let port = format!(":{}", TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port());
    let script = script(blocks).replace(DOCUMENTED_PORT, &port);
    let printed = bash(&script, folder.path(), &programs, &port)
        .replace(&port, DOCUMENTED_PORT)
        .replace(&folder.path().display().to_string(), "/home/me");
    let mut parts = printed.split(MARK).skip(1);
    blocks
        .iter()
        .map(|block| {
            let commands = if is_run(block) { steps(&block.text).len() } else { 0 };
            (0..commands)
                .map(|_| {
                    let output =
                        parts.next().unwrap_or_else(|| panic!("the session ended early:\n{printed}"));
                    let status = parts.next().and_then(|status| status.trim().parse().ok()).unwrap_or(-1);
                    Printed { output: output.strip_prefix('\n').unwrap_or(output).to_owned(), status }
                })
                .collect()
        })
        .collect()
}

/// Whether the commands of a block are run.
pub(crate) fn is_run(block: &Block) -> bool {
    block.language == "console" && block.needs.is_none()
}

fn bash(script: &str, folder: &Path, programs: &Path, port: &str) -> String {
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap_or_default());
    let ended = Command::new("timeout")
        .args([&LONGEST_S.to_string(), "bash", "-c", script])
        .current_dir(folder)
        .env("PATH", path)
        .env("JOULEPATH_BIND", format!("127.0.0.1{port}"))
        .env("HOME", folder)
        .env("RAYON_NUM_THREADS", "1")
        .stdin(Stdio::null())
        .output()
        .unwrap();
    String::from_utf8_lossy(&ended.stdout).into_owned()
}

/// The session as a script: every command between marks, with its status behind it.
fn script(blocks: &[Block]) -> String {
    let mut script = "exec 2>&1\ntrap 'kill $(jobs -p) 2>/dev/null' EXIT\n".to_owned();
    for block in blocks {
        if let Some(name) = &block.file {
            let _ = write!(script, "cat >'{name}' <<'END OF FILE'\n{}END OF FILE\n", block.text);
        }
        if !is_run(block) {
            continue;
        }
        for step in steps(&block.text) {
            let command = step.command.replace("cargo run --release -- ", "joulepath ");
            let command = if starts_service(&command) { in_background(&command) } else { command };
            let _ = write!(
                script,
                "printf '{MARK}\\n'; (exit ${{last:-0}})\n{command}\nlast=$?; printf '{MARK}%s\\n' $last\n"
            );
        }
    }
    script + "exit 0\n"
}

fn starts_service(command: &str) -> bool {
    (command.starts_with("joulepath serve") || command.starts_with("joulepath open"))
        && !command.contains("--help")
        && !command.contains("--check")
}

/// The service goes on beside later commands, which begin when it answers; a session has one at a time. Its log is no part of the page.
fn in_background(command: &str) -> String {
    format!(
        "kill $(jobs -p) 2>/dev/null; wait\n{command} >.service 2>.log &\n\
         curl --silent --output .ready --retry 60 --retry-delay 1 --retry-connrefused http://127.0.0.1{DOCUMENTED_PORT}/healthz\n\
         cat .service"
    )
}
