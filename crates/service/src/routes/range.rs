//! `POST /v1/range`: whether the battery lasts.

use axum::extract::State;
use mission::{
    BestSpeed, Carries, Doubt, Leg, Question, Range, Replanned, Spread, Stall, TurningPoint, range,
};
use planner::{Patience, Planner};
use serde::{Deserialize, Serialize};
use terrain::{MapFile, Terrain, Warning};
use utoipa::ToSchema;

use super::{
    plan::{
        GoalPose, PlanRequest, StartPose, UnknownGroundRequest, map_warnings, warnings::borrowed_constants,
        with_planner,
    },
    robots::RobotChoice,
};
use crate::{Engine, Tenant, answer::Json, body::JsonBody, problem::Problem};

/// Whether, how likely, and with what charge left a robot gets to a goal and back.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RangeRequest {
    /// The map itself; give this or `map_id`.
    pub map: Option<MapFile>,
    /// Id of a stored map; give this or `map`.
    pub map_id: Option<String>,
    /// Name of a built-in robot, id of a stored one, or a robot; it needs a battery.
    pub robot: RobotChoice,
    /// Where the robot stands.
    pub start: StartPose,
    /// Where it is to go. Default: the farthest place that the charge reaches.
    pub goal: Option<GoalPose>,
    /// Whether the way back to the start is part of the question. Default: false.
    #[serde(default, rename = "return")]
    pub back: bool,
    /// Charge when it sets out, as a fraction of the capacity. Default: 1, full.
    #[serde(default = "full")]
    #[schema(minimum = 0.0, maximum = 1.0)]
    pub charge: f64,
    /// Temperature of the air and of the motors when it sets out. Default: the motors' reference temperature [°C].
    pub ambient_c: Option<f64>,
    /// Draws of the robot, its battery and the ground as they may be. Default: 1000.
    #[serde(default = "samples")]
    #[schema(minimum = 1, maximum = 100000)]
    pub samples: usize,
    /// So many of them get a path of their own, each a plan over the map. Default: 0.
    #[serde(default)]
    #[schema(maximum = 100)]
    pub replanned: usize,
    /// Which draws. Default: 0.
    #[serde(default)]
    pub seed: u64,
    /// One-sigma error of the map's elevation. Default: 0.1, as good lidar surveys have it [m].
    #[serde(default = "elevation_sigma_m")]
    pub elevation_sigma_m: f64,
    /// Way over which that error changes. Default: 10 [m].
    #[serde(default = "elevation_scale_m")]
    pub elevation_scale_m: f64,
    /// Forward speed; lowered where the outer wheel would be too fast. Default: half the wheels' top speed [m/s].
    pub speed_mps: Option<f64>,
    /// Whether the robot may back up. Default: false.
    #[serde(default)]
    pub reverse: bool,
    /// How far a start or goal may be moved to ground where the robot can stand. Default: one cell [m].
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

pub(crate) fn full() -> f64 {
    1.0
}
fn samples() -> usize {
    1000
}
fn elevation_sigma_m() -> f64 {
    Doubt::default().elevation_sigma_m
}
fn elevation_scale_m() -> f64 {
    Doubt::default().elevation_scale_m
}

/// Median and central 90 % over the draws.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SpreadAnswer {
    /// One draw in twenty is below.
    pub p05: f64,
    /// Half are below.
    pub p50: f64,
    /// One in twenty is above.
    pub p95: f64,
}

