//! Ids: what an object's name is made of.

use sha2::{Digest, Sha256};

/// Characters of an id: 128 bits of a SHA-256.
const CHARACTERS: usize = 32;
/// Most of a wrong id that is shown again.
const SHOWN_CHARACTERS: usize = 64;

/// Whether a text is an id, and so can stand in the name of an object.
pub(crate) fn is_id(text: &str) -> bool {
    text.len() == CHARACTERS && text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}

/// The id of content whose hash was taken.
pub(crate) fn id_of(content: Sha256) -> String {
    content.finalize().iter().take(CHARACTERS / 2).map(|byte| format!("{byte:02x}")).collect()
}

/// An id that nobody knows, as it is told again.
pub(crate) fn shown(id: &str) -> String {
    id.chars().take(SHOWN_CHARACTERS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_lower_hexadecimal_of_the_right_length_is_an_id() {
        assert!(is_id(&id_of(Sha256::new())) && is_id(&"0f".repeat(16)));
        let wrong = [
            "",
            "0f",
            &"0F".repeat(16),
            &"0g".repeat(16),
            &"0f".repeat(32),
            "../../../../../../../../etc/pass",
        ];
        for text in wrong {
            assert!(!is_id(text), "{text}");
        }
    }
}
