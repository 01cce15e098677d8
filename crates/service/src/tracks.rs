//! Paths with their names, as files that other programs open.

use std::io::{self, Write};

use axum::http::HeaderMap;
use serde_json::{Map, Value, json};
use terrain::{Terrain, Warning, crs::EarthError};

use crate::{
    accept::preferred,
    geojson,
    problem::{Problem, ProblemType},
    route_file,
    routes::{
        compare::CompareAnswer,
        mission::{MissionAnswer, StopAnswer},
        plan::{PlanAnswer, PoseAnswer},
    },
};

/// A file format of paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrackForm {
    /// GeoJSON (RFC 7946); metres where the map does not say where on earth it lies.
    GeoJson,
    /// A table of poses.
    Csv,
    /// GPX 1.1.
    Gpx,
    /// KML 2.2, of maps with a CRS alone.
    Kml,
}

impl TrackForm {
    /// Every format.
    pub const ALL: [TrackForm; 4] = [TrackForm::GeoJson, TrackForm::Csv, TrackForm::Gpx, TrackForm::Kml];

    /// Its media type.
    #[must_use]
    pub const fn media_type(self) -> &'static str {
        match self {
            TrackForm::GeoJson => "application/geo+json",
            TrackForm::Csv => "text/csv",
            TrackForm::Gpx => "application/gpx+xml",
            TrackForm::Kml => "application/vnd.google-earth.kml+xml",
        }
    }

    /// The media type that `Accept` prefers, and its format; none where that is the JSON document.
    pub(crate) fn asked_for(headers: &HeaderMap) -> (&'static str, Option<TrackForm>) {
        let [geojson, csv, gpx, kml] = TrackForm::ALL.map(TrackForm::media_type);
        let media_type = preferred(headers, &["application/json", geojson, csv, gpx, kml]);
        (media_type, TrackForm::ALL.into_iter().find(|form| form.media_type() == media_type))
    }

    /// Why a path over a map has no coordinates in the format, if it has none: KML and GPX are longitude and latitude. Only GPX of a map
    /// without any `crs` is written about 0° N 0° E, where nobody takes it for a place.
    #[must_use]
    pub fn unplaced(self, terrain: &Terrain) -> Option<EarthError> {
        let error = terrain.earth().err()?;
        match self {
            TrackForm::GeoJson | TrackForm::Csv => None,
            TrackForm::Gpx if error == EarthError::NoCrs => None,
            TrackForm::Gpx | TrackForm::Kml => Some(error),
        }
    }

    /// Refuses a format that a map has no coordinates for.
    ///
    /// # Errors
    /// What [`TrackForm::unplaced`] says.
    pub fn check(self, terrain: &Terrain) -> Result<(), Problem> {
        let name = if self == TrackForm::Gpx { "GPX" } else { "KML" };
        self.unplaced(terrain).map_or(Ok(()), |error| {
            let detail = format!(
                "{name} is longitude and latitude, and {error}: send the map with a `crs` that is placed on earth, as EPSG:32632, or ask for application/json, application/geo+json or text/csv"
            );
            Err(Problem::new(ProblemType::InvalidMap, detail).at("/map"))
        })
    }
}

/// A path with its name and totals.
pub(crate) struct Track<'a> {
    /// None where it is the only one.
    pub(crate) name: Option<String>,
    pub(crate) poses: &'a [PoseAnswer],
    /// Names with units, and values.
    pub(crate) totals: Vec<(&'static str, Value)>,
    pub(crate) warnings: &'a [Warning],
}

/// The paths of an answer, and the stops between them.
pub struct Tracks<'a> {
    pub(crate) crs: Option<&'a str>,
    pub(crate) tracks: Vec<Track<'a>>,
    pub(crate) stops: &'a [StopAnswer],
}

impl<'a> From<&'a PlanAnswer> for Tracks<'a> {
    fn from(plan: &'a PlanAnswer) -> Self {
        Tracks { crs: plan.crs.as_deref(), tracks: vec![Track::of(plan, None)], stops: &[] }
    }
}

impl<'a> From<&'a CompareAnswer> for Tracks<'a> {
    fn from(found: &'a CompareAnswer) -> Self {
        let named =
            [("energy-minimal", &found.energy), ("shortest", &found.distance), ("fastest", &found.time)];
        let tracks = named.map(|(name, plan)| Track::of(plan, Some(name.to_owned())));
        Tracks { crs: found.energy.crs.as_deref(), tracks: tracks.into(), stops: &[] }
    }
}

impl<'a> Tracks<'a> {
    /// The legs of a mission over a map with this CRS, each named after the stop that it leads to.
    #[must_use]
    pub fn of_mission(found: &'a MissionAnswer, crs: Option<&'a str>) -> Self {
        let legs = found.stops.array_windows().enumerate().map(|(leg, [from, to])| Track {
            name: Some(format!("to {}", to.name())),
            poses: &to.poses,
            totals: vec![
                ("energy_j", json!(to.energy_j - from.energy_j)),
                ("driving_energy_j", json!(to.poses.last().map_or(0.0, |pose| pose.energy_j))),
                ("duration_s", json!(to.arrival_s - from.departure_s)),
                ("distance_m", json!(to.poses.last().map_or(0.0, |pose| pose.distance_m))),
                ("arrival_charge", json!(to.arrival_charge)),
            ],
            warnings: if leg == 0 { &found.warnings } else { &[] },
        });
        Tracks { crs, tracks: legs.collect(), stops: &found.stops }
    }

    /// Writes them in a format.
    ///
    /// # Errors
    /// An output that cannot be written to, or KML or GPX of poses without longitude and latitude.
    pub fn write(&self, form: TrackForm, out: &mut dyn Write) -> io::Result<()> {
        match form {
            TrackForm::GeoJson => geojson::write(self, out),
            TrackForm::Csv => route_file::csv(self, out),
            TrackForm::Gpx => route_file::gpx(self, out),
            TrackForm::Kml => route_file::kml(self, out),
        }
    }
}

impl<'a> Track<'a> {
    fn of(plan: &'a PlanAnswer, name: Option<String>) -> Self {
        let path = plan.followed_path();
        let totals = vec![
            ("energy_j", json!(path.energy_j)),
            ("energy_interval_j", json!(path.energy_interval_j)),
            ("duration_s", json!(path.duration_s)),
            ("distance_m", json!(path.distance_m)),
            ("climb_m", json!(path.climb_m)),
            ("descent_m", json!(path.descent_m)),
            ("recovered_j", json!(path.recovered_j)),
            ("lattice_energy_j", json!(path.lattice_energy_j)),
        ];
        Track { name, poses: path.poses, totals, warnings: &plan.warnings }
    }

    /// Totals, warnings and the name, if there is one, as properties of GeoJSON.
    pub(crate) fn properties(&self) -> Value {
        let mut properties: Map<String, Value> =
            self.totals.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
        properties.insert("warnings".to_owned(), json!(self.warnings));
        if let Some(name) = &self.name {
            properties.insert("name".to_owned(), json!(name));
        }
        Value::Object(properties)
    }
}

impl StopAnswer {
    /// What the stop is called: its kind, and its position in the request where it has one.
    #[must_use]
    pub fn name(&self) -> String {
        self.index.map_or_else(|| self.kind.clone(), |index| format!("{} {index}", self.kind))
    }
}
