//! Other methods on the same real drives.

use serde::{Deserialize, Serialize};

use crate::{PeerAnswer, real::RealKey};

/// How a peer did on one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RealPeerScore {
    /// The peer.
    pub peer: String,
    /// What it said.
    pub names: Vec<String>,
    /// Why it said nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Whether its first name is right.
    pub named: bool,
}

impl RealPeerScore {
    /// Scores the answer of a peer.
    pub fn new(answer: &PeerAnswer, key: &RealKey) -> Self {
        let (names, error) = match answer.names.clone() {
            Ok(names) => (names, None),
            Err(error) => (Vec::new(), Some(error)),
        };
        let named = names.first().is_some_and(|name| key.accepted().contains(&name.as_str()));
        RealPeerScore { peer: answer.peer.to_owned(), names, error, named }
    }
}
