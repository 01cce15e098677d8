//! What can be wrong with areas.

/// A fault of a document of areas; the message names the place and says how to mend it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{at} {what}")]
pub struct AreaError {
    /// The place in the document, as `areas.features[2].properties.max_speed_mps`.
    pub at: String,
    /// What is wrong with it, and how to mend it.
    pub what: String,
}

impl AreaError {
    /// A fault at a place below `areas`.
    pub(crate) fn new(at: &str, what: impl Into<String>) -> Self {
        let at = if at.is_empty() { "areas".to_owned() } else { format!("areas.{at}") };
        AreaError { at, what: what.into() }
    }
}
