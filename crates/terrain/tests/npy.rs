//! Arrays of numpy: every dtype and order is the same ground as the JSON grid, and what cannot be read right is refused.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{fs, path::Path};

use half::f16;
use proptest::prelude::*;
use terrain::{
    Cell, Error, Grid, Terrain, WarningKind,
    io::{self, Format, Georeference, Options},
};

const GRID: Grid = Grid { rows: 3, columns: 4, cell_size_m: 0.5, origin_m: [10.0, -20.0] };

/// Elevations that every dtype holds, row by row from the south.
const HEIGHTS_M: [u8; 12] = [7, 8, 9, 10, 17, 18, 19, 20, 27, 28, 29, 31];

fn options() -> Options {
    let georeference = Georeference {
        cell_size_m: Some(0.5),
        origin_m: Some([10.0, -20.0]),
        crs: Some("EPSG:26915".into()),
    };
    Options { georeference, ..Options::default() }
}

fn read(bytes: &[u8]) -> Result<Terrain, Error> {
    io::read_bytes(Format::Npy, bytes, &options())
}

fn said(bytes: &[u8], options: &Options) -> String {
    io::read_bytes(Format::Npy, bytes, options).unwrap_err().to_string()
}

/// A file of version 1.0 as numpy writes it.
fn npy(dtype: &str, is_fortran_order: bool, shape: &str, elements: &[u8]) -> Vec<u8> {
    let order = if is_fortran_order { "True" } else { "False" };
    let text = format!("{{'descr': '{dtype}', 'fortran_order': {order}, 'shape': {shape}, }}");
    let text = format!("{text:<117}\n");
    let length = (text.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], text.as_bytes(), elements].concat()
}

fn singles(heights_m: &[f32]) -> Vec<u8> {
    heights_m.iter().flat_map(|z| z.to_le_bytes()).collect()
}

/// Big-endian bytes of an element by dtype without byte order.
fn big_endian(dtype: &str, height_m: u8) -> Vec<u8> {
    match dtype {
        "f2" => f16::from_f32(f32::from(height_m)).to_be_bytes().to_vec(),
        "f4" => f32::from(height_m).to_be_bytes().to_vec(),
        "f8" => f64::from(height_m).to_be_bytes().to_vec(),
        whole => {
            let bytes: usize = whole[1..].parse().unwrap();
            [vec![0; bytes - 1], vec![height_m]].concat()
        }
    }
}

#[test]
fn every_dtype_and_order_is_the_same_ground_as_the_json_grid() {
    let json = serde_json::json!({
        "cell_size_m": 0.5, "origin_m": [10.0, -20.0], "crs": "EPSG:26915", "rows": 3, "columns": 4,
        "elevation_m": HEIGHTS_M.chunks(4).collect::<Vec<_>>()
    });
    let grid = io::read_bytes(Format::Json, json.to_string().as_bytes(), &Options::default()).unwrap();
    for dtype in ["f2", "f4", "f8", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"] {
        for (is_big_endian, is_fortran_order) in [(false, false), (false, true), (true, false), (true, true)]
        {
            let order: Vec<usize> = match is_fortran_order {
                true => (0..4).flat_map(|column| (0..3).map(move |row| 4 * row + column)).collect(),
                false => (0..12).collect(),
            };
            let element = |at: &usize| {
                let mut bytes = big_endian(dtype, HEIGHTS_M[*at]);
                if !is_big_endian {
                    bytes.reverse();
                }
                bytes
            };
            let elements: Vec<u8> = order.iter().flat_map(element).collect();
            let sign = if is_big_endian { ">" } else { "<" };
            let name = format!("{sign}{dtype}, Fortran order {is_fortran_order}");
            let terrain =
                read(&npy(&format!("{sign}{dtype}"), is_fortran_order, "(3, 4)", &elements)).unwrap();
            assert_eq!((terrain.grid, terrain.relative_m()), (GRID, grid.relative_m()), "{name}");
            if dtype.ends_with('1') {
                let warned = terrain.warnings().iter().any(|warning| warning.kind == WarningKind::Image);
                assert!(warned, "{name}: whole metres are too coarse");
            } else {
                assert_eq!(terrain.content_id(), grid.content_id(), "{name}");
            }
        }
    }
}

