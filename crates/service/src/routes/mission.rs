//! `POST /v1/mission`: many stops in the best order.

use axum::{extract::State, http::HeaderMap};
use mission::{Call, Doubt, Mission, MissionQuestion, Role, Site, Stop, mission};
use planner::{Patience, Planner};
use routing::Waypoint;
use serde::{Deserialize, Serialize};
use terrain::{MapFile, Terrain, Warning};
use utoipa::ToSchema;

use super::{
    plan::{
        GoalPose, PlanRequest, PoseAnswer, StartPose, UnknownGroundRequest, map_warnings, place_all,
        with_planner,
    },
    range::{SpreadAnswer, full, stalled},
    robots::RobotChoice,
};
use crate::{
    Engine, Tenant,
    answer::Written,
    body::JsonBody,
    place::{Place, absent, place_deg, settle_all},
    problem::Problem,
    tracks::{TrackForm, Tracks},
};

/// Waypoints to visit on a charge.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MissionRequest {
    /// The map itself; give this or `map_id`.
    pub map: Option<MapFile>,
    /// Id of a stored map; give this or `map`.
    pub map_id: Option<String>,
    /// Name of a built-in robot, id of a stored one, or a robot; it needs a battery.
    pub robot: RobotChoice,
    /// Where the robot sets out.
    pub start: StartPose,
    /// What it is to visit; of up to 12 the order is proven best.
    #[schema(min_items = 1, max_items = 40)]
    pub waypoints: Vec<WaypointRequest>,
    /// Chargers that may be driven to, as often as it helps. Default: none.
    #[serde(default)]
    #[schema(max_items = 8)]
    pub chargers: Vec<ChargerRequest>,
    /// `best` lets the planner choose, `given` keeps the waypoints' own order. Default: `best`.
    #[serde(default)]
    pub order: OrderName,
    /// Whether the mission ends where it began. Default: false.
    #[serde(default, rename = "return")]
    pub back: bool,
    /// When it has to be over. Default: never [s].
    #[schema(exclusive_minimum = 0.0)]
    pub deadline_s: Option<f64>,
    /// Charge when it sets out, as a fraction of the capacity. Default: 1, full.
    #[serde(default = "full")]
    #[schema(minimum = 0.0, maximum = 1.0)]
    pub charge: f64,
    /// Temperature of the air and of the motors when it sets out. Default: the motors' reference temperature [°C].
    pub ambient_c: Option<f64>,
    /// Draws of the robot, its battery and the ground as they may be, over the plan. Default: 1000.
    #[serde(default = "samples")]
    #[schema(minimum = 1, maximum = 100000)]
    pub samples: usize,
    /// Which draws. Default: 0.
    #[serde(default)]
    pub seed: u64,
    /// Forward speed; lowered where the outer wheel would be too fast. Default: half the wheels' top speed [m/s].
    pub speed_mps: Option<f64>,
    /// Whether the robot may back up. Default: false.
    #[serde(default)]
    pub reverse: bool,
    /// How far a place may be moved to ground where the robot can stand. Default: one cell [m].
    pub snap_radius_m: Option<f64>,
    /// Areas over the map, in place of those that it has, as `/v1/plan` takes them; their cost factors are left out. Default: the
    /// map's own.
    #[schema(value_type = Option<Object>)]
    pub areas: Option<serde_json::Value>,
    /// Opens unknown ground to the robot; its risk is left out. Default: it is impassable.
    pub unknown_ground: Option<UnknownGroundRequest>,
    /// Time for all of it. Default: the service's limit [s].
    #[schema(exclusive_minimum = 0.0)]
    pub timeout_s: Option<f64>,
}

fn samples() -> usize {
    1000
}

/// Who chooses the order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OrderName {
    /// The planner: the order of least energy.
    #[default]
    Best,
    /// The request.
    Given,
}

