//! Ground made from a seed, for trials at sizes and shapes that no survey covers.

use rayon::prelude::*;

use crate::{Cell, Error, Grid, Surfaces, Terrain};

/// Natural-looking relief: value noise in octaves, each half as long and `ROUGHNESS` as high as the one before.
///
/// `longest_m` is the length of the largest hills, `height_m` the span they would have alone. The same seed gives
/// the same ground on every machine. Elevations are whole millimetres.
pub fn relief(grid: Grid, seed: u64, longest_m: f64, height_m: f64) -> Vec<f64> {
    (0..grid.cells())
        .into_par_iter()
        .map(|index| {
            let cell = grid.cell(index);
            let (x_m, y_m) =
                ((cell.column as f64 + 0.5) * grid.cell_size_m, (cell.row as f64 + 0.5) * grid.cell_size_m);
            (octaves_m(seed, x_m, y_m, longest_m, height_m) * 1000.0).round() / 1000.0
        })
        .collect()
}

/// Ground in cells of so many of its own along each side, each of their mean height; what is left over at the far edges is cut off, and
/// cells with unknown ground are unknown.
///
/// # Errors
/// A factor of 0 or above the rows or columns, or ground without a known cell.
pub fn coarsened(fine: &Terrain, factor: usize) -> Result<Terrain, Error> {
    let per = |cells: usize| cells.checked_div(factor).unwrap_or(0);
    let (rows, columns) = (per(fine.grid.rows), per(fine.grid.columns));
    let cell_size_m = fine.grid.cell_size_m * factor as f64;
    let grid = Terrain::check_size(rows as u64, columns as u64, cell_size_m, fine.grid.origin_m)?;
    let mean = |index: usize| {
        let Cell { row, column } = grid.cell(index);
        let inside = (0..factor * factor)
            .map(|i| Cell { row: row * factor + i / factor, column: column * factor + i % factor });
        let sum_m: Option<f64> = inside.map(|cell| fine.elevation_m(cell)).sum();
        sum_m.map_or(f64::NAN, |sum_m| sum_m / (factor * factor) as f64)
    };
    Terrain::new(grid, &(0..grid.cells()).map(mean).collect::<Vec<f64>>())
}

/// How much of an octave's height the next one has; 0.45 looks like the shipped lidar terrain.
const ROUGHNESS: f64 = 0.45;
const OCTAVES: u32 = 5;

