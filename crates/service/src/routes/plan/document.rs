//! What a path comes back as: totals, poses, how the search ended.

use std::time::Duration;

use planner::{Objective, Patience, Plan, Planner, Pose, RefinedPath, Route, Snap};
use serde::{Deserialize, Serialize};
use terrain::{Terrain, Warning};
use utoipa::ToSchema;

use super::PlanRequest;

/// A path with its predicted energy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlanAnswer {
    /// Energy drawn from the battery [J].
    pub energy_j: f64,
    /// Central 95 % interval of it, from the robot's parameter uncertainty [J].
    #[schema(min_items = 2, max_items = 2)]
    pub energy_interval_j: [f64; 2],
    /// Time [s].
    pub duration_s: f64,
    /// Length along the ground [m].
    pub distance_m: f64,
    /// Height gained on the way up [m].
    pub climb_m: f64,
    /// Height lost on the way down [m].
    pub descent_m: f64,
    /// Energy that flowed back into the battery [J].
    pub recovered_j: f64,
    /// The path, pose by pose.
    pub poses: Vec<PoseAnswer>,
    /// Energy of the refined path; absent where `refined` is [J].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refined_energy_j: Option<f64>,
    /// The same way between the same ends with shortcuts and freely placed arcs, driven by the same model within the same
    /// limits, and never worse; absent where none was asked for or no time was left. It is what pictures, tables of tracks and the page show.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refined: Option<RefinedAnswer>,
    /// How far start and goal were moved to the lattice.
    pub snapped: Snapped,
    /// What the search did.
    pub search: SearchAnswer,
    /// Coordinate reference system of the map, `EPSG:` and a code or WKT; absent where it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crs: Option<String>,
    /// Energy that stops and changes of speed on the way take besides, which `energy_j` leaves out: kinetic energy that the motors do
    /// not give back. Speeding up at the start and stopping at the end are not among them [J].
    #[serde(default)]
    pub stops_j: f64,
    /// Number of stops on the way: reversals, and turns on the spot between driving and driving on.
    #[serde(default)]
    pub stops: usize,
    /// Least room on the way between the robot's outline and what it must not touch; at most 31 cells less half its diagonal. Null where no time was left to look [m].
    #[serde(default)]
    pub clearance_m: Option<f64>,
    /// What preferences add in comparisons, in the objective's unit: cost factors of areas, risks and prices; absent where none count.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub preferences: Option<f64>,
    /// Which of `goals` the path leads to, from 0; absent where the request has one goal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reached_goal: Option<usize>,
    /// How far from the goal, in a straight line, a partial path ends; absent where the path leads to the goal [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub short_of_goal_m: Option<f64>,
    /// Doubts about the map and about the path over it.
    #[serde(default)]
    pub warnings: Vec<Warning>,
}

/// A path that leaves the lattice, with the totals that the lattice's path has.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RefinedAnswer {
    /// Energy drawn from the battery [J].
    pub energy_j: f64,
    /// Central 95 % interval of it, from the robot's parameter uncertainty [J].
    #[schema(min_items = 2, max_items = 2)]
    pub energy_interval_j: [f64; 2],
    /// Time [s].
    pub duration_s: f64,
    /// Length along the ground [m].
    pub distance_m: f64,
    /// Height gained on the way up [m].
    pub climb_m: f64,
    /// Height lost on the way down [m].
    pub descent_m: f64,
    /// Energy that flowed back into the battery [J].
    pub recovered_j: f64,
    /// Energy that stops and changes of speed on the way take besides [J].
    pub stops_j: f64,
    /// Number of stops on the way.
    pub stops: usize,
    /// Least room on the way, as that of the lattice's path [m].
    pub clearance_m: Option<f64>,
    /// Whether it was refined to the end. False where the time for it, half of what the search left, was over first: the path is the
    /// best until then.
    pub finished: bool,
    /// The path, pose by pose.
    pub poses: Vec<PoseAnswer>,
}

/// A pose along the path, with what the path has cost up to it. Power, pitch, roll and radius are those of the
/// stretch that ends here; the first pose stands still.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[allow(missing_docs)]
pub struct PoseAnswer {
    pub x_m: f64,
    pub y_m: f64,
    /// Longitude on WGS 84; absent where the map does not say where on earth it lies [°].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lon_deg: Option<f64>,
    /// Latitude on WGS 84 [°].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lat_deg: Option<f64>,
    pub z_m: f64,
    pub heading_rad: f64,
    pub t_s: f64,
    pub distance_m: f64,
    pub energy_j: f64,
    pub power_w: f64,
    pub pitch_rad: f64,
    pub roll_rad: f64,
    /// Positive with the centre on the left; null when straight, 0 on the spot [m].
    pub radius_m: Option<f64>,
}

/// How far both ends were moved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[allow(missing_docs)]
pub struct Snapped {
    pub start: SnapAnswer,
    pub goal: SnapAnswer,
}

/// How far an end was moved to a cell centre and one of sixteen headings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[allow(missing_docs)]
pub struct SnapAnswer {
    pub distance_m: f64,
    pub turn_rad: f64,
}

