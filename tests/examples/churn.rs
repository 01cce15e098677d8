//! Uploads and deletes maps and recordings, and what is left of them on disk.
//!
//! `cargo run --release -p joulepath-tests --example churn [TIMES]`

#![allow(clippy::unwrap_used)]

use joulepath_tests::churn::churn;

fn main() {
    let times = std::env::args().nth(1).map_or(1000, |times| times.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let growth = churn(folder.path(), times);
    println!(
        "{times} maps and {times} recordings uploaded and deleted: {} files and {} bytes before, {} files and {} bytes after",
        growth.files_before, growth.bytes_before, growth.files_after, growth.bytes_after
    );
}
