//! Pixels over a rectangle of the map: shaded relief, and what is laid over it.

use terrain::{Cell, Grid, SlopeMap, Terrain, hillshade::hillshade};

/// Vertical exaggeration of the shading: slopes of ten degrees read as relief.
const EXAGGERATION: f32 = 2.0;
/// The longer side of a raster has at most so many pixels; larger maps are thinned.
const MOST_PIXELS: usize = 1000;
/// Unknown ground.
const UNKNOWN: [u8; 3] = [0xE4, 0xE6, 0xEA];
/// Share of the relief's brightness that obstacles keep.
const OBSTACLE_SHADE: f32 = 0.45;

/// A rectangle of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window {
    /// South-west corner [m].
    pub(crate) low_m: [f64; 2],
    /// North-east corner [m].
    pub(crate) high_m: [f64; 2],
}

impl Window {
    /// All of a map.
    pub(crate) fn whole(grid: &Grid) -> Self {
        Window { low_m: grid.origin_m, high_m: grid.far_corner_m() }
    }

    /// The part of a map about places, with a third of their extent as room on every side.
    pub(crate) fn about(grid: &Grid, places_m: impl Iterator<Item = [f64; 2]>) -> Self {
        const ROOM: f64 = 1.0 / 3.0;
        let whole = Window::whole(grid);
        let (low_m, high_m) = places_m.fold(([f64::MAX; 2], [f64::MIN; 2]), |(low_m, high_m), place_m| {
            ([0, 1].map(|i| low_m[i].min(place_m[i])), [0, 1].map(|i| high_m[i].max(place_m[i])))
        });
        let extent_m = (high_m[0] - low_m[0]).max(high_m[1] - low_m[1]);
        if !(extent_m >= 0.0 && extent_m.is_finite()) {
            return whole;
        }
        let room_m = (ROOM * extent_m).max(10.0 * grid.cell_size_m);
        Window {
            low_m: [0, 1].map(|i| (low_m[i] - room_m).max(whole.low_m[i])),
            high_m: [0, 1].map(|i| (high_m[i] + room_m).min(whole.high_m[i])),
        }
    }

    /// East and north [m].
    pub(crate) fn extent_m(&self) -> [f64; 2] {
        [0, 1].map(|i| self.high_m[i] - self.low_m[i])
    }
}

/// Pixels, the northernmost row first.
#[derive(Clone)]
pub(crate) struct Raster {
    /// What they cover.
    pub(crate) window: Window,
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Red, green and blue, a byte each.
    pub(crate) rgb: Vec<u8>,
}

impl Raster {
    /// The shaded relief of a part of a map, under a tint of its cells.
    pub(crate) fn of(terrain: &Terrain, window: Window, tint: &dyn Fn(Cell, f32) -> [u8; 3]) -> Self {
        let grid = &terrain.grid;
        let shade = hillshade(terrain, &SlopeMap::new(terrain), EXAGGERATION);
        let extent_m = window.extent_m();
        let finest_m = extent_m[0].max(extent_m[1]) / MOST_PIXELS as f64;
        let pixel_m = grid.cell_size_m.max(finest_m);
        let [width, height] = extent_m.map(|side_m| ((side_m / pixel_m).round() as usize).max(1));
        let mut rgb = Vec::with_capacity(3 * width * height);
        for y in 0..height {
            for x in 0..width {
                let x_m = window.low_m[0] + (x as f64 + 0.5) / width as f64 * extent_m[0];
                let y_m = window.high_m[1] - (y as f64 + 0.5) / height as f64 * extent_m[1];
                rgb.extend(match grid.cell_at(x_m, y_m) {
                    Some(cell) if terrain.elevation_m(cell).is_some() => {
                        // Lightened, so that lines and tints stand out.
                        let gray = 90.0 + f32::from(shade[grid.index(cell)]) * 160.0 / 255.0;
                        let is_obstacle =
                            terrain.obstacles().is_some_and(|obstacle| obstacle[grid.index(cell)]);
                        tint(cell, if is_obstacle { OBSTACLE_SHADE * gray } else { gray })
                    }
                    _ => UNKNOWN,
                });
            }
        }
        Raster { window, width, height, rgb }
    }

