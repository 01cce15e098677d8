//! Paths as GeoJSON: longitude and latitude of WGS 84, as RFC 7946 wants, where the map says where on earth it lies.

use std::io::{self, Write};

use serde::{Serialize, Serializer};
use serde_json::json;

use crate::routes::plan::{PlanAnswer, PoseAnswer};

/// Writes a path with its totals: a 3-D line string or, where start and goal are one place, a point. A line has two positions or
/// more (RFC 7946, 3.1.4). Where nothing says where on earth the map lies, coordinates are its own metres, and a member `crs`
/// says so: with the name of the system, as GeoJSON had it before RFC 7946, or null.
pub(crate) fn path(plan: &PlanAnswer, out: &mut dyn Write) -> io::Result<()> {
    let properties = json!({
        "energy_j": plan.energy_j,
        "energy_interval_j": plan.energy_interval_j,
        "duration_s": plan.duration_s,
        "distance_m": plan.distance_m,
        "climb_m": plan.climb_m,
        "descent_m": plan.descent_m,
        "recovered_j": plan.recovered_j,
        "warnings": plan.warnings,
    });
    out.write_all(br#"{"type":"FeatureCollection","#)?;
    if plan.poses.first().is_some_and(|pose| pose.lon_deg.is_none()) {
        let named = |name: &String| json!({ "type": "name", "properties": { "name": name } });
        write!(out, "\"crs\":{},", json!(plan.crs.as_ref().map(named)))?;
    }
    out.write_all(br#""features":[{"type":"Feature","geometry":"#)?;
    match plan.poses.as_slice() {
        [pose] => write!(out, "{}", json!({ "type": "Point", "coordinates": position(pose) }))?,
        poses => {
            out.write_all(br#"{"type":"LineString","coordinates":"#)?;
            serde_json::to_writer(&mut *out, &Line(poses))?;
            out.write_all(b"}")?;
        }
    }
    out.write_all(br#","properties":"#)?;
    serde_json::to_writer(&mut *out, &properties)?;
    out.write_all(b"}]}")
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
