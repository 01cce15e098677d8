//! What GDAL makes of files, by rasterio.

use std::{
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::Value;

/// What a script of this folder prints of a path; `None` without a Python environment that has rasterio.
pub(crate) fn by_rasterio(script: &str, path: &Path) -> Option<Value> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or(package.join("../../target"), PathBuf::from);
    let python = target.join("python/bin/python");
    let has_rasterio = Command::new(&python).args(["-c", "import rasterio, pyproj"]).output();
    if !has_rasterio.is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED: there is no Python with rasterio in {}; tests/run makes it", target.display());
        return None;
    }
    let output = Command::new(python).arg(package.join("tests").join(script)).arg(path).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(serde_json::from_slice(&output.stdout).unwrap())
}
