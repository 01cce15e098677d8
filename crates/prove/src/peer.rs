//! Other ways to the same answer, on the same files.

use std::path::Path;

use serde::Serialize;

use crate::{Kind, SealedKey};

/// A method that names mechanisms from the files of a case, most important first; none where it finds nothing.
pub struct Peer<'a> {
    /// What it is called.
    pub name: &'static str,
    /// The method: the folder of a case in, names out, or why there are none.
    #[allow(clippy::type_complexity)]
    pub names: &'a (dyn Fn(&Path) -> Result<Vec<String>, String> + Sync),
}

/// How a peer did on one case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PeerScore {
    /// The peer.
    pub peer: String,
    /// What it said.
    pub names: Vec<String>,
    /// Why it said nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Truths that stand among as many of its first names as there are truths.
    pub named: usize,
    /// Truths that have a name.
    pub truths: usize,
}

impl PeerScore {
    /// Scores the answer of a peer.
    pub fn new(peer: &str, answer: Result<Vec<String>, String>, key: &SealedKey) -> Self {
        let (names, error) = match answer {
            Ok(names) => (names, None),
            Err(error) => (Vec::new(), Some(error)),
        };
        let truths: Vec<String> = match key.kind {
            Kind::One | Kind::Two => key.truths.iter().map(|truth| truth.effect.name()).collect(),
            Kind::Healthy | Kind::Decoy | Kind::Unlisted => Vec::new(),
        };
        let first = &names[..names.len().min(truths.len())];
        let named = truths.iter().filter(|truth| first.contains(truth)).count();
        PeerScore { peer: peer.to_owned(), error, named, truths: truths.len(), names }
    }
}
