//! From GeoJSON to areas.

use serde_json::{Map, Value};

use super::{
    Area, AreaError, Areas, Effect,
    placing::Placing,
    shape::{Point, Shape},
};
use crate::Terrain;

/// Properties that mean nothing here, as many as are named.
const NAMED_OTHERS: usize = 5;

impl Areas {
    /// Reads a feature collection (RFC 7946) over a map: polygons and lines whose properties say what they change. Coordinates are
    /// longitude and latitude where the map has a `crs`, else the map's metres; a member `crs` names another system.
    ///
    /// # Errors
    /// The first feature, position or property that cannot be, by its place.
    pub fn of(document: &Value, terrain: &Terrain) -> Result<Self, AreaError> {
        let features = features(document)?;
        let text = document.to_string();
        if text.len() > Self::LONGEST_TEXT {
            let what = format!(
                "have {} bytes, but at most {} are read: simplify them",
                text.len(),
                Self::LONGEST_TEXT
            );
            return Err(AreaError::new("", what));
        }
        let mut drawn = Vec::with_capacity(features.len());
        let mut positions = 0;
        for (feature, value) in features.iter().enumerate() {
            let shapes = shapes(value.get("geometry"), &format!("features[{feature}].geometry"))?;
            positions += shapes.iter().flat_map(Shape::chains).map(Vec::len).sum::<usize>();
            if positions > Self::MOST_POSITIONS {
                let what = format!(
                    "is where all features have more than {} positions: simplify them",
                    Self::MOST_POSITIONS
                );
                return Err(AreaError::new(&format!("features[{feature}]"), what));
            }
            drawn.push(shapes);
        }
        let points = drawn.iter().flatten().flat_map(Shape::chains).flatten().copied();
        let (placing, note) = Placing::of(document, terrain, points)?;
        let mut others = Vec::new();
        let mut areas = Vec::with_capacity(drawn.len());
        for (feature, shapes) in drawn.into_iter().enumerate() {
            let at = format!("features[{feature}]");
            let effect = effect(features[feature], &at, &mut others)?;
            let shapes = placed(shapes, &placing, terrain, &at)?;
            areas.push(Area { feature, shapes, effect });
        }
        others.sort();
        others.dedup();
        let unknown = (!others.is_empty()).then(|| {
            let named: Vec<&str> = others.iter().take(NAMED_OTHERS).map(String::as_str).collect();
            let known = Effect::known();
            format!("the areas' properties {} mean nothing here; what counts is {known}", named.join(", "))
        });
        let notes = note.into_iter().chain(unknown).collect();
        Ok(Areas { text, areas, notes })
    }
}

/// The features of a collection, or the only one.
fn features(document: &Value) -> Result<Vec<&Value>, AreaError> {
    let features: Vec<&Value> = match (document.get("type").and_then(Value::as_str), document.get("features"))
    {
        (Some("FeatureCollection"), Some(Value::Array(features))) => features.iter().collect(),
        (Some("FeatureCollection"), _) => {
            return Err(AreaError::new("features", "is missing: give an array of features"));
        }
        _ => {
            let what = "is no GeoJSON feature collection: give {\"type\": \"FeatureCollection\", \"features\": [...]}";
            return Err(AreaError::new("type", what));
        }
    };
    if features.len() > Areas::MOST_FEATURES {
        let what = format!("has {} entries, but at most {} are read", features.len(), Areas::MOST_FEATURES);
        return Err(AreaError::new("features", what));
    }
    Ok(features)
}

/// What a feature changes.
fn effect(feature: &Value, at: &str, others: &mut Vec<String>) -> Result<Effect, AreaError> {
    let none = Map::new();
    let at = format!("{at}.properties");
    let properties = match feature.get("properties") {
        Some(Value::Object(properties)) => properties,
        None | Some(Value::Null) => &none,
        Some(_) => return Err(AreaError::new(&at, "is no object")),
    };
    let effect = Effect::of(properties, &at, others)?;
    if effect.is_any() {
        return Ok(effect);
    }
    Err(AreaError::new(&at, format!("say nothing that an area may change: give one of {}", Effect::known())))
}

/// The shapes of a geometry, as they are written.
fn shapes(geometry: Option<&Value>, at: &str) -> Result<Vec<Shape>, AreaError> {
    let kind =
        geometry.and_then(|geometry| geometry.get("type")).and_then(Value::as_str).unwrap_or("missing");
    let coordinates = geometry.and_then(|geometry| geometry.get("coordinates")).unwrap_or(&Value::Null);
    let at_each = format!("{at}.coordinates");
    let each = |read: &dyn Fn(&Value, &str) -> Result<Shape, AreaError>| {
        let list = array(coordinates, &at_each)?;
        list.iter().enumerate().map(|(i, one)| read(one, &format!("{at_each}[{i}]"))).collect()
    };
    match kind {
        "Polygon" => Ok(vec![polygon(coordinates, &at_each)?]),
        "MultiPolygon" => each(&polygon),
        "LineString" => Ok(vec![line(coordinates, &at_each)?]),
        "MultiLineString" => each(&line),
        other => {
            let what =
                format!("is {other}, but areas are Polygon, MultiPolygon, LineString or MultiLineString");
            Err(AreaError::new(&format!("{at}.type"), what))
        }
    }
}

