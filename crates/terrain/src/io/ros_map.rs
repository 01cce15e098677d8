//! ROS `map_server` maps: a YAML file beside an image of obstacles on level ground.

use std::path::Path;

use image::ImageReader;
use serde::Deserialize;

use crate::{Error, Terrain};

/// The YAML file. Fields that newer servers add (`mode` among them) are read where they matter and ignored else.
#[derive(Deserialize)]
struct RosMap {
    image: String,
    resolution: f64,
    origin: Vec<f64>,
    #[serde(default)]
    negate: u8,
    occupied_thresh: f64,
    free_thresh: f64,
}

/// Reads a `map_server` map: occupied pixels are obstacles, unknown ones unknown ground, free ones level at 0 m.
///
/// Occupancy is `(255 − pixel)/255`, or `pixel/255` with `negate`: above `occupied_thresh` occupied, below
/// `free_thresh` free, between them unknown (the server's trinary mode).
///
/// # Errors
/// What the YAML lacks, an image that cannot be read, or an origin that is rotated.
pub fn read(yaml: &str, folder: &Path) -> Result<Terrain, Error> {
    let map: RosMap = serde_yaml_ng::from_str(yaml)?;
    let &[x_m, y_m, ref rest @ ..] = map.origin.as_slice() else {
        let value = map.origin.len() as f64;
        return Err(Error::RosMap { field: "length of origin", value, expected: "3: x, y, yaw" });
    };
    if let Some(&yaw) = rest.first().filter(|yaw| **yaw != 0.0) {
        return Err(Error::RosMap { field: "origin yaw", value: yaw, expected: "0: rotate the map first" });
    }
    let image_error = |source| Error::Image { path: map.image.clone(), source };
    let reader = ImageReader::open(folder.join(&map.image)).map_err(|e| image_error(e.into()))?;
    let gray = reader.decode().map_err(image_error)?.into_luma8();
    let grid =
        Terrain::check_size(u64::from(gray.height()), u64::from(gray.width()), map.resolution, [x_m, y_m])?;
    let occupancy = |pixel: u8| {
        let dark = f64::from(pixel) / 255.0;
        if map.negate == 0 { 1.0 - dark } else { dark }
    };
    let from_north: Vec<f64> = gray.pixels().map(|p| occupancy(p.0[0])).collect();
    let occupied = super::ascii::south_up(&grid, &from_north);
    let is_obstacle = |p: f64| p > map.occupied_thresh;
    let elevation_m: Vec<f64> = occupied
        .iter()
        .map(|&p| if is_obstacle(p) || p < map.free_thresh { 0.0 } else { f64::NAN })
        .collect();
    let obstacle = occupied.into_iter().map(is_obstacle).collect();
    Ok(Terrain::new(grid, &elevation_m)?.with_obstacles(obstacle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cell;

    const YAML: &str = "image: map.pgm\nresolution: 0.05\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\n\
                        occupied_thresh: 0.65\nfree_thresh: 0.196\n";

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        // Two rows of three: free, occupied, unknown above; free below.
        let mut pgm = b"P5\n3 2\n255\n".to_vec();
        pgm.extend([254, 0, 205, 254, 254, 254]);
        std::fs::write(folder.path().join("map.pgm"), pgm).unwrap();
        folder
    }

    #[test]
    fn free_occupied_and_unknown_pixels_become_ground_obstacle_and_unknown() {
        let folder = folder();
        let terrain = read(YAML, folder.path()).unwrap();
        let top = |column| Cell { row: 1, column };
        assert!(!terrain.is_blocked(top(0)));
        assert!(terrain.is_blocked(top(1)) && terrain.elevation_m(top(1)).is_some());
        assert!(terrain.elevation_m(top(2)).is_none());
        assert_eq!(terrain.grid.origin_m, [-1.0, 2.0]);
        assert_eq!(terrain.grid.cell_size_m, 0.05);
    }

    #[test]
    fn a_rotated_origin_and_a_missing_image_are_refused_by_name() {
        let folder = folder();
        let rotated = YAML.replace("2.0, 0.0]", "2.0, 0.3]");
        assert!(read(&rotated, folder.path()).unwrap_err().to_string().contains("origin yaw"));
        let missing = YAML.replace("map.pgm", "gone.pgm");
        assert!(read(&missing, folder.path()).unwrap_err().to_string().contains("gone.pgm"));
        let no_resolution = YAML.replace("resolution: 0.05\n", "");
        assert!(read(&no_resolution, folder.path()).unwrap_err().to_string().contains("resolution"));
    }
}
