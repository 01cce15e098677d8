//! Elevation models in degrees lie on metres of their UTM zone where GDAL and PROJ have them, and what that changed is said.
//!
//! The comparisons need the Python environment that `tests/run` makes in `target/python`; without it they say that they skip.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stderr)]

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use terrain::{Cell, Terrain, WarningKind, io};

/// The models in degrees as they are read, and the folder that holds what GDAL makes of them.
fn models() -> Option<(tempfile::TempDir, Vec<(String, Terrain)>)> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or(package.join("../../target"), PathBuf::from);
    let python = target.join("python/bin/python");
    let has_both = Command::new(&python).args(["-c", "import rasterio, pyproj"]).output();
    if !has_both.is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED: there is no Python with rasterio in {}; tests/run makes it", target.display());
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    let run = |step: &str| {
        let script = package.join("tests/warp_models.py");
        let output = Command::new(&python).arg(script).arg(step).arg(folder.path()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    run("write");
    let names: Vec<String> =
        serde_json::from_slice(&fs::read(folder.path().join("index.json")).unwrap()).unwrap();
    let read = |name: &String| io::read_path(&folder.path().join(format!("{name}.tif"))).unwrap();
    let models: Vec<(String, Terrain)> = names.iter().map(|name| (name.clone(), read(name))).collect();
    let grids: Vec<serde_json::Value> = models
        .iter()
        .map(|(name, terrain)| {
            let grid = terrain.grid;
            serde_json::json!({"name": name, "crs": terrain.crs, "rows": grid.rows, "columns": grid.columns,
                "cell_size_m": grid.cell_size_m, "origin_m": grid.origin_m})
        })
        .collect();
    fs::write(folder.path().join("grids.json"), serde_json::to_vec(&grids).unwrap()).unwrap();
    run("warp");
    Some((folder, models))
}

/// What is said of the warp.
fn said(terrain: &Terrain) -> &str {
    let warped = terrain.warnings().iter().find(|warning| warning.kind == WarningKind::Warped);
    &warped.expect("a warning of the warp").detail
}

fn numbers(path: &Path) -> Vec<f64> {
    fs::read(path).unwrap().as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
}

/// Range of GDAL's heights within two cells, NaN where some are unknown: the larger cells of the source are two wide at most.
fn local_relief_m(heights_m: &[f64], terrain: &Terrain, cell: Cell) -> f64 {
    let (rows, columns) = (terrain.grid.rows, terrain.grid.columns);
    let near = |at: usize, count: usize| at.saturating_sub(2)..(at + 3).min(count);
    let around = near(cell.row, rows).flat_map(|row| near(cell.column, columns).map(move |c| (row, c)));
    let (mut lowest_m, mut highest_m) = (f64::INFINITY, f64::NEG_INFINITY);
    for (row, column) in around {
        let height_m = heights_m[(rows - 1 - row) * columns + column];
        if height_m.is_nan() {
            return f64::NAN;
        }
        (lowest_m, highest_m) = (lowest_m.min(height_m), highest_m.max(height_m));
    }
    highest_m - lowest_m
}

#[test]
fn heights_are_those_that_gdal_interpolates() {
    /// A position may be off along either axis by a hundredth of a cell here and by a thousandth in GDAL, and a height by as large a
    /// part of the local relief.
    const POSITION_CELLS: f64 = 0.011;
    const TOLERANCE: f64 = 2.0 * POSITION_CELLS;
    /// Heights are kept in single precision over the relief, and written in double precision.
    const ROUNDING_M: f64 = 1e-4;
    let Some((folder, models)) = models() else { return };
    for (name, terrain) in &models {
        let by_gdal = numbers(&folder.path().join(format!("{name}.f64")));
        let (mut compared, mut apart, mut worst) = (0, 0, 0.0f64);
        for index in 0..terrain.grid.cells() {
            let cell = terrain.grid.cell(index);
            let expected = by_gdal[(terrain.grid.rows - 1 - cell.row) * terrain.grid.columns + cell.column];
            let found = terrain.elevation_m(cell);
            apart += usize::from(found.is_some() == expected.is_nan());
            let (Some(found), relief_m) = (found, local_relief_m(&by_gdal, terrain, cell)) else { continue };
            if !relief_m.is_nan() {
                compared += 1;
                worst = worst.max((found - expected).abs() / (TOLERANCE * relief_m + ROUNDING_M));
            }
        }
        eprintln!("{name}: {compared} cells, worst {worst:.3} of the tolerance; {}", said(terrain));
        assert!(worst < 1.0, "{name}: {worst} times the tolerance");
        assert!(compared > terrain.grid.cells() / 2, "{name}: only {compared} cells were compared");
        // Centres as close as that to the footprint's edge may fall to either side.
        let edge_cells = 2 * (terrain.grid.rows + terrain.grid.columns);
        assert!(
            apart as f64 <= POSITION_CELLS * edge_cells as f64,
            "{name}: {apart} cells are known to one of both only"
        );
    }
}

#[test]
fn places_are_where_proj_has_them() {
    /// Half a cell to a centre, along both axes.
    const HALF_A_CELL: f64 = 0.5;
    let Some((folder, models)) = models() else { return };
    for (name, terrain) in &models {
        let mut found = 0;
        for place in numbers(&folder.path().join(format!("{name}.places"))).as_chunks::<3>().0 {
            let [x_m, y_m, height_m] = *place;
            let cell = terrain.grid.cell_at(x_m, y_m).unwrap_or_else(|| panic!("{name}: {place:?}"));
            let centre_m = terrain.grid.center_m(cell);
            let off = (centre_m[0] - x_m).abs().max((centre_m[1] - y_m).abs()) / terrain.grid.cell_size_m;
            assert!(off <= HALF_A_CELL * (1.0 + 1e-9));
            let Some(here_m) = terrain.elevation_at_m(x_m, y_m) else { continue };
            found += 1;
            // The largest difference that the reader itself measured, to the digits that it says.
            let said = said(terrain);
            let largest_m: f64 =
                said.split_once(" m at most").unwrap().0.rsplit(' ').next().unwrap().parse().expect(said);
            assert!((here_m - height_m).abs() <= largest_m + 2e-3, "{name}: {here_m} for {height_m}; {said}");
        }
        assert!(found > 100, "{name}: {found}");
    }
}