/// Whether the battery lasts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RangeAnswer {
    /// Whether at least half of the draws get there (and back) with the reserve.
    pub reachable: bool,
    /// Drawn from the battery, less what it took back [J].
    pub energy_j: SpreadAnswer,
    /// Charge at the end, 0 to 1.
    pub arrival_charge: SpreadAnswer,
    /// Share of the draws that get there with the reserve.
    pub success_probability: f64,
    /// Median of the energy that is missing, 0 where at least half of the draws succeed [J].
    pub missing_j: f64,
    /// Draws.
    pub samples: usize,
    /// Charge that must stay, 0 to 1.
    pub reserve_fraction: f64,
    /// Energy as planned: the sum of the edges, motors as they set out and everything taken back [J].
    pub planned_energy_j: f64,
    /// The same with motors that warm on the way and a battery that takes what it can.
    pub heated: HeatedAnswer,
    /// Time [s].
    pub duration_s: f64,
    /// Length along the ground [m].
    pub distance_m: f64,
    /// There, and back where that was asked for.
    pub legs: Vec<LegAnswer>,
    /// The last place of the way there from which turning back still leaves the reserve at home; null where there is none.
    pub turning_point: Option<TurningAnswer>,
    /// The speed over these paths that takes least energy.
    pub best_speed: BestSpeedAnswer,
    /// The draws that got paths of their own; null where none were asked for or none was found in time.
    pub replanned: Option<ReplannedAnswer>,
    /// How far the charge carries; null where a goal was given.
    pub carries: Option<CarriesAnswer>,
    /// Doubts about the map and about the robot.
    #[serde(default)]
    pub warnings: Vec<Warning>,
}

/// One drive of everything as the files say.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct HeatedAnswer {
    /// Drawn from the battery, less what it took back [J].
    pub energy_j: f64,
    /// What came back and the battery did not take [J].
    pub refused_j: f64,
    /// Charge at the end, 0 to 1.
    pub arrival_charge: f64,
    /// The hottest that a winding gets [°C].
    pub hottest_winding_c: f64,
    /// The least voltage at the battery [V].
    pub least_voltage_v: f64,
    /// What stops the robot though it has charge: `cut-off` of the drives at low voltage, `force` that the sagging voltage leaves
    /// too little of; null for nothing.
    pub stalled: Option<String>,
}

/// One way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[allow(missing_docs)]
pub struct LegAnswer {
    pub energy_j: f64,
    pub duration_s: f64,
    pub distance_m: f64,
    /// Charge at its end, 0 to 1.
    pub arrival_charge: f64,
    pub poses: Vec<ChargedPose>,
}

/// A pose with what was drawn and what is left there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[allow(missing_docs)]
pub struct ChargedPose {
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
    pub energy_j: f64,
    pub charge: f64,
    pub voltage_v: f64,
}

/// The last place to turn back.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[allow(missing_docs)]
pub struct TurningAnswer {
    pub x_m: f64,
    pub y_m: f64,
    /// Longitude on WGS 84; absent where the map does not say where on earth it lies [°].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lon_deg: Option<f64>,
    /// Latitude on WGS 84 [°].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lat_deg: Option<f64>,
    /// Along the way there [m].
    pub distance_m: f64,
    pub charge: f64,
    /// Energy of the best way back from there [J].
    pub homeward_energy_j: f64,
    pub homeward_duration_s: f64,
    pub charge_at_home: f64,
}

/// The best speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[allow(missing_docs)]
pub struct BestSpeedAnswer {
    pub speed_mps: f64,
    pub energy_j: f64,
    pub duration_s: f64,
    /// Energy at the speed asked for, less this [J].
    pub saving_j: f64,
}

/// Draws with paths of their own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReplannedAnswer {
    /// Draws.
    pub samples: usize,
    /// Their energies over their own paths [J].
    pub energy_j: SpreadAnswer,
    /// Median of what the own path saves [J].
    pub saving_j: f64,
}

/// How far a charge carries.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CarriesAnswer {
    /// Straight on over level ground of the robot's default surface; null where that draws nothing and so never ends [m].
    pub level_m: Option<SpreadAnswer>,
    /// Whether every place of the map that a way leads to can be reached.
    pub whole_map: bool,
}

