//! Who may ask: tokens, and pages of other origins.

use axum::http::HeaderValue;
use sha2::{Digest, Sha256};
use subtle::{ConditionallySelectable, ConstantTimeEq};

use crate::{Tenant, tenant::InvalidTenant};

use crate::{Hosts, Tiles};

/// Who may ask, and whom the page may. The default is anybody who reaches the service, and no page of another origin.
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
    /// Pictures of the ground that the page may fetch from elsewhere; without, it asks nobody but the service.
    pub tiles: Option<Tiles>,
}

/// Tokens with the tenants that hold them. Only hashes of tokens are kept.
#[derive(Clone, Default)]
pub struct Tokens(Vec<([u8; 32], Tenant)>);

impl std::fmt::Debug for Tokens {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} tokens", self.0.len())
    }
}

/// A token that cannot be used. Each is named by its number, from 1, and never shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TokenError {
    /// A token that is easily guessed, or cannot be sent.
    #[error(
        "token {number} must be {LEAST_CHARACTERS} or more visible ASCII characters, as `openssl rand -hex 32` makes"
    )]
    Weak {
        /// Which of them.
        number: usize,
    },
    /// A name that no tenant can have.
    #[error("token {number}: {source}; write each as NAME:TOKEN, or TOKEN for the tenant `default`")]
    Name {
        /// Which of them.
        number: usize,
        /// What names there can be.
        source: InvalidTenant,
    },
    /// A name and a token with an equals sign between them, which would be taken as one token that nobody sends.
    #[error("token {number} has `=` within it: write NAME:TOKEN, with a colon")]
    Equals {
        /// Which of them.
        number: usize,
    },
    /// The same token under two names.
    #[error("token {number} is also given to another name: make one for each")]
    Shared {
        /// Which of them.
        number: usize,
    },
}

/// Shortest token: 64 bits if it is hexadecimal.
const LEAST_CHARACTERS: usize = 16;

impl Tokens {
    /// Reads `NAME:TOKEN` or `TOKEN` between blanks, line ends or commas; a line that begins with # is a remark. A token without
    /// a name is held by the tenant `default`.
    ///
    /// # Errors
    /// A token that is too short or cannot stand in a header, a name that cannot be, or a token of two names.
    pub fn parse(text: &str) -> Result<Self, TokenError> {
        let lines = text.lines().filter(|line| !line.trim_start().starts_with('#'));
        let words = lines.flat_map(|line| line.split([' ', '\t', ','])).filter(|word| !word.is_empty());
        let mut tokens = Tokens::default();
        for (i, word) in words.enumerate() {
            let number = i + 1;
            let (name, token) =
                word.split_once(':').map_or((None, word), |(name, token)| (Some(name), token));
            // Base64 ends in such signs, and has none before.
            if name.is_none() && token.trim_end_matches('=').contains('=') {
                return Err(TokenError::Equals { number });
            }
            let named = name.map(Tenant::named).transpose();
            let tenant = named.map_err(|source| TokenError::Name { number, source })?.unwrap_or_default();
            if token.len() < LEAST_CHARACTERS || !token.bytes().all(|byte| byte.is_ascii_graphic()) {
                return Err(TokenError::Weak { number });
            }
            tokens.add(hash(token), tenant).map_err(|()| TokenError::Shared { number })?;
        }
        Ok(tokens)
    }

    /// Adds the hash of a token, unless another tenant holds it already.
    fn add(&mut self, token: [u8; 32], tenant: Tenant) -> Result<(), ()> {
        match self.0.iter().find(|(known, _)| *known == token) {
            Some((_, holder)) if *holder != tenant => Err(()),
            Some(_) => Ok(()),
            None => {
                self.0.push((token, tenant));
                Ok(())
            }
        }
    }

    /// These and others.
    ///
    /// # Errors
    /// The number of the first of the others that another tenant holds here.
    pub fn and(mut self, others: Tokens) -> Result<Self, TokenError> {
        for (i, (token, tenant)) in others.0.into_iter().enumerate() {
            self.add(token, tenant).map_err(|()| TokenError::Shared { number: i + 1 })?;
        }
        Ok(self)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The tenant that holds a token. It takes as long whichever it is like, and however much.
    pub(crate) fn holder(&self, token: &str) -> Option<&Tenant> {
        let asked = hash(token);
        let mut found = u32::MAX;
        for (index, (known, _)) in (0..u32::MAX).zip(&self.0) {
            found = u32::conditional_select(&found, &index, known.ct_eq(&asked));
        }
        self.0.get(found as usize).map(|(_, tenant)| tenant)
    }
}

fn hash(token: &str) -> [u8; 32] {
    Sha256::digest(token.as_bytes()).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_of_several_tokens_has_its_tenant_and_nothing_like_them_has_one() {
        let text = "# the team\n0123456789abcdef\n  alice:fedcba9876543210, Bob:AAAAAAAAAAAAAAAA\nalice:a:b:c:d:e:f:g:h:i\n\n";
        let tokens = Tokens::parse(text).unwrap();
        for (token, name) in [
            ("0123456789abcdef", "default"),
            ("fedcba9876543210", "alice"),
            ("AAAAAAAAAAAAAAAA", "bob"),
            ("a:b:c:d:e:f:g:h:i", "alice"),
        ] {
            assert_eq!(tokens.holder(token).map(Tenant::name), Some(name), "{token}");
        }
        for token in [
            "",
            "0123456789abcde",
            "0123456789abcdef0",
            "0123456789ABCDEF",
            "# the team",
            "alice",
            "alice:fedcba9876543210",
        ] {
            assert_eq!(tokens.holder(token), None, "{token}");
        }
    }

    #[test]
    fn tokens_that_cannot_be_used_are_refused_by_number() {
        let refused = |text: &str| Tokens::parse(text).unwrap_err();
        assert_eq!(refused("0123456789abcdef short"), TokenError::Weak { number: 2 });
        assert_eq!(refused("0123456789abcdéfg"), TokenError::Weak { number: 1 });
        assert_eq!(refused("alice:short"), TokenError::Weak { number: 1 });
        for name in ["", "..", "a/b"] {
            let text = format!("{name}:0123456789abcdef");
            assert_eq!(refused(&text), TokenError::Name { number: 1, source: InvalidTenant });
        }
        assert_eq!(refused("a:0123456789abcdef alice=0123456789abcdef"), TokenError::Equals { number: 2 });
        assert!(!Tokens::parse("bWFkZSBieSBiYXNlNjQ==").unwrap().is_empty());
        let twice = "a:0123456789abcdef a:0123456789abcdef b:0123456789abcdef";
        assert_eq!(refused(twice), TokenError::Shared { number: 3 });
        assert!(Tokens::parse("# none\n").unwrap().is_empty());
    }

    #[test]
    fn tokens_are_not_shown() {
        let shown = format!("{:?}", Tokens::parse("0123456789abcdef").unwrap());
        assert_eq!(shown, "1 tokens");
        let refused = Tokens::parse("alice:secret").unwrap_err().to_string();
        assert!(!refused.contains("secret"), "{refused}");
    }
}
