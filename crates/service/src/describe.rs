//! The part of the description that holds for all paths: ids, examples, and what the layers add to every answer.

mod examples;
mod forms;
mod operation_id;

use std::collections::HashSet;

use axum::http::Method;
use utoipa::openapi::{
    Content, Header, OpenApi, Ref, RefOr, Required, Response,
    header::HeaderBuilder,
    path::{Operation, ParameterBuilder, ParameterIn},
    response::ResponseBuilder,
    schema::{Object, Type},
    security::{HttpAuthScheme, HttpBuilder, SecurityRequirement, SecurityScheme},
};

use self::{
    forms::{describe_answers, describe_body},
    operation_id::operation_id,
};
use crate::layers::is_tagged;

/// Name of the security scheme.
const TOKEN: &str = "token";

/// Adds to each operation its id, its examples, what its layers may answer, and the headers that they read and write.
pub(crate) fn with_layers(mut description: OpenApi, wants_token: impl Fn(&str) -> bool) -> OpenApi {
    let mut any_token = false;
    let all: HashSet<String> = description.paths.paths.keys().cloned().collect();
    for (path, item) in &mut description.paths.paths {
        let operations = [
            (Method::GET, &mut item.get),
            (Method::POST, &mut item.post),
            (Method::PATCH, &mut item.patch),
            (Method::DELETE, &mut item.delete),
        ];
        for (method, operation) in operations {
            let Some(operation) = operation else { continue };
            let secured = wants_token(path);
            any_token |= secured;
            describe(operation, &method, secured, is_tagged(path));
            name(operation, operation_id(&method, path, all.contains(&format!("{path}/{{id}}"))));
        }
    }
    if any_token {
        let scheme = HttpBuilder::new().scheme(HttpAuthScheme::Bearer).build();
        description
            .components
            .get_or_insert_default()
            .add_security_scheme(TOKEN, SecurityScheme::Http(scheme));
    }
    description
}

/// Gives an operation its id and its examples.
fn name(operation: &mut Operation, id: String) {
    describe_answers(operation);
    describe_body(operation, &id);
    for parameter in operation.parameters.iter_mut().flatten() {
        if let RefOr::T(parameter) = parameter {
            let example = examples::parameter(&id, &parameter.name);
            *parameter = ParameterBuilder::from(parameter.clone()).example(example).build();
        }
    }
    operation.operation_id = Some(id);
}

fn describe(operation: &mut Operation, method: &Method, secured: bool, tagged: bool) {
    let has_content = operation.responses.responses.iter().any(|(status, response)| {
        status.starts_with('2') && matches!(response, RefOr::T(response) if !response.content.is_empty())
    });
    if has_content {
        add(operation, "406", "`Accept` asks for none of the forms of the answer");
    }
    if secured {
        add(operation, "401", "The token is missing or wrong");
        operation.security = Some(vec![SecurityRequirement::new(TOKEN, [] as [String; 0])]);
    }
    if *method != Method::GET {
        add(operation, "403", "A page of another origin asks");
    }
    if operation.request_body.is_some() {
        add(operation, "408", "The body came too slowly");
        add_header(
            operation,
            "x-request-id",
            "An id for the request, which the answer and the log repeat. Default: a new one",
        );
    }
    add(operation, "400", "The request has no `Host` field, or two");
    add(operation, "421", "`Host` names another than this service, which asks for no token");
    add(operation, "500", "A fault of the service");
    add(operation, "503", "Too much to do; `Retry-After` says when to try again");
    let tagged = tagged && *method == Method::GET;
    if tagged {
        add_condition(operation);
    }
    for response in operation.responses.responses.values_mut() {
        let RefOr::T(response) = response else { continue };
        response
            .headers
            .insert("x-request-id".into(), header("The id that the request came with, or was given"));
    }
    let mut also =
        vec![("503", "retry-after", "When to try again [s]"), ("401", "www-authenticate", "`Bearer`")];
    if tagged {
        also.extend(["200", "304"].map(|status| (status, "etag", "Tag of the answer, for `If-None-Match`")));
    }
    for (status, name, what) in also {
        if let Some(RefOr::T(response)) = operation.responses.responses.get_mut(status) {
            response.headers.insert(name.into(), header(what));
        }
    }
}

/// Adds how a client asks for what it has not got yet.
fn add_condition(operation: &mut Operation) {
    add_header(operation, "if-none-match", "Tags of answers that the client has");
    let unchanged = ResponseBuilder::new().description("The client has the answer already").build();
    operation.responses.responses.insert("304".into(), RefOr::T(unchanged));
}

/// Adds a header that a request may have.
fn add_header(operation: &mut Operation, name: &str, description: &str) {
    let parameter = ParameterBuilder::new()
        .name(name)
        .parameter_in(ParameterIn::Header)
        .required(Required::False)
        .description(Some(description))
        .schema(Some(text()))
        .build();
    operation.parameters.get_or_insert_default().push(RefOr::T(parameter));
}

/// Adds a failure, unless the operation tells of it itself.
fn add(operation: &mut Operation, status: &str, description: &str) {
    let problem: Response = ResponseBuilder::new()
        .description(description)
        .content("application/problem+json", Content::new(Some(Ref::from_schema_name("Problem"))))
        .build();
    operation.responses.responses.entry(status.to_owned()).or_insert(RefOr::T(problem));
}

fn header(description: &str) -> RefOr<Header> {
    RefOr::T(HeaderBuilder::new().schema(Some(text())).description(Some(description)).build())
}

fn text() -> Object {
    Object::with_type(Type::String)
}
