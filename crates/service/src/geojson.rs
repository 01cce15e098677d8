//! Paths as GeoJSON: longitude and latitude of WGS 84, as RFC 7946 wants, where the map says where on earth it lies.

use std::io::{self, Write};

use serde::{Serialize, Serializer};
use serde_json::json;
use terrain::crs::Crs;

use crate::{
    antimeridian,
    routes::{mission::StopAnswer, plan::PoseAnswer},
    tracks::{Track, Tracks},
};

/// Writes paths with their totals, each a 3-D line string or, where start and goal are one place, a point, and stops as points. A line has
/// two positions or more (RFC 7946, 3.1.4). Where nothing says where on earth the map lies, coordinates are its own metres, and a member
/// `crs` says so: with the name of the system, as GeoJSON had it before RFC 7946, or null where that counts in another unit.
pub(crate) fn write(found: &Tracks<'_>, out: &mut dyn Write) -> io::Result<()> {
    out.write_all(br#"{"type":"FeatureCollection","#)?;
    let first = found.tracks.iter().find_map(|track| track.poses.first());
    if first.is_some_and(|pose| pose.lon_deg.is_none()) {
        let named = |name: &&str| json!({ "type": "name", "properties": { "name": name } });
        let metres = found.crs.as_ref().filter(|text| Crs::counts_metres(text));
        write!(out, "\"crs\":{},", json!(metres.map(named)))?;
    }
    out.write_all(br#""features":["#)?;
    for (i, track) in found.tracks.iter().enumerate() {
        out.write_all(if i > 0 { b"," } else { b"" })?;
        path(track, out)?;
    }
    for feature in found.stops.iter().map(stop) {
        write!(out, ",{feature}")?;
    }
    out.write_all(b"]}")
}

fn path(track: &Track<'_>, out: &mut dyn Write) -> io::Result<()> {
    out.write_all(br#"{"type":"Feature","geometry":"#)?;
    match track.poses {
        [pose] => write!(out, "{}", json!({ "type": "Point", "coordinates": position(pose) }))?,
        poses => {
            line(poses, out)?;
        }
    }
    out.write_all(br#","properties":"#)?;
    serde_json::to_writer(&mut *out, &track.properties())?;
    out.write_all(b"}")
}

fn stop(stop: &StopAnswer) -> serde_json::Value {
    let coordinates = match (stop.lon_deg, stop.lat_deg) {
        (Some(lon_deg), Some(lat_deg)) => [lon_deg, lat_deg],
        _ => [stop.x_m, stop.y_m],
    };
    json!({
        "type": "Feature",
        "geometry": { "type": "Point", "coordinates": coordinates },
        "properties": {
            "name": stop.name(),
            "kind": stop.kind,
            "arrival_s": stop.arrival_s,
            "departure_s": stop.departure_s,
            "energy_j": stop.energy_j,
            "arrival_charge": stop.arrival_charge,
            "departure_charge": stop.departure_charge,
        },
    })
}

/// A line string, or one in several parts where it crosses the antimeridian.
fn line(poses: &[PoseAnswer], out: &mut dyn Write) -> io::Result<()> {
    let crosses = |[from, to]: &[PoseAnswer; 2]| {
        from.lon_deg.zip(to.lon_deg).is_some_and(|(from_deg, to_deg)| (to_deg - from_deg).abs() > 180.0)
    };
    if poses.array_windows().any(crosses) {
        let parts = antimeridian::cut_line(&poses.iter().map(position).collect::<Vec<_>>());
        return write!(out, "{}", json!({ "type": "MultiLineString", "coordinates": parts }));
    }
    out.write_all(br#"{"type":"LineString","coordinates":"#)?;
    serde_json::to_writer(&mut *out, &Line(poses))?;
    out.write_all(b"}")
}

/// Poses as positions.
struct Line<'a>(&'a [PoseAnswer]);

impl Serialize for Line<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(position))
    }
}

fn position(pose: &PoseAnswer) -> [f64; 3] {
    let [x, y] = match (pose.lon_deg, pose.lat_deg) {
        (Some(lon_deg), Some(lat_deg)) => [lon_deg, lat_deg],
        _ => [pose.x_m, pose.y_m],
    };
    [x, y, pose.z_m]
}
