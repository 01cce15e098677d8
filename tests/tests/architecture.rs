//! The arrows between the crates point one way, and what must be absent is absent.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use cargo_metadata::{DependencyKind, MetadataCommand};
use joulepath_tests::file;

/// Direct dependencies of each crate on others of the workspace, tests and examples aside.
fn arrows() -> BTreeMap<String, Vec<String>> {
    let metadata = MetadataCommand::new().manifest_path(file("Cargo.toml")).no_deps().exec().unwrap();
    let names: Vec<String> = metadata.packages.iter().map(|p| p.name.to_string()).collect();
    metadata
        .packages
        .iter()
        .map(|package| {
            let needs = package.dependencies.iter().filter(|d| d.kind == DependencyKind::Normal);
            let inside = needs.map(|d| d.name.clone()).filter(|name| names.contains(name)).collect();
            (package.name.to_string(), inside)
        })
        .collect()
}

#[test]
fn arrows_only_point_up_the_list_of_crates() {
    let order = [
        "joulepath-document",
        "joulepath-model",
        "joulepath-terrain",
        "joulepath-world",
        "joulepath-planner",
        "joulepath-routing",
        "joulepath-mission",
        "joulepath-bench",
        "joulepath-recording",
        "joulepath-calibration",
        "joulepath-diagnosis",
        "joulepath-prove",
        "joulepath-report",
        "joulepath-service",
        "joulepath",
        "joulepath-python",
    ];
    for (package, needs) in arrows() {
        if package == "joulepath-tests" {
            assert!(needs.is_empty(), "the black-box tests know no crate: {needs:?}");
            continue;
        }
        let rank = |name: &str| order.iter().position(|o| *o == name).unwrap();
        for need in needs {
            assert!(rank(&need) < rank(&package), "{package} must not need {need}");
        }
    }
}

#[test]
fn the_model_the_terrain_and_the_recording_know_nothing_of_each_other() {
    let arrows = arrows();
    for name in ["joulepath-model", "joulepath-terrain", "joulepath-recording"] {
        assert_eq!(arrows[name], ["joulepath-document"], "{name}");
    }
}

/// The world has to be seen through by what shares nothing with it but the ground.
#[test]
fn the_world_shares_only_the_ground_and_the_form_of_files_with_what_it_tests() {
    let metadata = MetadataCommand::new().manifest_path(file("Cargo.toml")).exec().unwrap();
    let resolve = metadata.resolve.as_ref().unwrap();
    let id = |name: &str| metadata.packages.iter().find(|p| p.name == name).unwrap().id.clone();
    let mut reached = vec![id("joulepath-world")];
    let mut next = 0;
    while next < reached.len() {
        let node = resolve.nodes.iter().find(|node| node.id == reached[next]).unwrap();
        let needs =
            node.deps.iter().filter(|dep| dep.dep_kinds.iter().any(|k| k.kind == DependencyKind::Normal));
        let new: Vec<_> = needs.map(|dep| dep.pkg.clone()).filter(|dep| !reached.contains(dep)).collect();
        reached.extend(new);
        next += 1;
    }
    let names = reached.iter().map(|id| metadata[id].name.to_string());
    let ours: Vec<String> = names.filter(|name| name.starts_with("joulepath")).collect();
    assert_eq!(ours, ["joulepath-world", "joulepath-document", "joulepath-terrain"]);
}

/// What judges the diagnosis must not be made of it.
#[test]
fn the_proof_knows_the_world_and_nothing_of_how_a_diagnosis_comes_about() {
    // Real drives are read, and their currents taken for forces, as everywhere.
    let read = ["joulepath-calibration", "joulepath-model", "joulepath-recording"];
    assert_eq!(arrows()["joulepath-prove"], [&read[..], &["joulepath-world"]].concat());
}

#[test]
fn nothing_below_the_service_is_async_or_speaks_http() {
    let metadata = MetadataCommand::new().manifest_path(file("Cargo.toml")).no_deps().exec().unwrap();
    for package in metadata.packages {
        let below = [
            "joulepath-document",
            "joulepath-model",
            "joulepath-terrain",
            "joulepath-world",
            "joulepath-planner",
            "joulepath-routing",
            "joulepath-mission",
            "joulepath-recording",
            "joulepath-calibration",
            "joulepath-diagnosis",
            "joulepath-prove",
            "joulepath-report",
            "joulepath-bench",
        ]
        .contains(&package.name.as_str());
        let banned = ["tokio", "axum", "hyper", "tower", "reqwest", "ureq"];
        let has = package.dependencies.iter().find(|d| banned.contains(&d.name.as_str()));
        assert!(!below || has.is_none(), "{} needs {:?}", package.name, has.map(|d| &d.name));
    }
}
