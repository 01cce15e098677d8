//! Which forms a document may have, and how a mistake is worded.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use document::{Error, from_json, from_value, pointer};
use proptest::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Pose {
    x_m: f64,
    y_m: f64,
    heading_rad: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
enum Ground {
    Level,
    Rolling { grade: f64, seed: u64 },
    File(String),
}

#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Request {
    map: Option<Pose>,
    map_id: Option<String>,
    start: Pose,
    #[serde(default)]
    stops: Vec<Pose>,
    ground: Ground,
    #[serde(default)]
    constants: BTreeMap<String, f64>,
    #[serde(default)]
    origin_m: [f64; 2],
    #[serde(default)]
    count: u64,
}

fn read(text: &str) -> Result<Request, Error> {
    from_json(text.as_bytes())
}

fn said(value: &Value) -> String {
    read(&value.to_string()).unwrap_err().to_string()
}

fn good() -> Value {
    json!({"start": {"x_m": 1, "y_m": 2.5}, "ground": "level"})
}

fn with(field: &str, value: Value) -> Value {
    let mut document = good();
    document[field] = value;
    document
}

#[test]
fn every_form_of_a_type_is_read() {
    for (ground, expected) in [
        (json!("level"), Ground::Level),
        (json!({"rolling": {"grade": 0.1, "seed": 3}}), Ground::Rolling { grade: 0.1, seed: 3 }),
        (json!({"file": "map.json"}), Ground::File("map.json".into())),
    ] {
        assert_eq!(read(&with("ground", ground).to_string()).unwrap().ground, expected);
    }
    let request =
        read(&with("stops", json!([{"x_m": 1, "y_m": 2, "heading_rad": null}])).to_string()).unwrap();
    assert_eq!(request.stops, [Pose { x_m: 1.0, y_m: 2.0, heading_rad: None }]);
}

#[test]
fn a_struct_is_no_array_wherever_it_stands() {
    for (document, path) in [
        (with("start", json!([1, 2, null])), "start"),
        (with("stops", json!([{"x_m": 1, "y_m": 2}, [6.5, 6.5, null]])), "stops[1]"),
        (with("map", json!([1, 2, null])), "map"),
        (with("ground", json!({"rolling": [0.1, 3]})), "ground.rolling"),
    ] {
        let error = read(&document.to_string()).unwrap_err();
        assert_eq!(error.field(), Some(path));
        assert!(error.to_string().contains("but found an array"), "{error}");
    }
    assert!(said(&json!([null, null, [1, 2, null], [], "level"])).contains("expected an object"));
}

#[test]
fn a_name_is_no_object() {
    assert!(said(&with("ground", json!({"level": null}))).contains("a name as a string"));
    assert!(said(&with("ground", json!({"file": "a", "level": null}))).contains("several"));
    assert!(said(&with("ground", json!({}))).contains("empty object"));
    assert!(said(&with("ground", json!(["level"]))).contains("ground: expected a name, but found an array"));
}

