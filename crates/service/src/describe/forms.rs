//! Forms of requests and answers that utoipa cannot derive.

use utoipa::openapi::{
    Content, KnownFormat, RefOr, SchemaFormat,
    path::Operation,
    schema::{ObjectBuilder, Type},
};

use super::examples;

/// Describes the answers whose route says only their status.
pub(super) fn describe_answers(operation: &mut Operation) {
    for (status, response) in &mut operation.responses.responses {
        let RefOr::T(response) = response else { continue };
        if response.description.is_empty() {
            usual(status).clone_into(&mut response.description);
        }
        for (media_type, content) in &mut response.content {
            let is_text = media_type.starts_with("text/")
                || ["json", "xml", "openmetrics-text"].iter().any(|end| media_type.ends_with(end));
            if !is_text {
                as_bytes(content);
            }
        }
    }
}

/// What a status means where nothing more can be said.
fn usual(status: &str) -> &'static str {
    match status {
        "400" => "The request cannot be read, or contradicts itself; `errors` names the fields",
        "404" => "Nothing has this id",
        "413" => "The request is larger than the service takes",
        "415" => "The content type is none of those listed",
        "507" => "The store is full",
        _ => "",
    }
}

/// Gives the body of a request its example. Whatever is neither JSON nor a form of several parts is sent as a file is.
pub(super) fn describe_body(operation: &mut Operation, operation_id: &str) {
    let Some(RefOr::T(body)) = &mut operation.request_body else { return };
    for (media_type, content) in &mut body.content {
        if !media_type.ends_with("json") && media_type != "multipart/form-data" {
            as_bytes(content);
        }
        let RefOr::T(content) = content else { continue };
        content.example = examples::body(operation_id, media_type);
    }
}

/// Bytes, which would be described as an array of numbers.
fn as_bytes(content: &mut RefOr<Content>) {
    let RefOr::T(content) = content else { return };
    let bytes = ObjectBuilder::new()
        .schema_type(Type::String)
        .format(Some(SchemaFormat::KnownFormat(KnownFormat::Binary)));
    content.schema = Some(bytes.into());
}
