//! Maps lie where their coordinate reference system says, in metres of the ground, or are refused with the command that mends them.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::io::Cursor;

use terrain::{Cell, Terrain, io};
use tiff::{
    encoder::{TiffEncoder, colortype::Gray32Float},
    tags::Tag,
};

const US_FOOT_M: f64 = 1200.0 / 3937.0;
const GDAL_METADATA: u16 = 42112;

/// A GeoTIFF of 4 × 3 cells that rise by 1 eastwards and by 10 southwards from 100 in the north-west.
struct File {
    scale: [f64; 3],
    tie: [f64; 6],
    matrix: Option<[f64; 16]>,
    keys: Vec<u16>,
    doubles: Vec<f64>,
    text: &'static str,
    metadata: &'static str,
}

impl File {
    /// A file in the system with a code.
    fn epsg(code: u16) -> Self {
        File {
            scale: [2.0, 2.0, 0.0],
            tie: [0.0, 0.0, 0.0, 500_000.0, 5_400_000.0, 0.0],
            matrix: None,
            keys: vec![1024, 0, 1, 1, 3072, 0, 1, code],
            doubles: vec![],
            text: "",
            metadata: "",
        }
    }

    fn write(&self) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut file).unwrap();
        let mut image = encoder.new_image::<Gray32Float>(4, 3).unwrap();
        let tags = image.encoder();
        match &self.matrix {
            Some(matrix) => tags.write_tag(Tag::ModelTransformationTag, &matrix[..]).unwrap(),
            None => {
                tags.write_tag(Tag::ModelPixelScaleTag, &self.scale[..]).unwrap();
                tags.write_tag(Tag::ModelTiepointTag, &self.tie[..]).unwrap();
            }
        }
        let directory = [&[1, 1, 0, self.keys.len() as u16 / 4][..], &self.keys].concat();
        tags.write_tag(Tag::GeoKeyDirectoryTag, &directory[..]).unwrap();
        if !self.doubles.is_empty() {
            tags.write_tag(Tag::GeoDoubleParamsTag, &self.doubles[..]).unwrap();
        }
        if !self.text.is_empty() {
            tags.write_tag(Tag::GeoAsciiParamsTag, self.text).unwrap();
        }
        if !self.metadata.is_empty() {
            tags.write_tag(Tag::from_u16_exhaustive(GDAL_METADATA), self.metadata).unwrap();
        }
        let samples: Vec<f32> = (0..12).map(|i| 100.0 + (i % 4 + i / 4 * 10) as f32).collect();
        image.write_data(&samples).unwrap();
        file.into_inner()
    }

    fn read(&self) -> Terrain {
        io::geotiff::read(&self.write(), 1000).unwrap()
    }

    fn refused(&self) -> String {
        io::geotiff::read(&self.write(), 1000).unwrap_err().to_string()
    }
}

fn height_m(terrain: &Terrain, row: usize, column: usize) -> f64 {
    terrain.elevation_m(Cell { row, column }).unwrap()
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-6 * expected.abs().max(1.0), "{found}, not {expected}");
}

#[test]
fn a_map_in_metres_keeps_its_system_and_needs_no_note() {
    let terrain = File::epsg(32632).read();
    assert_eq!(terrain.crs.as_deref(), Some("EPSG:32632"));
    assert_eq!(terrain.warnings(), []);
    assert_eq!((terrain.grid.cell_size_m, terrain.grid.origin_m), (2.0, [500_000.0, 5_399_994.0]));
}

