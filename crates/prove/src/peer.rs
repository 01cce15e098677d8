//! Other ways to the same answer, on the same files.

use serde::{Deserialize, Serialize};

use crate::{Kind, SealedKey};

/// What another method said of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct PeerAnswer {
    /// What the method is called.
    pub peer: &'static str,
    /// Mechanisms, most important first, or why there are none; empty where it finds nothing.
    pub names: Result<Vec<String>, String>,
}

/// How a peer did on one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PeerScore {
    /// The peer.
    pub peer: String,
    /// What it said.
    pub names: Vec<String>,
    /// Why it said nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Truths that stand among as many of its first names as there are truths.
    pub named: usize,
    /// Truths that have a name.
    pub truths: usize,
}

impl PeerScore {
    /// Scores the answer of a peer.
    pub fn new(answer: &PeerAnswer, key: &SealedKey) -> Self {
        let (names, error) = match answer.names.clone() {
            Ok(names) => (names, None),
            Err(error) => (Vec::new(), Some(error)),
        };
        let truths: Vec<String> = match key.kind {
            Kind::One | Kind::Two => key.truths.iter().map(|truth| truth.effect.name()).collect(),
            Kind::Healthy | Kind::Decoy | Kind::Unlisted => Vec::new(),
        };
        let first = &names[..names.len().min(truths.len())];
        let named = truths.iter().filter(|truth| first.contains(truth)).count();
        PeerScore { peer: answer.peer.to_owned(), error, named, truths: truths.len(), names }
    }
}
