//! Names by which the service may be asked, against pages of a name that leads to this machine (DNS rebinding).

use std::net::IpAddr;

/// Names of the service beside those of the loopback interface.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hosts {
    /// Names that a setting gives, without port.
    named: Vec<String>,
    /// Whether any IP address will do, as where other machines reach the service: nobody can make a browser take an address
    /// for another.
    any_address: bool,
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
            let plain = normal(name);
            let is_name =
                !plain.is_empty() && (plain.parse::<IpAddr>().is_ok() || plain.bytes().all(is_of_a_name));
            if is_name { Ok(plain) } else { Err(InvalidHost { name: name.clone() }) }
        };
        Ok(Hosts { named: names.iter().map(checked).collect::<Result<_, _>>()?, any_address })
    }

    /// Whether a `Host` field, or the authority of a URI, names the service.
    pub(crate) fn admit(&self, host: &str) -> bool {
        let Some(name) = without_port(host) else { return false };
        let name = normal(name);
        if let Ok(address) = name.parse::<IpAddr>() {
            let is_loopback = address.to_canonical().is_loopback();
            return is_loopback || self.any_address || self.named.contains(&name);
        }
        // RFC 6761, section 6.3: `localhost` and all names below it are loopback.
        name == "localhost" || name.ends_with(".localhost") || self.named.contains(&name)
    }

    /// Whether a setting names the host of an origin.
    pub(crate) fn is_named(&self, host: &str) -> bool {
        without_port(host).is_some_and(|name| self.named.contains(&normal(name)))
    }
}

/// A name in lower case, without the brackets of an IPv6 address and the dot of the root.
fn normal(name: &str) -> String {
    let name = name.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')).unwrap_or(name);
    name.strip_suffix('.').unwrap_or(name).to_ascii_lowercase()
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
        let open = Hosts::named(&[], true).unwrap();
        assert!(open.admit("10.0.0.2:8080") && open.admit("[fd00::2]") && !open.admit("evil.example"));
    }

    #[test]
    fn what_is_no_host_is_refused_by_name() {
        for name in ["", "https://maps.example.org", "maps.example.org:80", "a b", "a/b", "*"] {
            let said = Hosts::named(&[name.to_owned()], false).unwrap_err().to_string();
            assert!(said.contains("--host") && said.contains(name), "{said}");
        }
    }
}
