//! Where a document's coordinates are on the map.

use serde_json::Value;

use super::{AreaError, shape::Point};
use crate::{
    Terrain,
    crs::{Crs, Earth, registered_code},
};

/// The way from a document's coordinates to the map's metres.
pub(super) enum Placing {
    /// They are the map's.
    Map,
    /// Those of the map's system in its own unit, whose length in the map's metres this is along x and y.
    OwnUnits([f64; 2]),
    /// Longitude and latitude of WGS 84, and the way to the map.
    Degrees(Box<Earth>),
    /// Those of another projected system, by way of WGS 84.
    Other(Box<OtherSystem>),
}

/// The way from a projected system to the map.
pub(super) struct OtherSystem {
    /// Length of its unit [m].
    unit_m: f64,
    /// Its way to WGS 84.
    from: Earth,
    /// The map's.
    to: Earth,
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
        let code = name.strip_prefix("urn:ogc:def:crs:EPSG:").and_then(|rest| rest.split_once(':'));
        let short = code.map_or_else(|| name.to_owned(), |(_, code)| format!("EPSG:{code}"));
        if let Some(units_m) = own_units_m(terrain, &short) {
            let are_metres = units_m == [1.0; 2];
            return Ok((if are_metres { Placing::Map } else { Placing::OwnUnits(units_m) }, None));
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
        let unit_m = Crs::parse(&short).and_then(|crs| crs.unit).map_or(1.0, |unit| unit.metres);
        Ok((Placing::Other(Box::new(OtherSystem { unit_m, from, to })), Some(note)))
    }

    /// A place on the map [m].
    pub(super) fn place_m(&self, point: Point) -> Result<Point, String> {
        let placed = match self {
            Placing::Map => Ok(point),
            Placing::OwnUnits([unit_x_m, unit_y_m]) => Ok([point[0] * unit_x_m, point[1] * unit_y_m]),
            Placing::Degrees(earth) => earth.place_m(within_half_turn(point)),
            Placing::Other(other) => {
                let place_m = point.map(|at| at * other.unit_m);
                other.from.place_deg(place_m).and_then(|place_deg| other.to.place_m(place_deg))
            }
        };
        placed.map_err(|error| error.to_string())
    }

    /// What coordinates were taken for.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Placing::Map => "the map's metres",
            Placing::OwnUnits(_) => "coordinates of the map's crs",
            Placing::Degrees(_) => "longitude and latitude",
            Placing::Other(_) => "the system that its crs names",
        }
    }
}

/// Length of the unit of a system by its name, along x and y in metres of the map, where it is the map's own or the one whose coordinates were
/// multiplied to be the map's.
fn own_units_m(terrain: &Terrain, name: &str) -> Option<[f64; 2]> {
    let own = terrain.crs.as_deref()?;
    if let Some((code, units_m)) = registered_code(own)
        && name == format!("EPSG:{code}")
    {
        return Some(units_m);
    }
    let unit_m = || Crs::parse(own).and_then(|crs| crs.unit).map_or(1.0, |unit| unit.metres);
    // A text's unit is its own business: only a code is known to others by the same coordinates.
    (own == name).then(|| if name.starts_with("EPSG:") { [unit_m(); 2] } else { [1.0; 2] })
}
