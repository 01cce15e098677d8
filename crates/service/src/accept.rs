//! Which of several media types a client wants (RFC 9110, section 12.5.1).

use axum::http::{HeaderMap, header};

/// The media type of those on offer that the client wants most; among equals, the first. `None` where it wants none of them.
pub(crate) fn wanted<'a>(headers: &HeaderMap, offered: &[&'a str]) -> Option<&'a str> {
    let accept = accept(headers);
    let mut best = (0.0, None);
    for media_type in offered {
        let weight = preference(&accept, media_type);
        if weight > best.0 {
            best = (weight, Some(*media_type));
        }
    }
    best.1
}

/// The same for a handler, whose path has been found to offer what the client wants: the first where it wants none.
pub(crate) fn preferred(headers: &HeaderMap, offered: &[&'static str]) -> &'static str {
    wanted(headers, offered).unwrap_or(offered[0])
}

/// All `Accept` fields as one list; a client that sends none takes anything.
fn accept(headers: &HeaderMap) -> String {
    let fields: Vec<&str> = headers.get_all(header::ACCEPT).iter().filter_map(|v| v.to_str().ok()).collect();
    let all = fields.join(",");
    if all.trim().is_empty() { "*/*".to_owned() } else { all }
}

/// How much an `Accept` list wants a media type, 0 to 1; the most specific range counts.
fn preference(accept: &str, media_type: &str) -> f64 {
    let group = media_type.split('/').next().unwrap_or_default();
    let mut found = (0, 0.0);
    for range in accept.split(',') {
        let mut parts = range.split(';').map(str::trim);
        let name = parts.next().unwrap_or_default();
        let exactness = match name.split_once('/') {
            _ if name.eq_ignore_ascii_case(media_type) => 3,
            Some((g, "*")) if g.eq_ignore_ascii_case(group) => 2,
            Some(("*", "*")) => 1,
            _ => continue,
        };
        let weight = parts.find_map(|p| p.strip_prefix("q=")?.parse().ok()).unwrap_or(1.0);
        if exactness > found.0 {
            found = (exactness, weight);
        }
    }
    found.1
}

#[cfg(test)]
mod tests {
    use axum::http::HeaderValue;

    use super::*;

    fn headers(accept: &'static str) -> HeaderMap {
        let mut headers = HeaderMap::new();
        headers.insert(header::ACCEPT, HeaderValue::from_static(accept));
        headers
    }

    #[test]
    fn the_preferred_media_type_is_the_one_with_the_greatest_weight() {
        let choice =
            |accept| preferred(&headers(accept), &["application/json", "application/geo+json", "text/csv"]);
        assert_eq!(choice("application/geo+json"), "application/geo+json");
        assert_eq!(choice("application/json;q=0.5, application/geo+json"), "application/geo+json");
        assert_eq!(choice("text/*, application/json;q=0.9"), "text/csv");
        for accept in [
            "*/*",
            "application/*",
            "application/json, text/csv;q=0.1",
            "text/html, */*;q=0.8",
            "image/png",
            "",
        ] {
            assert_eq!(choice(accept), "application/json", "{accept}");
        }
    }

    #[test]
    fn what_is_not_wanted_at_all_is_not_chosen() {
        let offered = ["application/json", "text/csv"];
        assert_eq!(wanted(&headers("image/png, text/html;q=0.3"), &offered), None);
        assert_eq!(wanted(&headers("application/json;q=0, */*"), &offered), Some("text/csv"));
        assert_eq!(wanted(&headers("*/*;q=0"), &offered), None);
        assert_eq!(wanted(&HeaderMap::new(), &offered), Some("application/json"));
        let mut two = headers("image/png");
        two.append(header::ACCEPT, HeaderValue::from_static("TEXT/*"));
        assert_eq!(wanted(&two, &offered), Some("text/csv"), "several fields are one list");
    }
}
