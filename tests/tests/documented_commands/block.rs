//! Code blocks of a Markdown page, in the order in which they stand.

use std::ops::Range;

use pulldown_cmark::{CodeBlockKind, Event, Parser, Tag, TagEnd};

/// A fenced or indented block of a page.
#[derive(Debug)]
pub(crate) struct Block {
    /// First word of the info string, as `console`; empty for an indented block.
    pub language: String,
    /// The file that the block is written to before later commands run: `file=` of the info string.
    pub file: Option<String>,
    /// What the block needs that tests do not have: `needs=` of the info string.
    pub needs: Option<String>,
    /// What stands in the block.
    pub text: String,
    /// Bytes of the page that hold `text`.
    pub range: Range<usize>,
    /// Line of the page on which `text` begins, from 1.
    pub line: usize,
}

/// A command and what it prints.
#[derive(Debug, PartialEq)]
pub(crate) struct Step {
    /// The command without its prompt, lines of continuation included.
    pub command: String,
    /// The output as documented.
    pub output: String,
}

/// All code blocks of a page.
pub(crate) fn blocks(page: &str) -> Vec<Block> {
    let mut found = Vec::new();
    let mut open: Option<(String, Option<Range<usize>>)> = None;
    for (event, range) in Parser::new_ext(page, pulldown_cmark::Options::ENABLE_TABLES).into_offset_iter() {
        match event {
            Event::Start(Tag::CodeBlock(kind)) => {
                let info = match kind {
                    CodeBlockKind::Fenced(info) => info.to_string(),
                    CodeBlockKind::Indented => String::new(),
                };
                open = Some((info, None));
            }
            Event::Text(_) => {
                if let Some((_, held)) = &mut open {
                    *held = Some(held.as_ref().map_or(range.start, |held| held.start)..range.end);
                }
            }
            Event::End(TagEnd::CodeBlock) => {
                if let Some((info, held)) = open.take() {
                    found.push(block(page, &info, held.unwrap_or(range.end..range.end)));
                }
            }
            _ => {}
        }
    }
    found
}

fn block(page: &str, info: &str, range: Range<usize>) -> Block {
    let word = |key: &str| info.split_whitespace().find_map(|word| word.strip_prefix(key)).map(str::to_owned);
    Block {
        language: info.split_whitespace().next().unwrap_or_default().to_owned(),
        file: word("file="),
        needs: word("needs="),
        text: page[range.clone()].to_owned(),
        line: page[..range.start].matches('\n').count() + 1,
        range,
    }
}

/// Commands of a console block: lines behind `$ `, continued behind `\` and behind `> `; all else is output.
pub(crate) fn steps(text: &str) -> Vec<Step> {
    let mut found: Vec<Step> = Vec::new();
    let mut continued = false;
    for line in text.lines() {
        if let Some(command) = line.strip_prefix("$ ") {
            found.push(Step { command: command.to_owned(), output: String::new() });
        } else if let Some(last) = found.last_mut() {
            let more = line.strip_prefix("> ").filter(|_| last.output.is_empty());
            if continued || more.is_some() {
                last.command += "\n";
                last.command += more.unwrap_or(line);
            } else {
                last.output += line;
                last.output += "\n";
            }
        }
        continued = found.last().is_some_and(|last| last.output.is_empty() && last.command.ends_with('\\'));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_has_its_language_its_file_its_needs_and_its_place() {
        let page = "# A\n\n```json file=a.json\n{}\n```\n\n```console needs=docker\n$ docker run\n```\n";
        let found = blocks(page);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].language.as_str(), found[0].file.as_deref()), ("json", Some("a.json")));
        assert_eq!((found[0].text.as_str(), found[0].line), ("{}\n", 4));
        assert_eq!(found[1].needs.as_deref(), Some("docker"));
        assert_eq!(&page[found[1].range.clone()], "$ docker run\n");
    }

    #[test]
    fn commands_go_on_behind_a_backslash_and_behind_a_prompt() {
        let found = steps("$ a \\\n    b\nout\n$ cat <<'E'\n> x\n> E\n$ c\n");
        let step = |command: &str, output: &str| Step { command: command.into(), output: output.into() };
        assert_eq!(found, [step("a \\\n    b", "out\n"), step("cat <<'E'\nx\nE", ""), step("c", "")]);
    }
}
