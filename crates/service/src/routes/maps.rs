//! `/v1/maps`: terrain at hand.

use std::sync::Arc;

use axum::{
    extract::{Query, Request, State},
    http::{HeaderMap, StatusCode, Uri, header},
    response::{IntoResponse, Response},
};
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{DeserializeOwned, Error as _},
};
use sha2::{Digest, Sha256};
use terrain::{MapFile, Patch, Terrain, Warning, areas::Areas, io, io::json::JsonText};
use utoipa::{IntoParams, ToSchema};

use crate::{
    Engine, Tenant,
    accept::preferred,
    answer::{Json, streamed},
    body::{Id, JsonBody, read as read_body},
    cells::CellBytes,
    layers::Named,
    map_reader::{MapReader, Read, RosMapForm},
    maps::Stored,
    problem::{Problem, ProblemType},
    store::id_of,
};

/// A map in brief.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MapSummary {
    /// Content hash: the same map always has the same id.
    #[schema(example = "b1ae055dffb40c1e6d70fd1ca9d5c3aa")]
    pub id: String,
    /// What people call the map: the `name` that it was last sent with. Left out where it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, example = "minnesota.tif")]
    pub name: Option<String>,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Edge of a cell [m].
    pub cell_size_m: f64,
    /// South-west corner, x and y [m].
    #[schema(min_items = 2, max_items = 2)]
    pub origin_m: [f64; 2],
    /// Coordinate reference system whose easting and northing, in metres, are x and y: `EPSG:` and a code, or WKT. Left out
    /// where it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, example = "EPSG:26915")]
    pub crs: Option<String>,
    /// Lowest and highest known elevation [m].
    #[schema(min_items = 2, max_items = 2)]
    pub elevation_range_m: [f64; 2],
    /// Share of cells that are neither unknown nor an obstacle.
    pub passable_fraction: f64,
    /// Surfaces that the map names.
    pub surfaces: Vec<String>,
    /// Number of areas over the map.
    #[serde(default)]
    pub areas: usize,
    /// Doubts about the map, and what was done to it.
    #[serde(default)]
    pub warnings: Vec<Warning>,
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
            name: None,
            rows: grid.rows,
            columns: grid.columns,
            cell_size_m: grid.cell_size_m,
            origin_m: grid.origin_m,
            crs: terrain.crs.clone(),
            elevation_range_m: [terrain.base_m(), terrain.base_m() + f64::from(highest_m)],
            passable_fraction: passable as f64 / grid.cells() as f64,
            surfaces: terrain.surfaces().map_or(Vec::new(), |s| s.names.clone()),
            areas: terrain.areas().map_or(0, Areas::len),
            warnings: terrain.warnings().to_vec(),
        }
    }
}

/// How a map is to be read.
#[derive(Clone, Debug, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct ReadingQuery {
    /// Fill holes of unknown ground that are at most so wide from the ground around them, up to 1000; the answer's warnings say
    /// how many, and `filled` of the map which. Default: the service's setting, which is none unless it was started with one [m].
    #[param(exclusive_minimum = 0.0, maximum = 1000.0)]
    pub fill_voids_m: Option<f64>,
    /// Elevation of unknown cells, beside those that the file marks. Default: the service's setting, as above [m].
    pub nodata_m: Option<f64>,
    /// Edge of a cell of a numpy array (application/x-npy), which needs it. Other maps hold their own, and are refused with one [m].
    #[param(minimum = 0.01, maximum = 100.0)]
    pub cell_size_m: Option<f64>,
    /// South-west corner of a numpy array, x and y with a comma between them. Default: 0,0 [m].
    #[serde(default, deserialize_with = "origin_m")]
    #[param(value_type = String, pattern = r"^-?\d+(\.\d+)?,-?\d+(\.\d+)?$")]
    pub origin_m: Option<[f64; 2]>,
    /// Coordinate reference system of a numpy array, in metres: `EPSG:` and a code, or WKT. Default: unknown.
    pub crs: Option<String>,
    /// What the map is called, as its file; at most 200 characters. A map that is at hand takes this name. Default: the `name` in a
    /// JSON grid, else the one that it has.
    #[param(min_length = 1, max_length = 200)]
    pub name: Option<String>,
}

/// The two numbers of a query's `origin_m`.
fn origin_m<'de, D: Deserializer<'de>>(from: D) -> Result<Option<[f64; 2]>, D::Error> {
    let text = String::deserialize(from)?;
    io::Georeference::parse_origin_m(&text).map(Some).map_err(D::Error::custom)
}

