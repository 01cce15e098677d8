//! Sentences of the README and the guide are short enough to be read once.

#![allow(clippy::unwrap_used)]

use std::fs;

use joulepath_tests::file;
use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};

/// Words of a sentence at most, as a colon or a semicolon ends one too.
const MOST_WORDS: usize = 25;

/// Running text of a page by paragraphs, without tables and code blocks. A name or a command is one word.
fn paragraphs(page: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut text = String::new();
    let mut skipped = 0;
    for event in Parser::new_ext(page, Options::ENABLE_TABLES) {
        match event {
            Event::Start(Tag::CodeBlock(_) | Tag::Table(_)) => skipped += 1,
            Event::End(TagEnd::CodeBlock | TagEnd::Table) => skipped -= 1,
            Event::Start(Tag::Paragraph | Tag::Item | Tag::List(_) | Tag::Heading { .. }) => {
                found.push(std::mem::take(&mut text));
            }
            Event::Text(part) if skipped == 0 => text += &part,
            Event::Code(_) if skipped == 0 => text += "code",
            Event::SoftBreak | Event::HardBreak => text += " ",
            _ => {}
        }
    }
    found.push(text);
    found
}

/// Sentences of a paragraph.
fn sentences(paragraph: &str) -> Vec<&str> {
    let ends = [". ", "? ", "! ", ": ", "; "];
    let mut found = vec![paragraph];
    for end in ends {
        found = found.into_iter().flat_map(|part| part.split(end)).collect();
    }
    found
}

fn words(sentence: &str) -> usize {
    sentence.split_whitespace().filter(|word| word.contains(char::is_alphanumeric)).count()
}

#[test]
fn no_sentence_has_more_than_25_words() {
    let mut pages = vec!["README.md".to_owned(), "CONTRIBUTING.md".to_owned(), "CHANGELOG.md".to_owned()];
    for entry in fs::read_dir(file("docs")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.ends_with(".md") {
            pages.push(format!("docs/{name}"));
        }
    }
    let mut long = Vec::new();
    for page in pages {
        let text = fs::read_to_string(file(&page)).unwrap();
        for paragraph in paragraphs(&text) {
            for sentence in sentences(&paragraph).into_iter().filter(|sentence| words(sentence) > MOST_WORDS)
            {
                long.push(format!("{page}: {} words: {}", words(sentence), sentence.trim()));
            }
        }
    }
    assert!(long.is_empty(), "{}\n{} long sentences", long.join("\n"), long.len());
}
