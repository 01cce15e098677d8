//! Maps in projections whose metres are not metres of the ground are brought to the ground, or refused with what mends them.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;

use terrain::{Error, Terrain, Warning, WarningKind, crs::Earth, io};

const WGS_84: &str = r#"GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]]"#;

/// A grid of 80 × 80 cells of 2 m about a place in a system.
fn read(prj: &str, [x_m, y_m]: [f64; 2]) -> Result<Terrain, Error> {
    read_cells(prj, [x_m, y_m], 80, 2.0)
}

fn read_cells(prj: &str, [x_m, y_m]: [f64; 2], side: usize, cell_m: f64) -> Result<Terrain, Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.asc");
    let half_m = side as f64 * cell_m / 2.0;
    let corner = [x_m - half_m, y_m - half_m];
    let header = format!(
        "ncols {side}\nnrows {side}\nxllcorner {}\nyllcorner {}\ncellsize {cell_m}\n",
        corner[0], corner[1]
    );
    fs::write(&path, header + &"5 ".repeat(side * side)).unwrap();
    fs::write(path.with_extension("prj"), prj).unwrap();
    io::read_path(&path)
}

fn json(crs: &str, [x_m, y_m]: [f64; 2]) -> Result<Terrain, Error> {
    let text = serde_json::json!({"cell_size_m": 1, "origin_m": [x_m, y_m], "rows": 1, "columns": 2, "elevation_m": [[1, 2]], "crs": crs});
    io::json::read(&text.to_string())
}

fn scale_said(terrain: &Terrain) -> Option<&Warning> {
    terrain.warnings().iter().find(|warning| warning.kind == WarningKind::ProjectionScale)
}

#[test]
fn conformal_maps_are_multiplied_by_their_scale_and_stay_where_they_are_on_earth() {
    // Places and scales (map by ground) by PROJ 9.5.
    for (code, place_m, place_deg, by_proj) in [
        (5041, [2_591_424.98, -1_354_137.74], [10.0, 60.0], 1.065_302),
        (3413, [0.0, -3_323_160.27], [-45.0, 60.0], 1.039_428),
        (3031, [-2_457_024.46, 1_595_610.34], [-57.0, -63.5], 1.026_667),
    ] {
        let name = format!("EPSG:{code}");
        let terrain = read(&name, place_m).unwrap();
        assert!((terrain.grid.cell_size_m * by_proj / 2.0 - 1.0).abs() < 1e-5, "{name}: {:?}", terrain.grid);
        assert!(scale_said(&terrain).unwrap().detail.contains(&name));
        let middle_m = [0, 1].map(|axis| terrain.grid.origin_m[axis] + 40.0 * terrain.grid.cell_size_m);
        let earth = terrain.earth().unwrap();
        let found_deg = earth.place_deg(middle_m).unwrap();
        assert!((0..2).all(|axis| (found_deg[axis] - place_deg[axis]).abs() < 1e-6), "{name}: {found_deg:?}");
        // The text is a system of its own, which is true to scale there and needs no further change.
        let again = read(terrain.crs.as_deref().unwrap(), middle_m).unwrap();
        assert_eq!((again.grid.cell_size_m, scale_said(&again)), (2.0, None), "{name}");
        assert_eq!(again.crs, terrain.crs);
        assert!(json(terrain.crs.as_deref().unwrap(), middle_m).is_ok());
    }
}

#[test]
fn small_departures_stay_as_they_are() {
    for (prj, place_m) in [
        ("EPSG:32632", [500_000.0, 5_423_000.0]),
        ("EPSG:32632", [833_978.0, 1000.0]),
        ("EPSG:3035", [4_321_000.0, 2_765_157.5]),
        ("EPSG:27700", [336_038.76, 567_734.86]),
        ("EPSG:3067", [175_799.85, 6_777_654.09]),
        ("EPSG:28191", [150_167.21, 134_194.73]),
    ] {
        let terrain = read(prj, place_m).unwrap();
        assert_eq!((terrain.grid.cell_size_m, terrain.crs.as_deref()), (2.0, Some(prj)));
        assert_eq!(scale_said(&terrain), None, "{prj}");
    }
}

/// Places that people have are in these coordinates: UTM far beyond its zone, a national grid at its edge, equal areas off their middle.
#[test]
fn departures_below_a_hundredth_stay_and_are_said() {
    for (prj, place_m, said) in [
        ("EPSG:2154", [1_197_656.7, 6_118_854.94], "0.21 %"),
        ("EPSG:32632", [500.0, 860.0], "0.27 %"),
        ("EPSG:25832", [920_000.0, 5_680_000.0], "0.18 %"),
    ] {
        let terrain = read(prj, place_m).unwrap();
        assert_eq!((terrain.grid.cell_size_m, terrain.crs.as_deref()), (2.0, Some(prj)));
        let detail = &scale_said(&terrain).unwrap().detail;
        assert!(detail.contains(said) && detail.contains("coordinates stay"), "{detail}");
    }
}

