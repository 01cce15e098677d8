//! What the reach of one full charge takes over the lidar map, mirrored to size.
//!
//!     cargo run --release -p joulepath-routing --example reach [-- MAP [SIDE]]

use std::{error::Error, path::PathBuf, time::Instant};

use model::builtin;
use planner::{Patience, Planner, Settings};
use routing::{Kind, Waypoint, available_j, reach};
use terrain::{Cell, Grid, Terrain, io};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let map = arguments.next().unwrap_or_else(|| "maps/minnesota.tif".into());
    let side: usize = arguments.next().map_or(Ok(1000), |n| n.parse())?;
    let terrain = mirrored(&io::read_path(&PathBuf::from(&map))?, side)?;
    let robot = builtin::husky_a200();
    let battery = robot.battery.as_ref().ok_or("the robot has no battery")?;
    let most_j = available_j(battery, 1.0)?;
    let planner = Planner::new(&terrain, &robot, Settings::of(&robot))?;
    let [x_m, y_m] = terrain.grid.at_fraction_m(0.5, 0.5);
    let place = Waypoint { x_m, y_m, heading_rad: None };
    println!("{side} × {side} cells × 16 headings, {:.0} kJ", most_j / 1e3);
    let patience = Patience::default();
    for kind in [Kind::Outward, Kind::Homeward, Kind::OutAndBack] {
        for state in ["cold", "warm"] {
            let began = Instant::now();
            let found = reach(&planner, &place, kind, most_j, None, &patience)?;
            let taken_s = began.elapsed().as_secs_f64();
            let share = found.area_m2(most_j, &patience)?
                / (found.grid.cells() as f64 * found.grid.cell_size_m.powi(2));
            let began = Instant::now();
            let polygons = found.within(most_j / 20.0, &patience)?.len();
            println!(
                "{kind:?} {state}: {taken_s:.2} s, {:.1} % of the map; a contour of {polygons} polygons in {:.0} ms",
                100.0 * share,
                began.elapsed().as_secs_f64() * 1e3
            );
        }
    }
    Ok(())
}

/// The ground, mirrored at its edges to so many cells a side.
fn mirrored(terrain: &Terrain, side: usize) -> Result<Terrain, terrain::Error> {
    let fold = |i: usize, count: usize| {
        let at = i % (2 * count);
        if at < count { at } else { 2 * count - 1 - at }
    };
    let grid = Grid { rows: side, columns: side, ..terrain.grid };
    let at = |i: usize| {
        let Cell { row, column } = grid.cell(i);
        Cell { row: fold(row, terrain.grid.rows), column: fold(column, terrain.grid.columns) }
    };
    let z: Vec<f64> = (0..grid.cells()).map(|i| terrain.elevation_m(at(i)).unwrap_or(f64::NAN)).collect();
    Terrain::new(grid, &z)
}
