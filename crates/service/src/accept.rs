//! Which of several media types a client wants (RFC 9110, section 12.5.1).

use axum::http::{HeaderMap, header};

/// The media type of those on offer that the client wants most; among equals, the first.
pub(crate) fn preferred(headers: &HeaderMap, offered: &[&'static str]) -> &'static str {
    let accept = headers.get(header::ACCEPT).and_then(|value| value.to_str().ok()).unwrap_or("*/*");
    let mut best = (0.0, offered[0]);
    for media_type in offered {
        let weight = preference(accept, media_type);
        if weight > best.0 {
            best = (weight, media_type);
        }
    }
    best.1
}

/// How much an `Accept` header wants a media type, 0 to 1; the most specific range counts.
fn preference(accept: &str, media_type: &str) -> f64 {
    let group = media_type.split('/').next().unwrap_or_default();
    let mut found = (0, 0.0);
    for range in accept.split(',') {
        let mut parts = range.split(';').map(str::trim);
        let name = parts.next().unwrap_or_default();
        let exactness = match name.split_once('/') {
            _ if name.eq_ignore_ascii_case(media_type) => 3,
            Some((g, "*")) if g == group => 2,
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

    #[test]
    fn the_preferred_media_type_is_the_one_with_the_greatest_weight() {
        let choice = |accept| {
            let mut headers = HeaderMap::new();
            headers.insert(header::ACCEPT, HeaderValue::from_static(accept));
            preferred(&headers, &["application/json", "application/geo+json", "text/csv"])
        };
        assert_eq!(choice("application/geo+json"), "application/geo+json");
        assert_eq!(choice("application/json;q=0.5, application/geo+json"), "application/geo+json");
        assert_eq!(choice("text/*, application/json;q=0.9"), "text/csv");
        for accept in
            ["*/*", "application/*", "application/json, text/csv;q=0.1", "text/html, */*;q=0.8", "image/png"]
        {
            assert_eq!(choice(accept), "application/json", "{accept}");
        }
    }
}
