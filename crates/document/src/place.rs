//! Places in a document, as a path for people and as a JSON pointer for programs.

use serde_path_to_error::{Path, Segment};

/// A tracked path as `surfaces.marble.mu_roll` or `sources[3].unit`; empty for the document itself.
pub(crate) fn shown(path: &Path) -> String {
    let mut shown = String::new();
    for segment in path.iter() {
        match segment {
            Segment::Seq { index } => shown.push_str(&format!("[{index}]")),
            Segment::Map { key: name } | Segment::Enum { variant: name } => {
                if !shown.is_empty() {
                    shown.push('.');
                }
                // A name that is empty would look like none.
                shown.push_str(if name.is_empty() { "\"\"" } else { name });
            }
            Segment::Unknown => {}
        }
    }
    shown
}

/// A tracked path as a JSON pointer (RFC 6901).
pub(crate) fn tracked_pointer(path: &Path) -> String {
    path.iter()
        .map(|segment| match segment {
            Segment::Seq { index } => format!("/{index}"),
            Segment::Map { key: name } | Segment::Enum { variant: name } => pointer(name),
            Segment::Unknown => String::new(),
        })
        .collect()
}

/// Returns the JSON pointer (RFC 6901) of a field of the document.
pub fn pointer(field: &str) -> String {
    format!("/{}", field.replace('~', "~0").replace('/', "~1"))
}

/// A field of the object at a path.
pub(crate) fn beneath(path: &str, field: &str) -> String {
    if path.is_empty() { field.to_owned() } else { format!("{path}.{field}") }
}
