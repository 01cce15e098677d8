//! A diagnosis as one page that a robotics engineer understands in a minute.

mod errors;
mod excitation;
mod explanations;
mod file_error;
mod findings;
mod path_map;
mod places;
mod power_chart;
mod shaded;

use diagnosis::{Diagnosis, Verdict};
use maud::{Markup, html};

use crate::document::{document, section, with_code};

/// The page of a diagnosis of a robot: verdict, error of the robot file, explanations with their probabilities, findings, errors
/// before and after, places, next drive, detectable sizes, notes.
pub fn diagnosis_page(found: &Diagnosis, robot: &str) -> String {
    let body = html! {
        (header(found, robot))
        (file_error::section(found))
        (explanations::section(found))
        (findings::section(found))
        (errors::section(found))
        (places::section(found))
        @if let Some(next) = &found.next_drive {
            (section("Next drive", &html! { p { "To decide, " (with_code(next)) "." } }))
        }
        (excitation::section(found))
        @if !found.notes.is_empty() {
            (section("Notes", &html! { ul { @for note in &found.notes { li { (with_code(note)) } } } }))
        }
    };
    document(&format!("{robot}: {}", found.verdict), &body)
}

fn header(found: &Diagnosis, robot: &str) -> Markup {
    let drives = found.trace.runs.len();
    let minutes = found.trace.t_s.len() as f64 / 60.0;
    html! {
        header {
            p class={ "verdict " (found.verdict) } { (found.verdict) }
            h1 { (found.sentence) }
            p.quiet {
                (meaning(found.verdict)) " " (robot) ": " (drives) @if drives == 1 { " drive" } @else { " drives" }
                ", " (format!("{minutes:.0}")) " minutes compared with the model."
            }
        }
    }
}

/// What a verdict means, in a sentence.
fn meaning(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Consistent => "The model describes these drives.",
        Verdict::Explained => "The missing effect is identified.",
        Verdict::Ambiguous => "These drives cannot distinguish a few explanations.",
        Verdict::Unexplained => "The list of mechanisms does not settle what is missing.",
    }
}

#[cfg(test)]
mod example;

#[cfg(test)]
mod tests {
    use super::{example, *};

    /// Asserts that headings come in this order, and no others.
    fn assert_headings(page: &str, expected: &[&str]) {
        let found: Vec<&str> =
            page.split("<h2>").skip(1).filter_map(|rest| rest.split("</h2>").next()).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn the_files_error_stands_first_and_the_posterior_before_the_findings() {
        let page = diagnosis_page(&example::explained(), "husky");
        assert_headings(
            &page,
            &[
                "Error of the robot file",
                "Explanations",
                "Findings",
                "Errors before and after",
                "Where they differ",
                "Next drive",
                "Sensitivity of these drives",
                "Notes",
            ],
        );
        assert!(!page.contains("<script") && !page.contains("http"), "{page}");
    }

    #[test]
    fn what_a_diagnosis_does_not_have_is_not_shown() {
        let mut found = example::explained();
        (found.file, found.probability, found.explanations) = (None, None, Vec::new());
        (found.findings, found.places, found.detectable) = (Vec::new(), Vec::new(), Vec::new());
        (found.not_judged, found.notes, found.next_drive) = (Vec::new(), Vec::new(), None);
        found.trace = diagnosis::report::Trace::default();
        let page = diagnosis_page(&found, "<husky>");
        assert_headings(&page, &["Error of the robot file", "Errors before and after"]);
        assert!(page.contains("&lt;husky&gt;") && !page.contains("NaN") && !page.contains("inf"), "{page}");
    }
}