#[test]
fn maps_that_are_stretched_or_sheared_are_refused_with_the_command_for_their_zone() {
    let esri = |name: &str| {
        format!(
            r#"PROJCS["{name}",{WGS_84},PROJECTION["{name}"],PARAMETER["False_Easting",0.0],PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",0.0],UNIT["Meter",1.0]]"#
        )
    };
    for (prj, place_m, epsg) in [
        ("EPSG:6933".to_owned(), [964_862.8, 6_351_420.0], "EPSG:32632 "),
        ("EPSG:6931".to_owned(), [849_024.08, -4_815_054.82], "EPSG:32632 "),
        ("EPSG:3035".to_owned(), [1_759_253.33, 989_737.76], "EPSG:32628 "),
        (esri("Cylindrical_Equal_Area"), [11_131_949.08, 5_473_000.0], "EPSG:32647 "),
        (esri("Mollweide"), [6_485_639.31, 6_876_758.99], "EPSG:32647 "),
    ] {
        let refused = read(&prj, place_m).unwrap_err().to_string();
        assert!(refused.contains("m of ground along x") && refused.contains(epsg), "{refused}");
        assert!(refused.contains("in.asc"), "{refused}");
    }
    for prj in [
        "EPSG:8857".to_owned(),
        "EPSG:54008".to_owned(),
        esri("Sinusoidal"),
        esri("Robinson"),
        "+proj=sinu +R=6371007.181".to_owned(),
    ] {
        let refused = read(&prj, [1000.0, 2000.0]).unwrap_err().to_string();
        assert!(refused.contains("projection of the world") && refused.contains("gdalwarp"), "{refused}");
    }
}

#[test]
fn a_scale_that_changes_over_the_map_is_refused() {
    let refused = read_cells("EPSG:3413", [0.0, -3_323_160.27], 1000, 100.0).unwrap_err().to_string();
    assert!(refused.contains("m of ground over the map") && refused.contains("-t_srs EPSG:32"), "{refused}");
}

