//! Elevation models in degrees become ground in metres, or are refused with what mends them.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::{fs, io::Write, path::Path};

use terrain::{Terrain, WarningKind, io};

const DEGREES: &str = "GEOGCS[\"GCS_WGS_1984\",DATUM[\"D_WGS_1984\",SPHEROID[\"WGS_1984\",6378137.0,298.257223563]],\
     PRIMEM[\"Greenwich\",0.0],UNIT[\"Degree\",0.0174532925199433]]";

/// An ASCII grid of 40 × 40 cells of a second of arc from a corner, with a `.prj` beside it.
struct Model {
    west_deg: f64,
    south_deg: f64,
    cell_deg: f64,
    columns: usize,
    prj: &'static str,
}

impl Model {
    const SIDE: usize = 40;

    fn at(west_deg: f64, south_deg: f64) -> Self {
        Model { west_deg, south_deg, cell_deg: 1.0 / 3600.0, columns: Self::SIDE, prj: DEGREES }
    }

    /// Reads the model with heights by column and row from the south.
    fn read_as(
        &self,
        height: impl Fn(usize, usize) -> f64,
        options: &io::Options,
    ) -> Result<Terrain, terrain::Error> {
        let Model { west_deg, south_deg, cell_deg, columns, prj } = self;
        let mut text = format!(
            "ncols {columns}\nnrows {}\nxllcorner {west_deg}\nyllcorner {south_deg}\ncellsize {cell_deg}\nNODATA_value -9999\n",
            Self::SIDE
        );
        for row in (0..Self::SIDE).rev() {
            let line: Vec<String> = (0..*columns).map(|column| height(column, row).to_string()).collect();
            text += &(line.join(" ") + "\n");
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model.asc");
        fs::write(&path, text).unwrap();
        fs::write(path.with_extension("prj"), prj).unwrap();
        io::read_path_as(&path, options)
    }

    fn read(&self) -> Result<Terrain, terrain::Error> {
        self.read_as(|_, _| 250.0, &io::Options::default())
    }

    /// Longitude and latitude of a cell's centre.
    fn centre_deg(&self, column: usize, row: usize) -> [f64; 2] {
        let along = |start_deg: f64, cells: usize| start_deg + (cells as f64 + 0.5) * self.cell_deg;
        [along(self.west_deg, column), along(self.south_deg, row)]
    }
}

fn known(terrain: &Terrain) -> usize {
    terrain.relative_m().iter().filter(|height| !height.is_nan()).count()
}

fn said(terrain: &Terrain, kind: WarningKind) -> Option<&str> {
    terrain.warnings().iter().find(|warning| warning.kind == kind).map(|warning| warning.detail.as_str())
}

#[test]
fn level_ground_stays_level_within_its_footprint_and_nothing_is_known_beyond() {
    let model = Model::at(9.1, 48.9);
    let terrain = model.read().unwrap();
    assert_eq!((terrain.crs.as_deref(), terrain.grid.cell_size_m), (Some("EPSG:32632"), 20.4));
    assert!(terrain.relative_m().iter().all(|height| height.is_nan() || *height == 0.0));
    assert_eq!(terrain.base_m(), 250.0);
    // A second of arc is 20.36 × 30.88 m there.
    let footprint_m2 = (40.0 * 20.36) * (40.0 * 30.88);
    let known_m2 = known(&terrain) as f64 * 20.4 * 20.4;
    assert!((known_m2 / footprint_m2 - 1.0).abs() < 0.01, "{known_m2} of {footprint_m2}");
    let earth = terrain.earth().unwrap();
    for (column, row) in [(1, 1), (38, 1), (1, 38), (38, 38), (20, 20)] {
        let [x_m, y_m] = earth.place_m(model.centre_deg(column, row)).unwrap();
        assert_eq!(terrain.elevation_at_m(x_m, y_m), Some(250.0), "{column}, {row}");
    }
    let said = said(&terrain, WarningKind::Warped).unwrap();
    for part in
        ["EPSG:4326", "20.36 × 30.88 m", "cells of 20.4 m in EPSG:32632", "0.000 m (RMS), 0.000 m at most"]
    {
        assert!(said.contains(part), "{said}");
    }
}

#[test]
fn a_slope_is_as_steep_on_the_ground_as_it_was_in_degrees() {
    // Rising a metre a second of arc northwards, 30.88 m.
    let terrain = Model::at(9.1, 48.9).read_as(|_, row| row as f64, &io::Options::default()).unwrap();
    let middle_m = terrain.grid.at_fraction_m(0.5, 0.5);
    let height_m = |north_m: f64| terrain.elevation_at_m(middle_m[0], middle_m[1] + north_m).unwrap();
    let slope = (height_m(100.0) - height_m(-100.0)) / 200.0;
    assert!((slope * 30.88 - 1.0).abs() < 1e-3, "{slope}");
}

#[test]
fn unknown_cells_stay_unknown_with_the_cells_that_they_count_for() {
    let hole = |column: usize, row: usize| if (column, row) == (20, 20) { -9999.0 } else { 250.0 };
    let model = Model::at(9.1, 48.9);
    let terrain = model.read_as(hole, &io::Options::default()).unwrap();
    let whole = model.read().unwrap();
    // A pixel counts for places less than a pixel from it: twice its edges, four times its area.
    let pixel_cells = (20.36 * 30.88) / (20.4 * 20.4);
    let lost = known(&whole) - known(&terrain);
    assert!((3.0 * pixel_cells..5.0 * pixel_cells).contains(&(lost as f64)), "{lost}");
    assert!(terrain.relative_m().iter().all(|height| height.is_nan() || *height == 0.0));
    let [x_m, y_m] = terrain.earth().unwrap().place_m(model.centre_deg(20, 20)).unwrap();
    assert_eq!(terrain.elevation_at_m(x_m, y_m), None);
}

#[test]
fn given_nodata_and_doubts_are_about_the_cells_of_the_file() {
    let sea = |column: usize, row: usize| if column < 10 { 0.0 } else { 250.0 + row as f64 / 7.0 };
    let model = Model::at(9.1, 48.9);
    let options = io::Options { nodata_m: Some(0.0), ..io::Options::default() };
    let terrain = model.read_as(sea, &options).unwrap();
    assert!(terrain.base_m() >= 250.0, "no height lies between ground and nodata: {}", terrain.base_m());
    assert!(said(&terrain, WarningKind::GivenNodata).unwrap().starts_with("400 cells of 0"));
    let doubted = model.read_as(sea, &io::Options::default()).unwrap();
    assert!(said(&doubted, WarningKind::FillValue).is_some(), "{:?}", doubted.warnings());
}

#[test]
fn holes_are_filled_on_the_ground_in_metres() {
    let hole = |column: usize, row: usize| if (column, row) == (20, 20) { -9999.0 } else { 250.0 };
    let options = io::Options { fill_voids_m: Some(100.0), ..io::Options::default() };
    let model = Model::at(9.1, 48.9);
    let terrain = model.read_as(hole, &options).unwrap();
    assert_eq!(known(&terrain), known(&model.read().unwrap()));
}

#[test]
fn the_widest_and_the_most_northern_that_one_zone_serves_are_read_and_no_more() {
    let wide = |columns| Model { columns, cell_deg: 1.0 / 1200.0, ..Model::at(4.5, 83.9) };
    let widest = wide(9 * 1200).read().unwrap();
    assert_eq!(widest.crs.as_deref(), Some("EPSG:32632"));
    assert!(
        !said(&widest, WarningKind::Warped).unwrap().contains("beyond the zone"),
        "narrow close to a pole"
    );
    let equator = Model { south_deg: 0.0, ..wide(9 * 1200) }.read().unwrap();
    let doubt = said(&equator, WarningKind::Warped).unwrap();
    assert!(doubt.contains("beyond the zone's edges 1 m of ground is up to 1.002"), "{doubt}");
    let refused = |model: Model| model.read().unwrap_err().to_string();
    let wider = refused(wide(9 * 1200 + 1));
    assert!(wider.contains("more than the 9°") && wider.contains("-projwin 4.5 "), "{wider}");
    let polar = refused(Model::at(9.0, 83.995));
    assert!(polar.contains("80° S to 84° N") && polar.contains("-t_srs EPSG:32661 "), "{polar}");
    let antarctic = refused(Model::at(9.0, -80.001));
    assert!(antarctic.contains("-t_srs EPSG:32761 "), "{antarctic}");
}

#[test]
fn numbers_that_are_no_degrees_are_refused_whatever_the_system_says() {
    for (west, south) in [(512_000.0, 5_423_000.0), (9.0, 91.0), (-400.0, 10.0)] {
        let said = Model { cell_deg: 0.001, ..Model::at(west, south) }.read().unwrap_err().to_string();
        assert!(said.contains("no longitudes and latitudes"), "{said}");
    }
    let fine = Model { cell_deg: 1e-9, ..Model::at(9.0, 48.0) }.read().unwrap_err().to_string();
    assert!(fine.contains("0.01 to 100 m"), "{fine}");
}

#[test]
fn no_numbers_of_a_header_make_it_panic() {
    let numbers = [0.0, 1e-300, 1e-9, 1e-3, 0.5, 9.0, -80.0, 84.0, 90.0, -180.0, 180.0, 359.999, 1e6, 1e300];
    let mut read = 0;
    for west_deg in numbers {
        for south_deg in numbers {
            for cell_deg in [1e-300, 1e-9, 1e-7, 1e-4, 1e-3, 0.5, 1e300] {
                let model = Model { west_deg, south_deg, cell_deg, columns: 2, prj: DEGREES };
                read += usize::from(model.read().is_ok());
            }
        }
    }
    assert!(read > 0);
}

#[test]
fn what_cannot_be_read_back_is_said() {
    let single = Model { columns: 1, cell_deg: 1e-6, ..Model::at(9.1, 48.9) }.read().unwrap();
    let said = said(&single, WarningKind::Warped).unwrap();
    assert!(known(&single) >= 40 && said.contains("read back"), "{said}");
}

#[test]
fn more_cells_than_may_be_are_refused_before_they_are_made() {
    let options = io::Options { most_cells: 2000, ..io::Options::default() };
    // 1600 cells of the file, but half as many again of square ones.
    let refused = Model::at(9.1, 48.9).read_as(|_, _| 1.0, &options).unwrap_err().to_string();
    assert!(refused.contains("more than the 2000"), "{refused}");
}

#[test]
fn grids_are_the_same_for_any_number_of_threads() {
    let waves = |column: usize, row: usize| 9.0 * (column as f64 / 3.0).sin() + (row as f64).sqrt();
    let read = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Model::at(9.1, 48.9).read_as(waves, &io::Options::default()).unwrap().content_id())
    };
    assert_eq!(read(1), read(3));
}

