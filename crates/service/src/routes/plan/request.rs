//! What a path is asked for by.

use model::{PowerModel, Robot};
use planner::{Goal, Objective, Patience, Planner, Query, Settings, Start};
use serde::{Deserialize, Serialize};
use terrain::{MapFile, Terrain};
use utoipa::ToSchema;

use super::{ForbidName, GoalHeading, PricesRequest, UnknownGroundRequest};
use crate::{
    place::{Place, absent, settle_all},
    problem::Problem,
    routes::robots::RobotChoice,
};

/// What to plan.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanRequest {
    /// The map itself; give this or `map_id`.
    pub map: Option<MapFile>,
    /// Id of a stored map; give this or `map`.
    pub map_id: Option<String>,
    /// Name of a built-in robot, id of a stored one, or a robot.
    pub robot: RobotChoice,
    /// Where the robot stands.
    pub start: StartPose,
    /// Where it is to go; give this or `goals`.
    #[serde(default = "GoalPose::absent")]
    #[schema(required)]
    pub goal: GoalPose,
    /// Several places of which any will do, at most 64: the path leads to the one that is best to reach (`reached_goal` of the
    /// answer). Those where the robot cannot stand do not count.
    #[schema(min_items = 1, max_items = 64)]
    pub goals: Option<Vec<GoalPose>>,
    /// What the path is to have least of. Default: `energy`.
    #[serde(default)]
    pub objective: ObjectiveName,
    /// Forward speed; lowered where the outer wheel would be too fast. Default: half the wheels' top speed [m/s].
    pub speed_mps: Option<f64>,
    /// Form of the physics. Default: `force-balance`.
    #[serde(default)]
    pub power_model: PowerModel,
    /// Whether the robot may back up. Default: false.
    #[serde(default)]
    pub reverse: bool,
    /// The path may cost so many times the least, 1 to 10: looser bounds are answered sooner. Default: 1, the least itself.
    #[serde(default = "one")]
    #[schema(minimum = 1.0, maximum = 10.0)]
    pub bound: f64,
    /// Whether to refine the path off the lattice too. Default: true.
    #[serde(default = "yes")]
    pub refine: bool,
    /// Time for the search; when it is over the best path so far is the answer, with what is proven of it. Default: the
    /// service's limit [s].
    #[schema(exclusive_minimum = 0.0)]
    pub timeout_s: Option<f64>,
    /// Whether to work out and keep the exact cost to this goal from every pose of a stored map, so that later plans to it
    /// are immediate. Default: false.
    #[serde(default)]
    pub hold_goal: bool,
    /// How far a start or goal may be moved to ground where the robot can stand. Default: one cell [m].
    pub snap_radius_m: Option<f64>,
    /// The path may take no longer. Default: no limit [s].
    #[schema(exclusive_minimum = 0.0)]
    pub max_time_s: Option<f64>,
    /// The path may have drawn no more on arrival; negative asks for a gain. Default: no limit [J].
    pub max_energy_j: Option<f64>,
    /// The path may be no longer. Default: no limit [m].
    #[schema(exclusive_minimum = 0.0)]
    pub max_distance_m: Option<f64>,
    /// Steepest climb, descent or sideways tilt on the way, up to 1.571, which is π/2. Default: the robot's limits [rad].
    #[schema(exclusive_minimum = 0.0, maximum = 1.571)]
    pub max_slope_rad: Option<f64>,
    /// Areas over the map, in place of those that it has: a GeoJSON feature collection of polygons and lines, in longitude and latitude
    /// where the map has a `crs`, else in its metres. Their properties may be `surface`, `keep_out`, `max_speed_mps`, `cost_factor`
    /// and `one_way_rad`. Default: the map's own.
    #[schema(value_type = Option<Object>)]
    pub areas: Option<serde_json::Value>,
    /// Opens unknown ground to the robot. Default: it is impassable.
    pub unknown_ground: Option<UnknownGroundRequest>,
    /// What manoeuvres weigh in comparisons besides what they take. Default: nothing.
    pub prices: Option<PricesRequest>,
    /// What the robot is not to do. Default: nothing.
    #[serde(default)]
    pub forbid: Vec<ForbidName>,
    /// No turn is tighter; above 0 the robot does not turn on the spot. Default: half its slip track for arcs [m].
    #[schema(minimum = 0.0)]
    pub least_radius_m: Option<f64>,
    /// Whether the best part of the way is the answer where no path leads to the goal: to the place nearest to it that can be reached
    /// (`short_of_goal_m` of the answer). Default: false.
    #[serde(default)]
    pub partial: bool,
    /// Whether the path begins and ends exactly where it is asked to, by curves to and from the lattice's path, where ground and
    /// obstacles allow them; else at centres of cells. Default: true.
    #[serde(default = "yes")]
    pub exact_ends: bool,
    /// Whether cost factors and risks count; amounts of other questions leave them out.
    #[serde(skip, default = "yes")]
    #[schema(ignore)]
    pub preferences: bool,
}

/// Where the robot stands.
#[derive(Clone, Copy, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct StartPose {
    /// East; give this and `y_m`, or `lon_deg` and `lat_deg` [m].
    #[serde(default = "absent")]
    pub x_m: f64,
    /// North [m].
    #[serde(default = "absent")]
    pub y_m: f64,
    /// Longitude on WGS 84, −180 to 180, where the map has a `crs` [°].
    #[serde(default)]
    #[schema(minimum = -180.0, maximum = 180.0)]
    pub lon_deg: Option<f64>,
    /// Latitude on WGS 84, −90 to 90 [°].
    #[serde(default)]
    #[schema(minimum = -90.0, maximum = 90.0)]
    pub lat_deg: Option<f64>,
    /// Counter-clockwise from east; turned to the nearest of sixteen. Default: the planner chooses; −6.3 to 6.3 [rad].
    #[schema(minimum = -6.3, maximum = 6.3)]
    pub heading_rad: Option<f64>,
}