    /// The colour at a place given as shares of the width from the west and of the height from the north, between the pixels about it.
    pub(crate) fn color_at(&self, east: f64, south: f64) -> [u8; 3] {
        let along = |share: f64, size: usize| {
            let at = (share * size as f64 - 0.5).clamp(0.0, (size - 1) as f64);
            let low = at.floor() as usize;
            (low, (low + 1).min(size - 1), (at - low as f64) as f32)
        };
        let (west, east, to_east) = along(east, self.width);
        let (north, south, to_south) = along(south, self.height);
        let value = |x: usize, y: usize, band: usize| f32::from(self.rgb[3 * (y * self.width + x) + band]);
        [0, 1, 2].map(|band| {
            let mix =
                |y: usize| value(west, y, band) + to_east * (value(east, y, band) - value(west, y, band));
            (mix(north) + to_south * (mix(south) - mix(north))).round() as u8
        })
    }

    /// The raster as a PNG.
    ///
    /// # Errors
    /// A raster that cannot be encoded.
    pub(crate) fn png(&self) -> anyhow::Result<Vec<u8>> {
        encode(&self.rgb, self.width, self.height)
    }
}

/// Pixels of red, green and blue as a PNG, of gray where they have no colour.
///
/// # Errors
/// Pixels that cannot be encoded.
pub(crate) fn encode(rgb: &[u8], width: usize, height: usize) -> anyhow::Result<Vec<u8>> {
    let (pixels, _) = rgb.as_chunks::<3>();
    let is_gray = pixels.iter().all(|[red, green, blue]| red == green && green == blue);
    let gray: Vec<u8> = if is_gray { pixels.iter().map(|[gray, ..]| *gray).collect() } else { Vec::new() };
    let (color, samples) =
        if is_gray { (png::ColorType::Grayscale, &gray[..]) } else { (png::ColorType::Rgb, rgb) };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, u32::try_from(width)?, u32::try_from(height)?);
    encoder.set_color(color);
    encoder.set_compression(png::Compression::High);
    encoder.write_header()?.write_image_data(samples)?;
    Ok(bytes)
}

/// The relief itself.
pub(crate) fn plain(_: Cell, gray: f32) -> [u8; 3] {
    [gray as u8; 3]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(rows: usize, columns: usize) -> Terrain {
        let grid = Grid { rows, columns, cell_size_m: 1.0, origin_m: [100.0, 50.0] };
        Terrain::new(grid, &vec![1.0; rows * columns]).unwrap()
    }

    #[test]
    fn a_window_holds_its_places_with_room_and_ends_with_the_map() {
        let grid = level(400, 400).grid;
        let window = Window::about(&grid, [[110.0, 200.0], [170.0, 230.0]].into_iter());
        assert_eq!((window.low_m, window.high_m), ([100.0, 180.0], [190.0, 250.0]));
        assert_eq!(Window::about(&grid, std::iter::empty()), Window::whole(&grid));
    }

    #[test]
    fn the_northernmost_row_comes_first_and_large_maps_are_thinned() {
        let terrain = level(3, 2);
        let tint = |cell: Cell, _: f32| [cell.row as u8, cell.column as u8, 0];
        let raster = Raster::of(&terrain, Window::whole(&terrain.grid), &tint);
        assert_eq!((raster.width, raster.height), (2, 3));
        assert_eq!(raster.rgb[..6], [2, 0, 0, 2, 1, 0]);
        assert_eq!(raster.color_at(0.0, 0.0), [2, 0, 0]);
        assert_eq!(raster.color_at(0.5, 0.5), [1, 1, 0], "half of column 1, rounded up");
        let wide = level(30, 2500);
        let thinned = Raster::of(&wide, Window::whole(&wide.grid), &plain);
        assert_eq!((thinned.width, thinned.height), (1000, 12));
    }
}
