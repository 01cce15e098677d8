//! The guide of `docs/` as HTML pages: chapters in the order of `SUMMARY.md`, without scripts, so that the strictest content security
//! policy holds. `mdbook` reads the same folder, but its pages need scripts within them.

use std::{
    collections::{BTreeMap, HashMap},
    sync::LazyLock,
};

use maud::{DOCTYPE, Markup, PreEscaped, html};
use pulldown_cmark::{Alignment, CowStr, Event, Options, Parser, Tag, TagEnd};
use rust_embed::RustEmbed;

/// Chapters and pictures.
#[derive(RustEmbed)]
#[folder = "../../docs"]
struct Sources;

/// Name of the page with all chapters, on which a browser's own search finds everything.
const WHOLE: &str = "print.html";

/// The style sheet of all pages.
const STYLE: &str = include_str!("guide/guide.css");

/// A file of the guide.
#[derive(Debug)]
pub(crate) struct GuideFile {
    pub content_type: &'static str,
    pub bytes: Vec<u8>,
}

/// A chapter as `SUMMARY.md` lists it.
#[derive(Debug, Clone, PartialEq)]
struct Chapter {
    /// Name without an ending, as `first-plan`.
    name: String,
    title: String,
}

/// All files by name, rendered once.
static FILES: LazyLock<BTreeMap<String, GuideFile>> = LazyLock::new(files);

/// A file of the guide by its name, as `first-plan.html`; the empty name is the first page.
pub(crate) fn guide_file(name: &str) -> Option<&'static GuideFile> {
    FILES.get(if name.is_empty() { "index.html" } else { name })
}

fn files() -> BTreeMap<String, GuideFile> {
    let chapters = chapters(&source("SUMMARY.md"));
    let mut found = BTreeMap::new();
    let mut whole = String::new();
    for (i, chapter) in chapters.iter().enumerate() {
        let body = rendered(&source(&format!("{}.md", chapter.name)));
        let before = i.checked_sub(1).and_then(|i| chapters.get(i));
        let page = page(&chapters, Some(chapter), &beside(&body, before, chapters.get(i + 1)));
        found.insert(format!("{}.html", chapter.name), html_file(&page));
        whole += &body;
    }
    found.insert(WHOLE.into(), html_file(&page(&chapters, None, &PreEscaped(whole))));
    found.insert(
        "guide.css".into(),
        GuideFile { content_type: "text/css; charset=utf-8", bytes: STYLE.into() },
    );
    for name in Sources::iter() {
        let content_type = match name.rsplit('.').next() {
            Some("png") => "image/png",
            Some("svg") => "image/svg+xml",
            _ => continue,
        };
        if let Some(file) = Sources::get(&name) {
            found.insert(name.into_owned(), GuideFile { content_type, bytes: file.data.into_owned() });
        }
    }
    found
}

fn source(name: &str) -> String {
    Sources::get(name).map(|file| String::from_utf8_lossy(&file.data).into_owned()).unwrap_or_default()
}

fn html_file(page: &Markup) -> GuideFile {
    GuideFile { content_type: "text/html; charset=utf-8", bytes: page.0.clone().into_bytes() }
}

/// Chapters in the order of the links of a summary.
fn chapters(summary: &str) -> Vec<Chapter> {
    let mut found: Vec<Chapter> = Vec::new();
    let mut inside = false;
    for event in Parser::new(summary) {
        match event {
            Event::Start(Tag::Link { dest_url, .. }) => {
                let name = dest_url.trim_end_matches(".md").trim_start_matches("./").to_owned();
                found.push(Chapter {
                    name: if name == "README" { "index".into() } else { name },
                    title: String::new(),
                });
                inside = true;
            }
            Event::End(TagEnd::Link) => inside = false,
            Event::Text(text) | Event::Code(text) if inside => {
                if let Some(chapter) = found.last_mut() {
                    chapter.title += &text;
                }
            }
            _ => {}
        }
    }
    found
}

