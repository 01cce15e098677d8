//! What can be reached within some energies, as tinted bands over shaded relief.

use routing::Reach;
use terrain::{Cell, SlopeMap, Terrain, hillshade::hillshade};

/// Vertical exaggeration of the shading, as in the comparison's picture.
const EXAGGERATION: f32 = 2.0;
/// The longer side of a picture has about so many pixels.
const SIDE_PIXELS: usize = 800;
/// Share of a band's tint over the relief; its rim is drawn in the tint itself.
const TINT: f32 = 0.4;
/// Tints of bands, the innermost first; they stay apart for colour-blind eyes (Okabe & Ito).
const TINTS: [[u8; 3]; 5] =
    [[0x00, 0x72, 0xB2], [0x00, 0x9E, 0x73], [0xE6, 0x9F, 0x00], [0xD5, 0x5E, 0x00], [0xCC, 0x79, 0xA7]];
/// Radius of the dot at the start [pixels].
const DOT_PIXELS: f64 = 7.0;

/// Draws the bands between energies [J] as a PNG, north up, with a dot where the ways start [m].
pub(crate) fn draw(
    terrain: &Terrain,
    reach: &Reach,
    energies_j: &[f64],
    start_m: [f64; 2],
) -> anyhow::Result<Vec<u8>> {
    let grid = &terrain.grid;
    let shade = hillshade(terrain, &SlopeMap::new(terrain), EXAGGERATION);
    let mut levels_j = energies_j.to_vec();
    levels_j.sort_by(f64::total_cmp);
    // Beyond all levels where not even the last is enough.
    let band = |cell: Cell| {
        let energy_j = reach.energy_j[grid.index(cell)];
        levels_j.iter().position(|level_j| energy_j <= *level_j).unwrap_or(levels_j.len())
    };
    let scale = (SIDE_PIXELS / grid.rows.max(grid.columns)).max(1);
    let (width, height) = (grid.columns * scale, grid.rows * scale);
    let dot = [(start_m[0] - grid.origin_m[0]), (grid.far_corner_m()[1] - start_m[1])]
        .map(|along_m| along_m / grid.cell_size_m * scale as f64);
    let mut pixels = Vec::with_capacity(3 * width * height);
    for y in 0..height {
        for x in 0..width {
            let cell = Cell { row: grid.rows - 1 - y / scale, column: x / scale };
            let away = (x as f64 + 0.5 - dot[0]).hypot(y as f64 + 0.5 - dot[1]);
            let color = if away <= DOT_PIXELS {
                [if away <= DOT_PIXELS - 2.0 { 0 } else { 255 }; 3]
            } else {
                // Lightened, so that the tints stand out.
                let gray = 90.0 + f32::from(shade[grid.index(cell)]) * 160.0 / 255.0;
                tinted(gray, band(cell), levels_j.len(), is_rim(grid, cell, &band))
            };
            pixels.extend(color);
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, u32::try_from(width)?, u32::try_from(height)?);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    encoder.write_header()?.write_image_data(&pixels)?;
    Ok(bytes)
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
    TINTS[band % TINTS.len()].map(|tint| (gray + share * (f32::from(tint) - gray)) as u8)
}
