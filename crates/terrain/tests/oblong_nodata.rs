//! Marks of unknown ground and doubts are about a raster's own pixels, whatever becomes of these on the way to square cells.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::io::Cursor;

use terrain::{Error, Terrain, WarningKind, io};
use tiff::{
    encoder::{TiffEncoder, colortype::Gray8, colortype::Gray32Float},
    tags::Tag,
};

/// Frames of a raster: square, oblong, turned by 30°, and turned from the other end.
const FRAMES: [(&str, [f64; 4]); 4] = [
    ("square", [1.0, 0.0, 0.0, -1.0]),
    ("oblong", [2.0, 0.0, 0.0, -1.0]),
    ("turned", [0.866_025_403_8, 0.5, 0.5, -0.866_025_403_8]),
    ("from the south-east", [-2.0, 0.0, 0.0, 1.0]),
];
const COLUMNS: u32 = 40;
const ROWS: u32 = 30;

/// The tags of a frame in EPSG:32632; a step along columns and along rows, each of x and y.
fn matrix([column_x, row_x, column_y, row_y]: [f64; 4]) -> [f64; 16] {
    let mut matrix = [0.0; 16];
    [matrix[0], matrix[1], matrix[3]] = [column_x, row_x, 512_000.0];
    [matrix[4], matrix[5], matrix[7], matrix[15]] = [column_y, row_y, 5_423_000.0, 1.0];
    matrix
}

const KEYS: [u16; 12] = [1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 32_632];

/// Ground of 300 m and more, with a hole of 16 pixels and one of a single pixel that hold a fill value.
fn file(frame: [f64; 4], fill: f32) -> Vec<u8> {
    let height = |index: u32| {
        let (column, row) = (index % COLUMNS, index / COLUMNS);
        let is_fill = (10..14).contains(&row) && (10..14).contains(&column) || (row, column) == (20, 30);
        if is_fill { fill } else { 300.0 + 0.05 * column as f32 + 0.03 * row as f32 }
    };
    let mut file = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut file).unwrap();
    let mut image = encoder.new_image::<Gray32Float>(COLUMNS, ROWS).unwrap();
    image.encoder().write_tag(Tag::ModelTransformationTag, &matrix(frame)[..]).unwrap();
    image.encoder().write_tag(Tag::GeoKeyDirectoryTag, &KEYS[..]).unwrap();
    image.write_data(&(0..COLUMNS * ROWS).map(height).collect::<Vec<f32>>()).unwrap();
    file.into_inner()
}

fn read(bytes: &[u8], nodata_m: Option<f64>) -> Result<Terrain, Error> {
    io::read_bytes(io::Format::GeoTiff, bytes, &io::Options { nodata_m, ..io::Options::default() })
}

fn said(terrain: &Terrain, kind: WarningKind) -> Option<&str> {
    terrain.warnings().iter().find(|warning| warning.kind == kind).map(|warning| warning.detail.as_str())
}

#[test]
fn a_fill_value_is_never_mixed_into_ground() {
    for (name, frame) in FRAMES {
        let terrain = read(&file(frame, -9999.0), None).unwrap();
        assert!(terrain.base_m() >= 299.99, "{name}: {}", terrain.base_m());
        assert!(
            said(&terrain, WarningKind::UnmarkedNodata).unwrap().starts_with("17 cells hold -9999"),
            "{name}"
        );
        let (limit, written) = (f64::from(f32::MIN), f32::MIN);
        let terrain = read(&file(frame, written), Some(limit)).unwrap();
        assert!(terrain.base_m() >= 299.99, "{name}: {}", terrain.base_m());
    }
}

#[test]
fn given_nodata_is_that_of_the_files_pixels() {
    for (name, frame) in FRAMES {
        for fill in [0.0, -9999.0, 299.5] {
            let terrain = read(&file(frame, fill), Some(f64::from(fill))).unwrap();
            assert!(terrain.base_m() >= 299.99, "{name} {fill}: {}", terrain.base_m());
        }
        let terrain = read(&file(frame, 0.0), Some(0.0)).unwrap();
        assert!(said(&terrain, WarningKind::GivenNodata).unwrap().starts_with("17 cells of 0"), "{name}");
    }
}

#[test]
fn a_value_that_stands_off_is_doubted_before_it_is_smoothed() {
    for (name, frame) in FRAMES {
        let terrain = read(&file(frame, 0.0), None).unwrap();
        let doubt = said(&terrain, WarningKind::FillValue).unwrap_or_else(|| panic!("{name}"));
        assert!(doubt.starts_with("17 cells hold exactly 0"), "{name}: {doubt}");
    }
}

#[test]
fn a_picture_of_bytes_is_doubted_though_its_pixels_were_interpolated() {
    let mut file = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut file).unwrap();
    let mut image = encoder.new_image::<Gray8>(COLUMNS, ROWS).unwrap();
    image.encoder().write_tag(Tag::ModelTransformationTag, &matrix(FRAMES[2].1)[..]).unwrap();
    image.encoder().write_tag(Tag::GeoKeyDirectoryTag, &KEYS[..]).unwrap();
    image.write_data(&(0..COLUMNS * ROWS).map(|index| 7 + (index % 90) as u8).collect::<Vec<u8>>()).unwrap();
    let terrain = read(&file.into_inner(), None).unwrap();
    assert!(said(&terrain, WarningKind::Image).unwrap().contains("8-bit"), "{:?}", terrain.warnings());
}

#[test]
fn more_cells_than_may_be_are_refused_before_pixels_are_read() {
    let options = io::Options { most_cells: 1300, ..io::Options::default() };
    let turned = io::read_bytes(io::Format::GeoTiff, &file(FRAMES[2].1, 0.0), &options);
    assert!(turned.unwrap_err().to_string().contains("more than the 1300"));
}
