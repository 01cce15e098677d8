//! Maps in systems without a code have their place on earth, and areas in the map's own system or another one lie where they say.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::io::Cursor;

use serde_json::json;
use terrain::{
    Grid, Terrain,
    areas::Areas,
    crs::{Earth, EarthError},
    io,
};
use tiff::{
    encoder::{TiffEncoder, colortype::Gray32Float},
    tags::Tag,
};

/// A GeoTIFF of 4 × 3 cells of a metre whose north-west corner lies at a place, with keys and their doubles.
fn geotiff(place: [f64; 2], keys: &[[u16; 4]], doubles: &[f64]) -> Terrain {
    let mut file = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut file).unwrap();
    let mut image = encoder.new_image::<Gray32Float>(4, 3).unwrap();
    let tags = image.encoder();
    tags.write_tag(Tag::ModelPixelScaleTag, &[1.0, 1.0, 0.0][..]).unwrap();
    tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, place[0], place[1], 0.0][..]).unwrap();
    let head = [1, 1, 0, keys.len() as u16];
    let directory: Vec<u16> = head.into_iter().chain(keys.iter().flatten().copied()).collect();
    tags.write_tag(Tag::GeoKeyDirectoryTag, &directory[..]).unwrap();
    if !doubles.is_empty() {
        tags.write_tag(Tag::GeoDoubleParamsTag, doubles).unwrap();
    }
    image.write_data(&[1.0f32; 12]).unwrap();
    io::geotiff::read(&file.into_inner(), 1000).unwrap()
}

const PLACE_M: [f64; 2] = [512_000.0, 5_423_000.0];

/// Keys of a transverse Mercator of the file's own on a geographic system.
fn transverse(geographic: u16) -> (Vec<[u16; 4]>, Vec<f64>) {
    let double = |key: u16, at: u16| [key, 34736, 1, at];
    let short = |key: u16, value: u16| [key, 0, 1, value];
    let keys = vec![
        short(1024, 1),
        short(2048, geographic),
        short(3072, 32767),
        short(3074, 32767),
        short(3075, 1),
        short(3076, 9001),
        double(3080, 0),
        double(3081, 1),
        double(3082, 2),
        double(3083, 1),
        double(3092, 3),
    ];
    (keys, vec![9.0, 0.0, 500_000.0, 0.9996])
}

#[test]
fn a_projection_by_keys_lies_where_its_parameters_say() {
    let utm_32: Vec<[u16; 4]> = [[1024, 1], [2048, 4326], [3072, 32767], [3074, 16032], [3076, 9001]]
        .map(|[key, value]| [key, 0, 1, value])
        .into();
    let (own, doubles) = transverse(4326);
    let wanted = Earth::of("EPSG:32632").unwrap().place_deg(PLACE_M).unwrap();
    for (keys, doubles) in [(utm_32, vec![]), (own, doubles)] {
        let terrain = geotiff(PLACE_M, &keys, &doubles);
        let found = terrain.earth().unwrap().place_deg(PLACE_M).unwrap();
        assert!((0..2).all(|axis| (found[axis] - wanted[axis]).abs() < 1e-9), "{found:?}");
        assert_eq!(terrain.warnings(), []);
    }
}

#[test]
fn a_datum_that_is_not_wgs_84_and_a_method_that_is_not_known_are_named() {
    // European Datum 1950, some hundred metres from WGS 84.
    let (keys, doubles) = transverse(4230);
    let error = geotiff(PLACE_M, &keys, &doubles).earth().err().unwrap();
    assert!(matches!(error, EarthError::OwnDatum { .. }), "{error}");
    let gnomonic: Vec<[u16; 4]> =
        keys.iter().map(|key| if key[0] == 3075 { [3075, 0, 1, 19] } else { *key }).collect();
    let terrain = geotiff(PLACE_M, &gnomonic, &doubles);
    assert!(
        terrain.warnings()[0].detail.contains("gnomonic) is not computed here"),
        "{:?}",
        terrain.warnings()
    );
    let said = terrain.earth().err().unwrap().to_string();
    assert!(said.contains("no projection that is known here") && !said.contains("has no crs"), "{said}");
}

