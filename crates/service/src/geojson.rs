//! Paths as GeoJSON, in the map's own metres.

use serde_json::{Value, json};

use crate::routes::plan::PlanAnswer;

/// A path as a 3-D line string with its totals; coordinates are the map's projected metres.
pub(crate) fn path(plan: &PlanAnswer) -> Value {
    let line: Vec<[f64; 3]> = plan.poses.iter().map(|p| [p.x_m, p.y_m, p.z_m]).collect();
    json!({
        "type": "FeatureCollection",
        "features": [{
            "type": "Feature",
            "geometry": { "type": "LineString", "coordinates": line },
            "properties": {
                "energy_j": plan.energy_j,
                "energy_interval_j": plan.energy_interval_j,
                "duration_s": plan.duration_s,
                "distance_m": plan.distance_m,
                "climb_m": plan.climb_m,
                "descent_m": plan.descent_m,
                "recovered_j": plan.recovered_j,
            },
        }],
    })
}