#[test]
fn feet_become_metres_whether_a_key_or_the_code_says_so() {
    let long_island = [980_000.0, 200_000.0];
    for (file, [x, y]) in [
        (File::epsg(2263), long_island),
        (
            File { keys: [File::epsg(32632).keys, vec![3076, 0, 1, 9003]].concat(), ..File::epsg(0) },
            [1_640_000.0, 17_700_000.0],
        ),
        (
            File {
                keys: [File::epsg(32767).keys, vec![3076, 0, 1, 32767, 3077, 34736, 1, 0]].concat(),
                doubles: vec![US_FOOT_M],
                ..File::epsg(0)
            },
            long_island,
        ),
    ] {
        let terrain = File { tie: [0.0, 0.0, 0.0, x, y, 0.0], ..file }.read();
        near(terrain.grid.cell_size_m, 2.0 * US_FOOT_M);
        near(terrain.grid.origin_m[0], x * US_FOOT_M);
        near(height_m(&terrain, 0, 0), 120.0);
        assert!(
            terrain.warnings().iter().any(|warning| warning.detail.contains("unit of its heights")),
            "{:?}",
            terrain.warnings()
        );
    }
    let keys = [File::epsg(2263).keys, vec![3076, 0, 1, 9001]].concat();
    let both = File { keys, tie: [0.0, 0.0, 0.0, 300_000.0, 60_000.0, 0.0], ..File::epsg(0) }.read();
    near(both.grid.cell_size_m, 2.0);
    assert!(both.warnings()[0].detail.contains("EPSG:2263"), "{:?}", both.warnings());
}

#[test]
fn heights_have_the_unit_of_their_band_their_key_or_their_vertical_system() {
    let keyed = |keys: Vec<u16>| File { keys: [File::epsg(26915).keys, keys].concat(), ..File::epsg(0) };
    let unit = "<GDALMetadata><Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">US survey foot</Item></GDALMetadata>";
    for file in [
        keyed(vec![4096, 0, 1, 6360]),
        keyed(vec![4099, 0, 1, 9003]),
        File { metadata: unit, ..keyed(vec![]) },
    ] {
        let terrain = file.read();
        near(height_m(&terrain, 0, 0), 120.0 * US_FOOT_M);
        assert_eq!(terrain.grid.cell_size_m, 2.0);
        assert_eq!(terrain.warnings(), []);
    }
    near(height_m(&keyed(vec![4096, 0, 1, 8228]).read(), 0, 0), 120.0 * 0.3048);
    near(height_m(&keyed(vec![4096, 0, 1, 5703]).read(), 0, 0), 120.0);
    let disputed = File { metadata: unit, ..keyed(vec![4096, 0, 1, 5703]) }.read();
    near(height_m(&disputed, 0, 0), 120.0 * US_FOOT_M);
    assert!(disputed.warnings()[0].detail.contains("US survey foot"), "{:?}", disputed.warnings());
    assert!(keyed(vec![4096, 0, 1, 5715]).refused().contains("depths"));
}

#[test]
fn scale_and_offset_come_before_the_unit() {
    let metadata = "<GDALMetadata>\n<Item name=\"SCALE\" sample=\"0\" role=\"scale\">0.1</Item>\
        <Item name=\"OFFSET\" sample=\"0\" role=\"offset\">50</Item>\
        <Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">ft</Item></GDALMetadata>";
    near(height_m(&File { metadata, ..File::epsg(32632) }.read(), 0, 3), (12.3 + 50.0) * 0.3048);
}

#[test]
fn degrees_are_refused_with_the_command_for_their_zone() {
    let degrees = File { tie: [0.0, 0.0, 0.0, -93.9, 46.5, 0.0], scale: [1e-4, 1e-4, 0.0], ..File::epsg(0) };
    // Nothing says that they are degrees; a datum of its own; ED50; a system that is not named.
    for keys in [
        vec![],
        vec![1024, 0, 1, 2, 2048, 0, 1, 32767],
        vec![1024, 0, 1, 2, 2048, 0, 1, 4230],
        vec![1024, 0, 1, 2],
    ] {
        let said = File { keys, ..degrees.clone() }.refused();
        assert!(said.contains("degrees") && said.contains("-t_srs EPSG:32615 "), "{said}");
    }
    let grads = vec![1024, 0, 1, 2, 2048, 0, 1, 4326, 2054, 0, 1, 9105];
    let said = File { keys: grads, ..degrees.clone() }.refused();
    assert!(said.contains("GeogAngularUnitsGeoKey") && said.contains("9105"), "{said}");
    let large = File { scale: [0.25, 0.25, 0.0], keys: vec![], ..degrees.clone() }.read();
    assert!(large.warnings()[0].detail.contains("degrees"), "{:?}", large.warnings());
    let local = File {
        tie: [0.0, 0.0, 0.0, -0.1, 0.1, 0.0],
        scale: [0.05, 0.05, 0.0],
        keys: vec![],
        ..File::epsg(0)
    };
    for metres in [File { keys: vec![], ..File::epsg(0) }, local] {
        assert_eq!(metres.read().warnings(), [], "far from degrees, or a local frame about its origin");
    }
}

