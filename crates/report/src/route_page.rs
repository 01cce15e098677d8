//! Planned paths, reach or a mission, as a page.

use maud::{Markup, html};

use crate::document::{document, section};

/// What the page shows, as text that is ready to be read.
pub struct RoutePage<'a> {
    /// The answer in a few words.
    pub title: &'a str,
    /// What it holds for, a sentence each.
    pub about: &'a [String],
    /// Figures; the first row is the heading, and the first column names the rows.
    pub table: &'a [Vec<String>],
    /// The picture as a `data:` address.
    pub picture: &'a str,
    /// What is doubtful.
    pub warnings: &'a [String],
}

/// The page of planned paths: picture, figures, and what is doubtful.
pub fn route_page(page: &RoutePage<'_>) -> String {
    let doubts = html! { ul { @for warning in page.warnings { li { (warning) } } } };
    let body = html! {
        h1 { (page.title) }
        @for line in page.about { p { (line) } }
        figure { img src=(page.picture) alt=(page.title) style="width:100%;height:auto"; }
        div.wide role="region" aria-label="Figures" tabindex="0" { (table(page.table)) }
        @if !page.warnings.is_empty() { (section("Doubts", &doubts)) }
    };
    document(page.title, &body)
}

fn table(rows: &[Vec<String>]) -> Markup {
    let (head, rows) = rows.split_first().map_or((&[][..], rows), |(head, rows)| (&head[..], rows));
    html! {
        table.board.runs {
            thead { tr { @for cell in head { th { (cell) } } } }
            tbody {
                @for row in rows {
                    tr {
                        @for (i, cell) in row.iter().enumerate() {
                            @if i == 0 { th scope="row" { (cell) } } @else { td { (cell) } }
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_picture_figures_and_doubts_and_escapes_them() {
        let row = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
        let page = route_page(&RoutePage {
            title: "12 kJ <least>",
            about: &["On marble.".to_owned()],
            table: &[row(["", "energy"]), row(["path", "12 kJ"])],
            picture: "data:image/png;base64,AAAA",
            warnings: &["cells are coarse & few".to_owned()],
        });
        for part in [
            "<h1>12 kJ &lt;least&gt;</h1>",
            "<th scope=\"row\">path</th><td>12 kJ</td>",
            "src=\"data:image/png;base64,AAAA\"",
            "coarse &amp; few",
        ] {
            assert!(page.contains(part), "{part} is missing in\n{page}");
        }
    }
}
