//! The shipped maps are what they claim to be, and GeoTIFFs of every kind are read or refused by name.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::{io::Cursor, path::PathBuf};

use terrain::{Cell, Error, Terrain, io, synthetic};
use tiff::{
    encoder::{TiffEncoder, colortype},
    tags::Tag,
};

fn read(tiff: &[u8]) -> Result<Terrain, Error> {
    io::geotiff::read(tiff, Terrain::MAX_CELLS)
}

fn shipped(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../maps").join(name)
}

#[test]
fn the_yard_is_what_its_command_writes() {
    let text = std::fs::read_to_string(shipped("yard.json")).unwrap();
    assert_eq!(io::json::read(&text).unwrap().content_id(), synthetic::yard(7).content_id());
}

#[test]
fn the_lidar_terrain_is_400_by_400_metres_of_central_minnesota() {
    let terrain = io::read_path(&shipped("minnesota.tif")).unwrap();
    let grid = terrain.grid;
    assert_eq!((grid.rows, grid.columns, grid.cell_size_m), (400, 400, 1.0));
    // The north-west tie point of the file, UTM zone 15 north.
    assert!((grid.origin_m[0] - 429_252.313_370).abs() < 1e-3);
    assert!((grid.origin_m[1] + 400.0 - 5_150_885.424_943).abs() < 1e-3);
    let known = (0..grid.cells()).filter_map(|i| terrain.elevation_m(grid.cell(i)));
    let (low, high) = known.fold((f64::MAX, f64::MIN), |(l, h), z| (l.min(z), h.max(z)));
    assert!((low - 379.659_33).abs() < 1e-3 && (high - 410.758_67).abs() < 1e-3, "{low} to {high}");
}

/// A 3 × 2 GeoTIFF, rows from the north, with what the test wants changed.
struct Sample {
    scale: Option<[f64; 3]>,
    keys: Vec<u16>,
    nodata: Option<&'static str>,
}

impl Sample {
    fn plain() -> Self {
        Sample { scale: Some([0.5, 0.5, 0.0]), keys: vec![1, 1, 0, 1, 1024, 0, 1, 1], nodata: Some("-9999") }
    }

    fn write<C: colortype::ColorType>(&self, samples: &[C::Inner]) -> Vec<u8>
    where
        [C::Inner]: tiff::encoder::TiffValue,
    {
        let mut file = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut file).unwrap();
        let mut image = encoder.new_image::<C>(3, 2).unwrap();
        let tags = image.encoder();
        if let Some(scale) = &self.scale {
            tags.write_tag(Tag::ModelPixelScaleTag, &scale[..]).unwrap();
        }
        tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, 100.0, 201.0, 0.0][..]).unwrap();
        tags.write_tag(Tag::GeoKeyDirectoryTag, &self.keys[..]).unwrap();
        if let Some(nodata) = self.nodata {
            tags.write_tag(Tag::GdalNodata, nodata).unwrap();
        }
        image.write_data(samples).unwrap();
        file.into_inner()
    }
}

fn check_sample(terrain: &Terrain) {
    assert_eq!(terrain.grid.origin_m, [100.0, 200.0]);
    assert_eq!(terrain.elevation_m(Cell { row: 1, column: 0 }), Some(1.0), "north-west");
    assert_eq!(terrain.elevation_m(Cell { row: 0, column: 2 }), Some(6.0), "south-east");
}

