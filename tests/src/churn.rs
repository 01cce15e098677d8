//! Uploads and deletes, many times over, and what they leave on disk.

use std::path::Path;

use serde_json::json;

use crate::{Server, drive_csv, folder_store};

/// What a folder held before and after uploads and deletes.
#[derive(Debug)]
pub struct Growth {
    /// Files before.
    pub files_before: usize,
    /// Files after.
    pub files_after: usize,
    /// Bytes before.
    pub bytes_before: u64,
    /// Bytes after.
    pub bytes_after: u64,
}

/// Uploads a map and a recording and deletes them, so many times, each time others.
///
/// # Panics
/// When the service refuses one.
pub fn churn(folder: &Path, times: usize) -> Growth {
    let server = Server::start_over(folder);
    let (files_before, bytes_before) = (folder_store::files(folder).len(), folder_store::bytes(folder));
    for i in 0..times {
        let map = json!({ "cell_size_m": 1.0, "rows": 2, "columns": 2, "elevation_m": [[0.0, 1.0], [2.0, i as f64 / 100.0]] });
        let recording = drive_csv(1, 30).replace("drive-0", &format!("drive-{i}"));
        for (path, kind, body) in
            [("/v1/maps", "application/json", map.to_string()), ("/v1/recordings", "text/csv", recording)]
        {
            let stored = server.post(path, kind, body.as_bytes());
            assert_eq!(stored.status, 201, "{}", stored.text);
            let id = stored.json()["id"].as_str().unwrap_or_default().to_owned();
            assert_eq!(server.delete(&format!("{path}/{id}")).status, 204);
        }
    }
    let (files_after, bytes_after) = (folder_store::files(folder).len(), folder_store::bytes(folder));
    Growth { files_before, files_after, bytes_before, bytes_after }
}
