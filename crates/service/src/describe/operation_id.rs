//! Operation ids: the verb and noun of the path, as `createMap` or `plan`.

use axum::http::Method;

/// Returns the id of an operation. `is_collection` says that single members stand beneath the path, under their ids.
pub(super) fn operation_id(method: &Method, path: &str, is_collection: bool) -> String {
    let parts: Vec<&str> = path.split('/').filter(|part| !part.is_empty() && *part != "v1").collect();
    let is_action = *method == Method::POST && !is_collection;
    let verb = match *method {
        Method::POST if is_action => "",
        Method::POST => "create",
        Method::GET if is_collection => "list",
        Method::GET => "read",
        Method::PUT => "replace",
        Method::PATCH => "update",
        _ => "delete",
    };
    let noun: String = parts
        .iter()
        .enumerate()
        .filter(|(_, part)| !part.starts_with('{'))
        .map(|(i, part)| {
            let is_one = verb == "create" || parts.get(i + 1).is_some_and(|next| next.starts_with('{'));
            capitalized(if is_one { part.strip_suffix('s').unwrap_or(part) } else { part })
        })
        .collect();
    if is_action { noun.to_lowercase() } else { verb.to_owned() + &noun }
}

fn capitalized(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_the_verb_and_noun_of_the_path() {
        for (method, path, is_collection, id) in [
            (Method::POST, "/v1/plan", false, "plan"),
            (Method::POST, "/v1/maps", true, "createMap"),
            (Method::GET, "/v1/maps", true, "listMaps"),
            (Method::GET, "/v1/maps/{id}", false, "readMap"),
            (Method::PATCH, "/v1/maps/{id}", false, "updateMap"),
            (Method::DELETE, "/v1/maps/{id}", false, "deleteMap"),
            (Method::GET, "/v1/jobs/{id}/events", false, "readJobEvents"),
            (Method::GET, "/v1/status", false, "readStatus"),
            (Method::GET, "/healthz", false, "readHealthz"),
        ] {
            assert_eq!(operation_id(&method, path, is_collection), id);
        }
    }
}
