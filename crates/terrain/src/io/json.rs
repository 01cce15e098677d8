//! The JSON grid.

mod count;
mod layer;
mod text;

use serde::Deserialize;

use self::count::{pair, whole_number};
pub use self::{
    layer::{Cells, Layer, SurfaceNames},
    text::JsonText,
};
use crate::{Error, Terrain, Warning, areas::Areas, crs::GridSystem};

/// A map as JSON: rows from the south, `null` elevation for unknown ground.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct MapFile {
    /// Edge of a cell, 0.01 to 100 [m].
    pub cell_size_m: f64,
    /// South-west corner of the first cell, x and y [m]. Default: [0, 0].
    #[serde(default, deserialize_with = "pair")]
    #[cfg_attr(feature = "openapi", schema(min_items = 2, max_items = 2))]
    pub origin_m: [f64; 2],
    /// Number of rows.
    #[serde(deserialize_with = "whole_number")]
    #[cfg_attr(feature = "openapi", schema(minimum = 1))]
    pub rows: u64,
    /// Number of columns.
    #[serde(deserialize_with = "whole_number")]
    #[cfg_attr(feature = "openapi", schema(minimum = 1))]
    pub columns: u64,
    /// Coordinate reference system whose easting and northing, in metres, are the map's x and y: `EPSG:` and a code, or WKT.
    /// Default: not known.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(example = "EPSG:26915"))]
    pub crs: Option<String>,
    /// What people call the map, as the name of its file; kept beside its content, of which it is no part. Default: none.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(max_length = 200, example = "yard"))]
    pub name: Option<String>,
    /// Elevation by row and column, −11 000 to 22 000 or null [m].
    #[cfg_attr(feature = "openapi", schema(value_type = Vec<Vec<Option<f64>>>))]
    pub elevation_m: Layer<Vec<f64>>,
    /// Surface names by row and column; null means the robot's default surface. Default: none named.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(value_type = Option<Vec<Vec<Option<String>>>>))]
    pub surface: Option<Layer<SurfaceNames>>,
    /// Obstacles by row and column. Default: none.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(value_type = Option<Vec<Vec<bool>>>))]
    pub obstacle: Option<Layer<Vec<bool>>>,
    /// Cells by row and column whose elevation was worked out from the ground around a hole. Default: none.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(value_type = Option<Vec<Vec<bool>>>))]
    pub filled: Option<Layer<Vec<bool>>>,
    /// Doubts about the map and what was done to it, which answers repeat. Default: none.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(max_items = 32))]
    pub warnings: Vec<Warning>,
    /// What people know of parts of the ground and want of the robot there: a GeoJSON feature collection of polygons and lines, in
    /// longitude and latitude where the map has a `crs`, else in its metres. Their properties may be `surface`, `keep_out`,
    /// `max_speed_mps`, `cost_factor` and `one_way_rad`. Default: none.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(value_type = Option<Object>))]
    pub areas: Option<serde_json::Value>,
}

impl MapFile {
    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.elevation_m.cells()
    }
}

/// Reads a JSON grid.
///
/// # Errors
/// The place of whatever is missing, unknown, ragged or out of range.
pub fn read(text: &str) -> Result<Terrain, Error> {
    let file: MapFile = document::from_json(text.as_bytes())?;
    Terrain::try_from(file)
}

impl TryFrom<MapFile> for Terrain {
    type Error = Error;

    fn try_from(file: MapFile) -> Result<Self, Error> {
        let grid = Terrain::check_size(file.rows, file.columns, file.cell_size_m, file.origin_m)?;
        let system = GridSystem::of(file.crs, &grid)?;
        let shape = (grid.rows, grid.columns);
        let mut terrain = Terrain::new(grid, &file.elevation_m.shaped("elevation_m", shape)?)?;
        if let Some(surface) = file.surface {
            terrain = terrain.with_surfaces(surface.shaped("surface", shape)?.into_surfaces()?);
        }
        if let Some(obstacle) = file.obstacle {
            terrain = terrain.with_obstacles(obstacle.shaped("obstacle", shape)?);
        }
        terrain = system.on(terrain);
        if let Some(filled) = file.filled {
            terrain = terrain.with_filled(filled.shaped("filled", shape)?);
        }
        if file.warnings.len() > Warning::MOST {
            return Err(Error::TooManyWarnings { found: file.warnings.len(), limit: Warning::MOST });
        }
        for (index, warning) in file.warnings.into_iter().enumerate() {
            let (found, limit) = (warning.detail.len(), Warning::LONGEST_DETAIL);
            if found > limit {
                return Err(Error::LongWarning { index, found, limit });
            }
            terrain = terrain.with_warning(warning);
        }
        if let Some(areas) = file.areas.filter(|areas| !areas.is_null()) {
            let areas = Areas::of(&areas, &terrain)?;
            terrain = terrain.with_areas(areas);
        }
        Ok(terrain)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, Surfaces};

