//! Numeric constants of this crate and doc comments of functions, read from the sources.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// A numeric constant, or several under one doc comment.
pub(crate) struct Constant {
    /// Path of its file below `crates/diagnosis/src`.
    pub(crate) file: String,
    /// Names and values, first to last.
    pub(crate) values: Vec<(String, String)>,
    /// Doc comment as Markdown; empty where there is none.
    pub(crate) reason: String,
}

/// Numeric constants of `crates/diagnosis/src` outside tests, file by file.
///
/// # Errors
/// A file that cannot be read.
pub(crate) fn constants() -> io::Result<Vec<Constant>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    collect(&root, &mut files)?;
    files.sort();
    let mut all = Vec::new();
    for file in files {
        let name = file.strip_prefix(&root).unwrap_or(&file).to_string_lossy().replace('\\', "/");
        all.extend(of_source(&name, &fs::read_to_string(&file)?));
    }
    Ok(all)
}

/// Doc comment above a function of a mechanism; empty where it has none.
///
/// # Errors
/// A mechanism without a file.
pub(crate) fn doc_of_mechanism(mechanism: &str, function: &str) -> io::Result<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../model/src/mechanism");
    let source = fs::read_to_string(root.join(mechanism).with_extension("rs"))?;
    let start = format!("fn {function}(");
    let mut doc = Vec::new();
    for line in source.lines().map(str::trim) {
        match line.strip_prefix("///") {
            Some(text) => doc.push(text.trim()),
            None if line.starts_with(&start) => return Ok(markdown(&doc)),
            None => doc.clear(),
        }
    }
    Ok(String::new())
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

/// Constants of one source up to its tests. One without a comment right behind another shares that one's.
fn of_source(file: &str, source: &str) -> Vec<Constant> {
    let mut all: Vec<Constant> = Vec::new();
    let mut doc = Vec::new();
    let mut follows = false;
    for line in source.lines().take_while(|line| *line != "#[cfg(test)]").map(str::trim) {
        if let Some(text) = line.strip_prefix("///") {
            doc.push(text.trim());
            follows = false;
            continue;
        }
        match (numeric(line), all.last_mut().filter(|_| follows && doc.is_empty())) {
            (Some(value), Some(before)) => before.values.push(value),
            (Some(value), None) => {
                let constant =
                    Constant { file: file.to_owned(), values: vec![value], reason: markdown(&doc) };
                all.push(constant);
            }
            (None, _) => {}
        }
        follows = numeric(line).is_some();
        doc.clear();
    }
    all
}

/// Name and value of a line that is a numeric constant.
fn numeric(line: &str) -> Option<(String, String)> {
    let line = line.strip_prefix("pub").map_or(line, |rest| rest.trim_start_matches("(crate)").trim_start());
    let (name, rest) = line.strip_prefix("const ")?.split_once(": ")?;
    let (kind, value) = rest.strip_suffix(';')?.split_once(" = ")?;
    let is_number = ["f64", "usize", "[f64; ", "[usize; "].iter().any(|start| kind.starts_with(start));
    is_number.then(|| (name.to_owned(), value.to_owned()))
}

/// A doc comment as the cell of a table.
fn markdown(lines: &[&str]) -> String {
    let text = lines.iter().copied().filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
    let plain = text.replace("\\[", "[").replace("\\]", "]").replace("[`", "`").replace("`]", "`");
    plain.replace('|', "\\|")
}
