//! Places of a request: in the map's own metres, or in degrees of WGS 84 where the map says where on earth it lies.

use terrain::{Terrain, crs::EarthError};

use crate::{
    problem::{Problem, ProblemType},
    routes::{
        mission::{ChargerRequest, WaypointRequest},
        plan::{GoalPose, StartPose},
    },
};

/// What stands for a coordinate that a request does not give.
pub(crate) fn absent() -> f64 {
    f64::NAN
}

/// Longitude and latitude of a place of a map, where it says where on earth it lies.
pub(crate) fn place_deg(terrain: &Terrain, place_m: [f64; 2]) -> [Option<f64>; 2] {
    let place_deg = terrain.earth().and_then(|earth| earth.place_deg(place_m)).ok();
    [0, 1].map(|axis| place_deg.map(|place| place[axis]))
}

/// A pose that a request may give in degrees.
pub(crate) trait Place {
    /// Its metres, and longitude and latitude as given.
    fn coordinates(&mut self) -> ([&mut f64; 2], [Option<f64>; 2]);

    /// Works out the metres of a place that is given in degrees.
    ///
    /// # Errors
    /// Neither metres nor degrees, or both; degrees on a map without a system, or beyond its area.
    fn settle(&mut self, terrain: &Terrain, pointer: &str) -> Result<(), Problem> {
        let ([x_m, y_m], degrees) = self.coordinates();
        let refuse = |at: &str, detail: String| {
            Err(Problem::new(ProblemType::InvalidRequest, detail).at(format!("{pointer}{at}")))
        };
        let name = pointer.trim_start_matches('/');
        let [lon_deg, lat_deg] = match degrees {
            [None, None] => {
                for (value, field) in [(&*x_m, "x_m"), (&*y_m, "y_m")] {
                    if value.is_nan() {
                        let detail = format!(
                            "{name}: missing field `{field}`: give x_m and y_m, or lon_deg and lat_deg where the map has a crs"
                        );
                        return refuse(&format!("/{field}"), detail);
                    }
                }
                return Ok(());
            }
            [Some(lon_deg), Some(lat_deg)] => [lon_deg, lat_deg],
            [Some(_), None] => {
                return refuse("/lat_deg", format!("{name} has lon_deg and no lat_deg: give both"));
            }
            [None, Some(_)] => {
                return refuse("/lon_deg", format!("{name} has lat_deg and no lon_deg: give both"));
            }
        };
        if !(x_m.is_nan() && y_m.is_nan()) {
            return refuse("/lon_deg", format!("{name} has both metres and degrees: give one of them"));
        }
        let place = terrain.place_m([lon_deg, lat_deg]);
        match place {
            Ok(place_m) => {
                [*x_m, *y_m] = place_m;
                Ok(())
            }
            Err(error @ EarthError::OtherWayRound { .. }) => {
                Err(Problem::new(outside(pointer), format!("{name}: {error}"))
                    .at(format!("{pointer}/lat_deg")))
            }
            Err(error) => {
                refuse("/lon_deg", format!("{name} is given in degrees, and {error}: give x_m and y_m"))
            }
        }
    }
}

/// The type of a place off the map.
fn outside(pointer: &str) -> ProblemType {
    match pointer.split('/').nth(1) {
        Some("start") => ProblemType::StartOutsideMap,
        Some("goal" | "goals") => ProblemType::GoalOutsideMap,
        _ => ProblemType::WaypointOutsideMap,
    }
}

impl Place for StartPose {
    fn coordinates(&mut self) -> ([&mut f64; 2], [Option<f64>; 2]) {
        ([&mut self.x_m, &mut self.y_m], [self.lon_deg, self.lat_deg])
    }
}

impl Place for GoalPose {
    fn coordinates(&mut self) -> ([&mut f64; 2], [Option<f64>; 2]) {
        ([&mut self.x_m, &mut self.y_m], [self.lon_deg, self.lat_deg])
    }
}

impl Place for WaypointRequest {
    fn coordinates(&mut self) -> ([&mut f64; 2], [Option<f64>; 2]) {
        ([&mut self.x_m, &mut self.y_m], [self.lon_deg, self.lat_deg])
    }
}

impl Place for ChargerRequest {
    fn coordinates(&mut self) -> ([&mut f64; 2], [Option<f64>; 2]) {
        ([&mut self.x_m, &mut self.y_m], [self.lon_deg, self.lat_deg])
    }
}

/// Settles a list of places.
///
/// # Errors
/// The first that cannot be settled, as [`Place::settle`].
pub(crate) fn settle_all<P: Place>(
    places: &mut [P],
    terrain: &Terrain,
    pointer: &str,
) -> Result<(), Problem> {
    places.iter_mut().enumerate().try_for_each(|(i, place)| place.settle(terrain, &format!("{pointer}/{i}")))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn latitude_and_longitude_the_other_way_round_are_said() {
        let map = json!({"cell_size_m": 1.0, "rows": 30, "columns": 40, "origin_m": [512_000.0, 5_422_960.0],
            "crs": "EPSG:32632", "elevation_m": vec![vec![0.0; 40]; 30]});
        let terrain = terrain::io::json::read(&map.to_string()).unwrap();
        let settle = |lon_deg: f64, lat_deg: f64| {
            let mut pose: StartPose =
                serde_json::from_value(json!({"lon_deg": lon_deg, "lat_deg": lat_deg})).unwrap();
            pose.settle(&terrain, "/start")
        };
        let [lon_deg, lat_deg] = terrain.earth().unwrap().place_deg([512_010.0, 5_422_970.0]).unwrap();
        assert!(settle(lon_deg, lat_deg).is_ok());
        let problem = format!("{:?}", settle(lat_deg, lon_deg).unwrap_err());
        assert!(problem.contains("the other way round"), "{problem}");
    }
}
