//! Forms of two files, as `curl -F` sends them.

use axum::{body::Bytes, extract::Request, http::header::CONTENT_TYPE};
use futures_util::{FutureExt, stream};

use crate::problem::{Problem, ProblemType};

/// Parts of a form that are looked at.
const MOST_PARTS: usize = 8;

/// The boundary between the parts of a request's form.
///
/// # Errors
/// A content type that names none.
pub(crate) fn boundary_of(request: &Request) -> Result<String, Problem> {
    let whole = request.headers().get(CONTENT_TYPE).and_then(|value| value.to_str().ok());
    multer::parse_boundary(whole.unwrap_or_default()).map_err(|error| unreadable(&error))
}

/// Both files of a form, in the order of their names; they share the memory of its body. `example` is what curl is told to send them.
///
/// # Errors
/// A form that cannot be read, lacks a part or has another one.
pub(crate) fn two_files(
    body: Bytes,
    boundary: &str,
    names: [&str; 2],
    example: &str,
) -> Result<[Bytes; 2], Problem> {
    // All of the body is there, so that nothing is waited for.
    let parts = parts(body, boundary).now_or_never();
    let parts = parts.unwrap_or(Err(multer::Error::IncompleteStream)).map_err(|error| unreadable(&error))?;
    let mut files = [None, None];
    for (name, bytes) in parts {
        let Some(at) = names.iter().position(|known| *known == name) else {
            let shown: String = name.chars().take(40).collect();
            let [one, other] = names;
            return Err(problem(&format!("the form has a part `{shown}`, but takes `{one}` and `{other}`")));
        };
        files[at] = Some(bytes);
    }
    let missing = |at: usize| {
        problem(&format!("the form has no part `{}`: send both files, as by `curl {example}`", names[at]))
    };
    let [first, second] = files;
    Ok([first.ok_or_else(|| missing(0))?, second.ok_or_else(|| missing(1))?])
}

/// Parts by name; of a form with more of them than are looked at, so many.
async fn parts(body: Bytes, boundary: &str) -> Result<Vec<(String, Bytes)>, multer::Error> {
    let body = stream::once(async { Ok::<Bytes, std::convert::Infallible>(body) });
    let mut form = multer::Multipart::new(body, boundary);
    let mut parts = Vec::new();
    while let Some(part) = form.next_field().await? {
        let name = part.name().unwrap_or_default().to_owned();
        parts.push((name, part.bytes().await?));
        if parts.len() == MOST_PARTS {
            break;
        }
    }
    Ok(parts)
}

fn unreadable(error: &multer::Error) -> Problem {
    problem(&format!("the form cannot be read: {error}"))
}

fn problem(detail: &str) -> Problem {
    Problem::new(ProblemType::InvalidRequest, detail)
}