/// A tile of three seconds of arc that rises a metre a sample northwards, with a void at its south-west corner.
fn tile(folder: &Path, name: &str) -> std::path::PathBuf {
    let height = |row_from_north: usize, column: usize| match (row_from_north, column) {
        (1200, 0) => i16::MIN,
        (row, _) => 1200 - row as i16,
    };
    let samples = (0..1201).flat_map(|row| (0..1201).map(move |column| height(row, column)));
    let path = folder.join(name);
    fs::write(&path, samples.flat_map(i16::to_be_bytes).collect::<Vec<u8>>()).unwrap();
    path
}

#[test]
fn a_tile_of_srtm_lies_where_its_name_says() {
    let folder = tempfile::tempdir().unwrap();
    let path = tile(folder.path(), "N46W094.hgt");
    let terrain = io::read_path(&path).unwrap();
    assert_eq!(terrain.crs.as_deref(), Some("EPSG:32615"));
    let earth = terrain.earth().unwrap();
    let height_m = |longitude_deg: f64, latitude_deg: f64| {
        let [x_m, y_m] = earth.place_m([longitude_deg, latitude_deg]).unwrap();
        terrain.elevation_at_m(x_m, y_m)
    };
    // Samples lie on the degree lines.
    for (longitude_deg, latitude_deg, expected_m) in
        [(-93.5, 46.5, 600.0), (-93.25, 46.75, 900.0), (-93.9, 46.1, 120.0)]
    {
        let found_m = height_m(longitude_deg, latitude_deg).unwrap();
        assert!((found_m - expected_m).abs() < 0.02, "{found_m} for {expected_m}");
    }
    assert_eq!((height_m(-94.0, 46.0), height_m(-94.0, 46.0 + 2.0 / 1200.0).is_some()), (None, true));
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(&fs::read(&path).unwrap()).unwrap();
    let gz = folder.path().join("n46w094.SRTMGL3.hgt.gz");
    fs::write(&gz, packed.finish().unwrap()).unwrap();
    assert_eq!(io::read_path(&gz).unwrap().content_id(), terrain.content_id());
    let nameless = io::read_path(&tile(folder.path(), "tile.hgt")).unwrap_err().to_string();
    assert!(nameless.contains("`tile.hgt`") && nameless.contains("N46W094.hgt"), "{nameless}");
    fs::write(&path, [0; 100]).unwrap();
    assert!(io::read_path(&path).unwrap_err().to_string().contains("100 bytes are no tile"));
}