fn polygon(value: &Value, at: &str) -> Result<Shape, AreaError> {
    let rings = array(value, at)?;
    let mut read = Vec::with_capacity(rings.len());
    for (i, ring) in rings.iter().enumerate() {
        let at = format!("{at}[{i}]");
        let mut points = points(ring, &at)?;
        // RFC 7946 closes rings; what some programs leave open is meant so too.
        if points.first() != points.last() {
            points.extend(points.first().copied());
        }
        if points.len() < 4 {
            return Err(AreaError::new(
                &at,
                "has fewer than three corners, but encloses an area only with three",
            ));
        }
        read.push(points);
    }
    if read.is_empty() { Err(AreaError::new(at, "has no ring")) } else { Ok(Shape::Polygon(read)) }
}

fn line(value: &Value, at: &str) -> Result<Shape, AreaError> {
    let points = points(value, at)?;
    match points.len() {
        0 | 1 => Err(AreaError::new(at, "has fewer than two positions")),
        _ => Ok(Shape::Line(points)),
    }
}

fn points(value: &Value, at: &str) -> Result<Vec<Point>, AreaError> {
    let list = array(value, at)?;
    let point = |(i, position): (usize, &Value)| {
        let axis = |axis: usize| position.get(axis).and_then(Value::as_f64).filter(|value| value.is_finite());
        axis(0).zip(axis(1)).map(|(x, y)| [x, y]).ok_or_else(|| {
            AreaError::new(&format!("{at}[{i}]"), "is no position: give an array of two numbers")
        })
    };
    list.iter().enumerate().map(point).collect()
}

fn array<'v>(value: &'v Value, at: &str) -> Result<&'v Vec<Value>, AreaError> {
    value.as_array().ok_or_else(|| AreaError::new(at, "is no array"))
}

/// Shapes in the map's metres, each of which touches the map and does not cross itself.
fn placed(
    shapes: Vec<Shape>,
    placing: &Placing,
    terrain: &Terrain,
    at: &str,
) -> Result<Vec<Shape>, AreaError> {
    let chain = |points: Vec<Point>| -> Result<Vec<Point>, AreaError> {
        let place = |point| {
            placing
                .place_m(point)
                .map_err(|why| AreaError::new(&format!("{at}.geometry"), format!("cannot be placed: {why}")))
        };
        points.into_iter().map(place).collect()
    };
    let mut placed = Vec::with_capacity(shapes.len());
    for shape in shapes {
        let shape = match shape {
            Shape::Polygon(rings) => Shape::Polygon(rings.into_iter().map(&chain).collect::<Result<_, _>>()?),
            Shape::Line(points) => Shape::Line(chain(points)?),
        };
        if let Some([x_m, y_m]) = shape.crossing() {
            let what = format!(
                "crosses itself at {x_m:.2}, {y_m:.2} of the map: draw it anew, or as several polygons"
            );
            return Err(AreaError::new(&format!("{at}.geometry"), what));
        }
        placed.push(shape);
    }
    if placed.iter().any(|shape| shape.meets(&terrain.grid)) {
        return Ok(placed);
    }
    let ([west, south], [east, north]) = (terrain.grid.origin_m, terrain.grid.far_corner_m());
    let what = format!(
        "lies outside the map, which spans {west:.1} to {east:.1} east and {south:.1} to {north:.1} north; the coordinates were read as {}{}",
        placing.name(),
        if terrain.crs.is_none() { ": for longitude and latitude the map needs a crs" } else { "" }
    );
    Err(AreaError::new(&format!("{at}.geometry"), what))
}

