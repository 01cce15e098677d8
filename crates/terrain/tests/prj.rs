//! What the `.prj` beside an ASCII grid says of units and heights is honoured as in a GeoTIFF, and what cannot be used of it is said.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;

use terrain::{Cell, Terrain, WarningKind, io};

const US_FOOT_M: f64 = 1200.0 / 3937.0;
const UTM: &str = r#"PROJCS["WGS 84 / UTM zone 32N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],UNIT["metre",1],AUTHORITY["EPSG","32632"]]"#;
const LONG_ISLAND: &str = r#"PROJCS["NAD_1983_StatePlane_New_York_Long_Island_FIPS_3104_Feet",GEOGCS["GCS_North_American_1983",DATUM["D_North_American_1983",SPHEROID["GRS_1980",6378137.0,298.257222101]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Lambert_Conformal_Conic"],PARAMETER["False_Easting",984250.0],PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",-74.0],PARAMETER["Standard_Parallel_1",40.66666666666666],PARAMETER["Standard_Parallel_2",41.03333333333333],PARAMETER["Latitude_Of_Origin",40.16666666666666],UNIT["Foot_US",0.3048006096012192]]"#;

/// Reads a grid of four cells, the south-west one of 300, with files beside it.
fn read_beside(cell: f64, corner: [f64; 2], beside: &[(&str, &[u8])]) -> Result<Terrain, terrain::Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.asc");
    let [x, y] = corner;
    let text = format!("ncols 2\nnrows 2\nxllcorner {x}\nyllcorner {y}\ncellsize {cell}\n301 302\n300 303\n");
    fs::write(&path, text).unwrap();
    for (name, bytes) in beside {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    io::read_path(&path)
}

fn read(prj: &str) -> Result<Terrain, terrain::Error> {
    read_beside(1.0, [512_000.0, 5_000_000.0], &[("a.prj", prj.as_bytes())])
}

fn lowest_m(terrain: &Terrain) -> f64 {
    terrain.elevation_m(Cell { row: 0, column: 0 }).unwrap()
}

fn said(terrain: &Terrain, kind: WarningKind) -> Option<&str> {
    terrain.warnings().iter().find(|warning| warning.kind == kind).map(|warning| warning.detail.as_str())
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-6 * expected.abs(), "{found}, not {expected}");
}

