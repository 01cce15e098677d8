//! `/v1/maps/{id}/areas`: what people say of the ground, and what rasters of classes say.

use axum::{
    extract::{Request, State},
    http::{Uri, header},
    response::{IntoResponse, Response},
};
use serde::Deserialize;
use serde_json::Value;
use terrain::areas::{Areas, ClassesError};
use utoipa::{IntoParams, ToSchema};

use super::maps::query;
use crate::{
    Engine, Tenant,
    body::{Content, Id, content_type, from_json, read as read_body},
    form,
    problem::{Problem, ProblemType},
};

/// The system of coordinates in which areas are answered.
#[derive(Clone, Copy, Debug, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FrameName {
    /// The map's metres, with `"crs": null`.
    Map,
}

/// How areas are to be answered.
#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct AreasQuery {
    /// `map`: in the map's metres, with `"crs": null`. Default: as they were given.
    #[param(inline)]
    pub frame: Option<FrameName>,
}

/// The areas over a map, as they were given or in the map's metres.
#[utoipa::path(
    get, path = "/v1/maps/{id}/areas", tag = "maps",
    params(("id" = String, Path, description = "Content hash of the map"), AreasQuery),
    responses(
        (status = 200, description = "The areas; a feature collection without features where there are none", body = Object, content_type = "application/geo+json"),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 404, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn read_areas(
    State(engine): State<Engine>,
    tenant: Tenant,
    Id(id): Id,
    uri: Uri,
) -> Result<Response, Problem> {
    const NONE: &str = r#"{"type":"FeatureCollection","features":[]}"#;
    let AreasQuery { frame } = query(&uri, "frame")?;
    let map = engine.maps().get(&tenant, &id).await?;
    let text = map.areas().map_or_else(
        || NONE.to_owned(),
        |areas| match frame {
            Some(FrameName::Map) => areas.in_map_metres().to_string(),
            None => areas.text().to_owned(),
        },
    );
    Ok(geojson(text))
}

fn geojson(text: String) -> Response {
    ([(header::CONTENT_TYPE, "application/geo+json")], text).into_response()
}

/// A raster of classes and what they change.
#[derive(Debug, Deserialize, ToSchema)]
#[allow(dead_code)]
pub(crate) struct ClassesForm {
    /// A GeoTIFF of classes, as ESA WorldCover: whole numbers of one band. Only the part over the map is read.
    #[schema(value_type = String, format = Binary)]
    raster: Vec<u8>,
    /// A JSON object from class to the properties of an area, as `{"80": {"keep_out": true}, "40": {"surface": "sandy_loam"}}`; null for a class that changes nothing.
    #[schema(value_type = String, format = Binary)]
    classes: Vec<u8>,
}

/// Bytes of a pixel over the map while a raster of classes is read: the class, and its block in double precision.
const CLASS_BYTES: u64 = 16 + 8;

/// Areas over a map from a raster of classes: a feature for each class, to be sent as `areas` of a request or of `PATCH /v1/maps/{id}`. Nothing
/// is stored. `notes` says which classes the table does not name.
#[utoipa::path(
    post, path = "/v1/maps/{id}/areas", tag = "maps",
    params(("id" = String, Path, description = "Content hash of the map")),
    request_body(content((ClassesForm = "multipart/form-data"))),
    responses(
        (status = 200, description = "The areas", body = Object, content_type = "application/geo+json"),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 404, body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn areas_of_classes(
    State(engine): State<Engine>,
    tenant: Tenant,
    Id(id): Id,
    request: Request,
) -> Result<Response, Problem> {
    let kind = content_type(&request);
    if kind != "multipart/form-data" {
        let detail = format!(
            "this path takes multipart/form-data with the parts raster and classes, but the request has `{kind}`"
        );
        return Err(Problem::new(ProblemType::UnsupportedMediaType, detail));
    }
    let boundary = form::boundary_of(&request)?;
    let map = engine.maps().get(&tenant, &id).await?;
    let content = read_body(request, &engine).await?;
    let text = engine
        .compute(move |_| {
            let Content { bytes, mut reserved } = content;
            let length = bytes.len() as u64;
            let example = "-F raster=@worldcover.tif -F classes=@classes.json";
            let [raster, table] = form::two_files(bytes.into(), &boundary, ["raster", "classes"], example)?;
            let table: Value = from_json(&table)?;
            reserved.grow_to(length + CLASS_BYTES * engine_cells(&raster, map.grid.cells() as u64))?;
            let found = Areas::of_classes(&raster, &table, &map).map_err(|error| refused(&error))?;
            let mut document = found.document;
            document["notes"] = found.notes.into();
            Ok(document.to_string())
        })
        .await?;
    Ok(geojson(text))
}

/// Pixels that may be looked at: those of the raster, or as many as four for each cell of the map where it is finer.
fn engine_cells(raster: &[u8], cells: u64) -> u64 {
    terrain::io::geotiff::cells(raster).unwrap_or(cells).min(cells.saturating_mul(4))
}

/// Why there are no areas, at the part of the form that is to blame.
fn refused(error: &ClassesError) -> Problem {
    let (kind, part) = match error {
        ClassesError::Table(_) | ClassesError::NoneOfTable { .. } => {
            (ProblemType::InvalidRequest, "/classes")
        }
        ClassesError::Raster(terrain::Error::TooManyCells { .. }) | ClassesError::TooFine { .. } => {
            (ProblemType::TooLarge, "/raster")
        }
        _ => (ProblemType::InvalidRequest, "/raster"),
    };
    Problem::new(kind, error.to_string()).at(part)
}
