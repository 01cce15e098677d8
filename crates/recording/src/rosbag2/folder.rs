//! A folder of `ros2 bag record`: its storage files, read in the order of time as one recording.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{
    metadata,
    storage::{self, first_ns},
};
use crate::{Error, Map, Repair, Watch, container, reading::Reading, topic::Topics, watch::Budget};

const METADATA: &str = "metadata.yaml";

/// Longest metadata that is read \[bytes\]: a thousand topics take 300 kB.
const LONGEST_METADATA_BYTES: u64 = 16 << 20;

/// Endings of storage files.
const STORAGE: [&str; 2] = ["mcap", "db3"];

/// Endings of compressed storage files.
const COMPRESSED: [&str; 2] = ["zstd", "zst"];

/// Reads all storage files of a folder.
pub(crate) fn read(
    folder: &Path,
    name: &str,
    map: Option<&Map>,
    watch: &Watch,
    budget: &Budget,
) -> Result<Reading, Error> {
    let mut topics = container::topics(map, budget)?;
    let format = read_into(folder, &mut topics, watch)?;
    topics.finish(name, format)
}

/// Reads all storage files of a folder into the topics of a recording; returns their format.
pub(crate) fn read_into(
    folder: &Path,
    topics: &mut Topics<'_>,
    watch: &Watch,
) -> Result<&'static str, Error> {
    let mut format = "";
    let several = |files: &[PathBuf]| files.len() > 1;
    let files = in_order_of_time(files(folder, &mut topics.repairs)?, topics);
    for file in &files {
        let short = short_name(file);
        topics.begin_file(several(&files).then(|| short.clone()));
        format = storage::read_into(file, topics, watch).map_err(|error| match error {
            Error::Stopped => error,
            error => error.in_file(Path::new(&short)),
        })?;
    }
    Ok(format)
}

/// The files that `metadata.yaml` names, or where there is none, because the recorder was killed, all of them.
fn files(folder: &Path, repairs: &mut Vec<Repair>) -> Result<Vec<PathBuf>, Error> {
    let mut there: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if is_storage(&path) {
            there.push(path);
        }
    }
    there.sort_by_key(|path| natural(&short_name(path)));
    // What was unpacked beside its compressed form is there once.
    there.dedup_by(|packed, plain| is_same(&short_name(packed), &short_name(plain)));
    let mut tell = |place: &str, what: &str| repairs.push(Repair { place: place.into(), what: what.into() });
    there.retain(|path| {
        let holds = fs::metadata(path).is_ok_and(|data| data.len() > 0);
        if !holds {
            tell(&short_name(path), "it is empty; it was left out");
        }
        holds
    });
    let named = named(folder)?;
    if named.is_empty() {
        return match there.as_slice() {
            [] => Err(Error::NoStorage { found: listed(folder) }),
            [first, others @ ..] if others.iter().all(|other| whole_name(other) == whole_name(first)) => {
                Ok(there)
            }
            _ => Err(Error::NotOneRecording { found: listed(folder) }),
        };
    }
    let mut files = Vec::new();
    for name in &named {
        match there.iter().find(|path| is_same(&short_name(path), name)) {
            Some(path) if files.contains(path) => {}
            Some(path) => files.push(path.clone()),
            None => tell(METADATA, &format!("it names {name}, which is not in the folder; it was left out")),
        }
    }
    if files.is_empty() {
        return Err(Error::NoStorage { found: format!("{METADATA} names {}", named.join(", ")) });
    }
    for path in there.iter().filter(|path| !files.contains(path)) {
        tell(
            &short_name(path),
            "metadata.yaml does not name it; it was left out: name it for itself to read it",
        );
    }
    Ok(files)
}