#[test]
fn float_and_integer_geotiffs_are_read_and_nodata_is_unknown() {
    let f = read(&Sample::plain().write::<colortype::Gray32Float>(&[1.0, 2.0, -9999.0, 4.0, 5.0, 6.0]));
    let f = f.unwrap();
    check_sample(&f);
    assert_eq!(f.elevation_m(Cell { row: 1, column: 2 }), None);
    let i = read(&Sample::plain().write::<colortype::GrayI16>(&[1, 2, -9999, 4, 5, 6])).unwrap();
    check_sample(&i);
    assert_eq!(i.elevation_m(Cell { row: 1, column: 2 }), None);
    check_sample(&read(&Sample::plain().write::<colortype::Gray16>(&[1, 2, 3, 4, 5, 6])).unwrap());
    let d = Sample::plain().write::<colortype::Gray64Float>(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    check_sample(&read(&d).unwrap());
}

#[test]
fn a_point_raster_lies_half_a_cell_further_out() {
    let keys = vec![1, 1, 0, 2, 1024, 0, 1, 1, 1025, 0, 1, 2];
    let tiff = Sample { keys, ..Sample::plain() }.write::<colortype::GrayI16>(&[1, 2, 3, 4, 5, 6]);
    assert_eq!(read(&tiff).unwrap().grid.origin_m, [99.75, 200.25]);
}

#[test]
fn a_fill_value_that_no_tag_marks_is_unknown_and_said() {
    let unmarked =
        Sample { nodata: None, ..Sample::plain() }.write::<colortype::GrayI16>(&[1, 2, -9999, 4, 5, 6]);
    let terrain = read(&unmarked).unwrap();
    assert_eq!(terrain.elevation_m(Cell { row: 1, column: 2 }), None);
    assert!(terrain.warnings()[0].detail.contains("-9999"), "{:?}", terrain.warnings());
}

#[test]
fn an_absurd_elevation_is_refused_in_the_words_of_its_format() {
    let tiff = Sample::plain().write::<colortype::Gray32Float>(&[1.0, 2.0, 40_000.0, 4.0, 5.0, 6.0]);
    let options = io::Options::default();
    let error = io::read_bytes(io::Format::GeoTiff, &tiff, &options).unwrap_err();
    assert!(error.to_string().contains("gdal_translate -a_nodata 40000.0"), "{error}");
    assert_eq!(error.field().as_deref(), Some("elevation_m[1][2]"));
    let json = br#"{"cell_size_m": 1, "rows": 1, "columns": 2, "elevation_m": [[1, 40000]]}"#;
    let error = io::read_bytes(io::Format::Json, json, &options).unwrap_err();
    assert!(error.to_string().contains("null for unknown ground"), "{error}");
}

#[test]
fn unusable_geotiffs_are_refused_by_what_they_lack() {
    let samples = [1, 2, 3, 4, 5, 6];
    let refused = |sample: &Sample| read(&sample.write::<colortype::GrayI16>(&samples)).unwrap_err();
    let no_scale = refused(&Sample { scale: None, ..Sample::plain() });
    assert!(no_scale.to_string().contains("ModelPixelScale"), "{no_scale}");
    let degrees = refused(&Sample { keys: vec![1, 1, 0, 1, 1024, 0, 1, 2], ..Sample::plain() });
    assert!(degrees.to_string().contains("degrees"), "{degrees}");
    assert!(degrees.to_string().contains("gdalwarp -t_srs EPSG:326"), "{degrees}");
    let unit = refused(&Sample { keys: vec![1, 1, 0, 1, 3076, 0, 1, 9102], ..Sample::plain() });
    assert!(
        unit.to_string().contains("ProjLinearUnitsGeoKey") && unit.to_string().contains("9102"),
        "{unit}"
    );
    let flat = refused(&Sample { scale: Some([0.5, 0.0, 0.0]), ..Sample::plain() });
    assert!(flat.to_string().contains("pixel size"), "{flat}");
    let fathoms = Sample { keys: vec![1, 1, 0, 1, 4096, 0, 1, 5715], ..Sample::plain() };
    assert!(refused(&fathoms).to_string().contains("depths"));
    let crowded = io::geotiff::read(&Sample::plain().write::<colortype::GrayI16>(&samples), 5).unwrap_err();
    assert!(matches!(crowded, Error::TooManyCells { limit: 5, .. }), "{crowded}");
    let endless = Sample { nodata: Some("-inf"), ..Sample::plain() }.write::<colortype::GrayI16>(&samples);
    assert!(read(&endless).is_ok(), "a nodata mark that no sample has");
    let rgb = Sample::plain().write::<colortype::RGB8>(&[0; 18]);
    assert!(matches!(read(&rgb), Err(Error::TiffSamples { .. })));
}

#[test]
fn a_truncated_or_boasting_geotiff_is_refused_without_its_size_being_allocated() {
    let whole = std::fs::read(shipped("minnesota.tif")).unwrap();
    for keep in [0, 7, 100, 1000, whole.len() / 2, whole.len() - 1] {
        assert!(read(&whole[..keep]).is_err(), "{keep} bytes were accepted");
    }
    // Patch the declared size of a small file to 23 170 × 23 170 floats, 2.1 GB; then to 11 000 × 11 000.
    for side in [23_170u32, 11_000] {
        let mut small = Sample::plain().write::<colortype::Gray32Float>(&[1.0; 6]);
        patch_tag(&mut small, 256, side);
        patch_tag(&mut small, 257, side);
        patch_tag(&mut small, 278, side);
        let message = read(&small).unwrap_err().to_string();
        assert!(message.contains("truncated") || message.contains("crop"), "{message}");
    }
}

/// Overwrites the value of a single-valued LONG or SHORT tag in the first directory of a little-endian TIFF.
fn patch_tag(tiff: &mut [u8], tag: u16, value: u32) {
    let directory = u32::from_le_bytes(tiff[4..8].try_into().unwrap()) as usize;
    let count = u16::from_le_bytes(tiff[directory..directory + 2].try_into().unwrap()) as usize;
    for entry in (0..count).map(|i| directory + 2 + 12 * i) {
        if u16::from_le_bytes(tiff[entry..entry + 2].try_into().unwrap()) == tag {
            tiff[entry + 2..entry + 4].copy_from_slice(&4u16.to_le_bytes());
            tiff[entry + 8..entry + 12].copy_from_slice(&value.to_le_bytes());
        }
    }
}

#[test]
fn an_unknown_ending_lists_the_known_ones() {
    let message = io::read_path(std::path::Path::new("map.png")).unwrap_err().to_string();
    assert!(message.contains(".tif") && message.contains("map.png"), "{message}");
}
