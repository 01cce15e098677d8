//! How noisy the heights of a map are.

use terrain::Terrain;

/// Most blocks of four cells that are looked at: the median of so many is known to a third of a per cent.
const BLOCKS: usize = 1 << 17;

/// Standard deviation of the heights' noise, as far as it goes from cell to cell [m].
///
/// Of every block of 2 × 2 cells the difference across both diagonals is taken,
///
/// ```text
/// d = z_sw − z_se − z_nw + z_ne,   σ = median |d| / (2 · 0.6745)
/// ```
///
/// which a plane makes 0, slopes make small, and noise of σ in each cell a normal of 2 σ; 0.6745 is the median of a
/// standard normal's size. It is the finest diagonal detail of Haar's wavelet, and the median passes over walls and kerbs,
/// which lie in few blocks (Donoho & Johnstone, Ideal spatial adaptation by wavelet shrinkage, Biometrika 81(3), 1994).
pub(crate) fn sigma_m(terrain: &Terrain) -> f64 {
    const MEDIAN_OF_NORMAL: f64 = 0.6745;
    let grid = &terrain.grid;
    let (rows, columns) = (grid.rows / 2, grid.columns / 2);
    let every = (rows * columns).div_ceil(BLOCKS).max(1);
    let z = terrain.relative_m();
    let mut differences_m: Vec<f32> = (0..rows * columns)
        .step_by(every)
        .map(|block| {
            let at = 2 * (block / columns) * grid.columns + 2 * (block % columns);
            (z[at] - z[at + 1] - z[at + grid.columns] + z[at + grid.columns + 1]).abs()
        })
        .filter(|d| d.is_finite())
        .collect();
    if differences_m.is_empty() {
        return 0.0;
    }
    let middle = differences_m.len() / 2;
    let (_, median_m, _) = differences_m.select_nth_unstable_by(middle, f32::total_cmp);
    f64::from(*median_m) / (2.0 * MEDIAN_OF_NORMAL)
}

/// What the noise of the highest of all cells of a map comes to [m]: of n normals the largest is some σ √(2 ln n) (Leadbetter,
/// Lindgren & Rootzén, *Extremes and Related Properties of Random Sequences*, 1983, ch. 1).
pub(crate) fn highest_m(terrain: &Terrain) -> f64 {
    let cells = terrain.grid.cells().max(2) as f64;
    sigma_m(terrain) * (2.0 * cells.ln()).sqrt()
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use terrain::Grid;

    use super::*;

    /// Heights of a map of 200 × 200 cells with noise.
    fn sigma_of(sigma_m: f64, height_m: impl Fn(f64, f64) -> f64) -> f64 {
        let grid = Grid { rows: 200, columns: 200, cell_size_m: 0.1, origin_m: [0.0, 0.0] };
        let mut state = 7u64;
        let mut uniform = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) as f64 + 0.5) / f64::from(1u32 << 31)
        };
        let mut normal = move || (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos();
        let z: Vec<f64> = (0..grid.cells())
            .map(|i| {
                let [x_m, y_m] = grid.center_m(grid.cell(i));
                height_m(x_m, y_m) + sigma_m * normal()
            })
            .collect();
        super::sigma_m(&Terrain::new(grid, &z).unwrap())
    }

    #[test]
    fn noise_is_found_on_slopes_and_beside_walls_and_nothing_else_is() {
        assert_relative_eq!(sigma_of(0.03, |_, _| 0.0), 0.03, max_relative = 0.03);
        assert_relative_eq!(sigma_of(0.03, |x, y| 0.4 * x - 0.2 * y), 0.03, max_relative = 0.03);
        let wall = |x: f64, y: f64| if (5.0..5.3).contains(&x) && y < 15.0 { 2.0 } else { 0.0 };
        assert_relative_eq!(sigma_of(0.03, wall), 0.03, max_relative = 0.05);
        assert_eq!(sigma_of(0.0, wall), 0.0);
        assert!(sigma_of(0.0, |x, y| (x / 3.0).sin() * (y / 2.0).cos()) < 0.002);
    }
}