/// A chapter's Markdown as HTML: headings have the ids that `mdbook` gives them, and links lead to pages.
fn rendered(markdown: &str) -> String {
    let options = Options::ENABLE_TABLES | Options::ENABLE_FOOTNOTES | Options::ENABLE_STRIKETHROUGH;
    let mut events: Vec<Event<'_>> = Parser::new_ext(markdown, options).collect();
    let mut ids = HashMap::new();
    for i in 0..events.len() {
        let heading = match &events[i] {
            Event::Start(Tag::Heading { .. }) => Some(heading_id(&events[i + 1..], &mut ids)),
            _ => None,
        };
        match &mut events[i] {
            Event::Start(Tag::Heading { id, .. }) => *id = heading.map(CowStr::from),
            Event::Start(Tag::Link { dest_url, .. }) => *dest_url = page_link(dest_url).into(),
            // Aligned columns would be styles of their cells, which the policy forbids.
            Event::Start(Tag::Table(alignments)) => alignments.fill(Alignment::None),
            _ => {}
        }
    }
    let mut html = String::new();
    pulldown_cmark::html::push_html(&mut html, events.into_iter());
    html
}

/// The id of a heading whose text begins with these events: letters and digits in lower case, spaces as hyphens; the second of a name ends in `-1`.
fn heading_id(events: &[Event<'_>], ids: &mut HashMap<String, usize>) -> String {
    let mut id = String::new();
    for event in events.iter().take_while(|event| !matches!(event, Event::End(TagEnd::Heading(_)))) {
        if let Event::Text(text) | Event::Code(text) = event {
            id.extend(text.chars().filter_map(|c| match c {
                c if c.is_alphanumeric() || c == '_' || c == '-' => Some(c.to_ascii_lowercase()),
                c if c.is_whitespace() => Some('-'),
                _ => None,
            }));
        }
    }
    let seen = ids.entry(id.clone()).or_insert(0);
    *seen += 1;
    if *seen > 1 { format!("{id}-{}", *seen - 1) } else { id }
}

/// A link to a Markdown file of the guide as one to its page.
fn page_link(link: &str) -> String {
    let (file, place) = link.split_once('#').map_or((link, None), |(file, place)| (file, Some(place)));
    match file.strip_suffix(".md") {
        Some(name) if !file.contains("://") => {
            format!("{name}.html{}", place.map_or(String::new(), |place| format!("#{place}")))
        }
        _ => link.to_owned(),
    }
}

/// A chapter with links to those before and after it.
fn beside(body: &str, before: Option<&Chapter>, after: Option<&Chapter>) -> Markup {
    html! {
        (PreEscaped(body))
        nav class="beside" aria-label="Chapters before and after" {
            @if let Some(chapter) = before { a rel="prev" href={ (chapter.name) ".html" } { "← " (chapter.title) } }
            @if let Some(chapter) = after { a rel="next" href={ (chapter.name) ".html" } { (chapter.title) " →" } }
        }
    }
}

fn page(chapters: &[Chapter], here: Option<&Chapter>, body: &Markup) -> Markup {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (here.map_or("Whole guide", |here| &here.title)) " – joulepath" }
                link rel="stylesheet" href="guide.css";
            }
            body {
                nav class="chapters" aria-label="Chapters" {
                    p { a href="/" { "joulepath" } }
                    ol {
                        @for chapter in chapters {
                            li {
                                @let is_here = here == Some(chapter);
                                a href={ (chapter.name) ".html" } aria-current=[is_here.then_some("page")] { (chapter.title) }
                            }
                        }
                    }
                    p { a href=(WHOLE) { "All on one page" } " · " a href="/docs/" { "API reference" } }
                }
                main { (body) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chapters_are_those_of_the_summary_and_each_has_a_page() {
        let chapters = chapters(&source("SUMMARY.md"));
        assert!(chapters.len() >= 14, "{chapters:?}");
        for chapter in &chapters {
            let name = format!("{}.html", chapter.name);
            let page = guide_file(&name).unwrap_or_else(|| panic!("no {name}"));
            let text = String::from_utf8_lossy(&page.bytes);
            assert!(text.contains("<h1"), "{name}");
            assert!(!text.contains("<script") && !text.contains("style="), "{name}: forbidden by the policy");
        }
        assert!(guide_file("nowhere.html").is_none());
    }

    #[test]
    fn links_lead_to_pages_and_headings_have_ids() {
        let html = rendered("# A `b` c!\n\n## A b c\n\n[x](maps.md#on-earth) [y](https://a.org/b.md)\n");
        assert!(html.contains(r#"<h1 id="a-b-c">"#), "{html}");
        assert!(html.contains(r#"<h2 id="a-b-c-1">"#), "{html}");
        assert!(html.contains(r#"href="maps.html#on-earth""#), "{html}");
        assert!(html.contains(r#"href="https://a.org/b.md""#), "{html}");
    }
}