/// Where the robot is to go.
#[derive(Clone, Copy, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct GoalPose {
    /// East; give this and `y_m`, or `lon_deg` and `lat_deg` [m].
    #[serde(default = "absent")]
    pub x_m: f64,
    /// North [m].
    #[serde(default = "absent")]
    pub y_m: f64,
    /// Longitude on WGS 84, −180 to 180, where the map has a `crs` [°].
    #[serde(default)]
    #[schema(minimum = -180.0, maximum = 180.0)]
    pub lon_deg: Option<f64>,
    /// Latitude on WGS 84, −90 to 90 [°].
    #[serde(default)]
    #[schema(minimum = -90.0, maximum = 90.0)]
    pub lat_deg: Option<f64>,
    /// Counter-clockwise from east; turned to the nearest of sixteen. Default: any; −6.3 to 6.3 [rad].
    #[schema(minimum = -6.3, maximum = 6.3)]
    pub heading_rad: Option<f64>,
    /// `either`: the opposite of `heading_rad` will do as well.
    #[serde(default)]
    pub heading: Option<GoalHeading>,
    /// Any pose this close will do. Default: 0, the goal's own cell [m].
    #[serde(default)]
    pub tolerance_m: f64,
}

/// What a path is to have least of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ObjectiveName {
    /// Energy drawn from the battery.
    #[default]
    Energy,
    /// Length along the ground.
    Distance,
    /// Time.
    Time,
}

fn yes() -> bool {
    true
}

fn one() -> f64 {
    1.0
}

impl From<ObjectiveName> for Objective {
    fn from(name: ObjectiveName) -> Self {
        match name {
            ObjectiveName::Energy => Objective::Energy,
            ObjectiveName::Distance => Objective::Distance,
            ObjectiveName::Time => Objective::Time,
        }
    }
}

impl StartPose {
    /// A start in the map's metres.
    pub fn in_metres([x_m, y_m]: [f64; 2], heading_rad: Option<f64>) -> Self {
        StartPose { x_m, y_m, lon_deg: None, lat_deg: None, heading_rad }
    }
}

impl GoalPose {
    /// A goal in the map's metres.
    pub fn in_metres([x_m, y_m]: [f64; 2], heading_rad: Option<f64>) -> Self {
        GoalPose { x_m, y_m, lon_deg: None, lat_deg: None, heading_rad, heading: None, tolerance_m: 0.0 }
    }

    /// Where a start is, under any heading.
    pub(crate) fn at(start: StartPose) -> Self {
        let StartPose { x_m, y_m, lon_deg, lat_deg, .. } = start;
        GoalPose { x_m, y_m, lon_deg, lat_deg, heading_rad: None, heading: None, tolerance_m: 0.0 }
    }
}

impl PlanRequest {
    /// A request with nothing but defaults.
    pub fn of(robot: RobotChoice, start: StartPose, goal: GoalPose) -> Self {
        PlanRequest { refine: true, exact_ends: true, preferences: true, ..Self::plain(robot, start, goal) }
    }

    /// A request for amounts, which leaves out what only comparisons weigh; the path is not refined and has its ends on the lattice.
    pub(crate) fn plain(robot: RobotChoice, start: StartPose, goal: GoalPose) -> Self {
        PlanRequest {
            map: None,
            map_id: None,
            robot,
            start,
            goal,
            goals: None,
            objective: ObjectiveName::Energy,
            speed_mps: None,
            power_model: PowerModel::default(),
            reverse: false,
            bound: 1.0,
            refine: false,
            timeout_s: None,
            hold_goal: false,
            snap_radius_m: None,
            max_time_s: None,
            max_energy_j: None,
            max_distance_m: None,
            max_slope_rad: None,
            areas: None,
            unknown_ground: None,
            prices: None,
            forbid: Vec::new(),
            least_radius_m: None,
            partial: false,
            exact_ends: false,
            preferences: false,
        }
    }

    /// The request without its map, and with both ends in the map's metres.
    ///
    /// # Errors
    /// An end that is not given, or in degrees that the map cannot place.
    pub(crate) fn settled(&self, terrain: &Terrain) -> Result<Self, Problem> {
        let mut settled = PlanRequest { map: None, ..self.clone() };
        settled.check_steering()?;
        settled.start.settle(terrain, "/start")?;
        match &mut settled.goals {
            None => settled.goal.settle(terrain, "/goal")?,
            Some(goals) => {
                settle_all(goals, terrain, "/goals")?;
                settled.goal = goals[0];
            }
        }
        Ok(settled)
    }

    /// How the robot is driven.
    pub(super) fn settings(&self, robot: &Robot) -> Settings {
        let usual = Settings::of(robot);
        Settings {
            speed_mps: self.speed_mps.unwrap_or(usual.speed_mps),
            power_model: self.power_model,
            reverse: self.reverse,
            ..self.steered(usual)
        }
    }

    /// The question as the planner takes it.
    pub(crate) fn query(&self, planner: &Planner, patience: &Patience) -> Query {
        Query {
            start: Start { x_m: self.start.x_m, y_m: self.start.y_m, heading_rad: self.start.heading_rad },
            goal: Goal::from(&self.goal),
            settings: planner.lattice().settings,
            other_goals: self.goals.iter().flat_map(|goals| goals.iter().skip(1)).map(Goal::from).collect(),
            snap_radius_m: self.snap_radius_m,
            bound: self.bound,
            refine: self.refine,
            exact_ends: self.exact_ends,
            patience: patience.clone(),
        }
    }
}