#[test]
fn heights_become_metres_by_every_way_in_which_a_vertical_system_is_written() {
    let compound = |vertical: &str| format!(r#"COMPD_CS["both",{UTM},{vertical}]"#);
    let wkt_2 = r#"COMPOUNDCRS["both",PROJCRS["x",BASEGEOGCRS["y"],CONVERSION["UTM zone 32N",METHOD["Transverse Mercator"]],CS[Cartesian,2],AXIS["(E)",east],LENGTHUNIT["metre",1],ID["EPSG",32632]],VERTCRS["v",VDATUM["d"],CS[vertical,1],AXIS["gravity-related height (H)",up,LENGTHUNIT["foot",0.3048]]]]"#;
    for (prj, unit_m) in [
        ("EPSG:32632+6360".to_owned(), US_FOOT_M),
        ("EPSG:32632+8228".to_owned(), 0.3048),
        ("EPSG:32632+5703".to_owned(), 1.0),
        (
            compound(
                r#"VERT_CS["NAVD88 height (ftUS)",VERT_DATUM["NAVD88",2005],UNIT["US survey foot",0.304800609601219],AXIS["Up",UP],AUTHORITY["EPSG","6360"]]"#,
            ),
            US_FOOT_M,
        ),
        (
            format!(
                r#"{UTM},VERTCS["NAVD88_height_(ftUS)",VDATUM["NAVD88"],PARAMETER["Vertical_Shift",0.0],PARAMETER["Direction",1.0],UNIT["Foot_US",0.3048006096012192]]"#
            ),
            US_FOOT_M,
        ),
        (wkt_2.to_owned(), 0.3048),
        (
            "Projection UTM\nDatum WGS84\nZunits FEET\nUnits METERS\nZone 32\nParameters\n".to_owned(),
            US_FOOT_M,
        ),
        ("+proj=utm +zone=32 +datum=WGS84 +vunits=us-ft".to_owned(), US_FOOT_M),
    ] {
        let terrain = read(&prj).unwrap();
        near(lowest_m(&terrain), 300.0 * unit_m);
        assert_eq!(
            (terrain.grid.cell_size_m, terrain.grid.origin_m),
            (1.0, [512_000.0, 5_000_000.0]),
            "{prj}"
        );
        assert_eq!(terrain.warnings(), [], "{prj}");
    }
}

#[test]
fn depths_are_refused_however_they_are_written() {
    for prj in [
        "EPSG:32632+5715".to_owned(),
        format!(
            r#"{UTM},VERTCS["MSL_Depth",VDATUM["MSL"],PARAMETER["Vertical_Shift",0.0],PARAMETER["Direction",-1.0],UNIT["Meter",1.0]]"#
        ),
        format!(
            r#"COMPD_CS["both",{UTM},VERT_CS["MSL depth",VERT_DATUM["MSL",2005],UNIT["metre",1],AXIS["Depth",DOWN]]]"#
        ),
    ] {
        let refused = read(&prj).unwrap_err().to_string();
        assert!(refused.contains("depths") && refused.contains("in.asc"), "{refused}");
    }
}

#[test]
fn heights_of_a_grid_in_degrees_have_their_unit_too() {
    let degrees = read_beside(1e-4, [-93.9, 46.5], &[("a.prj", b"EPSG:4269+6360")]).unwrap();
    assert_eq!(degrees.crs.as_deref(), Some("EPSG:32615"));
    near(degrees.base_m(), 300.0 * US_FOOT_M);
    let depths = read_beside(1e-4, [-93.9, 46.5], &[("a.prj", b"EPSG:4269+5715")]).unwrap_err().to_string();
    assert!(depths.contains("depths"), "{depths}");
}

#[test]
fn heights_without_a_unit_are_doubted_where_coordinates_are_in_feet() {
    let terrain = read_beside(1.0, [980_000.0, 200_000.0], &[("a.prj", LONG_ISLAND.as_bytes())]).unwrap();
    near(lowest_m(&terrain), 300.0);
    near(terrain.grid.cell_size_m, US_FOOT_M);
    let said = said(&terrain, WarningKind::AssumedHeightUnit).unwrap();
    assert!(said.contains("US survey foot") && said.contains("gdal_translate"), "{said}");
}

#[test]
fn a_file_is_found_and_read_whatever_its_case_and_encoding() {
    let wide = |from: fn(u16) -> [u8; 2]| {
        let text = format!("\u{feff}{LONG_ISLAND}");
        text.encode_utf16().flat_map(from).collect::<Vec<u8>>()
    };
    // A letter of Latin 1, which is no UTF-8.
    let mut latin = LONG_ISLAND.as_bytes().to_vec();
    latin[9] = 0xe9;
    for (name, bytes) in [
        ("a.Prj", LONG_ISLAND.as_bytes().to_vec()),
        ("A.PRJ", LONG_ISLAND.as_bytes().to_vec()),
        ("a.asc.prj", LONG_ISLAND.as_bytes().to_vec()),
        ("a.prj", wide(u16::to_le_bytes)),
        ("a.prj", wide(u16::to_be_bytes)),
        ("a.prj", [b"\xef\xbb\xbf", LONG_ISLAND.as_bytes()].concat()),
        ("a.prj", latin),
        ("a.prj", b"+proj=lcc +lat_1=41.03 +lat_2=40.66 +lat_0=40.16 +lon_0=-74 +x_0=300000 +datum=NAD83 +units=us-ft".to_vec()),
        ("a.prj", b"Projection STATEPLANE\nFipszone 3104\nDatum NAD83\nUnits 3.2808333333\nParameters\n".to_vec()),
    ] {
        let terrain = read_beside(3.0, [980_000.0, 200_000.0], &[(name, &bytes)]).unwrap();
        near(terrain.grid.cell_size_m, 3.0 * US_FOOT_M);
        assert_eq!(said(&terrain, WarningKind::BesideFile), None, "{name}");
    }
}

#[test]
fn a_file_that_is_not_understood_is_named_with_what_is_wrong() {
    let json = r#"{"type": "ProjectedCRS", "id": {"authority": "EPSG", "code": 2263}}"#;
    for (prj, why) in [
        (&b""[..], "it is empty"),
        (b" \n", "it is empty"),
        (b"nothing that anyone knows", "what begins `nothing that"),
        (json.as_bytes(), "PROJJSON"),
        (b"\xff\xfe\x00\xd8\x00\xd8", "broken UTF-16"),
        (b"VERT_CS[\"NAVD88 height\",UNIT[\"metre\",1]]", "what begins `VERT_CS["),
        (b"Projection UTM\nZone 33\nDatum WGS84\nYshift 7\n", "what begins `Projection UTM"),
    ] {
        let terrain = read_beside(1.0, [512_000.0, 5e6], &[("a.prj", prj)]).unwrap();
        let said = said(&terrain, WarningKind::BesideFile).unwrap();
        assert!(said.contains("a.prj") && said.contains(why) && said.contains("gdalsrsinfo"), "{said}");
        assert_eq!(terrain.crs, None);
    }
    let furlongs =
        read("PROJCS[\"x\",GEOGCS[\"y\"],PROJECTION[\"Transverse_Mercator\"],UNIT[\"furlong\"]]").unwrap();
    assert!(said(&furlongs, WarningKind::BesideFile).unwrap().contains("no unit that is known"));
}

#[test]
fn of_two_files_that_differ_one_is_followed_and_the_other_named() {
    let both = |other: &str| {
        let beside = [("a.prj", UTM.as_bytes()), ("a.asc.prj", other.as_bytes())];
        read_beside(1.0, [512_000.0, 5e6], &beside).unwrap()
    };
    assert_eq!(both(UTM).warnings(), []);
    let differing = both(LONG_ISLAND);
    assert_eq!(differing.crs.as_deref(), Some("EPSG:32632"));
    assert!(said(&differing, WarningKind::BesideFile).unwrap().contains("a.asc.prj"));
}

#[test]
fn the_size_of_cells_is_checked_in_metres() {
    let read = |cell: f64| read_beside(cell, [980_000.0, 200_000.0], &[("a.prj", LONG_ISLAND.as_bytes())]);
    near(read(150.0).unwrap().grid.cell_size_m, 150.0 * US_FOOT_M);
    let refused = read(400.0).unwrap_err().to_string();
    assert!(refused.contains("121.9"), "{refused}");
    assert!(read(0.02).unwrap_err().to_string().contains("0.006"));
    let kilometres = "+proj=utm +zone=32 +datum=WGS84 +units=km";
    let fine = read_beside(0.005, [512.0, 5000.0], &[("a.prj", kilometres.as_bytes())]).unwrap();
    assert_eq!((fine.grid.cell_size_m, fine.grid.origin_m), (5.0, [512_000.0, 5_000_000.0]));
}
