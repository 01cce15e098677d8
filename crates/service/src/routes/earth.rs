//! `GET /v1/maps/{id}/earth`: where on earth a map lies, for who draws it.

use std::f64::consts::PI;

use axum::extract::State;
use serde::Serialize;
use terrain::{
    Grid, Terrain,
    crs::{Earth, EarthError},
};
use utoipa::ToSchema;

use crate::{
    Engine, Tenant,
    answer::Json,
    body::Id,
    problem::{Problem, ProblemType},
};

/// Where on earth a map lies: lattices of places, between whose nodes places are bilinear to some centimetres.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct EarthAnswer {
    /// The map's coordinate reference system, `EPSG:` and a code or WKT.
    pub crs: String,
    /// Heading of true north in the map's middle, counter-clockwise from east; 1.571 (π/2) where it is that of y [rad].
    pub true_north_rad: f64,
    /// Longitudes and latitudes at places of the map that lie evenly in x and y.
    pub degrees: DegreesAnswer,
    /// Places of the map that lie evenly in Web Mercator, by which tiles of pictures are cut.
    pub web_mercator: WebMercatorAnswer,
}

/// Longitudes and latitudes over a map.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct DegreesAnswer {
    /// Nodes from west to east; the first and the last lie on the map's borders.
    pub columns: usize,
    /// Nodes from south to north.
    pub rows: usize,
    /// Longitude and latitude on WGS 84 of each, row by row from the south-west corner [°].
    pub places_deg: Vec<[f64; 2]>,
}

/// Places of a map in the frame that tiles of pictures are cut by.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct WebMercatorAnswer {
    /// The frame that holds the map: west, north, east and south of it as parts of the world's square, x from 180° W eastwards, y from
    /// 85.05° N southwards. Tile `x` of zoom `z` begins at x / 2^z.
    #[schema(min_items = 4, max_items = 4)]
    pub bounds: [f64; 4],
    /// Nodes from west to east; the first and the last lie on the bounds.
    pub columns: usize,
    /// Nodes from north to south.
    pub rows: usize,
    /// x and y of the map at each, row by row from the north-west corner [m].
    pub places_m: Vec<[f64; 2]>,
}

