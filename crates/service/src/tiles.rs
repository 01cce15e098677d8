//! Pictures of the ground that the page may lay under paths: tiles of Web Mercator from somewhere else.

use axum::http::Uri;
use serde::Serialize;

/// Where tiles come from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Tiles {
    /// Address of a tile, with `{z}`, `{x}` and `{y}` in it.
    url: String,
    /// Whom the pictures are from, to be shown beside them.
    attribution: String,
    /// Largest zoom that there are tiles of.
    max_zoom: u8,
    /// Scheme, host and port that the page may ask for pictures.
    #[serde(skip)]
    origin: String,
}

/// Why tiles cannot be had from an address.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TilesError {
    /// An address that lacks the place of a number.
    #[error("{url} has no {missing}: give a template as https://tiles.example.org/{{z}}/{{x}}/{{y}}.png")]
    Template {
        /// The address.
        url: String,
        /// What is missing.
        missing: &'static str,
    },
    /// Anything but an absolute address of the web.
    #[error(
        "{url} is no address of the web: begin with http:// or https:// and a host, without a user's name"
    )]
    Address {
        /// The address.
        url: String,
    },
}

impl Tiles {
    /// Tiles from a template of addresses.
    ///
    /// # Errors
    /// A template without the places of zoom, column and row, or that is no address of the web.
    pub fn from_template(url: &str, attribution: &str, max_zoom: u8) -> Result<Self, TilesError> {
        let url = url.trim();
        for missing in ["{z}", "{x}", "{y}"] {
            if !url.contains(missing) {
                return Err(TilesError::Template { url: url.to_owned(), missing });
            }
        }
        let filled = ["{z}", "{x}", "{y}"].iter().fold(url.to_owned(), |url, place| url.replace(place, "0"));
        let origin = origin(&filled).ok_or_else(|| TilesError::Address { url: url.to_owned() })?;
        // A host that depends on the tile is not one host.
        if !url.starts_with(&origin) {
            return Err(TilesError::Address { url: url.to_owned() });
        }
        Ok(Tiles { url: url.to_owned(), attribution: attribution.trim().to_owned(), max_zoom, origin })
    }

    /// Scheme, host and port, as a content security policy names them.
    pub(crate) fn origin(&self) -> &str {
        &self.origin
    }
}

/// Scheme, host and port of an address; none of one that a policy could misunderstand.
fn origin(address: &str) -> Option<String> {
    let uri: Uri = address.parse().ok()?;
    let scheme = uri.scheme_str().filter(|scheme| matches!(*scheme, "http" | "https"))?;
    let host = uri.authority()?.as_str();
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | ':' | '[' | ']');
    (!host.is_empty() && host.chars().all(is_plain)).then(|| format!("{scheme}://{host}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(url: &str) -> Result<Tiles, TilesError> {
        Tiles::from_template(url, "", 19)
    }

    #[test]
    fn the_origin_is_scheme_host_and_port() {
        for (url, origin) in [
            ("https://tiles.example.org/{z}/{x}/{y}.png?key=a;b", "https://tiles.example.org"),
            ("http://127.0.0.1:8081/{z}/{y}/{x}", "http://127.0.0.1:8081"),
            ("http://[::1]:80/{z}/{x}/{y}", "http://[::1]:80"),
        ] {
            assert_eq!(read(url).unwrap().origin(), origin);
        }
    }

    #[test]
    fn what_is_no_template_of_the_web_is_refused() {
        assert!(read("https://tiles.example.org/{z}/{x}.png").unwrap_err().to_string().contains("{y}"));
        for url in [
            "/tiles/{z}/{x}/{y}.png",
            "file:///tiles/{z}/{x}/{y}.png",
            "https://{x}.example.org/{z}/{y}",
            "https://me:secret@example.org/{z}/{x}/{y}",
            "https://a;script-src*/{z}/{x}/{y}",
            "https:///{z}/{x}/{y}",
        ] {
            assert!(matches!(read(url), Err(TilesError::Address { .. })), "{url}");
        }
    }
}
