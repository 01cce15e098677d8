//! What coarse cells hide is bounded by how much their slopes differ, on real ground.

#![allow(clippy::unwrap_used)]

use std::path::Path;

use terrain::{
    Cell, Grid, Terrain,
    hidden_relief::{MOST_OVERSTATED, slope_rms},
    io,
    synthetic::coarsened,
};

/// Mean square of the slopes between neighbours along rows.
fn slope_2(terrain: &Terrain) -> f64 {
    let grid = &terrain.grid;
    let slopes =
        (0..grid.cells()).map(|i| grid.cell(i)).filter(|cell| cell.column + 1 < grid.columns).map(|cell| {
            let next = Cell { column: cell.column + 1, ..cell };
            (terrain.elevation_m(next).unwrap() - terrain.elevation_m(cell).unwrap()) / grid.cell_size_m
        });
    let slopes: Vec<f64> = slopes.collect();
    slopes.iter().map(|slope| slope * slope).sum::<f64>() / slopes.len() as f64
}

#[test]
fn the_slopes_that_coarse_cells_hide_are_no_more_than_twice_overstated_and_hardly_understated() {
    let fine =
        io::read_path(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../maps/minnesota.tif")).unwrap();
    for factor in [4, 8, 16, 24, 40] {
        let coarse = coarsened(&fine, factor).unwrap();
        let hidden = (slope_2(&fine) - slope_2(&coarse)).sqrt();
        let cells = coarse.grid.cells();
        let told_2 =
            (0..cells).map(|i| slope_rms(&coarse, coarse.grid.cell(i)).powi(2)).sum::<f64>() / cells as f64;
        let ratio = told_2.sqrt() / hidden;
        assert!(
            (0.9..1.05 * MOST_OVERSTATED).contains(&ratio),
            "{factor} m: told {}, hidden {hidden}, ratio {ratio}",
            told_2.sqrt()
        );
    }
}

#[test]
fn a_plane_hides_nothing_and_a_ridge_what_its_sides_differ_by() {
    let grid = Grid { rows: 9, columns: 9, cell_size_m: 30.0, origin_m: [0.0, 0.0] };
    let ground = |height_m: &dyn Fn(Cell) -> f64| {
        Terrain::new(grid, &(0..81).map(|i| height_m(grid.cell(i))).collect::<Vec<_>>()).unwrap()
    };
    let middle = Cell { row: 4, column: 4 };
    let plane = ground(&|cell| cell.row as f64 * 3.0 - cell.column as f64 * 1.5);
    assert!(slope_rms(&plane, middle) < 1e-6);
    // Sides of 0.1 up and down meet in one of five columns; rows along it are straight.
    let ridge = ground(&|cell| -3.0 * (cell.column as f64 - 4.0).abs());
    approx::assert_relative_eq!(slope_rms(&ridge, middle), 0.2 * f64::sqrt(0.1), epsilon = 1e-6);
    let line = Grid { rows: 1, columns: 2, ..grid };
    assert_eq!(slope_rms(&Terrain::new(line, &[0.0, 5.0]).unwrap(), Cell { row: 0, column: 0 }), 0.0);
}