/// Tell whether the battery lasts. A battery that does not is an answer (`reachable` false, `missing_j` how much), not a failure.
#[utoipa::path(
    post, path = "/v1/range", tag = "battery",
    request_body = RangeRequest,
    responses(
        (status = 200, description = "How likely the robot arrives, and on what charge", body = RangeAnswer),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such map or robot", body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "Start or goal unusable, or no path", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json"),
        (status = 504, description = "Out of time", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn handler(
    State(engine): State<Engine>,
    tenant: Tenant,
    JsonBody(mut request): JsonBody<RangeRequest>,
) -> Result<Json<RangeAnswer>, Problem> {
    let mut plan = request.plan();
    with_planner(&engine, &tenant, &mut plan, move |planner, plan, patience| {
        answer(planner, &request, plan, patience)
    })
    .await
    .map(Json)
}

impl RangeRequest {
    /// What of it concerns the planner; takes the map out.
    pub fn plan(&mut self) -> PlanRequest {
        let goal = self.goal.unwrap_or_else(|| GoalPose::at(self.start));
        PlanRequest {
            map: self.map.take(),
            map_id: self.map_id.clone(),
            speed_mps: self.speed_mps,
            reverse: self.reverse,
            timeout_s: self.timeout_s,
            snap_radius_m: self.snap_radius_m,
            areas: self.areas.clone(),
            unknown_ground: self.unknown_ground.clone(),
            ..PlanRequest::plain(self.robot.clone(), self.start, goal)
        }
    }
}

/// Answers a request; `plan` is what [`RangeRequest::plan`] made of it.
///
/// # Errors
/// An unusable question, robot or end, no path, or time that ran out.
pub fn answer(
    planner: &Planner,
    request: &RangeRequest,
    plan: &PlanRequest,
    patience: &Patience,
) -> Result<RangeAnswer, Problem> {
    let plan = &plan.settled(&planner.lattice().terrain)?;
    let robot = &planner.lattice().robot;
    let question = Question {
        query: plan.query(planner, patience),
        farthest: request.goal.is_none(),
        back: request.back,
        charge: request.charge,
        ambient_c: request.ambient_c.unwrap_or(robot.motors.reference_temperature_c),
        doubt: Doubt {
            elevation_sigma_m: request.elevation_sigma_m,
            elevation_scale_m: request.elevation_scale_m,
            ..Doubt::default()
        },
        samples: request.samples,
        replanned: request.replanned,
        seed: request.seed,
    };
    let found = range(planner, &question).map_err(|e| Problem::no_range(&e))?;
    let warnings = map_warnings(planner).into_iter().chain(borrowed_constants(planner.lattice())).collect();
    Ok(RangeAnswer { warnings, ..RangeAnswer::from(&found) }.placed(&planner.lattice().terrain))
}

impl From<&Range> for RangeAnswer {
    fn from(found: &Range) -> Self {
        let (likely, nominal) = (&found.likely, &found.nominal);
        RangeAnswer {
            reachable: likely.is_reachable(),
            energy_j: likely.energy_j.into(),
            arrival_charge: likely.arrival_charge.into(),
            success_probability: likely.success_probability,
            missing_j: likely.missing_j,
            samples: likely.samples,
            reserve_fraction: found.reserve,
            planned_energy_j: found.planned_j,
            heated: HeatedAnswer {
                energy_j: nominal.energy_j,
                refused_j: nominal.refused_j,
                arrival_charge: nominal.arrival_charge.clamp(0.0, 1.0),
                hottest_winding_c: nominal.hottest_c,
                least_voltage_v: nominal.least_voltage_v,
                stalled: nominal.stalled.map(|stall| stalled(stall).to_owned()),
            },
            duration_s: nominal.duration_s,
            distance_m: found.legs.iter().map(|leg| leg.plan.route.total.length_m).sum(),
            legs: legs(&found.legs, found.charge),
            turning_point: found.turning.as_ref().map(TurningAnswer::from),
            best_speed: (&found.best_speed).into(),
            replanned: found.replanned.as_ref().map(ReplannedAnswer::from),
            carries: found.carries.as_ref().map(CarriesAnswer::from),
            warnings: Vec::new(),
        }
    }
}

/// The name of what stops a robot.
pub(crate) fn stalled(stall: Stall) -> &'static str {
    match stall {
        Stall::CutOff => "cut-off",
        Stall::Force => "force",
        Stall::Charger => "charger",
    }
}

