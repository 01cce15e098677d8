//! The guide that the service shows is whole, needs nothing from elsewhere, and its links lead somewhere.

#![allow(clippy::unwrap_used)]

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
};

use joulepath_tests::{
    Server, file,
    published::{result, with_results},
};
use pulldown_cmark::{Event, Options, Parser, Tag};

/// Values of an attribute in a page.
fn attribute<'a>(page: &'a str, name: &str) -> Vec<&'a str> {
    let start = format!(" {name}=\"");
    page.split(&start).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

/// Links and pictures of a Markdown file.
fn targets(markdown: &str) -> Vec<String> {
    Parser::new_ext(markdown, Options::ENABLE_TABLES)
        .filter_map(|event| match event {
            Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                Some(dest_url.to_string())
            }
            _ => None,
        })
        .collect()
}

#[test]
fn every_link_of_the_guide_leads_to_a_page_and_a_place_on_it() {
    let server = Server::start();
    let mut pages: BTreeMap<String, String> = BTreeMap::new();
    let mut to_read = BTreeSet::from(["index.html".to_owned()]);
    while let Some(name) = to_read.pop_first() {
        let answer = server.get(&format!("/docs/guide/{name}"));
        assert_eq!(answer.status, 200, "{name}: {}", answer.text);
        let links = [attribute(&answer.text, "href"), attribute(&answer.text, "src")].concat();
        for link in links.iter().filter(|link| !link.contains("://") && !link.starts_with('/')) {
            let linked = link.split('#').next().unwrap_or_default();
            if linked.ends_with(".html") && !pages.contains_key(linked) {
                to_read.insert(linked.to_owned());
            } else if !linked.is_empty() {
                assert_eq!(server.get(&format!("/docs/guide/{linked}")).status, 200, "{name}: {link}");
            }
        }
        pages.insert(name, answer.text);
    }
    assert!(pages.len() >= 15, "{:?}", pages.keys());
    for (name, page) in &pages {
        for link in attribute(page, "href") {
            let Some((linked, place)) = link.split_once('#') else { continue };
            if linked.contains("://") {
                continue;
            }
            let linked = if linked.is_empty() { name } else { linked };
            let is_there = attribute(&pages[linked], "id").contains(&place);
            assert!(is_there, "{name}: nothing has the id of {link}");
        }
    }
}

#[test]
fn the_guide_runs_nothing_and_loads_nothing_from_elsewhere() {
    let server = Server::start();
    let page = server.get("/docs/guide/");
    let policy = page.header("content-security-policy");
    assert!(policy.starts_with("default-src 'none'; style-src 'self'; img-src 'self';"), "{policy}");
    assert!(!page.text.contains("<script") && !page.text.contains("style="), "{}", page.text);
    for source in attribute(&server.get("/docs/guide/print.html").text, "src") {
        assert!(!source.contains("//"), "{source}");
    }
    let tag = page.header("etag").to_owned();
    assert_eq!(server.ask("GET", "/docs/guide/", &[("if-none-match", &tag)], b"").status, 304);
    server.get("/docs/guide/nowhere.html").problem(404, "not-found");
    server.get("/docs/guide/../../Cargo.toml").problem(404, "not-found");
}

#[test]
fn links_of_the_repository_s_own_pages_lead_to_files() {
    for page in ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"] {
        for target in targets(&fs::read_to_string(file(page)).unwrap()) {
            let linked = target.split('#').next().unwrap_or_default();
            if !linked.is_empty() && !target.contains("://") {
                assert!(file(linked).exists(), "{page}: {target}");
            }
        }
    }
}

#[test]
fn every_page_of_the_folder_is_a_chapter() {
    let chapters = targets(&fs::read_to_string(file("docs/SUMMARY.md")).unwrap());
    for entry in fs::read_dir(file("docs")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.ends_with(".md") && name != "SUMMARY.md" {
            assert!(chapters.contains(&name), "docs/SUMMARY.md does not list {name}");
        }
    }
}

#[test]
fn every_figure_of_a_result_is_that_of_its_file() {
    let mut results = 0;
    for entry in fs::read_dir(file("docs")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "md") {
            let page = fs::read_to_string(&path).unwrap();
            results += page.matches("<!-- result ").count();
            assert_eq!(with_results(&page).unwrap(), page, "{}: run the example `publish`", path.display());
        }
    }
    assert!(results >= 3, "{results}");
}

#[test]
fn the_first_figure_of_the_readme_is_the_soberest_of_its_result() {
    let measured = result("savings").unwrap().output;
    let medians: Vec<f64> = measured
        .lines()
        .filter(|line| line.contains(" W "))
        .map(|line| line.split_whitespace().nth(3).unwrap().parse().unwrap())
        .collect();
    assert_eq!(medians.len(), 6, "{measured}");
    let least = medians.iter().copied().fold(f64::INFINITY, f64::min);
    let readme = fs::read_to_string(file("README.md")).unwrap();
    let first = readme.split(" saves ").nth(1).unwrap().split(" %").next().unwrap();
    assert_eq!(first.parse(), Ok(least), "{measured}");
}
