//! Shaded relief, the picture in which people recognise ground.

use crate::{SlopeMap, Terrain};

/// Brightness of each cell under one lamp, row-major, southernmost row first; 0 where unknown.
///
/// ```text
/// brightness = 255 · max(0, (sin h − (p sin az + q cos az) cos h) / √(1 + p² + q²))
/// ```
///
/// p, q gradient east and north times `exaggeration`, az azimuth of the lamp clockwise from north, h its height. Horn
/// (1981), Proc. IEEE 69(1); the lamp stands in the north-west at 45°, as maps have it.
pub fn hillshade(terrain: &Terrain, slope: &SlopeMap, exaggeration: f32) -> Vec<u8> {
    let azimuth_rad = 315f32.to_radians();
    let height_rad = 45f32.to_radians();
    let (sin_az, cos_az) = azimuth_rad.sin_cos();
    let (sin_h, cos_h) = height_rad.sin_cos();
    slope
        .east
        .iter()
        .zip(&slope.north)
        .zip(terrain.relative_m())
        .map(|((&east, &north), z)| {
            if z.is_nan() {
                return 0;
            }
            let (p, q) = (east * exaggeration, north * exaggeration);
            let towards_lamp = p * sin_az + q * cos_az;
            let brightness = (sin_h - towards_lamp * cos_h) / (1.0 + p * p + q * q).sqrt();
            (255.0 * brightness.max(0.0)).round() as u8
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;

    fn shade_of_plane(east: f64, north: f64) -> u8 {
        let grid = Grid { rows: 3, columns: 3, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        let z: Vec<f64> =
            (0..9).map(|i| grid.center_m(grid.cell(i))).map(|[x, y]| east * x + north * y).collect();
        let terrain = Terrain::new(grid, &z).unwrap();
        hillshade(&terrain, &SlopeMap::new(&terrain), 1.0)[4]
    }

    #[test]
    fn slopes_that_face_the_north_west_are_bright_and_those_that_face_away_dark() {
        let level = shade_of_plane(0.0, 0.0);
        assert_eq!(level, (255.0f32 * 45f32.to_radians().sin()).round() as u8);
        // Ground that falls towards the north-west rises to the south-east: east positive, north negative.
        assert!(shade_of_plane(0.5, -0.5) > level);
        assert!(shade_of_plane(-0.5, 0.5) < level);
    }
}