#[test]
fn degrees_that_are_named_are_warped_and_count_for_both_grids() {
    let degrees = File { tie: [0.0, 0.0, 0.0, -93.9, 46.5, 0.0], scale: [1e-4, 1e-4, 0.0], ..File::epsg(0) };
    for keys in [
        vec![1024, 0, 1, 2, 2048, 0, 1, 4326],
        vec![2048, 0, 1, 4269],
        vec![1024, 0, 1, 1, 3072, 0, 1, 4326],
        vec![1024, 0, 1, 2, 2048, 0, 1, 4979, 2054, 0, 1, 9102, 4096, 0, 1, 5773],
    ] {
        let file = File { keys, ..degrees.clone() };
        let terrain = file.read();
        assert_eq!(terrain.crs.as_deref(), Some("EPSG:32615"));
        // Rows come from the north: heights rise southwards.
        let [x_m, y_m] = terrain.earth().unwrap().place_m([-93.899_75, 46.499_85]).unwrap();
        assert!((terrain.elevation_at_m(x_m, y_m).unwrap() - 112.0).abs() < 0.5);
        let cells = io::geotiff::cells(&file.write()).unwrap();
        assert_eq!(cells, 12 + terrain.grid.cells() as u64, "memory is asked for on both sides");
    }
    let feet = vec![1024, 0, 1, 2, 2048, 0, 1, 4326, 4096, 0, 1, 6360];
    let in_feet = File { keys: feet, ..degrees.clone() }.read();
    near(in_feet.base_m(), 100.0 * US_FOOT_M);
    let mut turned = [0.0; 16];
    [turned[0], turned[1], turned[3]] = [1e-4, 2e-5, -93.9];
    [turned[4], turned[5], turned[7], turned[15]] = [2e-5, -1e-4, 46.5, 1.0];
    let keys = vec![1024, 0, 1, 2, 2048, 0, 1, 4326];
    let said = File { matrix: Some(turned), keys, ..degrees }.refused();
    assert!(said.contains("turned against north") && said.contains("-t_srs EPSG:32615 "), "{said}");
}

impl Clone for File {
    fn clone(&self) -> Self {
        File { keys: self.keys.clone(), doubles: self.doubles.clone(), ..*self }
    }
}

