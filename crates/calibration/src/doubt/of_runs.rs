//! Doubts about single runs among others.

use std::collections::BTreeMap;

use model::Robot;
use recording::{Recording, Run, Watch};

use super::{Doubt, together};
use crate::Error;

/// The doubts of all drives together with those that runs show alone: a wrong run among good ones hardly changes what all show, or shows it less
/// clearly than by itself.
///
/// # Errors
/// [`Error::Stopped`]; a run that is too short to tell anything is not doubted.
pub(super) fn with_runs(
    robot: &Robot,
    recording: &Recording,
    mut known: Vec<Doubt>,
    watch: &Watch,
) -> Result<Vec<Doubt>, Error> {
    if recording.runs.len() < 2 {
        return Ok(known);
    }
    let mut found: BTreeMap<&'static str, (Doubt, Vec<String>)> = BTreeMap::new();
    // A run that has its doubt already tells nothing more before that is mended.
    let is_told =
        |run: &Run| known.iter().any(|doubt| doubt.statement.contains(&format!("run `{}`", run.name)));
    for run in recording.runs.iter().filter(|run| !is_told(run)) {
        let alone = recording.of_runs(|other| other.name == run.name);
        let doubts = match together(robot, &alone, watch) {
            Err(Error::Stopped) => return Err(Error::Stopped),
            told => told.unwrap_or_default(),
        };
        for doubt in doubts {
            found.entry(doubt.name).or_insert_with(|| (doubt, Vec::new())).1.push(run.name.clone());
        }
    }
    for (name, (doubt, runs)) in found {
        match known.iter_mut().find(|other| other.name == name) {
            None => known.push(of(doubt, &runs)),
            // What names its run, or is so in all runs, is told of all together.
            Some(other) if !other.statement.contains("run `") && runs.len() < recording.runs.len() => {
                *other = of(doubt, &runs);
            }
            Some(_) => {}
        }
    }
    Ok(known)
}

/// A doubt of the first of some runs, with the names of all.
fn of(doubt: Doubt, runs: &[String]) -> Doubt {
    let [first, others @ ..] = runs else { return doubt };
    let others: Vec<String> = others.iter().map(|run| format!("`{run}`")).collect();
    let also =
        if others.is_empty() { String::new() } else { format!(" (and {} as well)", others.join(", ")) };
    Doubt { statement: format!("run `{first}` alone{also}: {}", doubt.statement), ..doubt }
}
