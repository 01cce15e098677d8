//! Where recorded and predicted power differ.

use diagnosis::{Diagnosis, Verdict, report::Place};
use maud::{Markup, html};

use super::path_map;
use crate::{document, figures::percent};

/// The section: parts of the drives with more than their share of the error, and the path.
pub(super) fn section(found: &Diagnosis) -> Markup {
    let map = path_map::path_map(found);
    if found.places.is_empty() && map.is_none() {
        return html! {};
    }
    let inside = html! {
        @if !found.places.is_empty() {
            ul { @for place in &found.places { (item(place)) } }
        } @else if found.verdict == Verdict::Consistent {
            p { "No part of the drives has an error beyond noise that recurs." }
        }
        @if let Some(map) = map { (map) }
    };
    document::section("Where they differ", &inside)
}

fn item(place: &Place) -> Markup {
    html! {
        li { (place.statement) " " span.quiet { "(" (percent(Some(place.share_of_excess))) " of the squared error beyond noise)" } }
    }
}