#[test]
fn a_mercator_is_brought_to_the_ground_or_refused_where_one_scale_does_not_do() {
    let north = [0.0, 0.0, 0.0, 1_113_194.9, 8_399_737.9, 0.0];
    let mercator = |keys: Vec<u16>| File { tie: north, keys, ..File::epsg(0) };
    let citation = "Google Maps Global Mercator|";
    for file in [
        mercator(vec![1024, 0, 1, 1, 3072, 0, 1, 3857]),
        mercator(vec![1024, 0, 1, 1, 3072, 0, 1, 3785]),
        mercator(vec![1024, 0, 1, 1, 3072, 0, 1, 3395]),
        mercator(vec![1024, 0, 1, 1, 3072, 0, 1, 41001]),
        File {
            text: citation,
            ..mercator(vec![1024, 0, 1, 1, 1026, 34737, 28, 0, 3072, 0, 1, 32767, 3075, 0, 1, 7])
        },
    ] {
        let terrain = file.read();
        assert!((terrain.grid.cell_size_m - 1.0).abs() < 0.01, "{}", terrain.grid.cell_size_m);
        assert!(
            terrain.warnings().iter().any(|warning| warning.detail.contains("m of ground")),
            "{:?}",
            terrain.warnings()
        );
        assert_ne!(terrain.crs.as_deref(), Some("EPSG:3857"), "its coordinates are others now");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wide.asc");
    let header = "ncols 500\nnrows 500\nxllcorner 1113194.9\nyllcorner 8399737.9\ncellsize 100\n";
    std::fs::write(&path, header.to_owned() + &"1 ".repeat(250_000)).unwrap();
    std::fs::write(path.with_extension("prj"), "EPSG:3857").unwrap();
    let refused = io::read_path(&path).unwrap_err().to_string();
    assert!(refused.contains("-t_srs EPSG:32632") && refused.contains("in.asc"), "{refused}");
}

#[test]
fn frames_from_the_south_are_cells_and_turned_or_oblong_ones_are_interpolated() {
    let matrix = |column: [f64; 2], row: [f64; 2]| {
        let mut matrix = [0.0; 16];
        [matrix[0], matrix[4]] = column;
        [matrix[1], matrix[5]] = row;
        [matrix[3], matrix[7], matrix[15]] = [500_000.0, 5_400_000.0, 1.0];
        File { matrix: Some(matrix), ..File::epsg(32632) }
    };
    let south_up = matrix([2.0, 0.0], [0.0, 2.0]).read();
    assert_eq!(south_up.grid.origin_m, [500_000.0, 5_400_000.0]);
    assert_eq!((height_m(&south_up, 0, 0), height_m(&south_up, 2, 3)), (100.0, 123.0));
    assert_eq!(south_up.warnings(), []);
    let oblong = matrix([2.0, 0.0], [0.0, -3.0]).read();
    near(oblong.grid.cell_size_m, 6.0f64.sqrt());
    assert!(
        oblong.warnings()[0].detail.contains("oblong")
            && oblong.warnings()[0].detail.contains("interpolated"),
        "{:?}",
        oblong.warnings()
    );
    // A quarter turn: columns run north, rows east.
    let turned = matrix([0.0, 2.0], [2.0, 0.0]).read();
    assert_eq!((turned.grid.rows, turned.grid.columns), (4, 3));
    assert_eq!(
        (height_m(&turned, 0, 0), height_m(&turned, 0, 2), height_m(&turned, 3, 0)),
        (100.0, 120.0, 103.0)
    );
    assert!(turned.warnings()[0].detail.contains("turned"), "{:?}", turned.warnings());
    assert!(matrix([2.0, 0.0], [4.0, 0.0]).refused().contains("pixel size"));
}

#[test]
fn a_prj_beside_an_ascii_grid_places_it() {
    let folder = tempfile::tempdir().unwrap();
    let asc =
        |cell: f64| format!("ncols 2\nnrows 2\nxllcorner 9.5\nyllcorner 48\ncellsize {cell}\n1 2\n3 4\n");
    let path = folder.path().join("map.asc");
    let read = |cell: f64, prj: &str| {
        std::fs::write(&path, asc(cell)).unwrap();
        std::fs::write(path.with_extension("prj"), prj).unwrap();
        io::read_path(&path)
    };
    let utm = read(1.0, "Projection UTM\nZone 32\nDatum WGS84\nUnits METERS\n").unwrap();
    assert_eq!(utm.crs.as_deref(), Some("EPSG:32632"));
    let feet = read(
        1.0,
        "PROJCS[\"x\",GEOGCS[\"y\"],PROJECTION[\"Lambert_Conformal_Conic\"],UNIT[\"Foot_US\",0.3048006096012192]]",
    );
    near(feet.unwrap().grid.cell_size_m, US_FOOT_M);
    let degrees = "GEOGCS[\"GCS_WGS_1984\",UNIT[\"Degree\",0.0174532925199433]]";
    assert_eq!(read(1e-4, degrees).unwrap().crs.as_deref(), Some("EPSG:32632"));
    let coarse = read(0.5, degrees).unwrap_err().to_string();
    assert!(coarse.contains("cells of 0.5°") && coarse.contains("0.01 to 100 m"), "{coarse}");
    let ed50 = "GEOGCS[\"GCS_European_1950\",DATUM[\"D_European_1950\"],UNIT[\"Degree\",0.0174532925199433]]";
    let refused = read(1e-4, ed50).unwrap_err().to_string();
    assert!(refused.contains("D_European_1950") && refused.contains("-t_srs EPSG:32632 "), "{refused}");
    assert_eq!(read(1.0, "nothing that anyone knows").unwrap().crs, None);
}