/// Store a map under a name of one's own, if it has one: a JSON grid (application/json), an ESRI ASCII grid (text/plain), a GeoTIFF in projected metres or degrees (image/tiff), a numpy array (application/x-npy, with `cell_size_m`), cells in bytes (application/octet-stream: see the guide), or
/// the YAML and the image of a ROS map_server map (multipart/form-data with the parts `yaml` and `image`). What looks wrong with
/// its elevations stands in the answer's warnings.
#[utoipa::path(
    post, path = "/v1/maps", tag = "maps",
    params(ReadingQuery),
    request_body(content(
        (MapFile = "application/json"),
        (String = "text/plain"),
        (Vec<u8> = "image/tiff"),
        (Vec<u8> = "application/x-npy"),
        (Vec<u8> = "application/octet-stream"),
        (RosMapForm = "multipart/form-data")
    )),
    responses(
        (status = 201, description = "Stored", body = MapSummary),
        (status = 200, description = "Already at hand", body = MapSummary),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 507, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn create(
    State(engine): State<Engine>,
    tenant: Tenant,
    uri: Uri,
    request: Request,
) -> Result<(StatusCode, Json<MapSummary>), Problem> {
    let query =
        query::<ReadingQuery>(&uri, "fill_voids_m`, `nodata_m`, `cell_size_m`, `origin_m`, `crs` and `name")?;
    let reader = MapReader::of(&request)?;
    let usual = engine.limits().map_options();
    let options = io::Options {
        nodata_m: query.nodata_m.or(usual.nodata_m),
        fill_voids_m: query.fill_voids_m.or(usual.fill_voids_m),
        georeference: io::Georeference {
            cell_size_m: query.cell_size_m,
            origin_m: query.origin_m,
            crs: query.crs,
        },
        ..usual
    };
    let name = query.name.as_deref().map(checked_name).transpose()?;
    let content = read_body(request, &engine).await?;
    let reader = reader.for_body(&content.bytes)?;
    let map = engine
        .compute(move |_| {
            let Read { terrain, name: own_name } = reader.read(content, &options)?;
            refuse_too_large(&terrain, options.most_cells)?;
            let name = match name {
                Some(name) => Some(name),
                None => own_name
                    .as_deref()
                    .map(checked_name)
                    .transpose()
                    .map_err(|problem| problem.at("/name"))?,
            };
            let summary = MapSummary { name, ..MapSummary::of(terrain.content_id(), &terrain) };
            Ok(Stored { terrain: Arc::new(terrain), summary })
        })
        .await?;
    let summary = map.summary.clone();
    let new = engine.maps().insert(&tenant, map, &engine.limits().maps()).await?;
    answered(&engine, &tenant, new, summary).await
}

/// The answer to a map that was sent: of one that was at hand, with the name that it keeps.
async fn answered(
    engine: &Engine,
    tenant: &Tenant,
    new: bool,
    summary: MapSummary,
) -> Result<(StatusCode, Json<MapSummary>), Problem> {
    if new {
        return Ok((StatusCode::CREATED, Json(summary)));
    }
    Ok((StatusCode::OK, Json(engine.maps().renamed(tenant, summary).await?)))
}

/// Longest name of a map [characters]; those of files have 255 bytes at most.
const LONGEST_NAME: usize = 200;

/// A name of a map without blanks around it.
fn checked_name(name: &str) -> Result<String, Problem> {
    let trimmed = name.trim();
    let length = trimmed.chars().count();
    if (1..=LONGEST_NAME).contains(&length) && !trimmed.contains(char::is_control) {
        return Ok(trimmed.to_owned());
    }
    let detail = format!(
        "the map's name has {length} characters, but must have 1 to {LONGEST_NAME} and no control characters: shorten it, or leave it out"
    );
    Err(Problem::new(ProblemType::InvalidRequest, detail))
}

/// Refuses a map that could be kept but not planned over.
pub(crate) fn refuse_too_large(terrain: &Terrain, most_cells: u64) -> Result<(), Problem> {
    let cells = terrain.grid.cells();
    if cells as u64 <= most_cells {
        return Ok(());
    }
    let side = most_cells.isqrt();
    let coarser_m = terrain.grid.cell_size_m * (cells as f64 / most_cells as f64).sqrt();
    let detail = format!(
        "the map has {cells} cells, more than the {most_cells} that can be planned over: crop it to {side} × {side} cells or resample it to cells of {coarser_m:.2} m"
    );
    Err(Problem::new(ProblemType::TooLarge, detail))
}

/// A JSON grid as terrain, read with options; `under` is where it stands in the request.
pub(crate) fn terrain_from(file: MapFile, options: &io::Options, under: &str) -> Result<Terrain, Problem> {
    let terrain = Terrain::try_from(file).and_then(|terrain| terrain.as_asked(options));
    terrain.map_err(|error| Problem::invalid_map(&error, under))
}

/// Maps at hand.
#[utoipa::path(
    get, path = "/v1/maps", tag = "maps",
    responses(
        (status = 200, description = "The stored maps", body = MapList),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn list(State(engine): State<Engine>, tenant: Tenant) -> Result<Json<MapList>, Problem> {
    Ok(Json(MapList { maps: engine.maps().list(&tenant).await? }))
}

/// How many cells to send.
#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct CellsQuery {
    /// Most cells of an answer in bytes: of a larger map every so many are sent. Default: all.
    #[param(minimum = 1)]
    pub max_cells: Option<usize>,
}

/// One map as a JSON grid, or its cells in bytes as `Accept` asks. The bytes, little-endian: `JPC1`; columns, rows and stride
/// as u32; cell_size_m, the south-west corner's x and y, and base_m as f64; by rows from the south, an f32 of elevation above
/// base_m for each cell, NaN where unknown; then a u8 of its surface, an index into the summary's names or 255; then a u8
/// that is 1 where there is an obstacle.
#[utoipa::path(
    get, path = "/v1/maps/{id}", tag = "maps",
    params(("id" = String, Path, description = "Content hash of the map"), CellsQuery),
    responses(
        (status = 200, description = "The map", content((MapFile = "application/json"), (Vec<u8> = "application/octet-stream"))),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 404, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn read(
    State(engine): State<Engine>,
    tenant: Tenant,
    Id(id): Id,
    headers: HeaderMap,
    uri: Uri,
) -> Result<Response, Problem> {
    let CellsQuery { max_cells } = cells_query(&uri)?;
    let map: Arc<Terrain> = engine.maps().get(&tenant, &id).await?;
    let form = preferred(&headers, &["application/json", "application/octet-stream"]);
    let about = |tag: String| [(header::CONTENT_TYPE, form.to_owned()), (header::ETAG, tag)];
    if form == "application/json" {
        let name = engine.maps().name(&tenant, &id).await?;
        // The name is part of the answer, and no part of the content that the id is of.
        let of_name = name.as_deref().map(|name| format!("-{}", id_of(Sha256::new_with_prefix(name))));
        let tag = format!("W/\"{id}{}\"", of_name.unwrap_or_default());
        let mut response = (about(tag), streamed(JsonText::of(&map).named(name))).into_response();
        response.extensions_mut().insert(Named);
        return Ok(response);
    }
    let cells = CellBytes::of(map, max_cells.unwrap_or(usize::MAX));
    let length = cells.length();
    let tag = format!("W/\"{id}-{length}\"");
    Ok((about(tag), [(header::CONTENT_LENGTH, length)], streamed(cells)).into_response())
}

fn cells_query(uri: &Uri) -> Result<CellsQuery, Problem> {
    let query: CellsQuery = query(uri, "max_cells")?;
    match query.max_cells {
        Some(0) => Err(unreadable_query("max_cells is 0, but must be at least 1")),
        _ => Ok(query),
    }
}

/// The query of a request; `fields` are those that it may hold.
pub(super) fn query<T: DeserializeOwned>(uri: &Uri, fields: &str) -> Result<T, Problem> {
    Query::<T>::try_from_uri(uri)
        .map(|Query(query)| query)
        .map_err(|error| unreadable_query(&format!("{error}; it may hold `{fields}`")))
}

fn unreadable_query(why: &str) -> Problem {
    Problem::new(ProblemType::InvalidRequest, format!("the query cannot be read: {why}"))
}

/// Change a rectangle of a map's cells, or the areas over it. The changed map is stored beside the other, under its own id; what has been worked
/// out for plans over the other is kept where the change does not touch it.
#[utoipa::path(
    patch, path = "/v1/maps/{id}", tag = "maps",
    params(("id" = String, Path, description = "Content hash of the map")),
    request_body = Patch,
    responses(
        (status = 201, description = "The changed map is stored", body = MapSummary),
        (status = 200, description = "Such a map is already at hand", body = MapSummary),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 404, body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 507, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn change(
    State(engine): State<Engine>,
    tenant: Tenant,
    Id(id): Id,
    JsonBody(patch): JsonBody<Patch>,
) -> Result<(StatusCode, Json<MapSummary>), Problem> {
    let before = engine.maps().get(&tenant, &id).await?;
    let name = engine.maps().name(&tenant, &id).await?;
    let (map, changed) = engine
        .compute(move |_| {
            let (terrain, changed) =
                before.patched(&patch).map_err(|error| Problem::invalid_map(&error, ""))?;
            let terrain = terrain.with_doubts();
            let summary = MapSummary { name, ..MapSummary::of(terrain.content_id(), &terrain) };
            Ok((Stored { terrain: Arc::new(terrain), summary }, changed))
        })
        .await?;
    let summary = map.summary.clone();
    let terrain = Arc::clone(&map.terrain);
    let new = engine.maps().insert(&tenant, map, &engine.limits().maps()).await?;
    // Another tenant may have the changed map, and planners for it, already.
    if new && !engine.planners().knows(&summary.id) {
        let (own, changed_id) = (engine.clone(), summary.id.clone());
        engine
            .compute(move |_| {
                own.planners().patch(&id, &changed_id, &terrain, &changed);
                own.planners().shrink(own.limits().kept_bytes);
                Ok(())
            })
            .await?;
    }
    answered(&engine, &tenant, new, summary).await
}

/// Forget a map.
#[utoipa::path(
    delete, path = "/v1/maps/{id}", tag = "maps",
    params(("id" = String, Path, description = "Content hash of the map")),
    responses(
        (status = 204, description = "Forgotten"),
        (status = 404, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn remove(
    State(engine): State<Engine>,
    tenant: Tenant,
    Id(id): Id,
) -> Result<StatusCode, Problem> {
    if engine.maps().remove(&tenant, &id).await? {
        engine.planners().forget(&id);
    }
    Ok(StatusCode::NO_CONTENT)
}
