//! `/v1/maps`: terrain at hand.

use std::sync::Arc;

use axum::{
    Json,
    extract::{Path, Request, State},
    http::StatusCode,
};
use serde::Serialize;
use terrain::{MapFile, Terrain, io};
use utoipa::ToSchema;

use crate::{
    Engine,
    body::{content_type, from_json, read as read_body},
    problem::{Problem, ProblemType},
};

/// A map in brief.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct MapSummary {
    /// Content hash: the same map always has the same id.
    #[schema(example = "b1ae055dffb40c1e")]
    pub id: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Edge of a cell [m].
    pub cell_size_m: f64,
    /// South-west corner, x and y [m].
    #[schema(min_items = 2, max_items = 2)]
    pub origin_m: [f64; 2],
    /// Lowest and highest known elevation [m].
    #[schema(min_items = 2, max_items = 2)]
    pub elevation_range_m: [f64; 2],
    /// Share of cells that are neither unknown nor an obstacle.
    pub passable_fraction: f64,
    /// Surfaces that the map names.
    pub surfaces: Vec<String>,
}

/// Maps at hand.
#[derive(Debug, Serialize, ToSchema)]
pub struct MapList {
    /// In the order of their ids.
    pub maps: Vec<MapSummary>,
}

impl MapSummary {
    /// Describes a map.
    pub fn of(id: String, terrain: &Terrain) -> Self {
        let grid = &terrain.grid;
        let highest_m = terrain.relative_m().iter().copied().filter(|z| !z.is_nan()).fold(0.0, f32::max);
        let passable = (0..grid.cells()).filter(|&i| !terrain.is_blocked(grid.cell(i))).count();
        MapSummary {
            id,
            rows: grid.rows,
            columns: grid.columns,
            cell_size_m: grid.cell_size_m,
            origin_m: grid.origin_m,
            elevation_range_m: [terrain.base_m(), terrain.base_m() + f64::from(highest_m)],
            passable_fraction: passable as f64 / grid.cells() as f64,
            surfaces: terrain.surfaces().map_or(Vec::new(), |s| s.names.clone()),
        }
    }
}

/// Store a map: a JSON grid (application/json), an ESRI ASCII grid (text/plain) or a GeoTIFF in projected metres
/// (image/tiff).
#[utoipa::path(
    post, path = "/v1/maps", tag = "maps",
    request_body(content(
        (MapFile = "application/json"),
        (String = "text/plain"),
        (Vec<u8> = "image/tiff")
    )),
    responses(
        (status = 201, description = "Stored", body = MapSummary),
        (status = 200, description = "Already at hand", body = MapSummary),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 507, body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn create(
    State(engine): State<Engine>,
    request: Request,
) -> Result<(StatusCode, Json<MapSummary>), Problem> {
    let parse = parser(&content_type(&request))?;
    let bytes = read_body(request, &engine).await?;
    let terrain = engine.compute(move || parse(&bytes)).await?;
    let cells = terrain.grid.cells();
    if cells > engine.limits().stored_cells {
        let detail = format!("{cells} cells are more than this service keeps: crop the map");
        return Err(Problem::new(ProblemType::TooLarge, detail));
    }
    let (id, new) = engine.maps().insert(terrain, engine.limits().stored_cells)?;
    let summary = MapSummary::of(id.clone(), &*engine.maps().get(&id)?);
    Ok((if new { StatusCode::CREATED } else { StatusCode::OK }, Json(summary)))
}

type Parser = fn(&[u8]) -> Result<Terrain, Problem>;

/// The reader for a content type.
fn parser(kind: &str) -> Result<Parser, Problem> {
    Ok(match kind {
        "application/json" => |bytes| terrain_from(from_json(bytes)?, ""),
        "text/plain" | "text/x-esri-ascii" | "application/x-esri-ascii" => {
            |bytes| io::text(bytes).and_then(io::ascii::read).map_err(|e| Problem::invalid_map(&e, ""))
        }
        "image/tiff" | "image/geotiff" | "application/geotiff" => {
            |bytes| io::geotiff::read(bytes).map_err(|e| Problem::invalid_map(&e, ""))
        }
        _ => {
            let detail = format!(
                "a map is application/json, text/plain (ESRI ASCII grid) or image/tiff (GeoTIFF), but the request has `{kind}`"
            );
            return Err(Problem::new(ProblemType::UnsupportedMediaType, detail));
        }
    })
}

/// A JSON grid as terrain; `under` is where it stands in the request.
pub(crate) fn terrain_from(file: MapFile, under: &str) -> Result<Terrain, Problem> {
    Terrain::try_from(file).map_err(|error| Problem::invalid_map(&error, under))
}

/// Maps at hand.
#[utoipa::path(get, path = "/v1/maps", tag = "maps", responses((status = 200, body = MapList)))]
pub(crate) async fn list(State(engine): State<Engine>) -> Json<MapList> {
    let maps = engine.maps().list().into_iter().map(|(id, map)| MapSummary::of(id, &map)).collect();
    Json(MapList { maps })
}

/// One map as a JSON grid.
#[utoipa::path(
    get, path = "/v1/maps/{id}", tag = "maps",
    params(("id" = String, Path, description = "Content hash of the map")),
    responses((status = 200, body = MapFile), (status = 404, body = Problem, content_type = "application/problem+json"))
)]
pub(crate) async fn read(
    State(engine): State<Engine>,
    Path(id): Path<String>,
) -> Result<Json<MapFile>, Problem> {
    let map: Arc<Terrain> = engine.maps().get(&id)?;
    Ok(Json(MapFile::from(&*map)))
}

/// Forget a map.
#[utoipa::path(
    delete, path = "/v1/maps/{id}", tag = "maps",
    params(("id" = String, Path, description = "Content hash of the map")),
    responses((status = 204, description = "Forgotten"), (status = 404, body = Problem, content_type = "application/problem+json"))
)]
pub(crate) async fn remove(
    State(engine): State<Engine>,
    Path(id): Path<String>,
) -> Result<StatusCode, Problem> {
    engine.maps().remove(&id)?;
    Ok(StatusCode::NO_CONTENT)
}
