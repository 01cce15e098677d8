//! What can be reached within some energies, as tinted bands over shaded relief.

use routing::Reach;
use terrain::{Cell, Terrain};

use crate::raster::{Raster, Window, encode};

/// The longer side of a picture has about so many pixels.
const SIDE_PIXELS: usize = 800;
/// Share of a band's tint over the relief; its rim is drawn in the tint itself.
const TINT: f32 = 0.4;
/// Tints of bands, the innermost first; they stay apart for colour-blind eyes (Okabe & Ito).
const TINTS: [[u8; 3]; 5] =
    [[0x00, 0x72, 0xB2], [0x00, 0x9E, 0x73], [0xE6, 0x9F, 0x00], [0xD5, 0x5E, 0x00], [0xCC, 0x79, 0xA7]];
/// Radius of the dot at the start [pixels].
const DOT_PIXELS: f64 = 7.0;

/// The tint of a band, counted from the innermost.
pub(crate) fn tint(band: usize) -> [u8; 3] {
    TINTS[band % TINTS.len()]
}

/// The bands between energies [J] over all of the map, north up.
pub(crate) fn bands(terrain: &Terrain, reach: &Reach, energies_j: &[f64]) -> Raster {
    let grid = &terrain.grid;
    let mut levels_j = energies_j.to_vec();
    levels_j.sort_by(f64::total_cmp);
    // Beyond all levels where not even the last is enough.
    let band = |cell: Cell| {
        let energy_j = reach.energy_j[grid.index(cell)];
        levels_j.iter().position(|level_j| energy_j <= *level_j).unwrap_or(levels_j.len())
    };
    let color = |cell: Cell, gray: f32| tinted(gray, band(cell), levels_j.len(), is_rim(grid, cell, &band));
    Raster::of(terrain, Window::whole(grid), &color)
}

/// Draws the bands as a PNG with a dot where the ways start [m].
pub(crate) fn draw(
    terrain: &Terrain,
    reach: &Reach,
    energies_j: &[f64],
    start_m: [f64; 2],
) -> anyhow::Result<Vec<u8>> {
    let raster = bands(terrain, reach, energies_j);
    let scale = (SIDE_PIXELS / raster.width.max(raster.height)).max(1);
    let (width, height) = (raster.width * scale, raster.height * scale);
    let (window, extent_m) = (raster.window, raster.window.extent_m());
    let dot = [
        (start_m[0] - window.low_m[0]) / extent_m[0] * width as f64,
        (window.high_m[1] - start_m[1]) / extent_m[1] * height as f64,
    ];
    let mut pixels = Vec::with_capacity(3 * width * height);
    for y in 0..height {
        for x in 0..width {
            let away = (x as f64 + 0.5 - dot[0]).hypot(y as f64 + 0.5 - dot[1]);
            let at = 3 * (y / scale * raster.width + x / scale);
            match away <= DOT_PIXELS {
                true => pixels.extend([if away <= DOT_PIXELS - 2.0 { 0 } else { 255 }; 3]),
                false => pixels.extend_from_slice(&raster.rgb[at..at + 3]),
            }
        }
    }
    encode(&pixels, width, height)
}

/// Whether a cell lies inside a band that its neighbour to the east, west, north or south lies beyond.
fn is_rim(grid: &terrain::Grid, cell: Cell, band: &impl Fn(Cell) -> usize) -> bool {
    let Cell { row, column } = cell;
    let beside = [
        (row > 0).then(|| Cell { row: row - 1, column }),
        (row + 1 < grid.rows).then(|| Cell { row: row + 1, column }),
        (column > 0).then(|| Cell { row, column: column - 1 }),
        (column + 1 < grid.columns).then(|| Cell { row, column: column + 1 }),
    ];
    let own = band(cell);
    beside.into_iter().flatten().any(|other| band(other) > own)
}

/// The relief's gray under the tint of a band; without one beyond the last.
fn tinted(gray: f32, band: usize, bands: usize, is_rim: bool) -> [u8; 3] {
    if band == bands {
        return [gray as u8; 3];
    }
    let share = if is_rim { 1.0 } else { TINT };
    tint(band).map(|tint| (gray + share * (f32::from(tint) - gray)) as u8)
}
