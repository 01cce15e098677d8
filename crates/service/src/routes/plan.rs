//! `POST /v1/plan`: one path.

mod document;
mod steering;
mod unknown_ground;
pub(crate) mod warnings;
mod work;

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use axum::{extract::State, http::HeaderMap};
use model::{PowerModel, Robot};
use planner::{Goal, Objective, Patience, Planner, Query, Settings, Start};
use routing::Limits;
use serde::{Deserialize, Serialize};
use terrain::{MapFile, Terrain};
use utoipa::ToSchema;

use super::robots::RobotChoice;
use crate::{
    Engine, Tenant,
    answer::Written,
    body::JsonBody,
    metrics::CacheLabels,
    place::{Place, absent, settle_all},
    planners::Planners,
    problem::{Problem, ProblemType},
    tracks::{TrackForm, Tracks},
};

pub(crate) use document::place_all;
pub use document::{PlanAnswer, PoseAnswer, RefinedAnswer, SearchAnswer, SnapAnswer, Snapped};
pub use steering::{ForbidName, GoalHeading, PricesRequest, UnknownGroundRequest};
pub(crate) use unknown_ground::no_plan_over;
pub(crate) use warnings::map_warnings;
pub(crate) use work::with_planner;

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

/// Plan one path.
#[utoipa::path(
    post, path = "/v1/plan", tag = "plan",
    request_body = PlanRequest,
    responses(
        (status = 200, description = "The path, in the form that `Accept` asks for; longitude and latitude of WGS 84 in GeoJSON and GPX where the map has a `crs`, else metres in GeoJSON, and the start of a GPX track at 0° N 0° E; KML of a map with a `crs` alone", content(
            (PlanAnswer = "application/json"),
            (Object = "application/geo+json"),
            (String = "text/csv"),
            (String = "application/gpx+xml"),
            (String = "application/vnd.google-earth.kml+xml")
        )),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such map or robot", body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "Start or goal unusable, no path, or limits that no path keeps", body = Problem, content_type = "application/problem+json"),
        (status = 504, description = "Out of time", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn handler(
    State(engine): State<Engine>,
    tenant: Tenant,
    headers: HeaderMap,
    JsonBody(mut request): JsonBody<PlanRequest>,
) -> Result<Written, Problem> {
    let (media_type, form) = TrackForm::asked_for(&headers);
    let planned = with_planner(&engine, &tenant, &mut request, move |planner, request, patience| {
        form.map_or(Ok(()), |form| form.check(&planner.lattice().terrain))?;
        answer(planner, request, patience)
    });
    let found = planned.await?;
    engine.metrics().expansions.inc_by(found.search.expanded);
    Ok(Written::new(media_type, move |out| match form {
        Some(form) => Tracks::from(&found).write(form, out),
        None => Ok(serde_json::to_writer(out, &found)?),
    }))
}

/// Largest limit on slopes: π/2, a vertical wall, rounded up [rad]. Degrees are nearly always beyond it.
const MAX_SLOPE_RAD: f64 = 1.571;

/// Longest search for the path that a slope limit forbids [s].
const STEEP_TIME: Duration = Duration::from_secs(5);

/// Answers a request; its own map is not looked at.
///
/// # Errors
/// An unusable end, no path, or time that ran out before there was one.
pub fn answer(planner: &Planner, request: &PlanRequest, patience: &Patience) -> Result<PlanAnswer, Problem> {
    let request = &request.settled(&planner.lattice().terrain)?;
    let query = request.query(planner, patience);
    let objective = request.objective.into();
    let limits = request.limits()?;
    request.check_limits(planner.lattice().has_preferences())?;
    if request.hold_goal {
        planner.hold_goal(&query, objective).map_err(|e| request.no_plan(planner, &e))?;
    }
    let found = match request.partial {
        true => planner.plan_partly(&query, objective).map_err(routing::Error::Planner),
        false => routing::plan_within(planner, &query, objective, &limits),
    };
    let found = found
        .map_err(|error| request.no_routing(planner, &error))
        .map_err(|problem| request.too_steep(planner, problem, patience))?;
    Ok(PlanAnswer::of(&found, planner, request, patience))
}

/// A time that a request allows; `None` where no clock counts that far, which is no limit.
///
/// # Errors
/// A time that is not above 0.
fn allowed_time(field: &str, time_s: f64) -> Result<Option<Duration>, Problem> {
    /// The shortest time there is: it is over at once.
    const LEAST: Duration = Duration::from_nanos(1);
    if time_s.is_nan() || time_s <= 0.0 {
        let detail =
            format!("{field} is {time_s}, but must be above 0: leave it out for the service's limit");
        return Err(Problem::new(ProblemType::InvalidRequest, detail).at(format!("/{field}")));
    }
    Ok(Duration::try_from_secs_f64(time_s).ok().map(|allowed| allowed.max(LEAST)))
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

    /// The limits on the path's totals.
    ///
    /// # Errors
    /// A time or length that is not above 0, or an energy that is no number.
    pub(crate) fn limits(&self) -> Result<Limits, Problem> {
        let refuse = |field: &str, value: f64| {
            let detail = format!("{field} is {value}, but must be above 0: leave it out for no limit");
            Problem::new(ProblemType::InvalidRequest, detail).at(format!("/{field}"))
        };
        for (field, value) in [("max_time_s", self.max_time_s), ("max_distance_m", self.max_distance_m)] {
            if let Some(value) = value.filter(|value| value.is_nan() || *value <= 0.0) {
                return Err(refuse(field, value));
            }
        }
        Ok(Limits {
            max_energy_j: self.max_energy_j,
            max_time_s: self.max_time_s,
            max_distance_m: self.max_distance_m,
        })
    }

    /// The robot, held to slopes no steeper than the request's limit.
    fn limited_robot(&self) -> Result<Robot, Problem> {
        let mut robot = self.robot.robot()?;
        if let Some(max_slope_rad) = self.max_slope_rad {
            if !(max_slope_rad > 0.0 && max_slope_rad <= MAX_SLOPE_RAD) {
                let detail = format!(
                    "max_slope_rad is {max_slope_rad}, but must be above 0 and at most {MAX_SLOPE_RAD} (pi/2): give radians, 0.35 for 20 degrees"
                );
                return Err(Problem::new(ProblemType::InvalidRequest, detail).at("/max_slope_rad"));
            }
            let limits = &mut robot.limits;
            limits.max_pitch_rad = limits.max_pitch_rad.min(max_slope_rad);
            limits.max_roll_rad = limits.max_roll_rad.min(max_slope_rad);
        }
        Ok(robot)
    }

    /// Tells a path that only the slope limit forbids from one that there is not, with the slope that would do.
    fn too_steep(&self, planner: &Planner, problem: Problem, patience: &Patience) -> Problem {
        let Some(max_slope_rad) = self.max_slope_rad.filter(|_| problem.kind == ProblemType::NoPath) else {
            return problem;
        };
        let free = PlanRequest { max_slope_rad: None, refine: false, ..self.clone() };
        let patience = patience.no_later_than(Some(Instant::now() + STEEP_TIME));
        let Ok(free_planner) = free.planner(&planner.lattice().terrain, &patience) else { return problem };
        let query = free.query(&free_planner, &patience);
        let Ok(path) = free_planner.plan(&query, Objective::Energy) else { return problem };
        let tilts_rad = path.route.poses.iter().flat_map(|pose| [pose.pitch_rad.abs(), pose.roll_rad.abs()]);
        let steepest_rad = tilts_rad.fold(0.0, f64::max);
        let detail = format!(
            "no path keeps within a slope of {max_slope_rad:.3} rad; the best path without that limit comes to {steepest_rad:.3} rad: raise max_slope_rad"
        );
        Problem::new(ProblemType::LimitsContradict, detail).at("/max_slope_rad")
    }

    /// Why the planner has no path for the request.
    pub(crate) fn no_plan(&self, planner: &Planner, error: &planner::Error) -> Problem {
        let ends_m = [[self.start.x_m, self.start.y_m], [self.goal.x_m, self.goal.y_m]];
        no_plan_over(planner, ends_m, error)
    }

    /// Why a question within limits has no answer.
    pub(crate) fn no_routing(&self, planner: &Planner, error: &routing::Error) -> Problem {
        match error {
            routing::Error::Planner(error) => self.no_plan(planner, error),
            other => Problem::no_routing(other),
        }
    }

    /// A planner over a terrain for the request's robot.
    ///
    /// # Errors
    /// An unusable robot, one that does not suit the ground, or patience that ended.
    pub fn planner(&self, terrain: &Terrain, patience: &Patience) -> Result<Planner, Problem> {
        let robot = self.limited_robot()?;
        let own = self.ground(terrain)?;
        let planner =
            Planner::prepare(own.as_ref().unwrap_or(terrain), &robot, self.settings(&robot), patience);
        planner.map_err(|e| Problem::no_plan(&e))
    }

    /// The service's planner over a stored map.
    fn planner_of(
        &self,
        engine: &Engine,
        (map_id, terrain): (&str, &Terrain),
        patience: &Patience,
    ) -> Result<Arc<Planner>, Problem> {
        let (planner, at_hand) = self.kept_planner(engine.planners(), (map_id, terrain), patience)?;
        let outcome = if at_hand { "hit" } else { "miss" };
        engine.metrics().planners.get_or_create(&CacheLabels { outcome }).inc();
        Ok(planner)
    }

    /// The planner over a map for the request's robot out of those that are kept, made unless it is at hand, and whether it was.
    ///
    /// # Errors
    /// As [`PlanRequest::planner`].
    pub fn kept_planner(
        &self,
        planners: &Planners,
        (map_id, terrain): (&str, &Terrain),
        patience: &Patience,
    ) -> Result<(Arc<Planner>, bool), Problem> {
        let robot = self.limited_robot()?;
        let own = self.ground(terrain)?;
        let (key, terrain) = match &own {
            Some(own) => (self.ground_key(map_id), own),
            None => (map_id.to_owned(), terrain),
        };
        let planner = planners.get(&key, terrain, &robot, self.settings(&robot), patience);
        planner.map_err(|e| Problem::no_plan(&e))
    }

    fn settings(&self, robot: &Robot) -> Settings {
        let usual = Settings::of(robot);
        Settings {
            speed_mps: self.speed_mps.unwrap_or(usual.speed_mps),
            power_model: self.power_model,
            reverse: self.reverse,
            ..self.steered(usual)
        }
    }

    /// When the request's own time is over; `None` where it gives itself none.
    ///
    /// # Errors
    /// A time that is not above 0.
    pub(crate) fn deadline(&self) -> Result<Option<Instant>, Problem> {
        let allowed = self.timeout_s.map(|timeout_s| allowed_time("timeout_s", timeout_s)).transpose()?;
        Ok(allowed.flatten().and_then(|allowed| Instant::now().checked_add(allowed)))
    }

    /// What patience there is, shortened to the request's own.
    ///
    /// # Errors
    /// A time that is not above 0.
    pub fn patience(&self, patience: &Patience) -> Result<Patience, Problem> {
        Ok(patience.no_later_than(self.deadline()?))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_time_above_nothing_is_allowed_however_long_or_short() {
        for short_s in [f64::MIN_POSITIVE, 1e-300, 1e-12, 1e-10] {
            assert_eq!(
                allowed_time("timeout_s", short_s).unwrap(),
                Some(Duration::from_nanos(1)),
                "{short_s}"
            );
        }
        assert_eq!(allowed_time("timeout_s", 0.5).unwrap(), Some(Duration::from_millis(500)));
        for long_s in [1e20, 1e300, f64::MAX, f64::INFINITY] {
            assert_eq!(allowed_time("timeout_s", long_s).unwrap(), None, "no limit but the service's");
        }
        for wrong in [0.0, -0.0, -1e-300, -1.0, f64::NEG_INFINITY, f64::NAN] {
            let refused = allowed_time("timeout_s", wrong).unwrap_err();
            assert_eq!(refused.errors[0].pointer, "/timeout_s");
            assert!(refused.detail.contains("must be above 0"), "{}", refused.detail);
        }
    }
}
