//! `x-request-id`: an id that a client sends is repeated in the answer and in the log, if it is one.

use axum::http::{HeaderValue, Request};

use super::REQUEST_ID;

/// Longest id [bytes]; a UUID has 36, a trace context 55.
const LONGEST: usize = 128;

/// Removes an id that is too long, empty, given twice, or has characters that a log or a shell would take for its own. The
/// request then gets a new one.
pub(super) fn without_unusable<B>(mut request: Request<B>) -> Request<B> {
    let mut given = request.headers().get_all(REQUEST_ID).iter();
    let is_usable = match (given.next(), given.next()) {
        (None, _) => true,
        (Some(id), None) => is_usable(id),
        (Some(_), Some(_)) => false,
    };
    if !is_usable {
        request.headers_mut().remove(REQUEST_ID);
    }
    request
}

fn is_usable(id: &HeaderValue) -> bool {
    let is_plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"-_.:/+=@~".contains(byte);
    (1..=LONGEST).contains(&id.len()) && id.as_bytes().iter().all(is_plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(ids: &[&[u8]]) -> usize {
        let mut request = Request::new(());
        for id in ids {
            request.headers_mut().append(REQUEST_ID, HeaderValue::from_bytes(id).unwrap());
        }
        without_unusable(request).headers().get_all(REQUEST_ID).iter().count()
    }

    #[test]
    fn ids_are_kept_up_to_128_plain_characters() {
        for id in ["a", "mine-17", "4bf92f35-77b3:4da6/a3ce+92=9@d~0.e_", &"x".repeat(128)] {
            assert_eq!(kept(&[id.as_bytes()]), 1, "{id}");
        }
        for id in ["", "a b", "{}\"'<>", "a;b", "$(id)", &"x".repeat(129)] {
            assert_eq!(kept(&[id.as_bytes()]), 0, "{id}");
        }
        assert_eq!(kept(&[b"\xc3\xa9"]), 0);
        assert_eq!(kept(&[b"a", b"b"]), 0, "nobody could tell which");
    }
}
