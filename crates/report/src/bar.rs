//! Horizontal bars with their values as text.

use maud::{Markup, html};

/// One bar.
pub(crate) struct Bar<'a> {
    /// What it is of.
    pub(crate) label: &'a str,
    /// Its length, as a share of the longest there can be.
    pub(crate) share: f64,
    /// Its value as text.
    pub(crate) value: &'a str,
    /// What stands behind the value, such as odds; may be empty.
    pub(crate) note: &'a str,
    /// Class of its colour, in the style sheet.
    pub(crate) class: &'a str,
}

/// Bars under one another. Each is a meter with a name and a value for who does not see it.
pub(crate) fn bars(all: &[Bar<'_>]) -> Markup {
    html! {
        div.bars {
            @for bar in all {
                @let percent = format!("{:.1}", 100.0 * bar.share.clamp(0.0, 1.0));
                @let text = [bar.value, bar.note].join(" ");
                div.bar {
                    span.bar-label { (bar.label) }
                    span.bar-track role="meter" aria-label=(bar.label) aria-valuemin="0" aria-valuemax="100"
                        aria-valuenow=(percent) aria-valuetext=(text.trim()) {
                        span class=(bar.class) style={ "width:" (percent) "%" } {}
                    }
                    span.bar-value { b { (bar.value) } @if !bar.note.is_empty() { " " small { (bar.note) } } }
                }
            }
        }
    }
}