/// The legs, each from where and with what the one before left off; `charge` is that of setting out.
fn legs(legs: &[Leg], charge: f64) -> Vec<LegAnswer> {
    let (mut before_j, mut before_s, mut before_charge) = (0.0, 0.0, charge);
    let leg = |leg: &Leg| {
        let poses = charged_poses(leg);
        // A leg of no length has no poses, and changes nothing.
        let (energy_j, t_s, arrival_charge) =
            poses.last().map_or((before_j, before_s, before_charge), |p| (p.energy_j, p.t_s, p.charge));
        let answer = LegAnswer {
            energy_j: energy_j - before_j,
            duration_s: t_s - before_s,
            distance_m: leg.plan.route.total.length_m,
            arrival_charge,
            poses,
        };
        (before_j, before_s, before_charge) = (energy_j, t_s, arrival_charge);
        answer
    };
    legs.iter().map(leg).collect()
}

impl RangeAnswer {
    /// The answer with longitude and latitude of its places, where the map says where on earth it lies.
    fn placed(mut self, terrain: &Terrain) -> Self {
        let Ok(earth) = terrain.earth() else { return self };
        let place = |x_m: f64, y_m: f64| {
            let place_deg = earth.place_deg([x_m, y_m]).ok();
            [0, 1].map(|axis| place_deg.map(|place| place[axis]))
        };
        for pose in self.legs.iter_mut().flat_map(|leg| &mut leg.poses) {
            [pose.lon_deg, pose.lat_deg] = place(pose.x_m, pose.y_m);
        }
        if let Some(turning) = &mut self.turning_point {
            [turning.lon_deg, turning.lat_deg] = place(turning.x_m, turning.y_m);
        }
        self
    }
}

fn charged_poses(leg: &Leg) -> Vec<ChargedPose> {
    let poses = leg.plan.route.poses.iter().skip(1).zip(&leg.passages);
    let charged = poses.map(|(pose, passage)| ChargedPose {
        x_m: pose.x_m,
        y_m: pose.y_m,
        lon_deg: None,
        lat_deg: None,
        z_m: pose.z_m,
        heading_rad: pose.heading_rad,
        t_s: passage.t_s,
        energy_j: passage.energy_j,
        charge: passage.charge.clamp(0.0, 1.0),
        voltage_v: passage.voltage_v,
    });
    charged.collect()
}

impl From<Spread> for SpreadAnswer {
    fn from(Spread { p05, p50, p95 }: Spread) -> Self {
        SpreadAnswer { p05, p50, p95 }
    }
}

impl From<&TurningPoint> for TurningAnswer {
    fn from(t: &TurningPoint) -> Self {
        TurningAnswer {
            x_m: t.x_m,
            y_m: t.y_m,
            lon_deg: None,
            lat_deg: None,
            distance_m: t.distance_m,
            charge: t.charge,
            homeward_energy_j: t.homeward_j,
            homeward_duration_s: t.homeward_s,
            charge_at_home: t.charge_at_home,
        }
    }
}

impl From<&BestSpeed> for BestSpeedAnswer {
    fn from(b: &BestSpeed) -> Self {
        BestSpeedAnswer {
            speed_mps: b.speed_mps,
            energy_j: b.energy_j,
            duration_s: b.duration_s,
            saving_j: b.saving_j,
        }
    }
}

impl From<&Replanned> for ReplannedAnswer {
    fn from(r: &Replanned) -> Self {
        ReplannedAnswer { samples: r.samples, energy_j: r.energy_j.into(), saving_j: r.saving_j }
    }
}

impl From<&Carries> for CarriesAnswer {
    fn from(c: &Carries) -> Self {
        CarriesAnswer { level_m: c.level_m.map(SpreadAnswer::from), whole_map: c.whole_map }
    }
}
