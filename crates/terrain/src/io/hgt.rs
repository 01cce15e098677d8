//! Tiles of the Shuttle Radar Topography Mission (SRTM, NASADEM): a degree square, placed by its file's name alone.
//!
//! Big-endian 16-bit heights in metres above EGM96, rows from the north; samples lie on the degree lines, so that neighbouring tiles share
//! their edges (SRTM Collection User Guide, NASA LP DAAC 2015, section 2.1).

use super::Options;
use crate::{
    Error, Terrain,
    crs::{Crs, DegreeFrame, Unwarped, Warp},
};

/// What is wrong with a tile.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HgtError {
    /// A name that does not say where the tile lies.
    #[error(
        "`{name}` does not say where the tile lies: name it after its south-west corner, as N46W094.hgt (46° north, 94° west)"
    )]
    Name {
        /// The file's name.
        name: String,
    },
    /// A size that no tile has.
    #[error(
        "{bytes} bytes are no tile: 1201 × 1201 heights take 2884802, 3601 × 3601 take 25934402 and 3601 × 1801 take 12970802; unpack or download it again"
    )]
    Size {
        /// Bytes found.
        bytes: usize,
    },
}

/// Rows and columns: of three seconds of arc, of one, and of one by two, as tiles north of 50° have them (GDAL, driver SRTMHGT).
const SIZES: [[usize; 2]; 3] = [[1201, 1201], [3601, 3601], [3601, 1801]];

/// Bytes of the largest tile.
pub(super) const MOST_BYTES: u64 = 3601 * 3601 * 2;

/// Marks of unknown ground (voids).
const VOID: i16 = i16::MIN;

/// The system of all tiles.
const WGS_84: u32 = 4326;

/// Reads a tile whose file has a name such as `N46W094.hgt`, in any case.
///
/// # Errors
/// A name or a size that no tile has, or latitudes beyond those of UTM.
pub(crate) fn read(bytes: &[u8], name: &str, options: &Options) -> Result<Unwarped, Error> {
    let south_west_deg = south_west_deg(name).ok_or_else(|| HgtError::Name { name: name.to_owned() })?;
    let of_size = |[rows, columns]: &[usize; 2]| rows * columns * size_of::<i16>() == bytes.len();
    let [rows, columns] = SIZES.into_iter().find(of_size).ok_or(HgtError::Size { bytes: bytes.len() })?;
    let step_deg = [columns, rows].map(|samples| 1.0 / (samples - 1) as f64);
    // Samples on the lines are the centres of cells.
    let corner_deg = [0, 1].map(|axis| south_west_deg[axis] - step_deg[axis] / 2.0);
    let frame = DegreeFrame::checked(corner_deg, step_deg, [columns as u64, rows as u64])?;
    let warp = Warp::plan(frame, &Crs::from_epsg(WGS_84), "hgt", options.most_cells)?;
    let rows = bytes.chunks_exact(columns * size_of::<i16>()).rev();
    let heights = rows.flat_map(|row| row.as_chunks().0).map(|sample| match i16::from_be_bytes(*sample) {
        VOID => f32::NAN,
        height_m => f32::from(height_m),
    });
    let terrain = Terrain::from_samples(warp.source_grid(), heights.collect(), |height_m| height_m)?;
    Ok(Unwarped::of(terrain, Some(warp)))
}

/// Longitude and latitude of the degree lines that a name has [°]: a letter and two digits of latitude, a letter and three of longitude.
fn south_west_deg(name: &str) -> Option<[f64; 2]> {
    let name = Some(name.to_ascii_uppercase()).filter(|name| name.is_ascii())?;
    let tile = name.get(..7).filter(|_| !name[7..].starts_with(|c: char| c.is_ascii_alphanumeric()))?;
    let number = |digits: &str, most: u32| {
        let is_number = digits.bytes().all(|byte| byte.is_ascii_digit());
        digits.parse::<u32>().ok().filter(|number| is_number && *number <= most).map(f64::from)
    };
    let (latitude_deg, longitude_deg) = (number(&tile[1..3], 90)?, number(&tile[4..7], 180)?);
    let signed = |letter: &str, positive: &str, negative: &str, angle_deg: f64| match letter {
        letter if letter == positive => Some(angle_deg),
        letter if letter == negative => Some(-angle_deg),
        _ => None,
    };
    Some([signed(&tile[3..4], "E", "W", longitude_deg)?, signed(&tile[..1], "N", "S", latitude_deg)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_has_the_south_west_corner() {
        for (name, corner) in [
            ("N46W094.hgt", Some([-94.0, 46.0])),
            ("s34e151.hgt", Some([151.0, -34.0])),
            ("N46W094.SRTMGL1.hgt", Some([-94.0, 46.0])),
            ("n00e000.hgt.gz", Some([0.0, 0.0])),
            ("N46X094.hgt", None),
            ("N4-W094.hgt", None),
            ("N46W0945.hgt", None),
            ("N91W094.hgt", None),
            ("tile.hgt", None),
            ("N46é94.hgt", None),
            ("ééééééé", None),
        ] {
            assert_eq!(south_west_deg(name), corner, "{name}");
        }
    }

    #[test]
    fn a_tile_of_the_north_has_half_as_many_columns() {
        let heights: Vec<u8> = (0..3601)
            .flat_map(|_| (0..1801i16).map(|column| 300 + column / 10))
            .flat_map(i16::to_be_bytes)
            .collect();
        let unwarped = read(&heights, "N61E010.hgt", &Options::default()).unwrap();
        let grid = unwarped.terrain.grid;
        assert_eq!((grid.rows, grid.columns), (3601, 1801));
        // At 61.5° a second of arc of longitude is 0.48 of one of latitude: cells of two seconds are all but square.
        assert!((29.0..31.0).contains(&grid.cell_size_m), "{}", grid.cell_size_m);
        let said = read(&heights[2..], "N61E010.hgt", &Options::default()).err().unwrap().to_string();
        assert!(said.contains("3601 × 1801"), "{said}");
    }
}