#[test]
fn a_large_document_is_not_read_again_and_again_for_its_missing_fields() {
    let filler = "x".repeat(8 << 20);
    let error = read(&format!(r#"{{"start": {{}}, "map_id": "{filler}"}}"#)).unwrap_err();
    assert_eq!(error.mistakes().len(), 1, "{error}");
    let error = from_value::<Request>(&json!({ "start": {}, "map_id": filler })).unwrap_err();
    assert_eq!(error.mistakes().len(), 1, "{error}");
}

#[test]
fn all_missing_fields_are_reported_at_once() {
    let error = read("{}").unwrap_err();
    assert_eq!(error.to_string(), "missing fields `start`, `ground`");
    let error = read(r#"{"start": {}, "stops": [{"x_m": 1}]}"#).unwrap_err();
    assert_eq!(error.to_string(), "missing fields `start.x_m`, `start.y_m`, `stops[0].y_m`, `ground`");
    let pointers: Vec<&str> = error.mistakes().iter().map(|mistake| mistake.pointer.as_str()).collect();
    assert_eq!(pointers, ["/start/x_m", "/start/y_m", "/stops/0/y_m", "/ground"]);
    assert_eq!(
        read(r#"{"start": {"x_m": 1}, "ground": "level"}"#).unwrap_err().to_string(),
        "missing field `start.y_m`"
    );
}

#[test]
fn an_unknown_name_is_answered_with_the_nearest_known_one() {
    let said_of = said(&with("strat", json!({})));
    assert!(said_of.starts_with("strat: unknown field `strat`: did you mean `start`?"), "{said_of}");
    assert!(said(&with("ground", json!("levle"))).contains("did you mean `level`?"));
    let far = said(&with("qqq", json!(1)));
    assert!(!far.contains("did you mean") && far.contains("`map_id`"), "{far}");
}

#[test]
fn an_id_in_the_place_of_an_object_is_answered_with_the_field_for_ids() {
    let said = said(&with("map", json!("b1ae055d")));
    assert!(said.contains("map: expected an object") && said.contains("did you mean `map_id`?"), "{said}");
}

#[test]
fn values_of_another_type_are_named_in_terms_of_json() {
    for (document, expected) in [
        (with("count", json!(-1)), "count: expected a whole number of at least 0, but found -1"),
        (with("count", json!(1.5)), "count: expected a whole number of at least 0, but found 1.5"),
        (
            with("start", json!({"x_m": "1", "y_m": 2})),
            "start.x_m: expected a number, but found the string \"1\"",
        ),
        (with("stops", json!({})), "stops: expected an array, but found an object"),
        (
            with("stops", json!([null])),
            "stops[0]: expected an object with `x_m`, `y_m`, `heading_rad`, but found null",
        ),
        (with("map_id", json!(7)), "map_id: expected a string, but found 7"),
        (with("constants", json!([1])), "constants: expected an object, but found an array"),
        (with("origin_m", json!([1])), "origin_m: expected an array of length 2, but found 1 elements"),
    ] {
        let said = said(&document);
        assert!(said.starts_with(expected), "{said}");
        assert!(said.contains("(line 1, column "), "{said}");
    }
}

#[test]
fn a_name_given_twice_is_refused_in_structs_and_maps() {
    let text = r#"{"start": {"x_m": 1, "y_m": 2}, "ground": "level", "constants": {"a": 1, "a": 2}}"#;
    assert!(read(text).unwrap_err().to_string().contains("`a` is given twice"));
    let text = r#"{"start": {"x_m": 1, "x_m": 2, "y_m": 2}, "ground": "level"}"#;
    assert!(read(text).unwrap_err().to_string().contains("`x_m` is given twice"));
}

#[test]
fn broken_json_is_located_by_line_and_column() {
    for (text, expected) in [
        ("{\n \"count\": 1,\n}", "this is no valid JSON: trailing comma (line 3, column 1)"),
        ("", "the document is empty"),
        (" \n", "the document is empty"),
        ("{\"count\": 01}", "this is no valid JSON: invalid number (line 1, column 12)"),
        ("{\"count\": 1e999, \"start\": 2}", "count: the number is too large to be represented (line 1, "),
        ("{\"start\"", "this is no valid JSON: EOF while parsing an object"),
        ("\u{feff}{}", "missing fields `start`, `ground`"),
    ] {
        let said = read(text).unwrap_err().to_string();
        assert!(said.starts_with(expected), "{text}: {said}");
    }
    let trailing = format!("{}]", good());
    assert!(read(&trailing).unwrap_err().to_string().contains("trailing characters"));
}

#[test]
fn no_message_shows_an_empty_place() {
    for text in ["", "{}", "[", "{,}", "7", "null", "[]", "{\"\": 1}", "{\"start\": {\"\": 1}}"] {
        let said = read(text).unwrap_err().to_string();
        assert!(!said.contains(".:") && !said.contains("?:") && !said.starts_with(':'), "{text}: {said}");
    }
}

#[test]
fn a_parsed_document_is_read_like_a_text() {
    assert_eq!(from_value::<Request>(&good()).unwrap(), read(&good().to_string()).unwrap());
    let error = from_value::<Request>(&with("start", json!([1, 2, null]))).unwrap_err().to_string();
    assert_eq!(error, "start: expected an object with `x_m`, `y_m`, `heading_rad`, but found an array");
}

#[test]
fn pointers_escape_what_rfc_6901_says() {
    assert_eq!(pointer("wet/clay~1"), "/wet~1clay~01");
}

/// Any JSON up to a depth.
fn any_json() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        "[a-z_]{0,9}".prop_map(Value::from),
    ];
    leaf.prop_recursive(3, 24, 4, |inner| {
        let names = prop_oneof![
            Just("start".to_owned()),
            Just("ground".into()),
            Just("x_m".into()),
            Just("y_m".into()),
            Just("stops".into()),
            Just("map".into()),
            "[a-z]{1,4}"
        ];
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..4).prop_map(Value::from),
            prop::collection::btree_map(names, inner, 0..5)
                .prop_map(|map| Value::Object(map.into_iter().collect())),
        ]
    })
}

proptest! {
    /// What plain serde refuses is refused; what is accepted here is the same value there.
    #[test]
    fn what_is_accepted_is_what_serde_reads(document in any_json()) {
        let plain = serde_json::from_value::<Request>(document.clone());
        if let Ok(value) = read(&document.to_string()) {
            prop_assert_eq!(value, plain.unwrap());
        }
    }

    /// What is written is read again.
    #[test]
    fn what_is_written_is_read(x_m in -1e6..1e6f64, count in 0u64..1 << 53, grade in 0.0..1.0f64) {
        let request = Request {
            map: None,
            map_id: Some("id".into()),
            start: Pose { x_m, ..Pose::default() },
            stops: vec![Pose { y_m: grade, heading_rad: Some(x_m), ..Pose::default() }],
            ground: Ground::Rolling { grade, seed: count },
            constants: BTreeMap::from([("k".into(), x_m)]),
            origin_m: [x_m, grade],
            count,
        };
        prop_assert_eq!(read(&serde_json::to_string(&request).unwrap()).unwrap(), request);
    }
}

#[test]
fn words_of_other_programs_for_no_number_are_named_with_their_place_and_the_mend() {
    for word in ["NaN", "Infinity", "-Infinity", "nan", "-inf", "None"] {
        for text in [
            format!("{{\"start\": {{\"x_m\": 1.5,\n \"y_m\": {word}}}}}"),
            format!("{{\"start\": {{\"x_m\": 1.5,\n \"y_m\":{word},\"heading_rad\": 0}}}}"),
        ] {
            let error = from_json::<Request>(text.as_bytes()).unwrap_err();
            let said = error.to_string();
            assert!(said.contains(&format!("{word} is no JSON: write null")), "{text}: {said}");
            assert!(said.contains("line 2") && said.starts_with("start.y_m"), "{text}: {said}");
            assert_eq!(error.mistakes()[0].pointer, "/start/y_m");
        }
    }
    let other = from_json::<Request>(b"{\"start\": oops}").unwrap_err().to_string();
    assert!(other.contains("no valid JSON"), "{other}");
}
