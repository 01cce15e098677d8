//! What these drives would have shown, and what they cannot tell.

use diagnosis::{Diagnosis, Verdict};
use maud::{Markup, html};

use crate::{
    document,
    figures::quantity,
    labels::{capitalized, either, mechanism_label, parameter_label},
};

/// The section; nothing where neither is known. The table is open where nothing was found.
pub(super) fn section(found: &Diagnosis) -> Markup {
    if found.detectable.is_empty() && found.not_judged.is_empty() {
        return html! {};
    }
    let inside = html! {
        @if !found.detectable.is_empty() {
            details open[found.verdict == Verdict::Consistent] {
                summary { "Least size of each other mechanism that would have been noticed" }
                table.detectable {
                    thead { tr { th { "mechanism" } th { "parameter" } th { "least size" } } }
                    tbody {
                        @for size in &found.detectable {
                            tr {
                                th scope="row" { (capitalized(&mechanism_label(size.mechanism))) }
                                td { (parameter_label(size.parameter)) }
                                td.number { (quantity(size.value, size.unit)) }
                            }
                        }
                    }
                }
            }
        }
        @if !found.not_judged.is_empty() {
            p { "Not identifiable from these drives: " (either(&found.not_judged)) "." }
        }
    };
    document::section("Sensitivity of these drives", &inside)
}
