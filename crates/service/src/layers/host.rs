//! `Host` and `Origin`: who is asked, and by whose page (RFC 9110, section 7.2; RFC 6454).

use axum::{
    extract::{Request, State},
    http::{HeaderValue, Method, Version, header},
    middleware::Next,
    response::{IntoResponse, Response},
};

use crate::{
    Access, Hosts,
    problem::{Problem, ProblemType},
};

/// What is checked.
#[derive(Clone, Debug)]
pub(crate) struct Rule {
    hosts: Hosts,
    reach: Reach,
    /// Origins that may ask.
    origins: Vec<HeaderValue>,
}

/// Where hosts are checked: wherever no token is asked for, which no page of another name can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reach {
    All,
    /// All else that is open tells nothing of what the service holds and does.
    Metrics,
    Nothing,
}

impl Rule {
    pub(crate) fn of(access: &Access) -> Self {
        let reach = match (access.tokens.is_empty(), access.open_metrics) {
            (true, _) => Reach::All,
            (false, true) => Reach::Metrics,
            (false, false) => Reach::Nothing,
        };
        Rule { hosts: access.hosts.clone(), reach, origins: access.cors_origins.clone() }
    }

    /// The hosts that a request may ask, if it matters.
    fn hosts(&self, request: &Request) -> Option<&Hosts> {
        let is_checked = match self.reach {
            Reach::All => true,
            Reach::Metrics => request.uri().path() == METRICS,
            Reach::Nothing => false,
        };
        is_checked.then_some(&self.hosts)
    }

    /// Whether a page of an origin may change something: its host is asked, or is named by a setting.
    fn admits_origin(&self, hosts: &Hosts, origin: &HeaderValue, asked: &str) -> bool {
        let host = origin.to_str().ok().and_then(|origin| origin.split_once("://")).map(|(_, host)| host);
        let is_own = host.is_some_and(|host| host.eq_ignore_ascii_case(asked) || hosts.is_named(host));
        is_own || self.origins.contains(origin)
    }
}

/// Refuses a request that does not say whom it asks, or, where no token is asked for, one that asks another.
pub(crate) async fn check(State(rule): State<Rule>, request: Request, next: Next) -> Response {
    match refusal(&rule, &request) {
        Some(problem) => problem.into_response(),
        None => next.run(request).await,
    }
}

fn refusal(rule: &Rule, request: &Request) -> Option<Problem> {
    let mut fields = request.headers().get_all(header::HOST).iter();
    let (first, second) = (fields.next(), fields.next());
    if second.is_some() || (first.is_none() && request.version() == Version::HTTP_11) {
        let detail =
            "an HTTP/1.1 request has one Host field, which names the service: send `Host: localhost`";
        return Some(Problem::new(ProblemType::InvalidRequest, detail));
    }
    let hosts = rule.hosts(request)?;
    let field = first.map(|host| String::from_utf8_lossy(host.as_bytes()));
    let target = request.uri().authority().map(|authority| authority.as_str().into());
    let mut asked = [target, field].into_iter().flatten().peekable();
    let own = asked.peek().cloned().unwrap_or_default();
    if let Some(other) = asked.find(|host| !hosts.admit(host)) {
        let shown: String = other.chars().take(LONGEST_SHOWN).collect();
        let detail = format!(
            "the request asks `{shown}`, but without a token the service answers as {hosts} only: start it with --host NAME to \
             answer as another"
        );
        return Some(Problem::new(ProblemType::MisdirectedRequest, detail));
    }
    let is_change = ![Method::GET, Method::HEAD, Method::OPTIONS].contains(request.method());
    let origin = request.headers().get(header::ORIGIN).filter(|_| is_change)?;
    (!rule.admits_origin(hosts, origin, &own)).then(super::cross_origin)
}

/// What may be open although tokens are asked for.
const METRICS: &str = "/metrics";
/// Characters of a foreign host that a refusal repeats.
const LONGEST_SHOWN: usize = 80;

#[cfg(test)]
mod tests {
    use axum::{body::Body, http::StatusCode};

    use super::*;
    use crate::Tokens;

    fn status(rule: &Rule, method: Method, uri: &str, fields: &[(&str, &str)]) -> Option<u16> {
        let mut request = Request::builder().method(method).uri(uri);
        for (name, value) in fields {
            request = request.header(*name, *value);
        }
        refusal(rule, &request.body(Body::empty()).unwrap()).map(|problem| problem.status)
    }

    fn open() -> Rule {
        let hosts = Hosts::named(&["maps.example.org".to_owned()], false).unwrap();
        Rule { hosts, reach: Reach::All, origins: vec![HeaderValue::from_static("https://pages.example")] }
    }

    #[test]
    fn a_request_names_one_host() {
        for rule in [open(), Rule { reach: Reach::Nothing, ..open() }] {
            assert_eq!(status(&rule, Method::GET, "/", &[]), Some(400));
            let two = [("host", "localhost"), ("host", "evil.example")];
            assert_eq!(status(&rule, Method::GET, "/", &two), Some(400));
        }
    }

    #[test]
    fn another_host_is_refused_only_where_no_token_is_asked_for() {
        let evil = [("host", "evil.example:8080"), ("origin", "http://evil.example:8080")];
        assert_eq!(status(&open(), Method::GET, "/", &evil), Some(421));
        let guarded = Rule { reach: Reach::Nothing, ..open() };
        assert_eq!(status(&guarded, Method::GET, "/", &evil), None);
        let target = "http://evil.example/v1/maps";
        assert_eq!(status(&open(), Method::GET, target, &[("host", "localhost")]), Some(421));
    }

    #[test]
    fn hosts_are_checked_wherever_metrics_are_open() {
        let tokens = Tokens::parse("0123456789abcdef").unwrap();
        let evil = [("host", "evil.example:8080")];
        for (access, all, metrics) in [
            (Access::default(), Some(421), Some(421)),
            (Access { open_metrics: true, ..Access::default() }, Some(421), Some(421)),
            (Access { tokens: tokens.clone(), open_metrics: true, ..Access::default() }, None, Some(421)),
            (Access { tokens, ..Access::default() }, None, None),
        ] {
            let rule = Rule::of(&access);
            assert_eq!(status(&rule, Method::GET, "/v1/maps", &evil), all, "{access:?}");
            assert_eq!(status(&rule, Method::GET, "/metrics?a=b", &evil), metrics, "{access:?}");
            assert_eq!(status(&rule, Method::GET, "/metrics", &[("host", "127.0.0.1:8080")]), None);
        }
    }

    #[test]
    fn pages_of_other_origins_change_nothing() {
        let host = ("host", "localhost:8080");
        let from = |origin| status(&open(), Method::POST, "/v1/maps", &[host, ("origin", origin)]);
        for own in ["http://localhost:8080", "https://maps.example.org", "https://pages.example"] {
            assert_eq!(from(own), None, "{own}");
        }
        for other in ["http://evil.example", "null", "http://localhost:9090", "http://127.0.0.1:8080", ""] {
            assert_eq!(from(other), Some(StatusCode::FORBIDDEN.as_u16()), "{other}");
        }
        let read = status(&open(), Method::GET, "/v1/maps", &[host, ("origin", "http://evil.example")]);
        assert_eq!(read, None, "the browser keeps the answer from the page");
    }
}
