//! The frame of every page.

use maud::{DOCTYPE, Markup, PreEscaped, html};

/// The style sheet of all pages.
const STYLE: &str = include_str!("page.css");

/// A complete HTML document.
pub(crate) fn document(title: &str, body: &Markup) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body { main { (body) } }
        }
    }
    .into_string()
        + "\n"
}

/// A section with its heading.
pub(crate) fn section(title: &str, inside: &Markup) -> Markup {
    html! {
        section aria-label=(title) {
            h2 { (title) }
            (inside)
        }
    }
}

/// Text in which names stand between backticks, as code.
pub(crate) fn with_code(text: &str) -> Markup {
    html! {
        @for (i, part) in text.split('`').enumerate() {
            @if i % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outside_text_is_escaped_and_names_are_code() {
        let page = document("<robot>", &with_code("`pitch_bias` & <b>"));
        assert!(page.contains("<title>&lt;robot&gt;</title>"), "{page}");
        assert!(page.contains("<code>pitch_bias</code> &amp; &lt;b&gt;"), "{page}");
    }
}
