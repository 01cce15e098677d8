//! `POST /v1/reachable`: the ground within energies of a place, as contours or as a raster.

use std::io::{self, Write};

use axum::{
    body::Body,
    extract::State,
    http::{HeaderMap, header},
    response::{IntoResponse, Response},
};
use model::PowerModel;
use planner::{Patience, Planner};
use routing::{Kind, Polygon, Reach, Waypoint, available_j, reach};
use serde::{Deserialize, Serialize};
use serde_json::json;
use terrain::{
    MapFile, Warning,
    crs::{Crs, Earth},
    io::geotiff,
};
use utoipa::ToSchema;

use super::{
    plan::{
        GoalPose, PlanRequest, StartPose, UnknownGroundRequest, map_warnings, no_plan_over, with_planner,
    },
    robots::RobotChoice,
};
use crate::{
    Engine, Tenant,
    accept::preferred,
    answer::Pieces,
    antimeridian,
    body::JsonBody,
    contour_file,
    place::Place,
    problem::{Problem, ProblemType},
    tracks::TrackForm,
};

/// What to find the reach of.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ReachableRequest {
    /// The map itself; give this or `map_id`.
    pub map: Option<MapFile>,
    /// Id of a stored map; give this or `map`.
    pub map_id: Option<String>,
    /// Name of a built-in robot, id of a stored one, or a robot; charges need its battery.
    pub robot: RobotChoice,
    /// The place that ways start from or lead to. With a heading, the robot departs and arrives with it.
    pub start: StartPose,
    /// From the place, to it, or there and back. Default: `outward`.
    #[serde(default)]
    pub kind: KindName,
    /// Energies to draw contours at; give these or `charges` [J].
    #[schema(min_items = 1, max_items = 32)]
    pub energies_j: Option<Vec<f64>>,
    /// States of charge to draw contours for, down to the battery's reserve, 0 to 1; give these or `energies_j`.
    #[schema(min_items = 1, max_items = 32)]
    pub charges: Option<Vec<f64>>,
    /// Forward speed; lowered where the outer wheel would be too fast. Default: half the wheels' top speed [m/s].
    pub speed_mps: Option<f64>,
    /// Form of the physics. Default: `force-balance`.
    #[serde(default)]
    pub power_model: PowerModel,
    /// Whether the robot may back up. Default: false.
    #[serde(default)]
    pub reverse: bool,
    /// How far the place may be moved to ground where the robot can stand. Default: one cell [m].
    pub snap_radius_m: Option<f64>,
    /// Areas over the map, in place of those that it has, as `/v1/plan` takes them; their cost factors are left out. Default: the
    /// map's own.
    #[schema(value_type = Option<Object>)]
    pub areas: Option<serde_json::Value>,
    /// Opens unknown ground to the robot; its risk is left out. Default: it is impassable.
    pub unknown_ground: Option<UnknownGroundRequest>,
    /// Time for the answer. Default: the service's limit [s].
    #[schema(exclusive_minimum = 0.0)]
    pub timeout_s: Option<f64>,
}

/// Which way the energy is spent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum KindName {
    /// From the place to each cell.
    #[default]
    Outward,
    /// From each cell to the place.
    Homeward,
    /// From the place to each cell and back, on from the pose in which it was reached.
    OutAndBack,
}

/// The ground within each energy, as a GeoJSON feature collection: in longitude and latitude where `application/geo+json` is
/// asked for and the map says where on earth it lies (RFC 7946), else in the map's metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReachableAnswer {
    /// Always `FeatureCollection`.
    #[serde(rename = "type")]
    pub kind: String,
    /// The system of the coordinates, as GeoJSON had it before RFC 7946, null where nothing is known of it; absent where they are
    /// longitude and latitude of WGS 84.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Object>)]
    pub crs: Option<serde_json::Value>,
    /// A contour for each energy, in the order of the request.
    pub features: Vec<ContourFeature>,
    /// Doubts about the map.
    #[serde(default)]
    pub warnings: Vec<Warning>,
}

