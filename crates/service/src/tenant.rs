//! Tenants: who owns what the service keeps.

use std::sync::Arc;

use axum::{extract::FromRequestParts, http::request::Parts};
use serde::{Deserialize, Serialize};

use crate::{
    Engine,
    problem::{Problem, ProblemType},
};

/// Longest name of a tenant [characters].
const LONGEST_NAME: usize = 32;
/// Owner of everything where tokens have no names, and where there are no tokens.
const DEFAULT: &str = "default";
/// Name of the tenant that sees the objects of all others.
const ADMIN: &str = "admin";

/// An owner of maps, robots, recordings and jobs, by a checked name. Case does not count, so that two names never meet in a
/// file system that ignores it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Tenant(Arc<str>);

/// A name that no tenant can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a tenant's name is 1 to {LONGEST_NAME} of a-z, 0-9, - and _, and begins with a letter or a digit")]
pub struct InvalidTenant;

impl Tenant {
    /// The tenant of a name.
    ///
    /// # Errors
    /// A name that cannot stand in the name of an object.
    pub fn named(name: &str) -> Result<Self, InvalidTenant> {
        let fits = (1..=LONGEST_NAME).contains(&name.len())
            && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_'))
            && name.starts_with(|first: char| first.is_ascii_alphanumeric());
        if fits { Ok(Tenant(name.to_ascii_lowercase().into())) } else { Err(InvalidTenant) }
    }

    /// Name of the tenant.
    pub fn name(&self) -> &str {
        &self.0
    }

    /// Whether it is the owner of what was stored without a name.
    pub fn is_default(&self) -> bool {
        *self.0 == *DEFAULT
    }

    /// Whether it sees the objects of all tenants.
    pub fn is_admin(&self) -> bool {
        *self.0 == *ADMIN
    }

    /// Whether it sees what another tenant owns.
    pub(crate) fn sees(&self, owner: &Tenant) -> bool {
        self == owner || self.is_admin()
    }
}

impl Default for Tenant {
    fn default() -> Self {
        Tenant(DEFAULT.into())
    }
}

impl TryFrom<String> for Tenant {
    type Error = InvalidTenant;

    fn try_from(name: String) -> Result<Self, InvalidTenant> {
        Tenant::named(&name)
    }
}

impl From<Tenant> for String {
    fn from(tenant: Tenant) -> Self {
        tenant.name().to_owned()
    }
}

/// The tenant whose token a request carries.
impl FromRequestParts<Engine> for Tenant {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &Engine) -> Result<Self, Problem> {
        let missing = || Problem::new(ProblemType::Unauthorized, "the request carries no token of a tenant");
        parts.extensions.get::<Tenant>().cloned().ok_or_else(missing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parts_of_paths_and_nothing_else_and_their_case_does_not_count() {
        for name in ["a", "team-1", "0_x", &"a".repeat(32)] {
            assert_eq!(Tenant::named(name).unwrap().name(), name);
        }
        assert_eq!(Tenant::named("Alice").unwrap(), Tenant::named("alice").unwrap());
        for name in ["", ".", "..", "a/b", "a.b", "-a", "_a", "a b", "é", &"a".repeat(33)] {
            assert_eq!(Tenant::named(name), Err(InvalidTenant), "{name}");
        }
    }

    #[test]
    fn an_admin_sees_all_and_others_see_their_own() {
        let [alice, bob, admin] = ["alice", "bob", "Admin"].map(|name| Tenant::named(name).unwrap());
        assert!(alice.sees(&alice) && !alice.sees(&bob) && !alice.sees(&admin));
        assert!(admin.sees(&alice) && admin.sees(&Tenant::default()) && admin.is_admin());
        assert!(!Tenant::default().sees(&alice));
    }
}
