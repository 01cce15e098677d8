//! Areas as a document in the map's metres, whatever system they were given in.

use serde_json::{Value, json};

use super::{Area, Areas, shape::Shape};

impl Areas {
    /// Returns the areas as a GeoJSON feature collection in the map's metres, with `"crs": null`; [`Areas::of`] reads it as the same areas.
    ///
    /// Features keep their order and properties, and their `id` if they have one. Rings are closed.
    pub fn in_map_metres(&self) -> Value {
        let given: Value = serde_json::from_str(&self.text).unwrap_or_default();
        let features: Vec<Value> = self.areas.iter().map(|area| feature(area, &given)).collect();
        json!({ "type": "FeatureCollection", "crs": null, "features": features })
    }
}

/// An area as a feature, with what the given document says of it besides its geometry.
fn feature(area: &Area, given: &Value) -> Value {
    let given = &given["features"][area.feature];
    let mut feature =
        json!({ "type": "Feature", "properties": given["properties"], "geometry": geometry(&area.shapes) });
    if let (Some(id), Some(members)) = (given.get("id"), feature.as_object_mut()) {
        members.insert("id".to_owned(), id.clone());
    }
    feature
}

/// The shapes of one feature: all polygons, or all lines.
fn geometry(shapes: &[Shape]) -> Value {
    let lines: Vec<&Vec<_>> = shapes
        .iter()
        .filter_map(|shape| if let Shape::Line(line) = shape { Some(line) } else { None })
        .collect();
    let polygons: Vec<&Vec<_>> = shapes
        .iter()
        .filter_map(|shape| if let Shape::Polygon(rings) = shape { Some(rings) } else { None })
        .collect();
    match (polygons.as_slice(), lines.as_slice()) {
        ([rings], []) => json!({ "type": "Polygon", "coordinates": rings }),
        ([], [line]) => json!({ "type": "LineString", "coordinates": line }),
        ([], lines) => json!({ "type": "MultiLineString", "coordinates": lines }),
        (polygons, _) => json!({ "type": "MultiPolygon", "coordinates": polygons }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, Terrain};

    fn ground(crs: Option<&str>, origin_m: [f64; 2]) -> Terrain {
        let grid = Grid { rows: 30, columns: 40, cell_size_m: 1.0, origin_m };
        Terrain { crs: crs.map(str::to_owned), ..Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap() }
    }

    #[test]
    fn areas_in_degrees_come_back_in_metres_and_are_read_as_the_same() {
        let terrain = ground(Some("EPSG:32632"), [512_000.0, 5_422_960.0]);
        // By pyproj: (512014, 5422960) and (512015, 5422986) of EPSG:32632.
        let [west, south, east, north] = [9.164_121_616, 48.959_440_829, 9.164_135_914, 48.959_674_641];
        let document = json!({"type": "FeatureCollection", "features": [
            {"type": "Feature", "id": "wall", "properties": {"keep_out": true, "name": "wall"}, "geometry":
                {"type": "LineString", "coordinates": [[west, south], [east, north]]}},
            {"type": "Feature", "properties": {"cost_factor": 2.0}, "geometry": {"type": "MultiPolygon", "coordinates":
                [[[[west, south], [east, south], [east, north]]], [[[west, south], [east, north], [west, north]]]]}}]});
        let areas = Areas::of(&document, &terrain).unwrap();
        let metres = areas.in_map_metres();
        assert_eq!(metres["crs"], Value::Null);
        assert_eq!(metres["features"][0]["id"], "wall");
        assert_eq!(metres["features"][0]["properties"], document["features"][0]["properties"]);
        let end = |axis: usize| metres["features"][0]["geometry"]["coordinates"][1][axis].as_f64().unwrap();
        assert!((end(0) - 512_015.0).abs() < 0.01 && (end(1) - 5_422_986.0).abs() < 0.01, "{metres}");
        assert_eq!(metres["features"][1]["geometry"]["type"], "MultiPolygon");
        assert_eq!(Areas::of(&metres, &terrain).unwrap().areas, areas.areas);
    }

    #[test]
    fn longitudes_from_0_to_360_are_those_from_minus_180_to_180() {
        // By pyproj: EPSG:32701 of 180° east, 17° south is (180 589, 8 118 429).
        let terrain = ground(Some("EPSG:32701"), [180_569.0, 8_118_414.0]);
        let earth = terrain.earth().unwrap();
        let corners = [[180_580.0, 8_118_420.0], [180_600.0, 8_118_420.0], [180_600.0, 8_118_440.0]];
        let metres = |turned: bool| {
            let place = |place_m: [f64; 2]| {
                let [lon, lat] = earth.place_deg(place_m).unwrap();
                [if turned { lon.rem_euclid(360.0) } else { lon }, lat]
            };
            let document = json!({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"keep_out": true},
                "geometry": {"type": "Polygon", "coordinates": [corners.map(place)]}}]});
            Areas::of(&document, &terrain).unwrap().areas
        };
        assert_eq!(format!("{:.3?}", metres(true)), format!("{:.3?}", metres(false)));
    }

    #[test]
    fn every_kind_of_geometry_keeps_its_kind() {
        let ring = json!([[1.0, 1.0], [3.0, 1.0], [3.0, 3.0], [1.0, 1.0]]);
        let line = json!([[1.0, 1.0], [3.0, 1.0]]);
        for (kind, coordinates) in [
            ("Polygon", json!([ring])),
            ("MultiPolygon", json!([[ring], [ring]])),
            ("LineString", line.clone()),
            ("MultiLineString", json!([line, line])),
        ] {
            let geometry = json!({ "type": kind, "coordinates": coordinates });
            let document = json!({"type": "FeatureCollection", "crs": null, "features":
                [{"type": "Feature", "properties": {"keep_out": true}, "geometry": geometry}]});
            let areas = Areas::of(&document, &ground(None, [0.0, 0.0])).unwrap();
            assert_eq!(areas.in_map_metres(), document);
        }
    }
}