/// Where on earth a map lies: longitude and latitude over all of it, the direction of true north, and its place among tiles of Web Mercator.
#[utoipa::path(
    get, path = "/v1/maps/{id}/earth", tag = "maps",
    params(("id" = String, Path, description = "Content hash of the map")),
    responses(
        (status = 200, description = "Where on earth the map lies", body = EarthAnswer),
        (status = 400, description = "The map does not say, or its system is not placed on earth here", body = Problem, content_type = "application/problem+json"),
        (status = 404, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn read(
    State(engine): State<Engine>,
    tenant: Tenant,
    Id(id): Id,
) -> Result<Json<EarthAnswer>, Problem> {
    let map = engine.maps().get(&tenant, &id).await?;
    engine.compute(move |_| answer(&map)).await.map(Json)
}

/// Where a map lies on earth.
///
/// # Errors
/// A map that does not say, whose system is not placed on earth here, or that reaches beyond the area of its system.
pub fn answer(terrain: &Terrain) -> Result<EarthAnswer, Problem> {
    let refuse = |error: EarthError| {
        let detail = format!(
            "{error}: give the map a `crs` that is placed on earth, as EPSG:32632, or use its metres"
        );
        Problem::new(ProblemType::InvalidMap, detail)
    };
    let earth = terrain.earth().map_err(refuse)?;
    let degrees = degrees(&earth, &terrain.grid).map_err(refuse)?;
    let web_mercator = web_mercator(&earth, &degrees, &terrain.grid).map_err(refuse)?;
    let true_north_rad = true_north_rad(&earth, &terrain.grid).map_err(refuse)?;
    Ok(EarthAnswer { crs: terrain.crs.clone().unwrap_or_default(), true_north_rad, degrees, web_mercator })
}

/// Nodes along an edge of a map. Bilinear places between nodes that lie h apart are off by h² tan φ / 8 R at most (the curvature of
/// parallels over a sphere of radius R, 6371 km): 5 cm at 45° for 1600 m.
fn nodes(length_m: f64) -> usize {
    const SPACING_M: f64 = 1600.0;
    const LEAST: f64 = 8.0;
    const MOST: f64 = 64.0;
    (length_m / SPACING_M).ceil().clamp(LEAST, MOST) as usize + 1
}

/// Position of a node as a part of the way from the first to the last.
fn part(node: usize, nodes: usize) -> f64 {
    node as f64 / (nodes - 1) as f64
}

fn degrees(earth: &Earth, grid: &Grid) -> Result<DegreesAnswer, EarthError> {
    let [east_m, north_m] = grid.far_corner_m();
    let [west_m, south_m] = grid.origin_m;
    let (columns, rows) = (nodes(east_m - west_m), nodes(north_m - south_m));
    let mut places_deg = Vec::with_capacity(columns * rows);
    for row in 0..rows {
        for column in 0..columns {
            let x_m = west_m + part(column, columns) * (east_m - west_m);
            let y_m = south_m + part(row, rows) * (north_m - south_m);
            places_deg.push(earth.place_deg([x_m, y_m])?);
        }
    }
    Ok(DegreesAnswer { columns, rows, places_deg })
}

fn web_mercator(
    earth: &Earth,
    degrees: &DegreesAnswer,
    grid: &Grid,
) -> Result<WebMercatorAnswer, EarthError> {
    let squares = || degrees.places_deg.iter().map(|place_deg| in_square(*place_deg));
    let least = |axis: usize| squares().map(|place| place[axis]).fold(f64::INFINITY, f64::min);
    let most = |axis: usize| squares().map(|place| place[axis]).fold(f64::NEG_INFINITY, f64::max);
    let bounds @ [west, north, east, south] = [least(0), least(1), most(0), most(1)];
    let [far_x_m, far_y_m] = grid.far_corner_m();
    let (columns, rows) = (nodes(far_x_m - grid.origin_m[0]), nodes(far_y_m - grid.origin_m[1]));
    let mut places_m = Vec::with_capacity(columns * rows);
    for row in 0..rows {
        for column in 0..columns {
            let x = west + part(column, columns) * (east - west);
            let y = north + part(row, rows) * (south - north);
            places_m.push(earth.place_m(of_square([x, y]))?);
        }
    }
    Ok(WebMercatorAnswer { bounds, columns, rows, places_m })
}

/// The square of the world at a longitude and latitude.
///
/// ```text
/// x = λ / 2π + 1/2,  y = 1/2 − artanh(sin φ) / 2π
/// ```
///
/// Spherical Mercator of EPSG:3857 (EPSG Guidance Note 7-2, method 1024), as tiles number it (OGC 17-083r4, WebMercatorQuad).
fn in_square([lon_deg, lat_deg]: [f64; 2]) -> [f64; 2] {
    [lon_deg / 360.0 + 0.5, 0.5 - lat_deg.to_radians().sin().atanh() / (2.0 * PI)]
}

/// Longitude and latitude of a place of the square [°]; the inverse of [`in_square`].
fn of_square([x, y]: [f64; 2]) -> [f64; 2] {
    [360.0 * (x - 0.5), (2.0 * PI * (0.5 - y)).tanh().asin().to_degrees()]
}

/// Heading of true north in a map's middle: along the meridian, over a second of latitude to either side.
fn true_north_rad(earth: &Earth, grid: &Grid) -> Result<f64, EarthError> {
    const SECOND_DEG: f64 = 1.0 / 3600.0;
    let far_m = grid.far_corner_m();
    let middle_m = [0, 1].map(|axis| (grid.origin_m[axis] + far_m[axis]) / 2.0);
    let [lon_deg, lat_deg] = earth.place_deg(middle_m)?;
    let south_m = earth.place_m([lon_deg, (lat_deg - SECOND_DEG).max(-90.0)])?;
    let north_m = earth.place_m([lon_deg, (lat_deg + SECOND_DEG).min(90.0)])?;
    Ok((north_m[1] - south_m[1]).atan2(north_m[0] - south_m[0]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(crs: &str, origin_m: [f64; 2], cells: usize, cell_size_m: f64) -> Terrain {
        let grid = Grid { rows: cells, columns: cells, cell_size_m, origin_m };
        let mut terrain = Terrain::new(grid, &vec![0.0; cells * cells]).unwrap();
        terrain.crs = Some(crs.into());
        terrain
    }

    /// Bilinear interpolation between the four nodes around a place, which is given as parts of the lattice.
    fn between(nodes: &[[f64; 2]], columns: usize, rows: usize, [right, down]: [f64; 2]) -> [f64; 2] {
        let (u, v) = (right * (columns - 1) as f64, down * (rows - 1) as f64);
        let (column, row) = ((u as usize).min(columns - 2), (v as usize).min(rows - 2));
        let (s, t) = (u - column as f64, v - row as f64);
        let at = |c: usize, r: usize| nodes[(row + r) * columns + column + c];
        [0, 1].map(|axis| {
            let row = |r: usize| at(0, r)[axis] * (1.0 - s) + at(1, r)[axis] * s;
            row(0) * (1.0 - t) + row(1) * t
        })
    }

    #[test]
    fn places_between_nodes_are_where_the_projection_has_them() {
        // 12.8 km in UTM at its zone's edge, a Lambert system in feet, and the far north.
        for (crs, origin_m) in [
            ("EPSG:32632", [280_000.0, 5_422_970.0]),
            ("EPSG:2263", [300_000.0, 60_000.0]),
            ("EPSG:32633", [500_000.0, 8_700_000.0]),
        ] {
            let terrain = field(crs, origin_m, 128, 100.0);
            let (earth, found) = (terrain.earth().unwrap(), answer(&terrain).unwrap());
            let off_m = |place_m: [f64; 2], place_deg| {
                let [x_m, y_m] = earth.place_m(place_deg).unwrap();
                (x_m - place_m[0]).hypot(y_m - place_m[1])
            };
            for parts in [[0.0, 0.0], [0.07, 0.93], [0.44, 0.56], [1.0, 0.31]] {
                let place_m = [0, 1].map(|axis| origin_m[axis] + 12_800.0 * parts[axis]);
                let DegreesAnswer { columns, rows, places_deg } = &found.degrees;
                let place_deg = between(places_deg, *columns, *rows, parts);
                assert!(off_m(place_m, place_deg) < 0.3, "{crs} {parts:?}: {}", off_m(place_m, place_deg));
                let WebMercatorAnswer { bounds: [west, north, east, south], columns, rows, places_m } =
                    &found.web_mercator;
                let square = [west + parts[0] * (east - west), north + parts[1] * (south - north)];
                let place_m = between(places_m, *columns, *rows, parts);
                let off_m = off_m(place_m, of_square(square));
                assert!(off_m < 0.3, "{crs} {parts:?}: {off_m}");
            }
        }
    }

    #[test]
    fn tiles_are_numbered_as_everywhere() {
        // Tile 132/88 of zoom 8 begins at 5.625° E, 48.922499° N (the tile scheme's own formula, by hand).
        let [x, y] = in_square([5.625, 48.922_499_263_758_24]);
        assert!((x * 256.0 - 132.0).abs() < 1e-9 && (y * 256.0 - 88.0).abs() < 1e-9, "{x} {y}");
        let [lon_deg, lat_deg] = of_square([x, y]);
        assert!((lon_deg - 5.625).abs() < 1e-12 && (lat_deg - 48.922_499_263_758_24).abs() < 1e-10);
    }

    #[test]
    fn true_north_turns_by_the_convergence_of_meridians() {
        // 3° west of the zone's meridian at 45° N: γ = atan(tan(−3°) sin 45°) = −2.123°, so that true north lies right of y.
        let earth = Earth::of("EPSG:32632").unwrap();
        let middle_m = earth.place_m([6.0, 45.0]).unwrap();
        let terrain = field("EPSG:32632", [middle_m[0] - 5.0, middle_m[1] - 5.0], 10, 1.0);
        let turned_deg = answer(&terrain).unwrap().true_north_rad.to_degrees() - 90.0;
        let expected_deg = ((-3f64).to_radians().tan() * 45f64.to_radians().sin()).atan().to_degrees();
        assert!((turned_deg - expected_deg).abs() < 2e-3, "{turned_deg} {expected_deg}");
    }

    #[test]
    fn a_map_that_does_not_say_where_it_lies_is_refused_with_the_mend() {
        let mut terrain = field("EPSG:27700", [0.0; 2], 4, 1.0);
        assert!(answer(&terrain).unwrap_err().detail.contains("datum"));
        terrain.crs = None;
        let said = answer(&terrain).unwrap_err().detail;
        assert!(said.contains("no crs") && said.contains("EPSG:32632"), "{said}");
    }
}