/// A contour.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ContourFeature {
    /// Always `Feature`.
    #[serde(rename = "type")]
    pub kind: String,
    /// The ground inside.
    pub geometry: ContourGeometry,
    /// What it is the contour of.
    pub properties: ContourProperties,
}

/// Polygons along the edges of cells: exteriors counter-clockwise, holes clockwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ContourGeometry {
    /// Always `MultiPolygon`.
    #[serde(rename = "type")]
    pub kind: String,
    /// Polygons, their rings, the exterior first, and their points, x and y [m].
    pub coordinates: Vec<Vec<Vec<[f64; 2]>>>,
}

/// What a contour is of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ContourProperties {
    /// Which way the energy is spent.
    pub kind: KindName,
    /// Cells inside take at most so much, drawn from the battery on arrival [J].
    pub energy_j: f64,
    /// The state of charge that this energy stands for, where charges were asked for.
    pub charge: Option<f64>,
    /// Area inside [m²].
    pub area_m2: f64,
}

/// Find what can be reached with some energies, from where a place can be reached, or how far the robot can go and still come
/// back. A cell is inside when driving there in the best of all headings takes at most the energy on arrival; on the way to
/// lower ground more may have been drawn for a while.
#[utoipa::path(
    post, path = "/v1/reachable", tag = "plan",
    request_body = ReachableRequest,
    responses(
        (status = 200, description = "The contours as GeoJSON, in longitude and latitude of WGS 84 where the map has a `crs`; the same in the map's metres when `Accept` asks for application/json; the least energy of every cell as a GeoTIFF when `Accept` asks for image/tiff", content(
            (ReachableAnswer = "application/geo+json"),
            (ReachableAnswer = "application/json"),
            (Vec<u8> = "image/tiff")
        )),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such map or robot", body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "The place unusable", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json"),
        (status = 504, description = "Out of time", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn handler(
    State(engine): State<Engine>,
    tenant: Tenant,
    headers: HeaderMap,
    JsonBody(mut request): JsonBody<ReachableRequest>,
) -> Result<Response, Problem> {
    let form = preferred(&headers, &["application/geo+json", "application/json", "image/tiff"]);
    let (as_raster, in_metres) = (form == "image/tiff", form == "application/json");
    let mut plan = request.plan();
    let memory = engine.admission().memory().clone();
    let pieces = with_planner(&engine, &tenant, &mut plan, move |planner, _, patience| {
        let mut found = Found::of(planner, &request, patience)?;
        if in_metres {
            found.earth = None;
        }
        if as_raster {
            let raster = found.raster()?;
            return Pieces::written(&memory, |out| out.write_all(&raster));
        }
        Pieces::written(&memory, |out| found.write_contours(out, patience))
    });
    Ok(([(header::CONTENT_TYPE, form)], Body::new(pieces.await?)).into_response())
}

impl ReachableRequest {
    /// What of it concerns the planner; takes the map out.
    pub fn plan(&mut self) -> PlanRequest {
        PlanRequest {
            map: self.map.take(),
            map_id: self.map_id.clone(),
            speed_mps: self.speed_mps,
            power_model: self.power_model,
            reverse: self.reverse,
            timeout_s: self.timeout_s,
            snap_radius_m: self.snap_radius_m,
            areas: self.areas.clone(),
            unknown_ground: self.unknown_ground.clone(),
            ..PlanRequest::plain(self.robot.clone(), self.start, GoalPose::at(self.start))
        }
    }

    /// Energies asked for, each with the charge that it stands for.
    fn energies_j(&self, planner: &Planner) -> Result<Vec<(f64, Option<f64>)>, Problem> {
        let invalid = |detail: String, at: &str| Problem::new(ProblemType::InvalidRequest, detail).at(at);
        let list = match (&self.energies_j, &self.charges) {
            (Some(energies_j), None) => energies_j.iter().map(|energy_j| (*energy_j, None)).collect(),
            (None, Some(charges)) => {
                let battery = planner.lattice().robot.battery.as_ref().ok_or_else(|| {
                    let detail = "the robot has no battery: give it one, or energies_j instead of charges";
                    Problem::new(ProblemType::InvalidRobot, detail).at("/robot/battery")
                })?;
                let energy = |(i, charge): (usize, &f64)| {
                    let energy_j = available_j(battery, *charge)
                        .map_err(|error| invalid(error.to_string(), &format!("/charges/{i}")))?;
                    Ok((energy_j, Some(*charge)))
                };
                charges.iter().enumerate().map(energy).collect::<Result<Vec<_>, Problem>>()?
            }
            (Some(_), Some(_)) => {
                return Err(invalid("give energies_j or charges, not both".into(), "/charges"));
            }
            (None, None) => return Err(invalid("give energies_j or charges".into(), "/energies_j")),
        };
        let name = if self.charges.is_some() { "charges" } else { "energies_j" };
        if list.is_empty() || list.len() > MOST_CONTOURS {
            let detail = format!("{name} has {} entries, but 1 to {MOST_CONTOURS} are drawn", list.len());
            return Err(invalid(detail, &format!("/{name}")));
        }
        for (i, (energy_j, _)) in list.iter().enumerate() {
            if !(*energy_j > 0.0 && energy_j.is_finite()) {
                let detail = format!("{name}[{i}] is {energy_j}, but must be above 0");
                return Err(invalid(detail, &format!("/{name}/{i}")));
            }
        }
        Ok(list)
    }
}

/// Contours of one request.
const MOST_CONTOURS: usize = 32;

/// What was found, before it is put in a form.
pub struct Found {
    /// Least energy of every cell.
    pub reach: Reach,
    kind: KindName,
    energies_j: Vec<(f64, Option<f64>)>,
    warnings: Vec<Warning>,
    /// Where on earth the map lies, if it says so.
    earth: Option<Earth>,
    crs: Option<String>,
}

impl Found {
    /// Answers a request; its own map is not looked at.
    ///
    /// # Errors
    /// Energies or charges that cannot be, an unusable place, or time that ran out.
    pub fn of(planner: &Planner, request: &ReachableRequest, patience: &Patience) -> Result<Self, Problem> {
        let energies_j = request.energies_j(planner)?;
        let most_j = energies_j.iter().map(|(energy_j, _)| *energy_j).fold(0.0, f64::max);
        let kind = match request.kind {
            KindName::Outward => Kind::Outward,
            KindName::Homeward => Kind::Homeward,
            KindName::OutAndBack => Kind::OutAndBack,
        };
        let terrain = &planner.lattice().terrain;
        let mut start = request.start;
        start.settle(terrain, "/start")?;
        let place = Waypoint::from(&start);
        let place_m = [start.x_m, start.y_m];
        let reach =
            reach(planner, &place, kind, most_j, request.snap_radius_m, patience).map_err(|error| {
                match &error {
                    routing::Error::Planner(error) => no_plan_over(planner, [place_m, place_m], error),
                    other => Problem::no_routing(other),
                }
            })?;
        let (warnings, crs) = (map_warnings(planner), terrain.crs.clone());
        Ok(Found { reach, kind: request.kind, energies_j, warnings, earth: terrain.earth().ok(), crs })
    }

    /// Writes the contours as GeoJSON, of which one at a time is in memory.
    fn write_contours(&self, out: &mut dyn Write, patience: &Patience) -> Result<(), Problem> {
        out.write_all(br#"{"type":"FeatureCollection","#)?;
        if let Some(crs) = self.member_crs() {
            write!(out, "\"crs\":{crs},")?;
        }
        out.write_all(br#""features":["#)?;
        for (index, energy) in self.energies_j.iter().enumerate() {
            out.write_all(if index > 0 { b"," } else { b"" })?;
            let contour = self.contour(energy, patience)?;
            serde_json::to_writer(&mut *out, &contour).map_err(io::Error::from)?;
        }
        out.write_all(br#"],"warnings":"#)?;
        serde_json::to_writer(&mut *out, &self.warnings).map_err(io::Error::from)?;
        Ok(out.write_all(b"}")?)
    }

    /// The contours as GeoJSON.
    ///
    /// # Errors
    /// Time that ran out.
    pub fn contours(&self, patience: &Patience) -> Result<ReachableAnswer, Problem> {
        let features = self.energies_j.iter().map(|energy| self.contour(energy, patience));
        let features = features.collect::<Result<_, Problem>>()?;
        Ok(ReachableAnswer {
            kind: "FeatureCollection".to_owned(),
            crs: self.member_crs(),
            features,
            warnings: self.warnings.clone(),
        })
    }

    /// Writes contours, as [`Found::contours`] gave them, in a file format.
    ///
    /// # Errors
    /// An output that cannot be written to, or GPX and KML of a map that does not say where on earth it lies.
    pub fn write(&self, form: TrackForm, contours: &ReachableAnswer, out: &mut dyn Write) -> io::Result<()> {
        contour_file::write(form, contours, &self.reach, out)
    }

    /// The ground within an energy, which may stand for a charge.
    fn contour(
        &self,
        &(energy_j, charge): &(f64, Option<f64>),
        patience: &Patience,
    ) -> Result<ContourFeature, Problem> {
        let late = |error| Problem::no_routing(&error);
        let polygons = self.reach.within(energy_j, patience).map_err(late)?;
        let area_m2 = self.reach.area_m2(energy_j, patience).map_err(late)?;
        Ok(ContourFeature {
            kind: "Feature".to_owned(),
            geometry: ContourGeometry {
                kind: "MultiPolygon".to_owned(),
                coordinates: polygons
                    .into_iter()
                    .map(|polygon| self.placed(polygon))
                    .collect::<Result<Vec<_>, Problem>>()?
                    .concat(),
            },
            properties: ContourProperties { kind: self.kind, energy_j, charge, area_m2 },
        })
    }

    /// A polygon as GeoJSON has it: in degrees cut at the antimeridian.
    fn placed(&self, polygon: Polygon) -> Result<Vec<Vec<Vec<[f64; 2]>>>, Problem> {
        let rings = self.rings(polygon)?;
        Ok(if self.earth.is_some() { antimeridian::cut_polygon(rings) } else { vec![rings] })
    }

    /// The rings of a polygon, in longitude and latitude where those are wanted and known.
    fn rings(&self, polygon: Polygon) -> Result<Vec<Vec<[f64; 2]>>, Problem> {
        let rings = std::iter::once(polygon.exterior).chain(polygon.holes);
        let Some(earth) = &self.earth else { return Ok(rings.collect()) };
        let place_deg = |place_m: [f64; 2]| {
            earth.place_deg(place_m).map_err(|error| Problem::new(ProblemType::Internal, error.to_string()))
        };
        rings.map(|ring| ring.into_iter().map(place_deg).collect()).collect()
    }

    /// The system that the coordinates of contours are in, as GeoJSON had it before RFC 7946: absent where they are longitude and
    /// latitude, null where nothing is known of it.
    fn member_crs(&self) -> Option<serde_json::Value> {
        let named = |name: &String| json!({ "type": "name", "properties": { "name": name } });
        let metres = self.crs.as_ref().filter(|text| Crs::counts_metres(text));
        self.earth.is_none().then(|| json!(metres.map(named)))
    }

    /// The least energy of every cell as a GeoTIFF [J].
    ///
    /// # Errors
    /// A raster that cannot be written.
    pub fn raster(&self) -> Result<Vec<u8>, Problem> {
        let energy_j: Vec<f32> = self.reach.energy_j.iter().map(|energy_j| *energy_j as f32).collect();
        geotiff::write(&self.reach.grid, &energy_j, self.crs.as_deref())
            .map_err(|error| Problem::new(ProblemType::Internal, format!("the raster: {error}")))
    }
}
