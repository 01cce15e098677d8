//! The page with its tables filled in.

use std::{
    collections::BTreeMap,
    error::Error,
    path::{Path, PathBuf},
};

use crate::method::{
    priors,
    source::{Constant, constants},
};

/// End of a table that is written by command.
const END: &str = "<!-- end -->";

/// Where the page lies.
pub(crate) fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/diagnosis.md")
}

/// A page whose tables are as the code has them. A table stands between `<!-- WHAT -->` and `<!-- end -->`, WHAT being `count`, `priors`,
/// `forms`, `shares`, `sources`, `sets`, or `constants` with the files, or `FILE:NAME`, whose constants it holds; `rest` are those of no
/// other table.
///
/// # Errors
/// An unknown table, and a constant that stands on the page twice or never.
pub(crate) fn filled(page: &str) -> Result<String, Box<dyn Error>> {
    let all = constants()?;
    let named: Vec<&str> = page.lines().filter_map(places).flatten().collect();
    let mut shown = BTreeMap::<String, usize>::new();
    let mut text = String::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        text += line;
        text.push('\n');
        let asked = line.strip_prefix("<!-- ").and_then(|rest| rest.strip_suffix(" -->"));
        let Some(asked) = asked else { continue };
        text.push('\n');
        text += &table(asked, &all, &named, &mut shown)?;
        text += &format!("\n{END}\n");
        lines.find(|line| *line == END).ok_or_else(|| format!("`{asked}` has no end"))?;
    }
    for constant in &all {
        let name = name(constant);
        match shown.get(&name) {
            Some(1) => {}
            Some(_) => return Err(format!("{name} stands on the page more than once").into()),
            None => return Err(format!("{name} does not stand on the page").into()),
        }
    }
    Ok(text)
}

/// Files and names of a line that asks for constants.
fn places(line: &str) -> Option<impl Iterator<Item = &str>> {
    Some(line.strip_prefix("<!-- constants ")?.strip_suffix(" -->")?.split(' '))
}

fn table(
    asked: &str,
    all: &[Constant],
    named: &[&str],
    shown: &mut BTreeMap<String, usize>,
) -> Result<String, Box<dyn Error>> {
    match asked {
        "count" => Ok(count(all)),
        "priors" => Ok(priors::sizes()?),
        "forms" => Ok(priors::forms()?),
        "shares" => Ok(priors::shares()?),
        "sources" => Ok(priors::sources()),
        "sets" => Ok(priors::sets(value(all, "MECHANISM_PRIOR")?, value(all, "UNLISTED_PRIOR")?)),
        _ => {
            let places = asked.strip_prefix("constants ").ok_or_else(|| format!("no table `{asked}`"))?;
            let mut text = String::from("| constant | value | reason |\n| --- | --- | --- |\n");
            for place in places.split(' ') {
                let is_of = |one: &Constant, place: &str| one.file == place || name(one) == place;
                let is_named = |one: &Constant| named.iter().any(|place| is_of(one, place));
                let is_own =
                    |one: &&Constant| if place == "rest" { !is_named(one) } else { is_of(one, place) };
                let own: Vec<&Constant> = all.iter().filter(is_own).collect();
                if own.is_empty() {
                    return Err(format!("no constants in `{place}`").into());
                }
                for constant in own {
                    *shown.entry(name(constant)).or_default() += 1;
                    text += &row(constant);
                }
            }
            Ok(text)
        }
    }
}

fn count(all: &[Constant]) -> String {
    let numbers: usize = all.iter().map(|one| one.values.len()).sum();
    let without = all.iter().filter(|one| one.reason.is_empty()).count();
    format!("{numbers} numeric constants under {} comments, {without} without one.\n", all.len())
}

/// The number that a constant is.
fn value(all: &[Constant], name: &str) -> Result<f64, Box<dyn Error>> {
    let mut values = all.iter().flat_map(|one| &one.values);
    let (_, value) = values.find(|(other, _)| other == name).ok_or_else(|| format!("no constant {name}"))?;
    Ok(value.parse()?)
}

/// A constant by its file and its first name.
fn name(constant: &Constant) -> String {
    format!("{}:{}", constant.file, constant.values[0].0)
}

fn row(constant: &Constant) -> String {
    let join = |cells: Vec<String>| cells.join("<br>");
    let names = join(constant.values.iter().map(|(name, _)| format!("`{name}`")).collect());
    let values = join(constant.values.iter().map(|(_, value)| value.clone()).collect());
    format!("| {names}, `{}` | {values} | {} |\n", constant.file, constant.reason)
}
