//! GeoTIFFs of every layout that GDAL writes hold, cell by cell, what rasterio reads in them.
//!
//! Needs the Python environment that `tests/run` makes in `target/python`; without it the tests say that they skip.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stderr)]

use std::{
    path::{Path, PathBuf},
    process::Command,
};

use serde::Deserialize;
use terrain::{Cell, Terrain, io};

/// A file as rasterio reads it.
#[derive(Deserialize)]
struct Expected {
    name: String,
    rows: usize,
    columns: usize,
    transform: [f64; 6],
}

/// The folder of the files; `None` without a Python environment that has rasterio.
fn files() -> Option<tempfile::TempDir> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or(package.join("../../target"), PathBuf::from);
    let python = target.join("python/bin/python");
    let has_rasterio = Command::new(&python).args(["-c", "import rasterio"]).output();
    if !has_rasterio.is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED: there is no Python with rasterio in {}; tests/run makes it", target.display());
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    let script = package.join("tests/write_geotiffs.py");
    let output = Command::new(python).arg(script).arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(folder)
}

/// The first cell that differs from rasterio's reading, or the frame, in words.
fn difference(folder: &Path, expected: &Expected) -> Option<String> {
    let file = std::fs::read(folder.join(format!("{}.tif", expected.name))).unwrap();
    let terrain = match io::geotiff::read(&file, Terrain::MAX_CELLS) {
        Ok(terrain) => terrain,
        Err(error) => return Some(error.to_string()),
    };
    let [width, _, x, _, height, y] = expected.transform;
    let grid = terrain.grid;
    let south_west = [x.min(x + width * expected.columns as f64), y.min(y + height * expected.rows as f64)];
    if (grid.rows, grid.columns) != (expected.rows, expected.columns) || grid.origin_m != south_west {
        return Some(format!("lies elsewhere: {grid:?}"));
    }
    if terrain.crs.as_deref() != Some("EPSG:32632") {
        return Some(format!("crs {:?}", terrain.crs));
    }
    let bytes = std::fs::read(folder.join(format!("{}.f64", expected.name))).unwrap();
    let heights: Vec<f64> = bytes.as_chunks().0.iter().map(|z| f64::from_le_bytes(*z)).collect();
    let highest = heights.iter().copied().fold(0.0, f64::max);
    // Relief is kept in single precision.
    let rounding_m = (highest - terrain.base_m()).max(1.0) * f64::from(f32::EPSILON);
    heights.iter().enumerate().find_map(|(index, z)| {
        let (row, column) = (index / grid.columns, index % grid.columns);
        let cell = Cell {
            row: if height < 0.0 { grid.rows - 1 - row } else { row },
            column: if width > 0.0 { column } else { grid.columns - 1 - column },
        };
        let same = match terrain.elevation_m(cell) {
            Some(found) => (found - z).abs() <= rounding_m,
            None => z.is_nan(),
        };
        (!same).then(|| format!("{:?} in {cell:?}, but rasterio reads {z}", terrain.elevation_m(cell)))
    })
}

#[test]
fn every_cell_is_as_rasterio_reads_it() {
    let Some(folder) = files() else { return };
    let index = std::fs::read_to_string(folder.path().join("index.json")).unwrap();
    let index: Vec<Expected> = serde_json::from_str(&index).unwrap();
    assert!(index.len() > 1000, "only {} files were written", index.len());
    let differ: Vec<String> = index
        .iter()
        .filter_map(|expected| Some(format!("{}: {}", expected.name, difference(folder.path(), expected)?)))
        .collect();
    assert!(
        differ.is_empty(),
        "{} of {} differ:\n{}",
        differ.len(),
        index.len(),
        differ[..differ.len().min(40)].join("\n")
    );
}

#[test]
fn a_damaged_file_is_an_error_or_a_map_and_never_a_panic() {
    let Some(folder) = files() else { return };
    let some = ["float32-block3-little", "int16-block4-big", "mask-", "cog-", "sparse", "bands2"];
    let entries = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path());
    let chosen = entries.filter(|path| {
        let name = path.file_name().unwrap().to_str().unwrap();
        name.ends_with(".tif") && some.iter().any(|part| name.contains(part))
    });
    for path in chosen {
        let whole = std::fs::read(&path).unwrap();
        let mut state = 1u64;
        for _ in 0..60 {
            let mut bytes = whole.clone();
            for _ in 0..3 {
                // Knuth's linear congruential generator (MMIX).
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let at = (state >> 33) as usize % bytes.len();
                bytes[at] = (state >> 25) as u8;
            }
            let _: Result<Terrain, _> = io::geotiff::read(&bytes, 1 << 20);
            let _ = io::geotiff::read(&whole[..(state >> 33) as usize % whole.len()], 1 << 20);
        }
    }
}
