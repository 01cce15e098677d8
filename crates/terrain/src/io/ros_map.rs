//! ROS `map_server` maps: a YAML file beside an image of obstacles on level ground.

mod error;
mod occupancy;

use std::{f64::consts::TAU, io::Cursor};

use image::{DynamicImage, ImageReader};
use serde::Deserialize;

pub use self::error::RosMapError;
use self::occupancy::{Mode, Negate, Occupancy, Pixel, Rule};
use super::ascii::south_up;
use crate::{Error, Grid, Terrain, Warning, WarningKind};

/// The YAML file. Fields that newer servers add are ignored.
#[derive(Deserialize)]
struct RosMap {
    image: String,
    resolution: f64,
    origin: Vec<f64>,
    #[serde(default)]
    negate: Negate,
    occupied_thresh: f64,
    free_thresh: f64,
    mode: Option<String>,
}

/// The image that a text names, if it is the YAML file of a `map_server` map.
pub fn image_named_in(text: &[u8]) -> Option<String> {
    let map: RosMap = serde_yaml_ng::from_slice(text).ok()?;
    Some(map.image)
}

/// Reads a `map_server` map, whose image `image` finds by its name: occupied pixels are obstacles, unknown ones unknown ground,
/// free ones level at 0 m. Modes `trinary`, `scale` and `raw` are those of `nav2_map_server`; pixels between free and occupied
/// are free with a warning, as there is no cost for them. The image's first bytes say which format it has, not its name.
///
/// # Errors
/// What the YAML lacks, an image that cannot be read, or an origin that is rotated.
pub fn read(
    yaml: &str,
    most_cells: u64,
    image: impl FnOnce(&str) -> std::io::Result<Vec<u8>>,
) -> Result<Terrain, Error> {
    let map: RosMap = serde_yaml_ng::from_str(yaml).map_err(RosMapError::Yaml)?;
    let rule = map.rule()?;
    let bytes = image(&map.image).map_err(|source| RosMapError::Read { name: map.image.clone(), source })?;
    if let Some((rows, columns)) = size(&bytes).filter(|(rows, columns)| rows * columns > most_cells) {
        return Err(Error::TooManyCells { rows, columns, limit: most_cells });
    }
    let picture = map.decoded(&bytes)?;
    let (rows, columns) = (u64::from(picture.height()), u64::from(picture.width()));
    let origin_m = map.origin_m([columns, rows])?;
    let grid = Terrain::check_size(rows, columns, map.resolution, origin_m).map_err(|error| match error {
        Error::CellSize { value, min, max } => RosMapError::Resolution { value, min, max }.into(),
        other => other,
    })?;
    let cells: Vec<Occupancy> = pixels(&picture).map(|pixel| rule.occupancy(pixel)).collect();
    let all_unknown = || RosMapError::AllUnknown {
        name: map.image.clone(),
        mode: rule.mode.name(),
        occupied: rule.occupied,
        free: rule.free,
    };
    terrain(grid, &cells).ok_or_else(all_unknown)?
}

/// Pixels of an image, as its head has it; 0 where it is none.
pub fn pixels_of(image: &[u8]) -> u64 {
    size(image).map_or(0, |(rows, columns)| rows * columns)
}

/// Rows and columns of an image, as its head has them.
fn size(image: &[u8]) -> Option<(u64, u64)> {
    let reader = ImageReader::new(Cursor::new(image)).with_guessed_format().ok()?;
    reader.into_dimensions().ok().map(|(columns, rows)| (u64::from(rows), u64::from(columns)))
}

/// Level ground with obstacles; none where every cell is unknown.
fn terrain(grid: Grid, from_north: &[Occupancy]) -> Option<Result<Terrain, Error>> {
    let level = |cell: &Occupancy| if *cell == Occupancy::Unknown { f64::NAN } else { 0.0 };
    let elevation_m = south_up(&grid, &from_north.iter().map(level).collect::<Vec<f64>>());
    if elevation_m.iter().all(|z| z.is_nan()) {
        return None;
    }
    let rows_from_south = from_north.chunks(grid.columns).rev();
    let obstacle = rows_from_south.flatten().map(|cell| *cell == Occupancy::Occupied).collect();
    let partly = from_north.iter().filter(|cell| **cell == Occupancy::Partly).count();
    let terrain = Terrain::new(grid, &elevation_m).map(|terrain| terrain.with_obstacles(obstacle));
    Some(terrain.map(|terrain| match partly {
        0 => terrain,
        _ => terrain.with_warning(Warning::new(
            WarningKind::PartlyOccupied,
            format!(
                "{partly} cells are neither free nor occupied, but between (1 to 99 %): taken as free ground"
            ),
        )),
    }))
}