fn octaves_m(seed: u64, x_m: f64, y_m: f64, longest_m: f64, height_m: f64) -> f64 {
    let (mut length_m, mut span_m, mut sum_m) = (longest_m, height_m, 0.0);
    for octave in 0..OCTAVES {
        let salt = seed.wrapping_add(u64::from(octave).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        sum_m += span_m * smooth_noise(salt, x_m / length_m, y_m / length_m);
        length_m /= 2.0;
        span_m *= ROUGHNESS;
    }
    sum_m
}

/// Noise of period one, smooth in value and slope, 0 to 1.
fn smooth_noise(salt: u64, x: f64, y: f64) -> f64 {
    let (x0, y0) = (x.floor(), y.floor());
    let fade = |t: f64| t * t * t * (t * (6.0 * t - 15.0) + 10.0);
    let (u, v) = (fade(x - x0), fade(y - y0));
    let corner = |dx: i64, dy: i64| uniform(salt, x0 as i64 + dx, y0 as i64 + dy);
    let south = corner(0, 0) * (1.0 - u) + corner(1, 0) * u;
    let north = corner(0, 1) * (1.0 - u) + corner(1, 1) * u;
    south * (1.0 - v) + north * v
}

/// A number in 0..1 that depends on the seed and place only (SplitMix64's finaliser).
fn uniform(salt: u64, x: i64, y: i64) -> f64 {
    let mut z = salt
        ^ (x as u64).wrapping_mul(0xD1B5_4A32_D192_ED03)
        ^ (y as u64).wrapping_mul(0xABC9_8388_FB8F_AC03);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^= z >> 31;
    (z >> 11) as f64 / (1u64 << 53) as f64
}

/// A yard at the scale of a robot: 24 m × 16 m in 0.2 m cells, a paved court in sandy ground, a mound, a wall with
/// a gap, and a few crates. `maps/yard.json` is this with seed 7.
pub fn yard(seed: u64) -> Terrain {
    let grid = Grid { rows: 80, columns: 120, cell_size_m: 0.2, origin_m: [0.0, 0.0] };
    let gentle_m = relief(grid, seed, 12.0, 0.8);
    let mut elevation_m = Vec::with_capacity(grid.cells());
    let mut obstacle = Vec::with_capacity(grid.cells());
    let mut names = Vec::with_capacity(grid.cells());
    for (index, ground_m) in gentle_m.iter().enumerate() {
        let [x_m, y_m] = grid.center_m(grid.cell(index));
        let mound_m = 1.1 * (-((x_m - 15.0).powi(2) + (y_m - 10.5).powi(2)) / 6.0).exp();
        let paved = (3.0..11.0).contains(&x_m) && (2.0..12.0).contains(&y_m);
        let level_m = if paved { ground_m * 0.15 + 0.35 } else { *ground_m };
        elevation_m.push(((level_m + mound_m) * 1000.0).round() / 1000.0);
        obstacle.push(is_yard_obstacle(seed, x_m, y_m));
        names.push(Some(if paved { "marble" } else { "sandy_loam" }));
    }
    let terrain =
        Terrain::new(grid, &elevation_m).unwrap_or_else(|_| unreachable!("the yard's relief is bounded"));
    let surfaces =
        Surfaces::from_names(names.into_iter()).unwrap_or_else(|_| unreachable!("the yard has two surfaces"));
    terrain.with_surfaces(surfaces).with_obstacles(obstacle)
}

fn is_yard_obstacle(seed: u64, x_m: f64, y_m: f64) -> bool {
    let wall = (12.4..12.8).contains(&x_m) && !(4.0..6.0).contains(&y_m);
    let crate_at = |i: i64| {
        let cx = 13.5 + 9.0 * uniform(seed, i, 1);
        let cy = 1.0 + 6.0 * uniform(seed, i, 2);
        (x_m - cx).abs() < 0.4 && (y_m - cy).abs() < 0.4
    };
    wall || (0..5).any(crate_at)
}

/// Ground of any size from a smaller piece: copies of it side by side, every other one mirrored, so that it joins without
/// steps.
///
/// # Errors
/// When the size is out of range.
pub fn mirrored(terrain: &Terrain, rows: usize, columns: usize) -> Result<Terrain, Error> {
    let from = &terrain.grid;
    let grid = Terrain::check_size(rows as u64, columns as u64, from.cell_size_m, from.origin_m)?;
    let fold = |i: usize, n: usize| if (i / n).is_multiple_of(2) { i % n } else { n - 1 - i % n };
    let elevation_m: Vec<f64> = (0..grid.cells())
        .map(|index| {
            let cell = grid.cell(index);
            let source = Cell { row: fold(cell.row, from.rows), column: fold(cell.column, from.columns) };
            terrain.elevation_m(source).unwrap_or(f64::NAN)
        })
        .collect();
    Terrain::new(grid, &elevation_m)
}

/// Scatters single blocked cells over ground, each cell with probability `share`; the borders stay free.
pub fn scatter_obstacles(terrain: Terrain, seed: u64, share: f64) -> Terrain {
    let grid = terrain.grid;
    let obstacle = (0..grid.cells())
        .map(|index| {
            let Cell { row, column } = grid.cell(index);
            let border = row == 0 || column == 0 || row + 1 == grid.rows || column + 1 == grid.columns;
            !border && uniform(seed ^ 0x5EED, column as i64, row as i64) < share
        })
        .collect();
    terrain.with_obstacles(obstacle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_gives_the_same_ground_and_another_seed_another() {
        assert_eq!(yard(7), yard(7));
        assert_ne!(yard(7), yard(8));
    }

    #[test]
    fn mirrored_copies_join_without_a_step_and_repeat_after_two() {
        let yard = yard(7);
        let (rows, columns) = (yard.grid.rows, yard.grid.columns);
        let large = mirrored(&yard, 3 * rows, 3 * columns).unwrap();
        let z = |row, column| large.elevation_m(Cell { row, column });
        assert_eq!(z(rows - 1, 5), z(rows, 5));
        assert_eq!(z(3, columns - 1), z(3, columns));
        assert_eq!(z(7, 9), z(7 + 2 * rows, 9 + 2 * columns));
    }

    #[test]
    fn relief_keeps_within_the_sum_of_its_octaves() {
        let grid = Grid { rows: 50, columns: 50, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        let z = relief(grid, 1, 30.0, 10.0);
        let most_m = 10.0 / (1.0 - ROUGHNESS);
        assert!(z.iter().all(|z| (0.0..=most_m).contains(z)));
        let span_m = z.iter().copied().fold(0.0, f64::max) - z.iter().copied().fold(most_m, f64::min);
        assert!(span_m > 2.0, "{span_m} m of relief");
    }
}
