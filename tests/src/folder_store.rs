//! A look into a folder that services keep everything in, while none of them runs.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use sha2::{Digest, Sha256};

/// What is wrong with a folder: files that nobody asked for, data without a note of any tenant or the other way, and recordings
/// that are not what their ids say.
pub fn faults(folder: &Path) -> Vec<String> {
    let mut faults = Vec::new();
    let names: BTreeSet<String> =
        files(folder).iter().map(|path| path.display().to_string()).filter(|name| name != ".lock").collect();
    // Notes of `default` lie under their kind, those of others under their name.
    let noted: BTreeSet<&str> = names.iter().filter_map(|name| of_kind(name).strip_suffix(".json")).collect();
    for name in &names {
        match of_kind(name).rsplit_once('.') {
            Some((kept, "json")) if kept.starts_with("maps/") || kept.starts_with("recordings/") => {
                if !names.contains(&format!("{kept}.data")) {
                    faults.push(format!("{name} is without {kept}.data"));
                }
            }
            Some((kept, "data")) if noted.contains(kept) => {}
            Some((_, "data")) => faults.push(format!("{name} is without a note")),
            Some((_, "json")) => {}
            Some((_, lease)) if lease.starts_with("lease-") => {}
            _ => faults.push(format!("{name} is left over")),
        }
    }
    for name in names.iter().filter(|name| name.starts_with("recordings/") && name.ends_with(".data")) {
        let content = fs::read(folder.join(name)).unwrap_or_default();
        let hash: String = Sha256::digest(&content).iter().map(|byte| format!("{byte:02x}")).collect();
        if !name.contains(&hash[..32]) {
            faults.push(format!("{name} holds something else"));
        }
    }
    faults
}

/// A file's path from its kind on, without the tenant that owns it.
fn of_kind(name: &str) -> &str {
    let rest = name.strip_prefix("tenants/").and_then(|rest| rest.split_once('/'));
    rest.map_or(name, |(_, of_kind)| of_kind)
}

/// All files below a folder, by their paths in it.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(next) = open.pop() {
        for entry in fs::read_dir(next).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                open.push(path);
            } else if let Ok(name) = path.strip_prefix(folder) {
                found.push(name.to_owned());
            }
        }
    }
    found
}

/// Bytes of all files below a folder.
pub fn bytes(folder: &Path) -> u64 {
    files(folder).iter().filter_map(|name| fs::metadata(folder.join(name)).ok()).map(|file| file.len()).sum()
}
