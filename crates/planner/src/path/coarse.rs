//! Maps whose cells are far coarser than the robot.

use std::collections::HashMap;

use model::{Acceleration, Attitude, Grade, Manoeuvre};
use terrain::hidden_relief::slope_rms;

use crate::{lattice::graph::Lattice, path::route::Route};

/// Cells that are longer than so many wheelbases are coarse: an order of magnitude, from which on a cell's one slope stands for ground
/// that the robot climbs and descends many times over.
const COARSE_WHEELBASES: f64 = 10.0;

/// Whether the cells of a lattice's map are far coarser than its robot, so that they hide ups and downs, which the intervals of its
/// paths' energies hold.
pub fn is_coarse(lattice: &Lattice) -> bool {
    lattice.terrain.grid.cell_size_m > COARSE_WHEELBASES * lattice.robot.wheelbase_m
}

/// Relief that a cell far coarser than the robot hides, under a step of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HiddenRelief {
    /// Index of the cell.
    pub cell: usize,
    /// Root mean square of its slopes about that of the map [-].
    pub slope_rms: f64,
}

/// The relief that cells hide under each step of a route: that of the cell that the step ends in. Empty where the map is not coarse.
pub fn hidden_relief(route: &Route, lattice: &Lattice) -> Vec<HiddenRelief> {
    if !is_coarse(lattice) {
        return Vec::new();
    }
    let terrain = &lattice.terrain;
    let mut known: HashMap<usize, f64> = HashMap::new();
    let ends = route.poses.iter().skip(1);
    let cells = ends.map(|pose| terrain.grid.cell_at(pose.x_m, pose.y_m));
    let hidden = cells.map(|cell| {
        let Some(cell) = cell else { return HiddenRelief { cell: usize::MAX, slope_rms: 0.0 } };
        let index = terrain.grid.index(cell);
        let slope_rms = *known.entry(index).or_insert_with(|| slope_rms(terrain, cell));
        HiddenRelief { cell: index, slope_rms }
    });
    hidden.collect()
}

impl HiddenRelief {
    /// Power that the relief adds on average to that of a manoeuvre on a grade [W]: slopes within the cell are normally distributed about
    /// that of the map. What climbs take is more than what descents give back, and the way along the ground is longer.
    pub fn added_w(&self, manoeuvre: &Manoeuvre, grade: Grade<f64>) -> f64 {
        // Gauss and Hermite's rule of three points: nodes in standard deviations, and their weights.
        let nodes = [(-f64::sqrt(3.0), 1.0 / 6.0), (0.0, 2.0 / 3.0), (f64::sqrt(3.0), 1.0 / 6.0)];
        let power_w = |grade| manoeuvre.power_on_grade(grade, Acceleration::NONE).bus_w;
        let of_node_w = |(node, weight): (f64, f64)| {
            let (pitched, stretch) = pitched(grade, node * self.slope_rms);
            weight * stretch * power_w(pitched)
        };
        nodes.into_iter().map(of_node_w).sum::<f64>() - power_w(grade)
    }
}

/// A grade with the nose up by so much more [-], and how much longer the way along it is over the same ground plan.
fn pitched(grade: Grade<f64>, slope: f64) -> (Grade<f64>, f64) {
    let pitch_rad = grade.along.clamp(-1.0, 1.0).asin();
    let steeper = Attitude { pitch_rad: (pitch_rad.tan() + slope).atan(), roll_rad: grade.tilt.atan() };
    (steeper.grade(), pitch_rad.cos() / steeper.pitch_rad.cos())
}
