//! `Content-Encoding` of requests: the one place where bodies are decoded (RFC 9110, section 8.4).

mod coding;
mod decode;

use axum::{
    body::HttpBody,
    extract::{Request, State},
    http::{HeaderMap, HeaderValue, header},
    middleware::Next,
    response::{IntoResponse, Response},
};

use self::{coding::Coding, decode::decoded};
use crate::{
    Engine,
    problem::{Problem, ProblemType},
};

/// Codings that are decoded, as `Accept-Encoding` of a refusal names them.
const ACCEPTED: HeaderValue = HeaderValue::from_static("gzip, deflate, br, zstd");
/// Most codings of one body. Each takes memory, and nobody applies more than two on purpose.
const MOST_CODINGS: usize = 3;

/// Decodes a body by its codings, the last one first. Limits count decoded bytes, so that a small body that decodes to a
/// large one is refused as a large one is.
pub(crate) async fn decode(State(engine): State<Engine>, mut request: Request, next: Next) -> Response {
    let codings = match codings(request.headers()) {
        Ok(codings) => codings,
        Err(problem) => return refusal(problem),
    };
    request.headers_mut().remove(header::CONTENT_ENCODING);
    if codings.is_empty() || request.body().is_end_stream() {
        return next.run(request).await;
    }
    // The declared length is that of the encoded body.
    request.headers_mut().remove(header::CONTENT_LENGTH);
    let bytes = codings.iter().map(|coding| coding.decoder_bytes()).sum();
    let reserved = match engine.admission().reserve(bytes) {
        Ok(reserved) => reserved,
        Err(problem) => return problem.into_response(),
    };
    let (parts, body) = request.into_parts();
    let body = codings.into_iter().rev().fold(body, |body, coding| decoded(coding, body));
    next.run(Request::from_parts(parts, crate::memory::holding(body, reserved))).await
}

fn refusal(problem: Problem) -> Response {
    let mut response = problem.into_response();
    response.headers_mut().insert(header::ACCEPT_ENCODING, ACCEPTED);
    response
}

/// Codings in the order in which they were applied, `identity` left out.
fn codings(headers: &HeaderMap) -> Result<Vec<Coding>, Problem> {
    let refused = |detail: String| Problem::new(ProblemType::UnsupportedMediaType, detail);
    let mut codings = Vec::new();
    for value in headers.get_all(header::CONTENT_ENCODING) {
        let list = String::from_utf8_lossy(value.as_bytes());
        for name in list.split(',').map(str::trim).filter(|name| !name.is_empty()) {
            if name.eq_ignore_ascii_case("identity") {
                continue;
            }
            let coding = Coding::named(name).ok_or_else(|| {
                let shown: String = name.chars().take(LONGEST_SHOWN).collect();
                refused(format!(
                    "the content coding `{shown}` is unknown: encode the body with gzip, deflate, br or zstd, or send it plain"
                ))
            })?;
            codings.push(coding);
        }
    }
    if codings.len() > MOST_CODINGS {
        let detail = format!("the body has {} content codings: apply {MOST_CODINGS} at most", codings.len());
        return Err(refused(detail));
    }
    Ok(codings)
}

/// Characters of an unknown coding that a refusal repeats.
const LONGEST_SHOWN: usize = 40;

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(values: &[&'static str]) -> HeaderMap {
        let values = values.iter().map(|value| (header::CONTENT_ENCODING, HeaderValue::from_static(value)));
        values.collect()
    }

    #[test]
    fn codings_are_a_list_without_regard_to_case_in_which_identity_counts_for_nothing() {
        let found = codings(&headers(&["GZIP, identity", "Br", "x-gzip,"])).unwrap();
        assert_eq!(found, [Coding::Gzip, Coding::Brotli, Coding::Gzip]);
        for plain in [&[][..], &["identity"], &[""], &["Identity, identity"]] {
            assert_eq!(codings(&headers(plain)).unwrap(), []);
        }
    }

    #[test]
    fn an_unknown_coding_and_too_many_are_refused() {
        for wrong in ["compress", "gzip, aes128gcm", "gzip;q=1", "gzip gzip", "gzip, gzip, gzip, gzip"] {
            let problem = codings(&headers(&[wrong])).unwrap_err();
            assert_eq!(problem.kind, ProblemType::UnsupportedMediaType, "{wrong}");
        }
    }
}
