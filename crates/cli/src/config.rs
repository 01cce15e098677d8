//! Settings of the service from a file: what stands neither in a flag nor in the environment is looked for there.

use std::{ffi::OsString, fs, path::Path};

use clap::{ArgMatches, Command, CommandFactory, FromArgMatches, parser::ValueSource};
use toml::{Table, Value};

use crate::{Arguments, failure::BadInput};

/// Flags that say what to do now, and not how the service is to be.
const NOT_IN_FILE: [&str; 2] = ["check", "config"];

/// Reads the command line, and for `serve` the file that `--config` names.
///
/// # Errors
/// clap's own, which knows its exit status, and settings of a file that cannot be.
pub(crate) fn parse(words: Vec<OsString>) -> anyhow::Result<Arguments> {
    let given = Arguments::command().try_get_matches_from(&words)?;
    let Some((words, path)) = with_file(&given, words)? else {
        return Ok(Arguments::from_arg_matches(&given)?);
    };
    let told = Arguments::command().try_get_matches_from(words);
    let told = told.map_err(|error| {
        let said = error.to_string();
        let first = said.lines().next().unwrap_or_default();
        BadInput(format!("{path}: {}", first.trim_start_matches("error: ")))
    })?;
    Ok(Arguments::from_arg_matches(&told)?)
}

/// The command line with the file's settings as flags, and the file; none without a file.
fn with_file(
    given: &ArgMatches,
    mut words: Vec<OsString>,
) -> anyhow::Result<Option<(Vec<OsString>, String)>> {
    let Some(("serve", given)) = given.subcommand() else { return Ok(None) };
    let Some(path) = given.get_one::<std::path::PathBuf>("config") else { return Ok(None) };
    let shown = path.display().to_string();
    let serve = Arguments::command().find_subcommand("serve").cloned().unwrap_or_default();
    for (key, value) in read(path)? {
        check_known(&serve, &shown, &key)?;
        let is_given =
            matches!(given.value_source(&key), Some(ValueSource::CommandLine | ValueSource::EnvVariable));
        if !is_given {
            words.extend(flags(&shown, &key, value)?);
        }
    }
    Ok(Some((words, shown)))
}

fn read(path: &Path) -> anyhow::Result<Table> {
    let shown = path.display();
    let text = fs::read_to_string(path).map_err(|error| BadInput(format!("{shown}: {error}")))?;
    let table = text.parse::<Table>();
    Ok(table
        .map_err(|error| BadInput(format!("{shown}: {}", error.to_string().trim().replace('\n', " "))))?)
}

fn check_known(serve: &Command, path: &str, key: &str) -> Result<(), BadInput> {
    let known: Vec<&str> = serve
        .get_arguments()
        .map(|argument| argument.get_id().as_str())
        .filter(|id| !NOT_IN_FILE.contains(id))
        .collect();
    if known.contains(&key) {
        return Ok(());
    }
    Err(BadInput(format!("{path}: there is no setting `{key}`; there are {}", known.join(", "))))
}

/// A setting as flags: a list is a flag for each, true the flag alone.
fn flags(path: &str, key: &str, value: Value) -> Result<Vec<OsString>, BadInput> {
    let flag = format!("--{}", key.replace('_', "-"));
    let one = |value: Value| match value {
        Value::String(text) => Ok(format!("{flag}={text}")),
        Value::Integer(number) => Ok(format!("{flag}={number}")),
        Value::Float(number) => Ok(format!("{flag}={number}")),
        other => {
            Err(BadInput(format!("{path}: {key} is a {}, but must be a number or a text", other.type_str())))
        }
    };
    let words = match value {
        Value::Boolean(true) => vec![flag],
        Value::Boolean(false) => Vec::new(),
        Value::Array(values) => values.into_iter().map(one).collect::<Result<_, _>>()?,
        value => vec![one(value)?],
    };
    Ok(words.into_iter().map(OsString::from).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(words: &[&str], file: &str) -> anyhow::Result<Vec<OsString>> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("joulepath.toml");
        fs::write(&path, file)?;
        let path = path.display().to_string();
        let words: Vec<OsString> =
            ["joulepath", "serve", "--config", &path].iter().chain(words).map(OsString::from).collect();
        let given = Arguments::command().try_get_matches_from(&words)?;
        let before = words.len();
        Ok(with_file(&given, words)?.map(|(words, _)| words[before..].to_vec()).unwrap_or_default())
    }

    #[test]
    fn a_file_says_what_flags_do_not() {
        let file = "bind = \"127.0.0.1:9000\"\nplan_time_s = 2.5\ninsecure_open = true\ncors_origin = [\"https://a.example\"]\n";
        let all = told(&[], file).unwrap();
        assert_eq!(all.len(), 4);
        assert!(all.contains(&"--bind=127.0.0.1:9000".into()) && all.contains(&"--insecure-open".into()));
        let rest = told(&["--bind", "127.0.0.1:1"], file).unwrap();
        assert_eq!(rest.len(), 3, "a flag stands above the file");
    }

    #[test]
    fn a_file_with_unknown_or_unusable_settings_is_refused_by_name() {
        let unknown = told(&[], "colour = 1").unwrap_err().to_string();
        assert!(unknown.contains("`colour`") && unknown.contains("plan_time_s"), "{unknown}");
        let table = told(&[], "[bind]\nx = 1").unwrap_err().to_string();
        assert!(table.contains("bind is a table"), "{table}");
        let broken = told(&[], "bind = ").unwrap_err().to_string();
        assert!(broken.contains("joulepath.toml") && broken.lines().count() == 1, "{broken}");
    }
}
