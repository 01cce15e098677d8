//! Ground to plan over, and where from and to.

use std::sync::Arc;

use model::{Robot, builtin};
use planner::{Goal, Heading, Lattice, Patience, Query, Settings, Start, State};
use terrain::{Cell, Terrain, synthetic};

use crate::Error;

/// Kinds of ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ground {
    /// The tile's relief.
    Relief,
    /// The same, strewn with obstacles.
    Obstacles,
}

/// Share of cells that are obstacles: as many as leave ways through.
const OBSTACLE_SHARE: f64 = 0.05;
const OBSTACLE_SEED: u64 = 3;

/// Both ends as fractions of the map: corner to corner, clear of the edges.
const START: [f64; 2] = [0.1, 0.12];
const GOAL: [f64; 2] = [0.9, 0.88];

impl Ground {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Ground::Relief => "relief",
            Ground::Obstacles => "obstacles",
        }
    }
}

/// A map with a robot and a way across.
pub(crate) struct Scene {
    pub(crate) side: usize,
    pub(crate) ground: Ground,
    pub(crate) terrain: Terrain,
    pub(crate) robot: Robot,
    pub(crate) lattice: Arc<Lattice>,
    pub(crate) starts: Vec<State>,
    pub(crate) goals: Vec<State>,
}

impl Scene {
    pub(crate) fn new(tile: &Terrain, side: usize, ground: Ground) -> Result<Self, Error> {
        let mirrored = synthetic::mirrored(tile, side, side).map_err(|source| Error::Map { side, source })?;
        let terrain = match ground {
            Ground::Relief => mirrored,
            Ground::Obstacles => synthetic::scatter_obstacles(mirrored, OBSTACLE_SEED, OBSTACLE_SHARE),
        };
        let robot = builtin::husky_a200();
        let lattice = Lattice::new(&terrain, &robot, Settings::of(&robot))
            .map_err(|source| Error::Plan { side, source })?;
        // One pose, as general-purpose searches take it.
        let starts: Vec<State> = standing(&lattice, START).into_iter().take(1).collect();
        let goals = standing(&lattice, GOAL);
        if starts.is_empty() || goals.is_empty() {
            return Err(Error::NoPath { side });
        }
        Ok(Scene { side, ground, terrain, robot, lattice, starts, goals })
    }

    pub(crate) fn states(&self) -> usize {
        self.lattice.states()
    }

    pub(crate) fn goal_cell(&self) -> Cell {
        self.goals[0].cell
    }

    pub(crate) fn no_path(&self) -> Error {
        Error::NoPath { side: self.side }
    }

    /// The way across as a question, from a place beside the start.
    pub(crate) fn query(&self, beside_m: [f64; 2]) -> Query {
        let [x_m, y_m] = self.terrain.grid.center_m(self.starts[0].cell);
        let [gx_m, gy_m] = self.terrain.grid.center_m(self.goal_cell());
        Query {
            start: Start { x_m: x_m + beside_m[0], y_m: y_m + beside_m[1], heading_rad: None },
            goal: Goal { x_m: gx_m, y_m: gy_m, heading_rad: None, either_way: false, tolerance_m: 0.0 },
            settings: self.lattice.settings,
            other_goals: Vec::new(),
            snap_radius_m: Some(10.0 * self.terrain.grid.cell_size_m),
            bound: 1.0,
            refine: false,
            exact_ends: false,
            patience: Patience::default(),
        }
    }
}

/// Poses at the first cell at or beside a place of the map where the robot can stand.
fn standing(lattice: &Lattice, [east, north]: [f64; 2]) -> Vec<State> {
    let grid = &lattice.terrain.grid;
    let at = |share: f64, count: usize| ((share * count as f64) as usize).min(count - 1);
    let (row, column) = (at(north, grid.rows), at(east, grid.columns));
    (column..grid.columns)
        .map(|column| {
            let poses = Heading::all().map(|heading| State { cell: Cell { row, column }, heading });
            poses.filter(|state| lattice.stand(*state).is_ok()).collect::<Vec<_>>()
        })
        .find(|poses| !poses.is_empty())
        .unwrap_or_default()
}