impl RosMap {
    fn rule(&self) -> Result<Rule, RosMapError> {
        let mode = self.mode.as_deref().map_or(Ok(Mode::Trinary), Mode::named)?;
        let (free, occupied) = (self.free_thresh, self.occupied_thresh);
        for (field, value) in [("free_thresh", free), ("occupied_thresh", occupied)] {
            if !(0.0..=1.0).contains(&value) {
                return Err(RosMapError::Threshold { field, value });
            }
        }
        if free > occupied {
            return Err(RosMapError::Thresholds { free, occupied });
        }
        Ok(Rule { mode, negate: self.negate.0, occupied, free })
    }

    fn decoded(&self, bytes: &[u8]) -> Result<DynamicImage, RosMapError> {
        let broken = |source| RosMapError::Image { name: self.image.clone(), source };
        let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
        reader.map_err(|error| broken(error.into()))?.decode().map_err(broken)
    }

    /// South-west corner of an image of so many columns and rows, if it is not rotated.
    fn origin_m(&self, [columns, rows]: [u64; 2]) -> Result<[f64; 2], RosMapError> {
        let &[x_m, y_m, ref rest @ ..] = self.origin.as_slice() else {
            return Err(RosMapError::Origin { found: self.origin.len() });
        };
        let Some(&yaw_rad) = rest.first() else { return Ok([x_m, y_m]) };
        let (width, height) = (columns as f64, rows as f64);
        let turn_rad = (yaw_rad - TAU * (yaw_rad / TAU).round()).abs();
        /// What a rotation may move the far corner by [cells]: the centre of every pixel stays in its cell.
        const LEAST_SHIFT_CELLS: f64 = 0.5;
        if turn_rad * width.hypot(height) < LEAST_SHIFT_CELLS {
            return Ok([x_m, y_m]);
        }
        let (sin, cos) = yaw_rad.sin_cos();
        let corner = |east: f64, north: f64| {
            [self.resolution * (east * cos - north * sin), self.resolution * (east * sin + north * cos)]
        };
        let corners = [corner(0.0, 0.0), corner(width, 0.0), corner(0.0, height), corner(width, height)];
        let least = |axis: usize| corners.iter().map(|corner| corner[axis]).fold(f64::INFINITY, f64::min);
        Err(RosMapError::Yaw {
            yaw_rad,
            clockwise_deg: -yaw_rad.to_degrees(),
            image: self.image.clone(),
            x_m: x_m + least(0),
            y_m: y_m + least(1),
        })
    }
}

