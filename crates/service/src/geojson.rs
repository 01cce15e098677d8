//! Paths as GeoJSON, in the map's own metres.

use serde_json::{Value, json};

use crate::routes::plan::PlanAnswer;

/// A path with its totals: a 3-D line string or, where start and goal are one place, a point. Coordinates are the map's
/// projected metres. A line has two positions or more (RFC 7946, 3.1.4).
pub(crate) fn path(plan: &PlanAnswer) -> Value {
    let positions: Vec<[f64; 3]> = plan.poses.iter().map(|p| [p.x_m, p.y_m, p.z_m]).collect();
    let geometry = match positions.as_slice() {
        [position] => json!({ "type": "Point", "coordinates": position }),
        line => json!({ "type": "LineString", "coordinates": line }),
    };
    json!({
        "type": "FeatureCollection",
        "features": [{
            "type": "Feature",
            "geometry": geometry,
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