/// Level ground of 40 × 40 cells of a metre with its south-west corner at a place.
fn level(crs: &str, origin_m: [f64; 2]) -> Terrain {
    let grid = Grid { rows: 40, columns: 40, cell_size_m: 1.0, origin_m };
    let mut terrain = Terrain::new(grid, &[0.0; 1600]).unwrap();
    terrain.crs = Some(crs.to_owned());
    terrain
}

/// Corners of an area that has them in the unit of a system, as the map has them [m].
fn corners_m(terrain: &Terrain, system: &str, corners: [[f64; 2]; 3]) -> Vec<[f64; 2]> {
    let document = json!({"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": system}},
        "features": [{"type": "Feature", "properties": {"keep_out": true}, "geometry": {"type": "Polygon", "coordinates": [corners]}}]});
    let metres = Areas::of(&document, terrain).unwrap().in_map_metres();
    let ring = metres["features"][0]["geometry"]["coordinates"][0].as_array().unwrap();
    ring.iter().take(3).map(|at| [0, 1].map(|axis| at[axis].as_f64().unwrap())).collect()
}

const FOOT_M: f64 = 1200.0 / 3937.0;

fn assert_near(found: &[[f64; 2]], wanted: [[f64; 2]; 3]) {
    let off_m = found.iter().zip(wanted).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max);
    assert!(off_m < 1e-3, "{found:?} instead of {wanted:?}");
}

#[test]
fn areas_in_the_maps_own_feet_are_feet() {
    // NAD27 of Texas is placed by a grid of corrections alone.
    for (crs, unit_m) in [("EPSG:2263", FOOT_M), ("EPSG:32040", FOOT_M), ("EPSG:27700", 1.0)] {
        let terrain = level(crs, [300_000.0, 60_000.0]);
        let wanted = [[300_010.0, 60_010.0], [300_020.0, 60_010.0], [300_020.0, 60_020.0]];
        let feet = wanted.map(|at| at.map(|at_m| at_m / unit_m));
        for name in [
            crs.to_owned(),
            crs.replace("EPSG:", "urn:ogc:def:crs:EPSG::"),
            crs.replace("EPSG:", "urn:ogc:def:crs:EPSG:9.9:"),
        ] {
            assert_near(&corners_m(&terrain, &name, feet), wanted);
        }
    }
}

#[test]
fn areas_in_the_system_that_was_multiplied_are_multiplied_likewise() {
    let text =
        "PROJCS[\"EPSG:3857 times 0.67\",GEOGCS[\"g\"],PROJECTION[\"custom_proj4\"],UNIT[\"metre\",1]]";
    let of_each_axis = "LOCAL_CS[\"EPSG:3857 times 0.67 and 0.668\",UNIT[\"metre\",1]]";
    let web = [[1_113_200.0, 6_106_860.0], [1_113_210.0, 6_106_860.0], [1_113_210.0, 6_106_870.0]];
    for (crs, by) in [(text, [0.67, 0.67]), (of_each_axis, [0.67, 0.668])] {
        let wanted = web.map(|[x, y]| [x * by[0], y * by[1]]);
        let terrain = level(crs, [wanted[0][0] - 10.0, wanted[0][1] - 10.0]);
        assert_near(&corners_m(&terrain, "urn:ogc:def:crs:EPSG::3857", web), wanted);
        let degrees = web.map(|at| Earth::of("EPSG:3857").unwrap().place_deg(at).unwrap());
        assert_near(&corners_m(&terrain, "urn:ogc:def:crs:OGC:1.3:CRS84", degrees), wanted);
    }
}

#[test]
fn areas_in_feet_of_another_system_lie_where_these_feet_do() {
    let long_island = Earth::of("EPSG:2263").unwrap();
    let utm = Earth::of("EPSG:32618").unwrap();
    let feet = [[984_250.0, 197_000.0], [984_300.0, 197_000.0], [984_300.0, 197_050.0]];
    let wanted =
        feet.map(|at| utm.place_m(long_island.place_deg(at.map(|feet| feet * FOOT_M)).unwrap()).unwrap());
    let terrain = level("EPSG:32618", [wanted[0][0] - 5.0, wanted[0][1] - 5.0]);
    assert_near(&corners_m(&terrain, "EPSG:2263", feet), wanted);
}