#[cfg(test)]
#[allow(clippy::needless_pass_by_value)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::Grid;

    fn ground(crs: Option<&str>) -> Terrain {
        let origin_m = if crs.is_some() { [512_000.0, 5_422_960.0] } else { [0.0, 0.0] };
        let grid = Grid { rows: 30, columns: 40, cell_size_m: 1.0, origin_m };
        Terrain { crs: crs.map(str::to_owned), ..Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap() }
    }

    fn one(geometry: Value, properties: Value) -> Value {
        json!({"type": "FeatureCollection", "features": [
            {"type": "Feature", "geometry": geometry, "properties": properties}]})
    }

    fn square(west: f64, south: f64, side: f64) -> Value {
        let (east, north) = (west + side, south + side);
        json!({"type": "Polygon", "coordinates":
            [[[west, south], [east, south], [east, north], [west, north], [west, south]]]})
    }

    #[test]
    fn degrees_are_placed_by_the_maps_system_and_metres_by_its_own() {
        let mud = json!({"surface": "mud"});
        let terrain = ground(Some("EPSG:32632"));
        let earth = terrain.earth().unwrap();
        let corner_deg = earth.place_deg([512_010.0, 5_422_970.0]).unwrap();
        let in_degrees =
            Areas::of(&one(square(corner_deg[0], corner_deg[1], 1e-4), mud.clone()), &terrain).unwrap();
        let [low, _] = in_degrees.areas[0].shapes[0].bounds();
        assert!((low[0] - 512_010.0).abs() < 0.2 && (low[1] - 5_422_970.0).abs() < 0.2, "{low:?}");
        let in_metres = Areas::of(&one(square(512_010.0, 5_422_970.0, 5.0), mud.clone()), &terrain).unwrap();
        assert_eq!(in_metres.areas[0].shapes[0].bounds()[0], [512_010.0, 5_422_970.0]);
        let local = Areas::of(&one(square(3.0, 4.0, 5.0), mud), &ground(None)).unwrap();
        assert_eq!(local.areas[0].shapes[0].bounds(), [[3.0, 4.0], [8.0, 9.0]]);
    }

    #[test]
    fn another_system_is_transformed_and_said() {
        let terrain = ground(Some("EPSG:32632"));
        let place_deg = terrain.earth().unwrap().place_deg([512_010.0, 5_422_970.0]).unwrap();
        let other_m = crate::crs::Earth::of("EPSG:25832").unwrap().place_m(place_deg).unwrap();
        let mut document = one(square(other_m[0], other_m[1], 5.0), json!({"keep_out": true}));
        document["crs"] = json!({"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}});
        let areas = Areas::of(&document, &terrain).unwrap();
        let [low, _] = areas.areas[0].shapes[0].bounds();
        assert!((low[0] - 512_010.0).abs() < 0.01 && (low[1] - 5_422_970.0).abs() < 0.01, "{low:?}");
        assert!(areas.notes()[0].contains("from EPSG:25832 to the map's EPSG:32632"), "{:?}", areas.notes());
    }

    #[test]
    fn what_cannot_be_is_refused_by_its_place() {
        let (terrain, keep_out) = (ground(None), json!({"keep_out": true}));
        let refused = |document: &Value| Areas::of(document, &terrain).unwrap_err().to_string();
        let bow = json!({"type": "Polygon", "coordinates": [[[1, 1], [5, 5], [5, 1], [1, 5], [1, 1]]]});
        for (document, said) in [
            (one(bow, keep_out.clone()), "areas.features[0].geometry crosses itself at 3.00, 3.00"),
            (
                one(square(400.0, 4.0, 2.0), keep_out.clone()),
                "areas.features[0].geometry lies outside the map",
            ),
            (one(square(1.0, 1.0, 2.0), json!({})), "areas.features[0].properties say nothing"),
            (
                one(square(1.0, 1.0, 2.0), json!({"max_speed_mps": -1})),
                "areas.features[0].properties.max_speed_mps is -1",
            ),
            (
                one(square(1.0, 1.0, 2.0), json!({"cost_factor": 0.01})),
                "cost_factor is 0.01, but must be a number from 0.1",
            ),
            (one(square(1.0, 1.0, 2.0), json!({"keep_out": "yes"})), "keep_out is \"yes\""),
            (one(square(1.0, 1.0, 2.0), json!({"one_way_rad": 90})), "one_way_rad is 90"),
            (
                one(json!({"type": "Point", "coordinates": [1, 1]}), keep_out.clone()),
                "features[0].geometry.type is Point",
            ),
            (
                one(json!({"type": "LineString", "coordinates": [[1, 1]]}), keep_out.clone()),
                "fewer than two positions",
            ),
            (
                one(json!({"type": "Polygon", "coordinates": [[[1, 1], [2, 2], [1, 1]]]}), keep_out.clone()),
                "fewer than three corners",
            ),
            (
                one(json!({"type": "LineString", "coordinates": [[1, 1], [1, "n"]]}), keep_out),
                "coordinates[1] is no position",
            ),
            (json!({"type": "Feature"}), "areas.type is no GeoJSON feature collection"),
            (json!([1]), "areas.type is no GeoJSON feature collection"),
        ] {
            let message = refused(&document);
            assert!(message.contains(said), "{message}\n  lacks {said}");
        }
    }

    #[test]
    fn properties_that_mean_nothing_are_said() {
        let areas = Areas::of(
            &one(square(1.0, 1.0, 2.0), json!({"surface": "mud", "max_speed_kmh": 3})),
            &ground(None),
        )
        .unwrap();
        assert!(areas.notes()[0].contains("max_speed_kmh mean nothing here"), "{:?}", areas.notes());
    }
}
