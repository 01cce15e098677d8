//! Who may ask: tokens, and pages of other origins.

use axum::http::HeaderValue;
use sha2::{Digest, Sha256};
use subtle::{Choice, ConstantTimeEq};

use crate::Hosts;

/// Who may ask. The default is anybody who reaches the service, and no page of another origin.
#[derive(Clone, Debug, Default)]
pub struct Access {
    /// Tokens that are taken; without any, none is asked for.
    pub tokens: Tokens,
    /// Whether `/metrics` asks for no token, as for a service that only its own machine reaches.
    pub open_metrics: bool,
    /// Origins whose pages may ask, as `https://maps.example.org`.
    pub cors_origins: Vec<HeaderValue>,
    /// Names by which the service may be asked where no token is.
    pub hosts: Hosts,
}

/// Tokens, of which only hashes are kept.
#[derive(Clone, Default)]
pub struct Tokens(Vec<[u8; 32]>);

impl std::fmt::Debug for Tokens {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} tokens", self.0.len())
    }
}

/// A token that is easily guessed, or cannot be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WeakToken {
    /// Which of them, from 1.
    pub number: usize,
}

impl std::fmt::Display for WeakToken {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let WeakToken { number } = self;
        write!(
            f,
            "token {number} must be {LEAST_CHARACTERS} or more visible ASCII characters, as `openssl rand -hex 32` makes"
        )
    }
}

impl std::error::Error for WeakToken {}

/// Shortest token: 64 bits if it is hexadecimal.
const LEAST_CHARACTERS: usize = 16;

impl Tokens {
    /// Reads tokens between blanks, line ends or commas; a line that begins with # is a remark.
    ///
    /// # Errors
    /// A token that is too short or cannot stand in a header.
    pub fn parse(text: &str) -> Result<Self, WeakToken> {
        let lines = text.lines().filter(|line| !line.trim_start().starts_with('#'));
        let words = lines.flat_map(|line| line.split([' ', '\t', ','])).filter(|word| !word.is_empty());
        let hash = |(i, word): (usize, &str)| {
            let is_fit = word.len() >= LEAST_CHARACTERS && word.bytes().all(|byte| byte.is_ascii_graphic());
            if is_fit { Ok(hash(word)) } else { Err(WeakToken { number: i + 1 }) }
        };
        words.enumerate().map(hash).collect::<Result<_, _>>().map(Tokens)
    }

    /// These and others.
    #[must_use]
    pub fn and(mut self, others: Tokens) -> Self {
        self.0.extend(others.0);
        self
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether a token is one of them. It takes as long whichever it is like, and however much.
    pub(crate) fn admit(&self, token: &str) -> bool {
        let asked = hash(token);
        let found = self.0.iter().fold(Choice::from(0), |found, known| found | known.ct_eq(&asked));
        found.into()
    }
}

fn hash(token: &str) -> [u8; 32] {
    Sha256::digest(token.as_bytes()).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_of_several_tokens_is_admitted_and_nothing_like_them() {
        let tokens =
            Tokens::parse("# the team\n0123456789abcdef\n  fedcba9876543210, AAAAAAAAAAAAAAAA\n\n").unwrap();
        for token in ["0123456789abcdef", "fedcba9876543210", "AAAAAAAAAAAAAAAA"] {
            assert!(tokens.admit(token), "{token}");
        }
        for token in ["", "0123456789abcde", "0123456789abcdef0", "0123456789ABCDEF", "# the team"] {
            assert!(!tokens.admit(token), "{token}");
        }
    }

    #[test]
    fn weak_tokens_are_refused_by_number() {
        assert_eq!(Tokens::parse("0123456789abcdef short").unwrap_err(), WeakToken { number: 2 });
        assert_eq!(Tokens::parse("0123456789abcdéfg").unwrap_err(), WeakToken { number: 1 });
        assert!(Tokens::parse("# none\n").unwrap().is_empty());
    }

    #[test]
    fn tokens_are_not_shown() {
        let shown = format!("{:?}", Tokens::parse("0123456789abcdef").unwrap());
        assert_eq!(shown, "1 tokens");
    }
}