#[test]
fn what_is_not_known_of_a_scale_is_said() {
    for prj in [
        format!(r#"PROJCS["x",{WGS_84},PROJECTION["Polyconic"],UNIT["Meter",1.0]]"#),
        format!(r#"PROJCS["x",{WGS_84},PROJECTION["Some_Other"],UNIT["Meter",1.0]]"#),
    ] {
        let terrain = read(&prj, [1000.0, 2000.0]).unwrap();
        assert!(scale_said(&terrain).unwrap().detail.contains("not computed here"), "{prj}");
    }
    let beyond = read("EPSG:32632", [4.0e7, 4.0e7]).unwrap();
    assert!(scale_said(&beyond).unwrap().detail.contains("beyond the area"));
    let national = format!(r#"PROJCS["x",{WGS_84},PROJECTION["Cassini"],UNIT["Meter",1.0]]"#);
    assert_eq!(scale_said(&read(&national, [1000.0, 2000.0]).unwrap()), None);
    assert!(scale_said(&read(&national, [500_000.0, 2000.0]).unwrap()).unwrap().detail.contains("0.31 %"));
    let moon = r#"PROJCS["ps",GEOGCS["Moon",DATUM["D_Moon",SPHEROID["Moon",1737400,0]],PRIMEM["m",0],UNIT["degree",0.0174532925199433]],PROJECTION["Polar_Stereographic"],PARAMETER["latitude_of_origin",-90],UNIT["metre",1]]"#;
    for (prj, said) in [
        (moon, "of another body than the earth"),
        ("+proj=eqc +lat_ts=15 +R=3396190", "of another body than the earth"),
        ("EPSG:3375", "omerc) is not computed here"),
        ("EPSG:27200", "nzmg) is not computed here"),
        ("EPSG:65000", "the projection of EPSG:65000 is not known here"),
        ("+proj=gnom +lat_0=45 +lon_0=9 +datum=WGS84", "gnom) is not computed here"),
        ("Projection STATEPLANE\nUnits METERS\n", "stateplane) is not computed here"),
    ] {
        let terrain = read(prj, [444_864.56, 343_000.63]).unwrap();
        let detail = &scale_said(&terrain).unwrap().detail;
        assert!(detail.contains(said) && detail.contains("were taken for the ground's"), "{prj}: {detail}");
    }
    let local = read("LOCAL_CS[\"yard\",UNIT[\"metre\",1]]", [0.0, 0.0]).unwrap();
    assert_eq!(scale_said(&local), None, "a frame of its own is metres of the ground");
}

/// Scales (ground by map) by PROJ 9.5; of some nothing is known here, which is said.
#[test]
fn systems_that_are_newer_than_the_definitions_have_their_scale_or_say_that_it_is_not_known() {
    let refused = read("EPSG:10598", [-1_662_395.73, -1_582_506.35]).err().unwrap().to_string();
    assert!(refused.contains("1.0013 m of ground along x"), "{refused}");
    let antarctica = read("EPSG:9354", [0.0, 1_605_785.93]).unwrap();
    assert!((antarctica.grid.cell_size_m / 2.0 / 1.031_248 - 1.0).abs() < 1e-5, "{:?}", antarctica.grid);
    assert!(scale_said(&antarctica).unwrap().detail.contains("1.0312"));
    assert!(json("EPSG:9354", [0.0, 1_605_785.93]).err().unwrap().to_string().contains("1.0312 m of ground"));
    for (crs, place_m) in [
        ("EPSG:9311", [-5_505_212.18, -993_460.44]),
        ("EPSG:9311", [-1_645_296.78, 521_000.04]),
        ("EPSG:27704", [7_483_531.13, 771_739.81]),
    ] {
        let said = match read(crs, place_m) {
            Ok(terrain) => scale_said(&terrain).unwrap().detail.clone(),
            Err(error) => error.to_string(),
        };
        assert!(said.contains(crs) && said.contains("metre"), "{said}");
    }
}

#[test]
fn a_grid_whose_scale_is_not_known_says_so() {
    let doubted = json("EPSG:3375", [444_864.56, 343_000.63]).unwrap();
    assert!(scale_said(&doubted).unwrap().detail.contains("EPSG:3375, omerc"));
    assert_eq!(scale_said(&json("EPSG:32632", [500_000.0, 5_423_000.0]).unwrap()), None);
}

#[test]
fn a_mercator_of_any_size_keeps_its_place() {
    // By pyproj: 10° east, 48° north.
    for (code, place_m, side) in [
        (3857, [1_113_194.908, 6_106_854.835], 40),
        (3857, [1_113_194.908, 6_106_854.835], 120),
        (3395, [1_113_194.908, 6_075_085.090], 120),
    ] {
        let terrain = read_cells(&format!("EPSG:{code}"), place_m, side, 1.5).unwrap();
        let middle_m =
            [0, 1].map(|axis| terrain.grid.origin_m[axis] + side as f64 / 2.0 * terrain.grid.cell_size_m);
        let [lon_deg, lat_deg] = terrain.earth().unwrap().place_deg(middle_m).unwrap();
        assert!((lon_deg - 10.0).abs() < 1e-7 && (lat_deg - 48.0).abs() < 1e-7, "{lon_deg} {lat_deg}");
        assert!(json(terrain.crs.as_deref().unwrap(), middle_m).is_ok());
    }
}

#[test]
fn cells_of_a_grid_that_are_metres_of_the_ground_are_no_metres_of_such_a_system() {
    for (crs, place_m, said) in [
        ("EPSG:6933", [964_862.8, 6_351_420.0], "along x"),
        ("EPSG:5041", [2_591_424.98, -1_354_137.74], "0.9387 m of ground"),
        ("EPSG:8857", [7_225_128.0, 6_924_035.0], "projection of the world"),
    ] {
        let error = json(crs, place_m).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
        assert_eq!(error.field().as_deref(), Some("crs"));
    }
    assert!(
        json("EPSG:2154", [1_197_656.7, 6_118_854.94]).is_ok(),
        "0.2 %, less than a sphere and the ellipsoid differ"
    );
}

#[test]
fn systems_whose_coordinates_run_west_and_south_are_refused() {
    let wkt = format!(
        r#"PROJCS["Hartebeesthoek94 / Lo29",{WGS_84},PROJECTION["Transverse_Mercator_South_Orientated"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",29],PARAMETER["scale_factor",1],PARAMETER["false_easting",0],PARAMETER["false_northing",0],UNIT["metre",1],AXIS["Y",WEST],AXIS["X",SOUTH]]"#
    );
    for prj in ["EPSG:2065", "EPSG:5513", "EPSG:8352", "EPSG:5515", "EPSG:2218"] {
        let refused = read(prj, [700_000.0, 1_050_000.0]).unwrap_err().to_string();
        assert!(refused.contains("run west and south") && refused.contains("-t_srs EPSG:32"), "{refused}");
    }
    for prj in ["EPSG:2053", wkt.as_str()] {
        let refused = read(prj, [-10_011.77, 2_876_838.4]).unwrap_err().to_string();
        assert!(
            refused.contains("run west and south") && refused.contains("-t_srs EPSG:32735 "),
            "{refused}"
        );
        assert!(json(prj, [-10_011.77, 2_876_838.4]).unwrap_err().to_string().contains("run west and south"));
    }
    assert!(Earth::of("EPSG:2053").is_ok(), "areas and places of other files may be in it");
}
