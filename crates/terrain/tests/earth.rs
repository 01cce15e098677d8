//! Places on earth are where PROJ has them, to a millimetre, in every system that is claimed to be known.
//!
//! Needs the Python environment that `tests/run` makes in `target/python`; without it the test says that it skips.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stderr)]

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    process::Command,
};

use terrain::crs::{Crs, Earth};

/// Length of a degree of latitude, or of longitude at the equator [m].
const DEGREE_M: f64 = 111_320.0;

fn places() -> Option<String> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or(package.join("../../target"), PathBuf::from);
    let python = target.join("python/bin/python");
    if !Command::new(&python).args(["-c", "import pyproj"]).output().is_ok_and(|o| o.status.success()) {
        eprintln!("SKIPPED: there is no Python with pyproj in {}; tests/run makes it", target.display());
        return None;
    }
    let output = Command::new(python).arg(package.join("tests/project_places.py")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8(output.stdout).unwrap())
}

#[test]
fn every_system_that_is_known_agrees_with_proj_to_a_millimetre() {
    let Some(places) = places() else { return };
    let (mut known, mut refused) = (BTreeSet::new(), BTreeSet::new());
    for line in places.lines() {
        let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        let [code, longitude, latitude, easting, northing] = numbers[..] else { panic!("{line}") };
        let name = format!("EPSG:{code}");
        let Ok(earth) = Earth::of(&name) else {
            refused.insert(code as u32);
            continue;
        };
        known.insert(code as u32);
        let metres = Crs::parse(&name).unwrap().unit.unwrap().metres;
        let [x_m, y_m] = earth.place_m([longitude, latitude]).unwrap();
        let off_m = (x_m - metres * easting).hypot(y_m - metres * northing);
        assert!(off_m < 1e-3, "{name}: {off_m} m off at {longitude} {latitude}");
        let [lon, lat] = earth.place_deg([metres * easting, metres * northing]).unwrap();
        let shrunk = latitude.to_radians().cos();
        let back_m = DEGREE_M * ((lon - longitude) * shrunk).hypot(lat - latitude);
        assert!(back_m < 1e-3, "{name}: {back_m} m off on the way back");
    }
    eprintln!("{} systems agree, refused: {refused:?}", known.len());
    assert!(known.len() >= 30, "{known:?}");
    for by_grid in [27_700, 28_992, 29_902, 5_514, 24_378, 4_326] {
        assert!(refused.contains(&by_grid), "EPSG:{by_grid} needs more than is known here");
    }
}
