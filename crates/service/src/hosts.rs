//! Names by which the service may be asked, against pages of a name that leads to this machine (DNS rebinding).

use std::{fmt, net::IpAddr};

/// Names of the service beside those of the loopback interface.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hosts {
    /// Names and addresses that a setting gives.
    named: Vec<Host>,
    /// Whether any IP address will do, as where other machines reach the service: nobody can make a browser take an address
    /// for another.
    any_address: bool,
}

/// A host without its port.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Host {
    /// An address, however it is written.
    Address(IpAddr),
    /// A name in lower case, without the dot of the root.
    Name(String),
}

/// A name that no `Host` field can hold.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "--host {name} is no host: give a name or an address without scheme, port and path, as maps.example.org"
)]
pub struct InvalidHost {
    name: String,
}

impl Hosts {
    /// Names that a setting gives.
    ///
    /// # Errors
    /// A name with a scheme, port or path, or with characters that names do not have.
    pub fn named(names: &[String], any_address: bool) -> Result<Self, InvalidHost> {
        let checked = |name: &String| {
            let host = Host::from(name.as_str());
            let is_host = match &host {
                Host::Address(_) => true,
                Host::Name(name) => !name.is_empty() && name.bytes().all(is_of_a_name),
            };
            if is_host { Ok(host) } else { Err(InvalidHost { name: name.clone() }) }
        };
        Ok(Hosts { named: names.iter().map(checked).collect::<Result<_, _>>()?, any_address })
    }

    /// Whether a `Host` field, or the authority of a URI, names the service.
    pub(crate) fn admit(&self, host: &str) -> bool {
        let Some(host) = without_port(host).map(Host::from) else { return false };
        self.named.contains(&host)
            || match host {
                Host::Address(address) => self.any_address || address.is_loopback(),
                // RFC 6761, section 6.3: `localhost` and all names below it are loopback.
                Host::Name(name) => name == "localhost" || name.ends_with(".localhost"),
            }
    }

    /// Whether a setting names the host of an origin.
    pub(crate) fn is_named(&self, host: &str) -> bool {
        without_port(host).is_some_and(|host| self.named.contains(&host.into()))
    }
}

/// What is admitted, in words.
impl fmt::Display for Hosts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.any_address { "localhost and any IP address" } else { "localhost" })?;
        if self.named.is_empty() { Ok(()) } else { f.write_str(" and what --host names") }
    }
}

impl From<&str> for Host {
    fn from(text: &str) -> Self {
        let plain = text.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')).unwrap_or(text);
        let plain = plain.strip_suffix('.').unwrap_or(plain);
        match plain.parse::<IpAddr>() {
            Ok(address) => Host::Address(address.to_canonical()),
            Err(_) => Host::Name(plain.to_ascii_lowercase()),
        }
    }
}

fn is_of_a_name(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || b"-._".contains(&byte)
}

/// The host of `host[:port]`; `None` where it is neither.
fn without_port(text: &str) -> Option<&str> {
    let split = match text.strip_prefix('[') {
        Some(rest) => rest.find(']')? + 2,
        None => text.find(':').unwrap_or(text.len()),
    };
    let (host, port) = text.split_at_checked(split)?;
    let is_port = |port: &str| port.parse::<u16>().is_ok() || port.is_empty();
    (port.is_empty() || port.strip_prefix(':').is_some_and(is_port)).then_some(host)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loopback_names_and_addresses_are_the_services_own() {
        let hosts = Hosts::default();
        for host in [
            "localhost",
            "localhost:8080",
            "LocalHost:1",
            "localhost.",
            "maps.localhost:80",
            "127.0.0.1",
            "127.0.0.1:8080",
            "127.9.8.7:1",
            "[::1]",
            "[::1]:8080",
            "[::ffff:127.0.0.1]:80",
            "localhost:",
        ] {
            assert!(hosts.admit(host), "{host}");
        }
        for host in [
            "",
            "evil.example",
            "evil.example:8080",
            "localhost.evil.example",
            "127.0.0.1.evil.example",
            "evillocalhost",
            "128.0.0.1",
            "10.0.0.1:8080",
            "[::2]",
            "[::1",
            "::1",
            "localhost:80:80",
            "localhost:x",
            "user@localhost",
            "localhost/",
            "evil.example#localhost",
            "0.0.0.0",
            "[::1]evil.example",
            "2130706433",
            "127.1",
        ] {
            assert!(!hosts.admit(host), "{host}");
        }
    }

    #[test]
    fn named_hosts_are_admitted_and_addresses_where_others_reach_the_service() {
        let named =
            Hosts::named(&["Maps.Example.org".into(), "10.0.0.1".into(), "[fd00::1]".into()], false).unwrap();
        for host in ["maps.example.org", "MAPS.example.org.:443", "10.0.0.1:8080", "[fd00::1]:8080"] {
            assert!(named.admit(host), "{host}");
        }
        assert!(!named.admit("example.org") && !named.admit("10.0.0.2"));
        let long = Hosts::named(&["[fd00:0::1]".into(), "::ffff:10.0.0.1".into()], false).unwrap();
        for host in ["[fd00::1]:80", "[FD00:0:0::0001]", "10.0.0.1", "[::ffff:a00:1]"] {
            assert!(long.admit(host), "{host}");
        }
        assert!(long.is_named("[fd00::1]:8080") && !long.is_named("[fd00::2]"));
        let open = Hosts::named(&[], true).unwrap();
        assert!(open.admit("10.0.0.2:8080") && open.admit("[fd00::2]") && !open.admit("evil.example"));
    }

    #[test]
    fn what_is_admitted_is_said() {
        let said = |names: &[String], any_address| Hosts::named(names, any_address).unwrap().to_string();
        assert_eq!(said(&[], false), "localhost");
        assert_eq!(said(&[], true), "localhost and any IP address");
        assert_eq!(said(&["a.example".into()], false), "localhost and what --host names");
    }

    #[test]
    fn what_is_no_host_is_refused_by_name() {
        for name in ["", "https://maps.example.org", "maps.example.org:80", "a b", "a/b", "*"] {
            let said = Hosts::named(&[name.to_owned()], false).unwrap_err().to_string();
            assert!(said.contains("--host") && said.contains(name), "{said}");
        }
    }
}