fn named(folder: &Path) -> Result<Vec<String>, Error> {
    let path = folder.join(METADATA);
    let Ok(data) = fs::metadata(&path) else { return Ok(Vec::new()) };
    if data.len() > LONGEST_METADATA_BYTES {
        return Err(Error::TooLong { most: LONGEST_METADATA_BYTES }.in_file(Path::new(METADATA)));
    }
    Ok(metadata::file_names(&String::from_utf8_lossy(&fs::read(path)?)))
}

/// By when their first messages were written, where all tell, else as they come.
fn in_order_of_time(files: Vec<PathBuf>, topics: &mut Topics<'_>) -> Vec<PathBuf> {
    if files.len() < 2 {
        return files;
    }
    let begins: Option<Vec<i64>> = files.iter().map(|file| first_ns(file, topics)).collect();
    let Some(begins) = begins else { return files };
    let mut timed: Vec<(i64, PathBuf)> = begins.into_iter().zip(files).collect();
    timed.sort_by_key(|(begins_ns, _)| *begins_ns);
    timed.into_iter().map(|(_, file)| file).collect()
}

fn short_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// A name without the ending of a compression.
fn without_compression(name: &str) -> &str {
    match name.rsplit_once('.') {
        Some((plain, ending)) if COMPRESSED.contains(&ending) => plain,
        _ => name,
    }
}

/// The name of the recording that a file is a split of: `drive` of `drive_7.db3`.
fn whole_name(path: &Path) -> String {
    let name = short_name(path);
    let plain = without_compression(&name);
    let stem = plain.rsplit_once('.').map_or(plain, |(stem, _)| stem);
    match stem.rsplit_once('_') {
        Some((whole, number)) if number.bytes().all(|byte| byte.is_ascii_digit()) => whole.to_owned(),
        _ => stem.to_owned(),
    }
}

/// Whether a file is the one that was recorded under a name, unpacked or packed since.
fn is_same(found: &str, named: &str) -> bool {
    found == named || without_compression(found) == without_compression(named)
}

fn is_storage(path: &Path) -> bool {
    let name = short_name(path);
    let ending = without_compression(&name).rsplit_once('.').map(|(_, ending)| ending);
    ending.is_some_and(|ending| STORAGE.contains(&ending)) && !name.starts_with('.')
}

/// What sorts `drive_2` before `drive_10`.
fn natural(name: &str) -> Vec<(u64, String)> {
    let mut parts: Vec<(u64, String)> = Vec::new();
    for character in name.chars() {
        let digit = character.to_digit(10).map(u64::from);
        match (parts.last_mut(), digit) {
            (Some((number, text)), Some(digit)) if text.is_empty() => {
                *number = number.saturating_mul(10).saturating_add(digit);
            }
            (_, Some(digit)) => parts.push((digit, String::new())),
            (Some((_, text)), None) if !text.is_empty() => text.push(character),
            (_, None) => parts.push((0, character.to_string())),
        }
    }
    parts
}

fn listed(folder: &Path) -> String {
    const MOST: usize = 10;
    let mut names: Vec<String> =
        fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| short_name(&entry.path())).collect();
    names.sort();
    match names.len() {
        0 => "it is empty".into(),
        all if all > MOST => format!("it holds {} and {} more", names[..MOST].join(", "), all - MOST),
        _ => format!("it holds {}", names.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splits_follow_one_another_by_number() {
        let mut names = ["drive_10.db3", "drive_2.db3", "drive_1.db3", "a.db3"];
        names.sort_by_key(|name| natural(name));
        assert_eq!(names, ["a.db3", "drive_1.db3", "drive_2.db3", "drive_10.db3"]);
    }

    #[test]
    fn a_file_is_the_one_named_when_it_was_packed_or_unpacked_since() {
        assert!(is_same("a.mcap", "a.mcap.zstd") && is_same("a.db3.zstd", "a.db3"));
        assert!(!is_same("a.db3", "b.db3"));
        assert!(is_storage(Path::new("x/a.mcap.zstd")) && !is_storage(Path::new("x/metadata.yaml")));
    }
}
