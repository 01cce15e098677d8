//! Files beside a GeoTIFF are honoured as GDAL honours them, and rasters that are written lie for GDAL where the map does.
//!
//! Needs the Python environment that `tests/run` makes in `target/python`; without it the tests say that they skip.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stderr)]

mod rasterio;

use rasterio::by_rasterio;
use terrain::{
    Cell, Grid, WarningKind,
    crs::Earth,
    io::{self, geotiff},
};

#[test]
fn files_beside_a_geotiff_are_honoured_as_by_gdal() {
    let folder = tempfile::tempdir().unwrap();
    let Some(expected) = by_rasterio("write_sidecars.py", folder.path()) else { return };
    for (name, expected) in expected.as_object().unwrap() {
        let terrain = io::read_path(&folder.path().join(format!("{name}.tif"))).unwrap();
        let grid = terrain.grid;
        assert_eq!(grid.cell_size_m, expected["cell_size_m"], "{name}");
        assert_eq!(serde_json::json!(grid.origin_m), expected["origin_m"], "{name}");
        let code = expected["epsg"].as_u64().map(|code| format!("EPSG:{code}"));
        assert_eq!(terrain.crs, code, "{name}");
        for index in 0..grid.cells() {
            let Cell { row, column } = grid.cell(index);
            let wanted = expected["elevation_m"][row][column].as_f64();
            let found = terrain.elevation_m(Cell { row, column });
            let same = match (found, wanted) {
                (Some(found), Some(wanted)) => (found - wanted).abs() < 1e-6,
                (found, wanted) => found.is_none() && wanted.is_none(),
            };
            assert!(same, "{name}: {found:?} in row {row}, column {column}, but rasterio reads {wanted:?}");
        }
        let said = terrain.warnings().iter().filter(|warning| warning.kind == WarningKind::BesideFile);
        let contradicts = matches!(name.as_str(), "both" | "over");
        assert_eq!(said.count(), usize::from(contradicts), "{name}: {:?}", terrain.warnings());
    }
}

#[test]
fn what_lies_beside_a_geotiff_and_cannot_be_used_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.tif");
    let grid = Grid { rows: 2, columns: 3, cell_size_m: 1.0, origin_m: [500_000.0, 5_000_000.0] };
    let write = |grid: &Grid| geotiff::write(grid, &vec![1.0; grid.cells()], Some("EPSG:32632")).unwrap();
    std::fs::write(&path, write(&grid)).unwrap();
    std::fs::write(folder.path().join("map.tfw"), "six numbers").unwrap();
    std::fs::write(folder.path().join("map.tif.aux.xml"), "<PAMDataset><SRS>somewhere</SRS>").unwrap();
    let terrain = io::read_path(&path).unwrap();
    let said: String = terrain.warnings().iter().map(|warning| warning.detail.clone() + "\n").collect();
    for word in ["map.tfw", "six numbers", "map.tif.aux.xml", "SRS", "broken off"] {
        assert!(said.contains(word), "{word}: {said}");
    }
    let wider = Grid { columns: 4, ..grid };
    std::fs::write(folder.path().join("map.tif.msk"), write(&wider)).unwrap();
    let refused = io::read_path(&path).unwrap_err().to_string();
    assert!(refused.contains(".msk") && refused.contains("4 × 2 pixels"), "{refused}");
}

#[test]
fn a_written_raster_lies_where_the_map_does() {
    let folder = tempfile::tempdir().unwrap();
    let web = folder.path().join("web.asc");
    let header = "ncols 3\nnrows 2\nxllcorner 1000000\nyllcorner 6200000\ncellsize 0.5\n";
    std::fs::write(&web, header.to_owned() + "1 1 1 1 1 1").unwrap();
    std::fs::write(web.with_extension("prj"), "EPSG:3857").unwrap();
    let scaled = io::read_path(&web).unwrap();
    let (scaled, scaled_origin_m) = (scaled.crs.unwrap(), scaled.grid.origin_m);
    let zone = "PROJCS[\"NAD_1983_UTM_Zone_15N\",GEOGCS[\"GCS_North_American_1983\",DATUM[\"D_North_American_1983\",SPHEROID[\"GRS_1980\",6378137.0,298.257222101]],PRIMEM[\"Greenwich\",0.0],UNIT[\"Degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"False_Easting\",500000.0],PARAMETER[\"False_Northing\",0.0],PARAMETER[\"Central_Meridian\",-93.0],PARAMETER[\"Scale_Factor\",0.9996],PARAMETER[\"Latitude_Of_Origin\",0.0],UNIT[\"Meter\",1.0]]";
    for (crs, origin_m, epsg) in [
        (Some("EPSG:32632"), [512_000.0, 5_422_970.0], Some(32_632)),
        (Some("EPSG:2263"), [300_000.0, 60_000.0], Some(2263)),
        (Some(zone), [512_000.0, 4_982_950.0], Some(26_915)),
        (Some(scaled.as_str()), scaled_origin_m, Some(3857)),
        (None, [512_000.0, 5_422_970.0], None),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("energy.tif");
        let grid = Grid { rows: 2, columns: 3, cell_size_m: 0.5, origin_m };
        std::fs::write(&path, geotiff::write(&grid, &[1.0; 6], crs).unwrap()).unwrap();
        let Some(found) = by_rasterio("read_written.py", &path) else { return };
        let first_m = [origin_m[0] + 0.25, origin_m[1] + 0.75];
        let wanted = crs.map(|crs| Earth::of(crs).unwrap().place_deg(first_m).unwrap());
        match wanted {
            Some(wanted) => {
                let off_deg = |axis: usize| (found["place_deg"][axis].as_f64().unwrap() - wanted[axis]).abs();
                assert!(off_deg(0) < 1e-8 && off_deg(1) < 1e-8, "{crs:?}: {found} instead of {wanted:?}");
            }
            None => assert!(found["place_deg"].is_null(), "{found}"),
        }
        assert_eq!(found["epsg"].as_u64(), epsg, "{crs:?}: {found}");
    }
}