/// A place to visit and what is done there.
#[derive(Clone, Copy, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct WaypointRequest {
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
    /// How long the robot works there. Default: 0 [s].
    #[serde(default)]
    pub service_s: f64,
    /// What it draws for that, besides its hotel load. Default: 0 [W].
    #[serde(default)]
    pub service_power_w: f64,
    /// Charging there, after the work. Default: none.
    pub recharge: Option<RechargeRequest>,
}

/// How a battery is charged.
#[derive(Clone, Copy, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RechargeRequest {
    /// Power at the battery, beyond the hotel load; cells may take less [W].
    pub power_w: f64,
    /// Charge to reach, 0 to 1. Default: 0.8, from where charging slows down.
    #[serde(default = "level")]
    pub level: f64,
}

/// A charger that may be driven to.
#[derive(Clone, Copy, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ChargerRequest {
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
    /// Power at the battery, beyond the hotel load; cells may take less [W].
    pub power_w: f64,
    /// Charge to reach, 0 to 1. Default: 0.8, from where charging slows down.
    #[serde(default = "level")]
    pub level: f64,
}

fn level() -> f64 {
    0.8
}

/// A planned mission.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MissionAnswer {
    /// Whether it can be driven within charge and deadline, as the files say.
    pub feasible: bool,
    /// Positions of the waypoints in the order of visits.
    pub order: Vec<usize>,
    /// Drawn from the battery, less what it took back, chargers apart; over the draws [J].
    pub energy_j: SpreadAnswer,
    /// Charge at the end, 0 to 1; over the draws.
    pub arrival_charge: SpreadAnswer,
    /// Share of the draws that keep the reserve to the end.
    pub success_probability: f64,
    /// What is missing as the files say, 0 where nothing is [J].
    pub missing_j: f64,
    /// What stops the robot though it has charge: `cut-off`, `force`, or a `charger` that cannot reach its level; null for
    /// nothing.
    pub stalled: Option<String>,
    /// Time with all stops [s].
    pub duration_s: f64,
    /// Length along the ground [m].
    pub distance_m: f64,
    /// Charge that must stay, 0 to 1.
    pub reserve_fraction: f64,
    /// Stops in order, the start first.
    pub stops: Vec<StopAnswer>,
    /// The leg that arrives with the least charge.
    pub weakest_leg: WeakestAnswer,
    /// How good the order is.
    pub search: MissionSearch,
    /// Doubts about the map.
    #[serde(default)]
    pub warnings: Vec<Warning>,
}

/// A stop of the plan. Charge and energy are as the files say.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[allow(missing_docs)]
pub struct StopAnswer {
    /// `start`, `waypoint`, `charger` or `home`.
    pub kind: String,
    /// Position of the waypoint or charger in the request; null for start and home.
    pub index: Option<usize>,
    pub x_m: f64,
    pub y_m: f64,
    /// Longitude on WGS 84; absent where the map does not say where on earth it lies [°].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lon_deg: Option<f64>,
    /// Latitude on WGS 84 [°].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lat_deg: Option<f64>,
    pub heading_rad: f64,
    pub arrival_s: f64,
    pub departure_s: f64,
    /// Drawn since the start, on arrival [J].
    pub energy_j: f64,
    pub arrival_charge: f64,
    pub departure_charge: f64,
    /// The way there from the stop before; empty for the start.
    pub poses: Vec<PoseAnswer>,
}

/// The leg that arrives with the least charge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct WeakestAnswer {
    /// Position in `stops` of where it ends.
    pub to_stop: usize,
    /// Charge on arrival, 0 to 1.
    pub arrival_charge: f64,
    /// That, less the reserve; below 0 where the reserve is broken.
    pub margin: f64,
}

/// How good the order is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MissionSearch {
    /// Energy of the ways as planned [J].
    pub ways_energy_j: f64,
    /// Proven: the ways of no order take less, chargers apart [J].
    pub least_energy_j: f64,
    /// By how much the order may exceed the best [J]: 0 but for rounding where it is proven.
    pub excess_at_most_j: f64,
}

