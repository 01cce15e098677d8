//! `Authorization: Bearer`: who has a token may ask, as the tenant that holds it.

use axum::{
    extract::{Request, State},
    http::header,
    middleware::Next,
    response::{IntoResponse, Response},
};

use crate::{
    Tenant, Tokens,
    problem::{Problem, ProblemType},
};

/// Refuses a request without one of the tokens; without any tokens, everybody may ask as the tenant `default`.
pub(crate) async fn needs_token(State(tokens): State<Tokens>, request: Request, next: Next) -> Response {
    if tokens.is_empty() {
        return run_as(Tenant::default(), request, next).await;
    }
    let field = request.headers().get(header::AUTHORIZATION).and_then(|value| value.to_str().ok());
    let token = field.and_then(bearer);
    if let Some(tenant) = token.and_then(|token| tokens.holder(token)) {
        return run_as(tenant.clone(), request, next).await;
    }
    let detail = match token {
        Some(_) => {
            "the token is not one of the service's: give what stands behind the colon of NAME:TOKEN, or ask who runs the service for one"
        }
        None => "this service wants a token: send it as `Authorization: Bearer TOKEN`",
    };
    Problem::new(ProblemType::Unauthorized, detail).into_response()
}

async fn run_as(tenant: Tenant, mut request: Request, next: Next) -> Response {
    tracing::Span::current().record("tenant", tenant.name());
    request.extensions_mut().insert(tenant);
    next.run(request).await
}

/// The token of a field's value; the scheme's case does not matter (RFC 9110, section 11.1).
fn bearer(value: &str) -> Option<&str> {
    let (scheme, token) = value.split_once(' ')?;
    scheme.eq_ignore_ascii_case("bearer").then(|| token.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_bearer_scheme_carries_a_token() {
        assert_eq!(bearer("Bearer abc"), Some("abc"));
        assert_eq!(bearer("bearer  abc "), Some("abc"));
        for other in ["", "abc", "Basic abc", "Bearerabc"] {
            assert_eq!(bearer(other), None, "{other}");
        }
    }
}