/// The pixels of an image, by rows from the north.
fn pixels(picture: &DynamicImage) -> Box<dyn Iterator<Item = Pixel> + '_> {
    let has_opacity = picture.color().has_alpha();
    let pixel = move |[r, g, b, a]: [f64; 4], most: f64| Pixel {
        colors: [r / most, g / most, b / most],
        opacity: has_opacity.then_some(a / most),
    };
    match picture {
        DynamicImage::ImageLuma8(gray) => {
            Box::new(gray.as_raw().iter().map(move |v| pixel([f64::from(*v); 4], f64::from(u8::MAX))))
        }
        _ => {
            let colors = picture.to_rgba16().into_raw();
            let count = colors.len() / 4;
            Box::new((0..count).map(move |i| {
                let number = |channel| colors.get(4 * i + channel).copied().map_or(0.0, f64::from);
                pixel([number(0), number(1), number(2), number(3)], f64::from(u16::MAX))
            }))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cell;

    const YAML: &str = "image: map.pgm\nresolution: 0.05\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\n\
                        occupied_thresh: 0.65\nfree_thresh: 0.196\n";

    /// Two rows of three: free, occupied, unknown above; free below.
    fn pgm() -> Vec<u8> {
        let mut pgm = b"P5\n3 2\n255\n".to_vec();
        pgm.extend([254, 0, 205, 254, 254, 254]);
        pgm
    }

    fn read(yaml: &str, image: impl FnOnce(&str) -> std::io::Result<Vec<u8>>) -> Result<Terrain, Error> {
        super::read(yaml, Terrain::MAX_CELLS, image)
    }

    #[test]
    fn an_image_that_is_too_large_is_not_decoded() {
        let huge = b"P5\n30000 30000\n255\n".to_vec();
        let error = super::read(YAML, 1000, |_| Ok(huge)).unwrap_err();
        assert!(matches!(error, Error::TooManyCells { limit: 1000, .. }), "{error}");
    }

    fn read_pgm(yaml: &str) -> Result<Terrain, Error> {
        read(yaml, |_| Ok(pgm()))
    }

    #[test]
    fn free_occupied_and_unknown_pixels_become_ground_obstacle_and_unknown() {
        let terrain = read_pgm(YAML).unwrap();
        let top = |column| Cell { row: 1, column };
        assert!(!terrain.is_blocked(top(0)));
        assert!(terrain.is_blocked(top(1)) && terrain.elevation_m(top(1)).is_some());
        assert!(terrain.elevation_m(top(2)).is_none());
        assert_eq!(terrain.grid.origin_m, [-1.0, 2.0]);
        assert_eq!(terrain.grid.cell_size_m, 0.05);
    }

    #[test]
    fn an_image_is_what_its_bytes_say() {
        let gray = image::GrayImage::from_raw(3, 2, vec![254, 0, 205, 254, 254, 254]).unwrap();
        let mut png = Cursor::new(Vec::new());
        gray.write_to(&mut png, image::ImageFormat::Png).unwrap();
        let of_png = read(YAML, |_| Ok(png.into_inner())).unwrap();
        assert_eq!(of_png.content_id(), read_pgm(YAML).unwrap().content_id());
        let said = read(YAML, |_| Ok(b"no image".to_vec())).unwrap_err().to_string();
        assert!(said.contains("map.pgm") && said.contains("PNG"), "{said}");
    }

    #[test]
    fn negate_is_a_number_or_a_truth_value() {
        let blocked = |negate: &str| {
            let terrain = read_pgm(&YAML.replace("negate: 0", &format!("negate: {negate}"))).unwrap();
            terrain.is_blocked(Cell { row: 0, column: 0 })
        };
        assert!(!blocked("0") && !blocked("false") && !blocked("no"));
        assert!(blocked("1") && blocked("true") && blocked("2"));
        let said = read_pgm(&YAML.replace("negate: 0", "negate: perhaps")).unwrap_err().to_string();
        assert!(said.contains("negate must be 0, 1, true or false"), "{said}");
    }

    #[test]
    fn a_turn_that_moves_no_pixel_is_none_and_any_other_is_refused_with_the_mend() {
        for yaw in ["1.0e-9", "6.283185307179586", "-6.283185307179586"] {
            assert!(read_pgm(&YAML.replace("2.0, 0.0]", &format!("2.0, {yaw}]"))).is_ok(), "{yaw}");
        }
        let said = read_pgm(&YAML.replace("2.0, 0.0]", "2.0, 1.5707963267948966]")).unwrap_err().to_string();
        assert!(said.contains("origin yaw") && said.contains("-rotate -90.0"), "{said}");
        assert!(said.contains("origin: [-1.100, 2.000, 0]"), "{said}");
    }

    #[test]
    fn partly_occupied_cells_are_free_and_said() {
        let yaml = YAML.replace("0.65", "1.0").replace("0.196", "0.0") + "mode: scale\n";
        let terrain = read_pgm(&yaml).unwrap();
        assert!((0..6).all(|i| terrain.is_blocked(terrain.grid.cell(i)) == (i == 4)), "{terrain:?}");
        assert_eq!(terrain.warnings()[0].kind, WarningKind::PartlyOccupied);
    }

    #[test]
    fn what_a_map_server_does_not_know_is_refused_by_name() {
        for (from, to, said) in [
            ("negate: 0", "mode: heightmap", "mode of the map_server YAML is `heightmap`"),
            ("0.65", "65", "occupied_thresh of the map_server YAML is 65"),
            ("0.196", "-0.1", "free_thresh"),
            ("0.196", ".nan", "free_thresh"),
            ("0.196", "0.7", "swap"),
            ("resolution: 0.05\n", "", "resolution"),
            ("0.05", "-0.05", "resolution of the map_server YAML is -0.05"),
            ("[-1.0, 2.0, 0.0]", "[1.0]", "origin of the map_server YAML has 1"),
        ] {
            let message = read_pgm(&YAML.replace(from, to)).unwrap_err().to_string();
            assert!(message.contains(said), "{to}: {message}");
        }
        let gone = read(YAML, |_| Err(std::io::ErrorKind::NotFound.into())).unwrap_err().to_string();
        assert!(gone.contains("map.pgm"), "{gone}");
        let gray = read(&(YAML.to_owned() + "mode: raw\n"), |_| Ok(b"P5\n1 1\n255\n\xcd".to_vec()));
        let said = gray.unwrap_err().to_string();
        assert!(said.contains("mode raw") && said.contains("unknown"), "{said}");
    }
}
