//! `docs/diagnosis.md` says what the code does.

mod method;

#[test]
fn the_page_of_the_method_is_what_its_command_writes() {
    let page = std::fs::read_to_string(method::path()).unwrap();
    let expected = method::filled(&page).unwrap();
    assert!(page == expected, "write it anew: cargo run -p joulepath-diagnosis --example method");
}

#[test]
fn every_numeric_constant_has_a_comment() {
    let all = method::constants().unwrap();
    let without: Vec<&String> =
        all.iter().filter(|one| one.reason.is_empty()).map(|one| &one.values[0].0).collect();
    assert!(!all.is_empty() && without.is_empty(), "{without:?}");
}