#[test]
fn row_0_is_the_southernmost_and_nan_is_unknown() {
    let mut heights_m = HEIGHTS_M.map(f32::from);
    heights_m[1] = f32::NAN;
    let terrain = read(&npy("<f4", false, "(3, 4)", &singles(&heights_m))).unwrap();
    assert_eq!(terrain.elevation_at_m(10.25, -19.75), Some(7.0), "the south-west corner");
    assert_eq!(terrain.elevation_m(Cell { row: 0, column: 1 }), None);
    assert_eq!(terrain.elevation_m(Cell { row: 2, column: 3 }), Some(31.0));
}

#[test]
fn files_that_numpy_wrote_are_read_by_their_ending() {
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds/terrain");
    let place = |row, column| Cell { row, column };
    for name in ["d.npy", "e.npy"] {
        let terrain = io::read_path_as(&seeds.join(name), &options()).unwrap();
        assert_eq!(terrain.grid, GRID);
        assert_eq!(terrain.elevation_m(place(2, 3)), Some(381.75), "{name}");
        assert_eq!(terrain.elevation_m(place(1, 2)), None, "{name}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("Dem.NPY");
    fs::copy(seeds.join("f.npy"), &path).unwrap();
    let terrain = io::read_path_as(&path, &options()).unwrap();
    assert_eq!(terrain.elevation_m(place(2, 3)), Some(387.0), "version 2.0");
    let said = io::read_path(&path).unwrap_err().to_string();
    assert!(said.contains("cell_size_m") && said.contains("--cell-size-m 0.5"), "{said}");
}

#[test]
fn an_array_that_breaks_off_anywhere_is_refused() {
    let good = npy("<f4", false, "(3, 4)", &singles(&HEIGHTS_M.map(f32::from)));
    assert!(read(&good).is_ok());
    for end in 0..good.len() {
        let message = read(&good[..end]).unwrap_err().to_string();
        let why = if end < 6 { "no numpy array" } else { "truncated" };
        assert!(message.contains(why), "{end} bytes: {message}");
    }
    let short = said(&good[..good.len() - 1], &options());
    assert!(short.contains("takes 176 bytes, but the file has 175"), "{short}");
    let two = [&good[..], &good].concat();
    assert!(said(&two, &options()).contains("176 bytes follow the array"));
}

#[test]
fn bad_arrays_and_frames_are_refused_with_what_mends_them() {
    let good = npy("<f4", false, "(3, 4)", &singles(&HEIGHTS_M.map(f32::from)));
    for (file, words) in [
        (npy("|O", false, "(3, 4)", b"\x80\x04K\x01."), "not unpickled"),
        (npy("<c16", false, "(3, 4)", &[]), "z.real"),
        (npy("|b1", false, "(3, 4)", &[]), "true or false"),
        (npy("<f4", false, "(12,)", &[]), "1 axis"),
        (npy("<f4", false, "(1, 3, 4)", &[]), "3 axes"),
        (npy("<f4", false, "(0, 4)", &[]), "rows is 0"),
        (npy("<f8", false, "(4000000000, 4000000000)", &[]), "4000000000 × 4000000000 cells"),
        (npy("<f8", true, "(9000, 9000)", &[]), "takes 648000128 bytes"),
        (npy("<f4", false, "(1, 2)", &singles(&[1.0, 123_456.0])), "z[0, 1] is 123456.0"),
        (npy("<f4", true, "(2, 2)", &singles(&[1.0, f32::INFINITY, 2.0, 3.0])), "z[1, 0] is inf"),
        (npy("<f4", false, "(1, 2)", &singles(&[f32::NAN, f32::NAN])), "no known cell"),
        (b"{\"rows\": 3}".to_vec(), "no numpy array"),
    ] {
        let message = said(&file, &options());
        assert!(message.contains(words), "{message}\n  lacks: {words}");
    }
    let structured = String::from_utf8_lossy(&good[6..118]).replace("'<f4'", "[('z', '<f4')]");
    let structured = [&good[..6], structured.as_bytes(), &good[118..]].concat();
    assert!(said(&structured, &options()).contains("z[\"elevation\"]"));

    let framed = |change: &dyn Fn(&mut Georeference)| {
        let mut options = options();
        change(&mut options.georeference);
        let error = io::read_bytes(Format::Npy, &good, &options).unwrap_err();
        (error.field().unwrap(), error.to_string())
    };
    for ((field, message), expected) in [
        (framed(&|frame| frame.cell_size_m = None), "cell_size_m"),
        (framed(&|frame| frame.cell_size_m = Some(-1.0)), "cell_size_m"),
        (framed(&|frame| frame.cell_size_m = Some(f64::NAN)), "cell_size_m"),
        (framed(&|frame| frame.origin_m = Some([0.0, f64::INFINITY])), "origin_m[1]"),
        (framed(&|frame| frame.crs = Some("EPSG:4326".into())), "crs"),
        (
            framed(&|frame| (frame.crs, frame.origin_m) = (Some("EPSG:3857".into()), Some([0.0, 8.4e6]))),
            "crs",
        ),
    ] {
        assert_eq!(field, expected, "{message}");
    }
    let small = Options { most_cells: 11, ..options() };
    assert!(said(&good, &small).contains("more than the 11"));
}

#[test]
fn the_frame_of_a_file_that_has_its_own_is_refused() {
    let asc = b"ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n";
    for (field, georeference) in [
        ("cell_size_m", Georeference { cell_size_m: Some(1.0), ..Georeference::default() }),
        ("origin_m", Georeference { origin_m: Some([0.0; 2]), ..Georeference::default() }),
        ("crs", Georeference { crs: Some("EPSG:26915".into()), ..Georeference::default() }),
    ] {
        let options = Options { georeference, ..Options::default() };
        for format in [Format::Ascii, Format::Json, Format::GeoTiff, Format::Cells] {
            assert_eq!(io::read_bytes(format, asc, &options).unwrap_err().field().as_deref(), Some(field));
        }
        let path = Path::new("no-such.tif");
        assert_eq!(io::read_path_as(path, &options).unwrap_err().field().as_deref(), Some(field));
    }
}

#[test]
fn nodata_is_unknown_whether_ground_has_it_or_not() {
    let heights: Vec<u8> = [60_000u16, 5, 6, 7].iter().flat_map(|z| z.to_le_bytes()).collect();
    let file = npy("<u2", false, "(2, 2)", &heights);
    assert!(said(&file, &options()).contains("z[0, 0] is 60000.0"));
    for (nodata_m, unknown) in [(60_000.0, vec![0]), (5.0, vec![1])] {
        let heights = [if unknown == [0] { 60_000u16 } else { 4 }, 5, 6, 7];
        let file =
            npy("<u2", false, "(2, 2)", &heights.iter().flat_map(|z| z.to_le_bytes()).collect::<Vec<_>>());
        let terrain = io::read_bytes(Format::Npy, &file, &Options { nodata_m: Some(nodata_m), ..options() });
        let terrain = terrain.unwrap();
        let found: Vec<usize> = (0..4).filter(|i| terrain.relative_m()[*i].is_nan()).collect();
        assert_eq!(found, unknown);
    }
}

/// Bytes that a header may hold, and some that it may not.
fn header_byte() -> impl Strategy<Value = u8> {
    prop_oneof![8 => prop::sample::select(&b"{}()[]'\":, descrfotanhpTFlseL<>|=0123456789iufO\\\n"[..]), 1 => any::<u8>()]
}

proptest! {
    #[test]
    fn any_change_of_a_file_is_read_or_refused(
        changes in prop::collection::vec((0..176usize, header_byte()), 1..6),
        end in 0..200usize,
    ) {
        let mut bytes = npy("<f4", false, "(3, 4)", &singles(&HEIGHTS_M.map(f32::from)));
        for (at, byte) in changes {
            bytes[at] = byte;
        }
        bytes.truncate(end.max(100));
        let small = Options { most_cells: 1 << 16, ..options() };
        let claimed = io::npy::claimed(&bytes);
        if let Ok(terrain) = io::npy::read(&bytes, &small) {
            prop_assert_eq!(terrain.grid.cells() as u64, claimed.unwrap());
        }
    }

    #[test]
    fn any_header_is_read_or_refused(text in prop::collection::vec(header_byte(), 0..200)) {
        let length = (text.len() as u32).to_le_bytes();
        let bytes = [b"\x93NUMPY\x03\x00", &length[..], &text].concat();
        let _ = io::npy::read(&bytes, &options());
    }

    #[test]
    fn shapes_of_any_size_are_refused_without_taking_room(rows in any::<u64>(), columns in any::<u64>()) {
        let bytes = npy(">f8", true, &format!("({rows}, {columns})"), &[0; 64]);
        prop_assert!(rows.checked_mul(columns) == Some(8) || io::npy::read(&bytes, &options()).is_err());
    }
}
