//! Trials that were made before, added up.

use std::path::Path;

use serde::Deserialize;

use crate::{CaseScore, Error, Scoreboard, files::SCOREBOARD, scoreboard};

/// What of a scoreboard is added up.
#[derive(Deserialize)]
struct Part {
    seed: u64,
    commitment: String,
    scores: Vec<CaseScore>,
}

/// One scoreboard of all cases of the trials in some folders; it has the seed of the first and the commitments of all.
///
/// # Errors
/// Folders without a scoreboard, files that are none, and a trial that is named twice.
pub fn together<P: AsRef<Path>>(folders: &[P]) -> Result<Scoreboard, Error> {
    let parts: Vec<Part> = folders.iter().map(|folder| part(folder.as_ref())).collect::<Result<_, _>>()?;
    for (i, part) in parts.iter().enumerate() {
        if parts[..i].iter().any(|before| before.commitment == part.commitment) {
            return Err(Error::Twice { path: folders[i].as_ref().join(SCOREBOARD) });
        }
    }
    let commitments: Vec<&str> = parts.iter().map(|part| part.commitment.as_str()).collect();
    let (seed, commitment) = (parts.first().map_or(0, |part| part.seed), commitments.join(" "));
    Ok(scoreboard(seed, commitment, parts.into_iter().flat_map(|part| part.scores).collect()))
}

fn part(folder: &Path) -> Result<Part, Error> {
    let path = folder.join(SCOREBOARD);
    let bytes = std::fs::read(&path).map_err(Error::file(&path))?;
    serde_json::from_slice(&bytes).map_err(|source| Error::Content { path, source })
}