    fn refused(text: &str) -> String {
        read(text).unwrap_err().to_string()
    }

    #[test]
    fn a_small_map_is_read_with_all_its_layers() {
        let terrain = read(
            r#"{"cell_size_m": 0.5, "origin_m": [1, 2], "rows": 2, "columns": 3,
                "elevation_m": [[0, 0.1, null], [0.2, 0.3, 0.4]],
                "surface": [["grass", null, "mud"], ["grass", "mud", "mud"]],
                "obstacle": [[false, true, false], [false, false, false]]}"#,
        )
        .unwrap();
        let cell = |row, column| Cell { row, column };
        assert!((terrain.elevation_m(cell(1, 2)).unwrap() - 0.4).abs() < 1e-6);
        assert!(terrain.is_blocked(cell(0, 2)), "unknown ground");
        assert!(terrain.is_blocked(cell(0, 1)), "an obstacle");
        assert!(!terrain.is_blocked(cell(0, 0)));
        assert_eq!(terrain.surface_class(cell(0, 1)), Surfaces::UNNAMED);
        assert_eq!(terrain.surfaces().unwrap().names, ["grass", "mud"]);
    }

    #[test]
    fn a_coordinate_reference_system_is_kept_and_must_be_one_of_metres() {
        let with = |crs: &str| {
            format!(r#"{{"cell_size_m": 1, "crs": {crs}, "rows": 1, "columns": 1, "elevation_m": [[1]]}}"#)
        };
        for crs in [r#""EPSG:26915""#, r#""LOCAL_CS[\"yard\",UNIT[\"metre\",1]]""#] {
            let terrain = read(&with(crs)).unwrap();
            let again: Vec<u8> = JsonText::of(&terrain).flatten().collect();
            assert!(String::from_utf8(again).unwrap().contains(&format!(r#""crs":{crs}"#)));
        }
        assert!(refused(&with(r#""EPSG:4326""#)).contains("crs is `EPSG:4326`"));
        assert!(refused(&with(r#""Minnesota""#)).contains("crs is `Minnesota`"));
        // A height, two geocentric systems, a unit, a geographic system of three axes, and codes of nothing.
        for code in [5773, 4978, 4328, 9001, 4979, 1, 99_999] {
            let found = refused(&with(&format!("\"EPSG:{code}\"")));
            assert!(
                found.contains(&format!("crs is `EPSG:{code}`")) && found.contains("projected"),
                "{found}"
            );
        }
        // Newer than the definitions: true to scale on its parallels of 18° and 36° south (y by pyproj), by 2.5 % not between.
        assert!(read(&with(r#""EPSG:9473", "origin_m": [0, -1922185.5]"#)).is_ok());
        assert!(refused(&with(r#""EPSG:9473", "origin_m": [0, -3000000]"#)).contains("m of ground along x"));
        assert!(
            read(&with(r#""EPSG:26931", "origin_m": [54500000, 700000]"#)).unwrap().warnings().len() == 1
        );
        let web = |north_m: f64| with(&format!(r#""EPSG:3857", "origin_m": [0, {north_m}]"#));
        assert!(read(&web(0.0)).is_ok(), "true to scale on the equator");
        let stretched = refused(&web(8_399_737.0));
        assert!(stretched.contains("0.5008 m of ground") && stretched.contains("EPSG:32631"), "{stretched}");
    }

    #[test]
    fn counts_may_be_written_with_decimals_and_texts_begin_with_a_byte_order_mark() {
        let text = r#"{"cell_size_m": 1, "rows": 1.0, "columns": 2e0, "elevation_m": [[1, 2]]}"#;
        assert_eq!(read(text).unwrap().grid, read(&format!("\u{feff}{text}")).unwrap().grid);
        for wrong in ["1.5", "-1.0", "1e30", "\"1\"", "null"] {
            let message = refused(&text.replace("1.0", wrong));
            assert!(message.contains("rows"), "{wrong}: {message}");
        }
        for origin in ["[]", "[1]", "[1, 2, 0]", "1"] {
            let message = refused(&text.replace("\"rows\"", &format!("\"origin_m\": {origin}, \"rows\"")));
            assert!(message.contains("origin_m") && message.contains("x and y"), "{origin}: {message}");
        }
    }

    #[test]
    fn a_map_survives_a_round_trip() {
        let text = r#"{"cell_size_m": 1.0, "rows": 1, "columns": 2, "elevation_m": [[1.5, null]], "obstacle": [[true, false]],
                       "areas": {"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"cost_factor": 2},
                           "geometry": {"type": "LineString", "coordinates": [[0, 0], [1, 0.5]]}}]},
                       "filled": [[true, false]], "warnings": [{"kind": "filled-voids", "detail": "1 \"cell\""}]}"#;
        let terrain = read(text).unwrap();
        let again: Vec<u8> = JsonText::of(&terrain).flatten().collect();
        assert_eq!(read(std::str::from_utf8(&again).unwrap()).unwrap().content_id(), terrain.content_id());
    }

    #[test]
    fn rows_of_the_wrong_length_are_counted_and_not_kept() {
        let with = |rows: &str| {
            let text = format!(r#"{{"elevation_m": [{rows}], "cell_size_m": 1, "rows": 3, "columns": 2}}"#);
            let file: MapFile = serde_json::from_str(&text).unwrap();
            (file.elevation_m.cells.capacity(), Terrain::try_from(file).unwrap_err().to_string())
        };
        let many = vec!["[]"; 100_000].join(",");
        let (kept, said) = with(&many);
        assert!(kept == 0 && said.contains("100000"), "{kept}: {said}");
        let long = vec!["1"; 100_000].join(",");
        let (kept, said) = with(&format!("[1, 2], [{long}], [{long}]"));
        assert!(kept < 100 && said.contains("elevation_m[1]") && said.contains("100000"), "{kept}: {said}");
    }

    #[test]
    fn every_kind_of_bad_map_is_refused_by_place() {
        let with = |body: &str| format!(r#"{{"cell_size_m": 1, {body}}}"#);
        for (text, place) in [
            (with(r#""rows": 2, "columns": 2, "elevation_m": [[1, 2], [3]]"#), "elevation_m[1]"),
            (with(r#""rows": 0, "columns": 2, "elevation_m": []"#), "rows"),
            (with(r#""rows": 1, "columns": 0, "elevation_m": [[]]"#), "columns"),
            (with(r#""rows": 3, "columns": 1, "elevation_m": [[1], [2]]"#), "elevation_m"),
            (with(r#""rows": 1, "columns": 1, "elevation_m": [["high"]]"#), "elevation_m[0][0]"),
            (with(r#""rows": 1, "columns": 1, "elevation_m": [[1e999]]"#), "elevation_m[0][0]"),
            (with(r#""rows": 1, "columns": 1, "elevation_m": [[123456]]"#), "elevation_m[0][0]"),
            (with(r#""rows": 1, "columns": 1, "elevation_m": [[1]], "colour": 3"#), "colour"),
            (with(r#""rows": 1, "columns": 2, "elevation_m": [[1, 2]], "surface": [["a"]]"#), "surface[0]"),
            (with(r#""rows": 4000000000, "columns": 4000000000, "elevation_m": [[1]]"#), "4000000000"),
            (r#"{"cell_size_m": -1, "rows": 1, "columns": 1, "elevation_m": [[1]]}"#.into(), "cell_size_m"),
            (r#"{"cell_size_m": 500, "rows": 1, "columns": 1, "elevation_m": [[1]]}"#.into(), "cell_size_m"),
            (r#"{"cell_size_m": 1, "origin_m": [1e300, 0], "rows": 1, "columns": 1, "elevation_m": [[1]]}"#.into(), "origin_m[0]"),
            (r#"{"cell_size_m": 1, "rows": 1, "columns": 1, "elevation_m": [[1]]} trailing"#.into(), "trailing"),
            (r#"{"cell_size_m": 1, "rows": 1, "#.into(), "EOF"),
        ] {
            let message = refused(&text);
            assert!(message.contains(place), "{text}\n  said: {message}");
        }
    }
}
