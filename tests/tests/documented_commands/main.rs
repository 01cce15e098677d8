//! Every command in the README and the guide does what the page says that it does.
//!
//! Blocks of the language `console` are run, each page in one shell session, and their output is held against the page.
//! `file=NAME` behind a block's language writes it into the session's folder. `needs=REASON` says why a block is not run.
//! With `JOULEPATH_WRITE_DOCS=1` in the environment, output that differs is written into the page instead.

#![allow(clippy::unwrap_used, clippy::panic)]

mod block;
mod matching;
mod session;

use std::fs;

use joulepath_tests::file;

use self::{
    block::{Block, blocks, steps},
    matching::agrees,
    session::{Printed, is_run},
};

/// Why a block is not run here. Whatever else a block needs has to be there.
const NEEDS: [&str; 8] = ["bucket", "cargo", "docker", "file", "minutes", "recordings", "root", "python"];

/// Languages of blocks that hold no commands: what a file holds, formulas and drawings, output of measurements.
const NO_COMMANDS: [&str; 7] = ["json", "text", "toml", "xml", "csv", "rust", "yaml"];

/// Pages whose blocks are run by tests of their own, or take minutes: Python's by doctest, those of fleets on a cluster.
const RUN_ELSEWHERE: [&str; 3] = ["docs/python.md", "docs/fleets.md", "docs/performance.md"];

/// Pages of the README and the guide, relative to the root.
fn pages() -> Vec<String> {
    let mut found = vec!["README.md".to_owned(), "CONTRIBUTING.md".to_owned()];
    for entry in fs::read_dir(file("docs")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.ends_with(".md") {
            found.push(format!("docs/{name}"));
        }
    }
    found.retain(|page| !RUN_ELSEWHERE.contains(&page.as_str()));
    found.sort();
    found
}

fn read(page: &str) -> String {
    fs::read_to_string(file(page)).unwrap()
}

/// What differs between a block and what its commands printed.
fn differences(page: &str, block: &Block, printed: &[Printed]) -> Vec<String> {
    let documented = steps(&block.text);
    let mut found = Vec::new();
    for (i, (step, printed)) in documented.iter().zip(printed).enumerate() {
        let place = format!("{page}:{}: `{}`", block.line, step.command);
        if !agrees(&step.output, &printed.output) {
            found.push(format!("{place}\n--- documented\n{}--- printed\n{}", step.output, printed.output));
        }
        let asked = documented.get(i + 1).is_some_and(|next| next.command == "echo $?");
        if printed.status != 0 && !asked {
            found.push(format!("{place} ended with status {}:\n{}", printed.status, printed.output));
        }
    }
    found
}

/// The block with what its commands printed.
fn rewritten(block: &Block, printed: &[Printed]) -> String {
    let mut text = String::new();
    for (step, printed) in steps(&block.text).iter().zip(printed) {
        let command = step.command.replace('\n', "\n> ").replace("\\\n> ", "\\\n");
        let output = if agrees(&step.output, &printed.output) { &step.output } else { &printed.output };
        text += &format!("$ {command}\n{output}");
        if !text.ends_with('\n') {
            text += "\n";
        }
    }
    text
}

fn check(page: &str) {
    let source = read(page);
    let blocks = blocks(&source);
    if !blocks.iter().any(is_run) {
        return;
    }
    let printed = session::run(&blocks);
    let found: Vec<(&Block, &Vec<Printed>, Vec<String>)> = blocks
        .iter()
        .zip(&printed)
        .map(|(block, printed)| (block, printed, differences(page, block, printed)))
        .filter(|(_, _, found)| !found.is_empty())
        .collect();
    if std::env::var_os("JOULEPATH_WRITE_DOCS").is_some() {
        let mut text = source.clone();
        for (block, printed, _) in found.iter().rev() {
            text.replace_range(block.range.clone(), &rewritten(block, printed));
        }
        fs::write(file(page), text).unwrap();
    }
    let found: Vec<String> = found.into_iter().flat_map(|(_, _, found)| found).collect();
    assert!(found.is_empty(), "{}\n{} differences", found.join("\n"), found.len());
}

/// A test for each page that holds commands, so that they run side by side.
macro_rules! pages_are_true {
    ($($name:ident: $page:literal),* $(,)?) => {
        $(#[test] fn $name() { check($page); })*
        const CHECKED: &[&str] = &[$($page),*];
    };
}

pages_are_true! {
    commands_of_the_readme: "README.md",
    commands_of_contributing: "CONTRIBUTING.md",
    commands_of_install: "docs/install.md",
    commands_of_first_plan: "docs/first-plan.md",
    commands_of_maps: "docs/maps.md",
    commands_of_steering: "docs/steering.md",
    commands_of_robots: "docs/robots.md",
    commands_of_logs: "docs/logs.md",
    commands_of_diagnose: "docs/diagnose.md",
    commands_of_simulate: "docs/simulate.md",
    commands_of_missions: "docs/missions.md",
    commands_of_api: "docs/api.md",
    commands_of_operations: "docs/operations.md",
    commands_of_physics: "docs/physics.md",
    commands_of_faq: "docs/faq.md",
}

#[test]
fn every_page_with_commands_is_run() {
    for page in pages() {
        let runs = blocks(&read(&page)).iter().any(is_run);
        assert!(
            !runs || CHECKED.contains(&page.as_str()),
            "{page} holds commands and no test here runs them"
        );
    }
}

#[test]
fn every_block_is_run_or_says_why_not() {
    for page in pages() {
        let source = read(&page);
        for block in blocks(&source) {
            if let Some(name) = &block.file {
                let above = source[..block.range.start].lines().rev().skip(1).find(|line| !line.is_empty());
                let is_named = above.is_some_and(|line| line.contains(&format!("`{name}`")));
                assert!(is_named, "{page}:{}: the line above does not name `{name}`", block.line);
            }
            let place = format!("{page}:{}", block.line);
            match (block.language.as_str(), block.needs.as_deref()) {
                (language, Some(needs)) => {
                    assert!(NEEDS.contains(&needs), "{place}: `needs={needs}` is none of {NEEDS:?}");
                    println!("{place}: {language}, not run: needs {needs}");
                }
                ("console", None) => {
                    assert!(!steps(&block.text).is_empty(), "{place}: no line begins with `$ `");
                }
                ("json", None) => {
                    let read: Result<serde_json::Value, _> = serde_json::from_str(&block.text);
                    assert!(read.is_ok(), "{place}: {read:?}");
                }
                ("python", None) if block.file.is_some() => {}
                (language, None) => {
                    assert!(NO_COMMANDS.contains(&language), "{place}: a block of `{language}` is not run");
                }
            }
        }
    }
}
