//! The `metadata.yaml` that stands beside the storage files of a recording.

/// Names of the storage files, in the order in which they were written.
///
/// Recorders write the list as a block of YAML, people and converters also within brackets:
///
/// ```yaml
/// rosbag2_bagfile_information:
///   relative_file_paths:
///     - drive_0.db3
///     - drive_1.db3
/// ```
pub(crate) fn file_names(text: &str) -> Vec<String> {
    let mut lines = text.lines().map(str::trim).skip_while(|line| !line.starts_with("relative_file_paths:"));
    let Some(first) = lines.next() else { return Vec::new() };
    let beside = first.trim_start_matches("relative_file_paths:").trim();
    if beside.starts_with('[') {
        let rest: String = std::iter::once(beside).chain(lines).collect();
        let inside = rest.trim_start_matches('[').split(']').next().unwrap_or_default().to_owned();
        return inside.split(',').filter_map(file_name).collect();
    }
    let entries = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    entries.map_while(|line| line.strip_prefix("- ")).filter_map(file_name).collect()
}

/// The file's name of an entry: all lie in the folder, whatever path the entry holds.
fn file_name(entry: &str) -> Option<String> {
    let plain = match entry.trim() {
        quoted if quoted.starts_with(['"', '\'']) => quoted.trim_matches(['"', '\'']),
        entry => entry.split(" #").next().unwrap_or(entry).trim_end(),
    };
    let name = plain.rsplit('/').next().unwrap_or(plain);
    (!name.is_empty() && name != "." && name != "..").then(|| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_in_blocks_and_brackets_with_and_without_quotes() {
        let block = "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n    - drive_0.db3\n    \
                     # the second\n    - \"drive 1.db3\"\n  duration:\n    - no.db3\n";
        assert_eq!(file_names(block), ["drive_0.db3", "drive 1.db3"]);
        assert_eq!(file_names("relative_file_paths: ['a.mcap', b.mcap]\nx: 1"), ["a.mcap", "b.mcap"]);
        assert!(file_names("version: 5").is_empty() && file_names("relative_file_paths:").is_empty());
    }

    #[test]
    fn no_entry_leads_out_of_the_folder() {
        let text = "relative_file_paths:\n- ../../etc/passwd\n- /abs/b.db3\n- ..\n- bag/bag_0.db3\n";
        assert_eq!(file_names(text), ["passwd", "b.db3", "bag_0.db3"]);
    }
}