/// What the search did.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SearchAnswer {
    /// States expanded.
    pub expanded: u64,
    /// Time for preparing and searching [ms].
    pub duration_ms: f64,
    /// Whether the path is proven to be the best of the lattice, to the rounding of costs by 1/2048. This, `bound` and
    /// `excess_at_most` are of the lattice's path, without the curves that lead from and to exact ends.
    pub optimal: bool,
    /// Proven: the path has at most so many times the least of its objective that the lattice allows, rounding included;
    /// null where the least may be nothing or a gain, which no factor bounds.
    pub bound: Option<f64>,
    /// By how much the path may exceed the least of its objective, rounding included; in J, m or s.
    pub excess_at_most: f64,
    /// Whether time ran out before the bound asked for was proven.
    pub timed_out: bool,
}

impl From<&Plan> for PlanAnswer {
    fn from(plan: &Plan) -> Self {
        let total = &plan.route.total;
        PlanAnswer {
            energy_j: total.energy_j,
            energy_interval_j: plan.energy_interval_j,
            duration_s: total.duration_s,
            distance_m: total.length_m,
            climb_m: total.climb_m,
            descent_m: total.descent_m,
            recovered_j: total.recovered_j,
            poses: plan.route.poses.iter().map(PoseAnswer::from).collect(),
            refined_energy_j: plan.refined.as_ref().map(|refined| refined.route.total.energy_j),
            refined: plan.refined.as_ref().map(RefinedAnswer::from),
            snapped: Snapped { start: (&plan.start_snap).into(), goal: (&plan.goal_snap).into() },
            search: SearchAnswer {
                expanded: plan.search.expanded,
                duration_ms: milliseconds(plan.search.duration),
                optimal: plan.search.is_optimal(),
                bound: plan.search.bound,
                excess_at_most: plan.search.excess,
                timed_out: plan.search.timed_out,
            },
            crs: None,
            stops_j: 0.0,
            stops: planner::stops(&plan.route),
            clearance_m: None,
            preferences: None,
            reached_goal: None,
            short_of_goal_m: plan.short_of_goal_m,
            warnings: Vec::new(),
        }
    }
}

impl From<&RefinedPath> for RefinedAnswer {
    fn from(refined: &RefinedPath) -> Self {
        let RefinedPath { route, energy_interval_j, finished } = refined;
        RefinedAnswer {
            energy_j: route.total.energy_j,
            energy_interval_j: *energy_interval_j,
            duration_s: route.total.duration_s,
            distance_m: route.total.length_m,
            climb_m: route.total.climb_m,
            descent_m: route.total.descent_m,
            recovered_j: route.total.recovered_j,
            stops_j: 0.0,
            stops: planner::stops(route),
            clearance_m: None,
            finished: *finished,
            poses: route.poses.iter().map(PoseAnswer::from).collect(),
        }
    }
}

impl PlanAnswer {
    /// The answer to a request: a path with its place on earth, what lies beside it, and doubts about it and its map.
    pub(crate) fn of(plan: &Plan, planner: &Planner, request: &PlanRequest, patience: &Patience) -> Self {
        let lattice = planner.lattice();
        let objective: Objective = request.objective.into();
        let total = &plan.route.total;
        let added = objective.compared(total) - objective.amount(total);
        let beside = |route: &Route| {
            (planner::stops_j(&lattice.robot, route), planner::least_room_m(lattice, route, patience))
        };
        let (stops_j, clearance_m) = beside(&plan.route);
        let refined = plan.refined.as_ref().map(|refined| {
            let (stops_j, clearance_m) = beside(&refined.route);
            RefinedAnswer { stops_j, clearance_m, ..RefinedAnswer::from(refined) }
        });
        let answer = PlanAnswer {
            stops_j,
            clearance_m,
            refined,
            preferences: lattice.has_preferences().then_some(added),
            reached_goal: request.goals.as_ref().map(|_| plan.goal),
            ..PlanAnswer::from(plan)
        };
        answer.warned(planner, request, patience)
    }
}

impl From<&Pose> for PoseAnswer {
    fn from(p: &Pose) -> Self {
        PoseAnswer {
            x_m: p.x_m,
            y_m: p.y_m,
            lon_deg: None,
            lat_deg: None,
            z_m: p.z_m,
            heading_rad: p.heading_rad,
            t_s: p.t_s,
            distance_m: p.distance_m,
            energy_j: p.energy_j,
            power_w: p.power_w,
            pitch_rad: p.pitch_rad,
            roll_rad: p.roll_rad,
            radius_m: p.radius_m,
        }
    }
}

impl PlanAnswer {
    /// The answer with longitude and latitude of its poses, where the map says where on earth it lies.
    #[must_use]
    pub(crate) fn placed(mut self, terrain: &Terrain) -> Self {
        self.crs.clone_from(&terrain.crs);
        place_all(&mut self.poses, terrain);
        if let Some(refined) = &mut self.refined {
            place_all(&mut refined.poses, terrain);
        }
        self
    }
}

/// Sets longitude and latitude of poses, where the map says where on earth it lies.
pub(crate) fn place_all(poses: &mut [PoseAnswer], terrain: &Terrain) {
    let Ok(earth) = terrain.earth() else { return };
    for pose in poses {
        let place_deg = earth.place_deg([pose.x_m, pose.y_m]).ok();
        [pose.lon_deg, pose.lat_deg] = [0, 1].map(|axis| place_deg.map(|place| place[axis]));
    }
}

impl From<&Snap> for SnapAnswer {
    fn from(snap: &Snap) -> Self {
        SnapAnswer { distance_m: snap.distance_m, turn_rad: snap.turn_rad }
    }
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}
