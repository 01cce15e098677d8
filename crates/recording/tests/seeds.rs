//! The fuzz targets begin with files that are right, one at least for each reader of recordings.

#![allow(clippy::unwrap_used)]

use std::path::Path;

use recording::read_path;

#[test]
fn every_seed_of_the_readers_is_read() {
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds");
    for folder in ["csv", "parquet", "mcap", "db3", "bag", "ulog"] {
        let files: Vec<_> =
            std::fs::read_dir(seeds.join(folder)).unwrap().map(|file| file.unwrap().path()).collect();
        assert!(!files.is_empty(), "{folder}");
        for file in files {
            assert!(read_path(&file, None).is_ok(), "{}", file.display());
        }
    }
}