/// Plan a mission. One that the battery or the deadline does not allow is an answer (`feasible` false), unless no order of the
/// ways is fast enough.
#[utoipa::path(
    post, path = "/v1/mission", tag = "battery",
    request_body = MissionRequest,
    responses(
        (status = 200, description = "The mission, in the form that `Accept` asks for: a way to each stop, and the stops; coordinates as `/v1/plan` has them", content(
            (MissionAnswer = "application/json"),
            (Object = "application/geo+json"),
            (String = "text/csv"),
            (String = "application/gpx+xml"),
            (String = "application/vnd.google-earth.kml+xml")
        )),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such map or robot", body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "A place unusable or unreachable, or a deadline too short", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json"),
        (status = 504, description = "Out of time", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn handler(
    State(engine): State<Engine>,
    tenant: Tenant,
    headers: HeaderMap,
    JsonBody(mut request): JsonBody<MissionRequest>,
) -> Result<Written, Problem> {
    let (media_type, form) = TrackForm::asked_for(&headers);
    let mut plan = request.plan();
    let planned = with_planner(&engine, &tenant, &mut plan, move |planner, plan, patience| {
        let terrain = &planner.lattice().terrain;
        form.map_or(Ok(()), |form| form.check(terrain))?;
        Ok((answer(planner, &request, plan, patience)?, terrain.crs.clone()))
    });
    let (found, crs) = planned.await?;
    Ok(Written::new(media_type, move |out| match form {
        Some(form) => Tracks::of_mission(&found, crs.as_deref()).write(form, out),
        None => Ok(serde_json::to_writer(out, &found)?),
    }))
}

impl MissionRequest {
    /// What of it concerns the planner; takes the map out.
    pub fn plan(&mut self) -> PlanRequest {
        PlanRequest {
            map: self.map.take(),
            map_id: self.map_id.clone(),
            speed_mps: self.speed_mps,
            reverse: self.reverse,
            timeout_s: self.timeout_s,
            snap_radius_m: self.snap_radius_m,
            areas: self.areas.clone(),
            unknown_ground: self.unknown_ground.clone(),
            ..PlanRequest::plain(self.robot.clone(), self.start, GoalPose::at(self.start))
        }
    }

    fn question(&self, planner: &Planner, patience: &Patience) -> MissionQuestion {
        let robot = &planner.lattice().robot;
        MissionQuestion {
            start: Waypoint { x_m: self.start.x_m, y_m: self.start.y_m, heading_rad: self.start.heading_rad },
            waypoints: self.waypoints.iter().map(Site::from).collect(),
            chargers: self.chargers.iter().map(Site::from).collect(),
            in_order: self.order == OrderName::Given,
            back: self.back,
            deadline_s: self.deadline_s.unwrap_or(f64::INFINITY),
            charge: self.charge,
            ambient_c: self.ambient_c.unwrap_or(robot.motors.reference_temperature_c),
            doubt: Doubt::default(),
            samples: self.samples,
            seed: self.seed,
            snap_radius_m: self.snap_radius_m,
            patience: patience.clone(),
        }
    }
}

impl From<&WaypointRequest> for Site {
    fn from(w: &WaypointRequest) -> Self {
        let work = Stop::Work { duration_s: w.service_s, power_w: w.service_power_w };
        let charge = w.recharge.map(|r| Stop::Charge { level: r.level, power_w: r.power_w });
        Site {
            place: Waypoint { x_m: w.x_m, y_m: w.y_m, heading_rad: w.heading_rad },
            stops: std::iter::once(work).chain(charge).collect(),
        }
    }
}

impl From<&ChargerRequest> for Site {
    fn from(c: &ChargerRequest) -> Self {
        Site {
            place: Waypoint { x_m: c.x_m, y_m: c.y_m, heading_rad: c.heading_rad },
            stops: vec![Stop::Charge { level: c.level, power_w: c.power_w }],
        }
    }
}

/// Answers a request; `plan` is what [`MissionRequest::plan`] made of it.
///
/// # Errors
/// An unusable question, robot or place, no path, a deadline that no order keeps, or time that ran out.
pub fn answer(
    planner: &Planner,
    request: &MissionRequest,
    plan: &PlanRequest,
    patience: &Patience,
) -> Result<MissionAnswer, Problem> {
    let _ = plan;
    let terrain = &planner.lattice().terrain;
    let mut request = request.clone();
    request.start.settle(terrain, "/start")?;
    settle_all(&mut request.waypoints, terrain, "/waypoints")?;
    settle_all(&mut request.chargers, terrain, "/chargers")?;
    let found = mission(planner, &request.question(planner, patience))
        .map_err(|error| Problem::no_mission(&error))?;
    let answer = MissionAnswer { warnings: map_warnings(planner), ..MissionAnswer::from(&found) };
    Ok(answer.placed(terrain))
}

impl From<&Mission> for MissionAnswer {
    fn from(found: &Mission) -> Self {
        let (likely, nominal) = (&found.likely, &found.nominal);
        let position = |call: &Call| if let Role::Waypoint(index) = call.role { Some(index) } else { None };
        let to_stop = found.weakest_leg + 1;
        let arrival_charge = found.calls.get(to_stop).map_or(0.0, |call| call.arrival_charge);
        let stops = found.calls.iter().enumerate().map(|(i, call)| {
            let poses = i.checked_sub(1).and_then(|leg| found.routes.get(leg)).map(|route| &route.poses[..]);
            stop(call, poses.unwrap_or_default().iter().map(PoseAnswer::from).collect())
        });
        MissionAnswer {
            feasible: found.feasible,
            order: found.calls.iter().filter_map(position).collect(),
            energy_j: likely.energy_j.into(),
            arrival_charge: likely.arrival_charge.into(),
            success_probability: likely.success_probability,
            missing_j: nominal.missing_j,
            stalled: nominal.stalled.map(|stall| stalled(stall).to_owned()),
            duration_s: nominal.duration_s,
            distance_m: found.routes.iter().map(|route| route.total.length_m).sum(),
            reserve_fraction: found.reserve,
            stops: stops.collect(),
            weakest_leg: WeakestAnswer { to_stop, arrival_charge, margin: arrival_charge - found.reserve },
            search: MissionSearch {
                ways_energy_j: found.ways_j,
                least_energy_j: found.bound_j.min(found.ways_j),
                excess_at_most_j: (found.ways_j - found.bound_j).max(0.0),
            },
            warnings: Vec::new(),
        }
    }
}

impl MissionAnswer {
    /// The answer with longitude and latitude of its places, where the map says where on earth it lies.
    fn placed(mut self, terrain: &Terrain) -> Self {
        for stop in &mut self.stops {
            [stop.lon_deg, stop.lat_deg] = place_deg(terrain, [stop.x_m, stop.y_m]);
            place_all(&mut stop.poses, terrain);
        }
        self
    }
}

fn stop(call: &Call, poses: Vec<PoseAnswer>) -> StopAnswer {
    let (kind, index) = match call.role {
        Role::Start => ("start", None),
        Role::Waypoint(index) => ("waypoint", Some(index)),
        Role::Charger(index) => ("charger", Some(index)),
        Role::Home => ("home", None),
    };
    let [x_m, y_m, heading_rad] = call.pose;
    StopAnswer {
        kind: kind.to_owned(),
        index,
        x_m,
        y_m,
        lon_deg: None,
        lat_deg: None,
        heading_rad,
        arrival_s: call.arrival_s,
        departure_s: call.departure_s,
        energy_j: call.energy_j,
        arrival_charge: call.arrival_charge,
        departure_charge: call.departure_charge,
        poses,
    }
}
