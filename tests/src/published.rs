//! Results of measurements as files, and the pages that show them: no figure is copied by hand.

use std::{fs, path::PathBuf, process::Command};

use serde::{Deserialize, Serialize};

use crate::file;

/// What a measurement printed, and where it comes from: `docs/results/NAME.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// The command that printed it, at the root of the repository.
    pub command: String,
    /// The commit that was measured, in short; `-dirty` behind it where files differed.
    pub commit: String,
    /// The day, as `2026-11-28`.
    pub day: String,
    /// Processor and number of its threads.
    pub machine: String,
    /// What the command printed.
    pub output: String,
}

impl Measured {
    /// Runs a command and keeps what it prints.
    ///
    /// # Errors
    /// When it cannot be run, or fails.
    pub fn by(command: &str) -> std::io::Result<Self> {
        let ended = Command::new("sh").args(["-c", command]).current_dir(file("")).output()?;
        if !ended.status.success() {
            let said = String::from_utf8_lossy(&ended.stderr).into_owned();
            return Err(std::io::Error::other(format!("`{command}` failed: {said}")));
        }
        Ok(Measured {
            command: command.to_owned(),
            commit: said_by("git describe --always --dirty --abbrev=7 --exclude '*'")?,
            day: said_by("date -u +%F")?,
            machine: said_by(
                "echo \"$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | sort -u | head -1), $(nproc) threads\"",
            )?,
            output: String::from_utf8_lossy(&ended.stdout).trim_end().to_owned(),
        })
    }

    /// The result as a page shows it.
    pub fn shown(&self) -> String {
        let Measured { command, commit, day, machine, output } = self;
        let lines: Vec<&str> = output.lines().map(str::trim_end).collect();
        format!(
            "```text\n{}\n```\n\nPrinted by `{command}` at commit {commit}, on {day}, on {machine}.\n",
            lines.join("\n")
        )
    }
}

fn said_by(command: &str) -> std::io::Result<String> {
    let ended = Command::new("sh").args(["-c", command]).current_dir(file("")).output()?;
    Ok(String::from_utf8_lossy(&ended.stdout).trim().to_owned())
}

/// Where the result of a name is kept.
pub fn result_file(name: &str) -> PathBuf {
    file("docs/results").join(format!("{name}.json"))
}

/// The result of a name.
///
/// # Errors
/// When its file cannot be read, or holds something else.
pub fn result(name: &str) -> std::io::Result<Measured> {
    Ok(serde_json::from_str(&fs::read_to_string(result_file(name))?)?)
}

/// A page in which every part between `<!-- result NAME -->` and `<!-- end -->` shows the result of that name.
///
/// # Errors
/// When a result cannot be read, or a part has no end.
pub fn with_results(page: &str) -> std::io::Result<String> {
    let mut parts = page.split("<!-- result ");
    let mut shown = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let name = part.split(' ').next().unwrap_or_default();
        let rest = part.split_once("<!-- end -->").map(|(_, rest)| rest);
        let rest =
            rest.ok_or_else(|| std::io::Error::other(format!("no `<!-- end -->` behind result {name}")))?;
        shown += &format!("<!-- result {name} -->\n\n{}\n<!-- end -->{rest}", result(name)?.shown());
    }
    Ok(shown)
}
