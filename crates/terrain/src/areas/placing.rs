//! Where a document's coordinates are on the map.

use serde_json::Value;

use super::{AreaError, shape::Point};
use crate::{Terrain, crs::Earth};

/// The way from a document's coordinates to the map's metres.
pub(super) enum Placing {
    /// They are the map's.
    Map,
    /// Longitude and latitude of WGS 84, and the way to the map.
    Degrees(Box<Earth>),
    /// Those of another projected system, by way of WGS 84: its own way there, and the map's.
    Other(Box<[Earth; 2]>),
}

/// Names of WGS 84 in longitude and latitude, as files write them.
const DEGREES: [&str; 5] =
    ["urn:ogc:def:crs:OGC:1.3:CRS84", "OGC:CRS84", "CRS84", "urn:ogc:def:crs:EPSG::4326", "EPSG:4326"];

/// The same place with a longitude from −180° to 180°.
fn within_half_turn([lon_deg, lat_deg]: Point) -> Point {
    let is_beyond = (180.0..=360.0).contains(&lon_deg);
    [if is_beyond { lon_deg - 360.0 } else { lon_deg }, lat_deg]
}

impl Placing {
    /// By the `crs` member, if the document has one as GeoJSON had before RFC 7946; else degrees where the map says where on earth
    /// it lies and all coordinates can be degrees; else the map's metres. Returns a note where that was not plain.
    pub(super) fn of(
        document: &Value,
        terrain: &Terrain,
        points: impl Iterator<Item = Point>,
    ) -> Result<(Self, Option<String>), AreaError> {
        match document.get("crs") {
            Some(Value::Null) => return Ok((Placing::Map, None)),
            Some(crs) => return Self::named(crs, terrain),
            None => {}
        }
        let mut points = points;
        // Maps about the antimeridian are often drawn from 0° to 360° of longitude.
        let are_degrees = points.all(|[x, y]| (-180.0..=360.0).contains(&x) && y.abs() <= 90.0);
        if !are_degrees || terrain.crs.is_none() {
            return Ok((Placing::Map, None));
        }
        match terrain.earth() {
            Ok(earth) => Ok((Placing::Degrees(Box::new(earth)), None)),
            Err(error) => Err(AreaError::new(
                "",
                format!(
                    "are in degrees, as RFC 7946 wants, but cannot be placed: {error}; give them in the map's metres with \"crs\": null"
                ),
            )),
        }
    }

    /// By the name of a system.
    fn named(crs: &Value, terrain: &Terrain) -> Result<(Self, Option<String>), AreaError> {
        let name = crs.pointer("/properties/name").and_then(Value::as_str).ok_or_else(|| {
            let what = "is not a named system: give {\"type\": \"name\", \"properties\": {\"name\": \"EPSG:32632\"}}, null for the map's own, or leave it out for longitude and latitude";
            AreaError::new("crs", what)
        })?;
        let short = name
            .strip_prefix("urn:ogc:def:crs:EPSG::")
            .map_or_else(|| name.to_owned(), |code| format!("EPSG:{code}"));
        if terrain.crs.as_deref() == Some(short.as_str()) {
            return Ok((Placing::Map, None));
        }
        let placed = |error: crate::crs::EarthError| AreaError::new("crs", format!("is {name}, but {error}"));
        let to = terrain.earth().map_err(placed)?;
        if DEGREES.contains(&name) {
            return Ok((Placing::Degrees(Box::new(to)), None));
        }
        let from = Earth::of(&short).map_err(placed)?;
        let own = terrain.crs.as_deref().unwrap_or_default();
        let own: String = own.chars().take(60).collect();
        let note = format!("the areas' coordinates were brought from {short} to the map's {own}");
        Ok((Placing::Other(Box::new([from, to])), Some(note)))
    }

    /// A place on the map [m].
    pub(super) fn place_m(&self, point: Point) -> Result<Point, String> {
        let placed = match self {
            Placing::Map => Ok(point),
            Placing::Degrees(earth) => earth.place_m(within_half_turn(point)),
            Placing::Other(earths) => {
                earths[0].place_deg(point).and_then(|place_deg| earths[1].place_m(place_deg))
            }
        };
        placed.map_err(|error| error.to_string())
    }

    /// What coordinates were taken for.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Placing::Map => "the map's metres",
            Placing::Degrees(_) => "longitude and latitude",
            Placing::Other(_) => "the system that its crs names",
        }
    }
}
