//! `Accept`: what the description says a path offers is what a client may ask it for.

use std::{collections::HashMap, sync::Arc};

use axum::{
    extract::{MatchedPath, Request, State},
    http::{HeaderValue, Method, header},
    middleware::Next,
    response::{IntoResponse, Response},
};
use utoipa::openapi::{OpenApi, PathItem, RefOr, path::Operation};

use crate::{
    accept::wanted,
    problem::{Problem, ProblemType},
};

/// Media types of successful answers, by path template and method.
#[derive(Clone, Debug)]
pub(crate) struct Offers(Arc<HashMap<(String, Method), Vec<String>>>);

impl Offers {
    /// Reads them off a description.
    pub(crate) fn of(description: &OpenApi) -> Self {
        let mut offers = HashMap::new();
        for (path, item) in &description.paths.paths {
            for (method, operation) in operations(item) {
                offers.insert((path.clone(), method), offered(operation));
            }
        }
        Offers(Arc::new(offers))
    }

    fn at(&self, path: &str, method: &Method) -> &[String] {
        let method = if method == Method::HEAD { Method::GET } else { method.clone() };
        self.0.get(&(path.to_owned(), method)).map_or(&[], Vec::as_slice)
    }
}

/// The operations of a path.
fn operations(item: &PathItem) -> impl Iterator<Item = (Method, &Operation)> {
    [
        (Method::GET, &item.get),
        (Method::POST, &item.post),
        (Method::PUT, &item.put),
        (Method::PATCH, &item.patch),
        (Method::DELETE, &item.delete),
    ]
    .into_iter()
    .filter_map(|(method, operation)| Some((method, operation.as_ref()?)))
}

fn offered(operation: &Operation) -> Vec<String> {
    let successes = operation.responses.responses.iter().filter(|(status, _)| status.starts_with('2'));
    let mut types: Vec<String> = Vec::new();
    for (_, response) in successes {
        let RefOr::T(response) = response else { continue };
        types.extend(
            response.content.keys().filter(|kind| !types.contains(kind)).cloned().collect::<Vec<_>>(),
        );
    }
    types
}

/// Refuses a request whose answer the client would not take, before anything is done for it.
pub(crate) async fn negotiate(
    State(offers): State<Offers>,
    path: Option<MatchedPath>,
    request: Request,
    next: Next,
) -> Response {
    let offered: Vec<&str> = path
        .map_or(&[][..], |path| offers.at(path.as_str(), request.method()))
        .iter()
        .map(String::as_str)
        .collect();
    if offered.is_empty() {
        return next.run(request).await;
    }
    if wanted(request.headers(), &offered).is_none() {
        let detail =
            format!("this path answers as {}: ask for that, or leave Accept out", offered.join(", "));
        return Problem::new(ProblemType::NotAcceptable, detail).into_response();
    }
    let several = offered.len() > 1;
    let mut response = next.run(request).await;
    if several {
        response.headers_mut().append(header::VARY, HeaderValue::from_static("accept"));
    }
    response
}
