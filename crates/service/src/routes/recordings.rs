//! `/v1/recordings`: drive logs at hand.

use std::{
    ops::ControlFlow,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use axum::{
    extract::{Query, Request, State},
    http::{StatusCode, Uri},
};
use recording::{BeginningColumn, Format, ReadingReport, Room};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::{IntoParams, ToSchema};

use crate::{
    Engine, Tenant,
    answer::Json,
    body::{Id, content_type},
    memory::hold,
    problem::{Problem, ProblemType},
    receive::{Received, receive},
    recordings::{Note, map_from},
    store::{Spool, cannot},
};

/// How a recording is to be read.
#[derive(Debug, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct ReadingQuery {
    /// Name of a built-in map (`husky`, `borealtc`), or a map as JSON, which names columns or topics and their units.
    /// Default: columns are what their names say, topics those of a Husky.
    pub map: Option<String>,
    /// What the run is called where the file does not say. Default: `recording`.
    pub name: Option<String>,
}

/// A recording in brief.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct RecordingSummary {
    /// Content hash: the same file always has the same id.
    #[schema(example = "0f3a86b2c1d94e7785aa01c2b3d4e5f6")]
    pub id: String,
    /// Its format.
    pub format: Format,
    /// Its size [bytes].
    pub bytes: u64,
    /// Rows of the table that it was read into.
    pub rows: u64,
    /// Names of its drives.
    pub runs: Vec<String>,
}

/// Recordings at hand.
#[derive(Debug, Serialize, ToSchema)]
pub struct RecordingList {
    /// In the order of their ids.
    pub recordings: Vec<RecordingSummary>,
}

/// A recording with what reading it found.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct RecordingAnswer {
    /// The recording in brief.
    #[serde(flatten)]
    pub summary: RecordingSummary,
    /// What was found, used, left aside, repaired, missing and suspicious.
    #[schema(value_type = ReadingReport)]
    pub report: Value,
}

impl From<&Note> for RecordingSummary {
    fn from(note: &Note) -> Self {
        let runs = note.report["runs"].as_array().map_or(&[][..], Vec::as_slice);
        RecordingSummary {
            id: note.id.clone(),
            format: note.format,
            bytes: note.bytes,
            rows: note.report["rows"].as_u64().unwrap_or(0),
            runs: runs.iter().filter_map(|run| run["run"].as_str().map(str::to_owned)).collect(),
        }
    }
}

impl From<Note> for RecordingAnswer {
    fn from(note: Note) -> Self {
        RecordingAnswer { summary: (&note).into(), report: note.report }
    }
}

/// Store a recording: CSV (text/csv), Parquet (application/vnd.apache.parquet), MCAP (application/mcap), a SQLite file of
/// ROS 2 (application/vnd.sqlite3) or a ROS 1 bag (application/x-rosbag). The body goes to disk as it comes, and is read once
/// to be checked; where its first bytes show another of these than was said, it is read as what it is.
#[utoipa::path(
    post, path = "/v1/recordings", tag = "recordings",
    params(ReadingQuery),
    request_body(content(
        (String = "text/csv"),
        (Vec<u8> = "application/vnd.apache.parquet"),
        (Vec<u8> = "application/mcap"),
        (Vec<u8> = "application/vnd.sqlite3"),
        (Vec<u8> = "application/x-rosbag")
    )),
    responses(
        (status = 201, description = "Stored", body = RecordingAnswer),
        (status = 200, description = "Was at hand already; it was read anew", body = RecordingAnswer),
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
    request: Request,
) -> Result<(StatusCode, Json<RecordingAnswer>), Problem> {
    let said = format_of(&content_type(&request))?;
    let ReadingQuery { map, name } = query(request.uri())?;
    let map = map.map(map_choice).transpose()?;
    map.as_ref().map(map_from).transpose()?;
    let (parts, body) = request.into_parts();
    let received = receive(&engine, &tenant, &parts.headers, body).await?;
    let format = content_of(&received)?.unwrap_or(said);
    let reading = Reading::of(&engine, format, received.bytes);
    hold(Arc::new(engine.admission().reserve(reading.bytes)?));
    let name = name.unwrap_or_else(|| "recording".into());
    let note =
        Note { id: received.id.clone(), format, bytes: received.bytes, name, map, report: Value::Null };
    let (note, received) = engine.work(move |left| checked(received, note, reading.room, left)).await?;
    let new = engine.recordings().keep(&tenant, received, &note, &engine.limits().quota()).await?;
    Ok((if new { StatusCode::CREATED } else { StatusCode::OK }, Json(note.into())))
}

/// The beginning of a log.
#[derive(Debug, Serialize, ToSchema)]
pub struct RecordingColumns {
    /// Columns of a table, or fields of topics, that hold anything.
    pub columns: Vec<BeginningColumn>,
}

/// Look into a log without storing it: the first values of each column of a CSV or Parquet file, or of each field of the topics of an
/// MCAP file, a SQLite file of ROS 2, a ROS 1 bag or a PX4 log, so that a map can be made of what is there. Of logs other than Parquet and
/// SQLite the first megabytes do.
#[utoipa::path(
    post, path = "/v1/recordings/columns", tag = "recordings",
    request_body(content(
        (String = "text/csv"),
        (Vec<u8> = "application/vnd.apache.parquet"),
        (Vec<u8> = "application/mcap"),
        (Vec<u8> = "application/vnd.sqlite3"),
        (Vec<u8> = "application/x-rosbag")
    )),
    responses(
        (status = 200, description = "The columns", body = RecordingColumns),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 507, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn columns(
    State(engine): State<Engine>,
    tenant: Tenant,
    request: Request,
) -> Result<Json<RecordingColumns>, Problem> {
    let said = format_of(&content_type(&request))?;
    let (parts, body) = request.into_parts();
    let received = receive(&engine, &tenant, &parts.headers, body).await?;
    let format = content_of(&received)?.unwrap_or(said);
    let reading = Reading::of(&engine, format, received.bytes);
    hold(Arc::new(engine.admission().reserve(reading.bytes)?));
    let columns = engine.work(move |left| looked_into(&received, format, left)).await?;
    Ok(Json(RecordingColumns { columns }))
}

fn looked_into(
    received: &Received,
    format: Format,
    left: &Arc<AtomicBool>,
) -> Result<Vec<BeginningColumn>, Problem> {
    let file = received.file.reader().map_err(|error| cannot("read from", &error))?;
    recording::beginning(file, format, &watch_of(left)).map_err(|error| Problem::invalid_recording(&error))
}

/// A watch that stops a reading that nobody waits for any more.
fn watch_of(left: &Arc<AtomicBool>) -> recording::Watch {
    let left = Arc::clone(left);
    Arc::new(
        move |_| {
            if left.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        },
    )
}

/// The map of a query: an object in full, or the name of a built-in one.
fn map_choice(text: String) -> Result<Value, Problem> {
    if !text.trim_start().starts_with(['{', '[']) {
        return Ok(Value::String(text));
    }
    document::from_json(text.as_bytes()).map_err(|error| Problem::invalid_document(&error, "/map"))
}

/// What reading a recording may take.
struct Reading {
    bytes: u64,
    room: Room,
}

/// The table of a recording of any length, 2²⁴ numbers, and as much again while topics are merged into it [bytes].
const LARGEST_READING_BYTES: u64 = 2 * 8 * (1 << 24);
/// The same for each byte of a CSV file, of which a number takes two at the least.
const CSV_READING_FACTOR: u64 = 2 * 8 / 2;

impl Reading {
    /// A quarter of what all requests may take at most; longer recordings are then read into means of neighbours.
    fn of(engine: &Engine, format: Format, file_bytes: u64) -> Self {
        let most = LARGEST_READING_BYTES.min(engine.limits().request_memory_bytes / 4);
        let room = Room::default().share(most, LARGEST_READING_BYTES);
        let bytes = match format {
            Format::Csv => file_bytes.saturating_mul(CSV_READING_FACTOR).min(most),
            _ => most,
        };
        Reading { bytes, room }
    }
}

/// Reads what was received, and notes what it is if it is a recording.
fn checked(
    received: Received,
    mut note: Note,
    room: Room,
    left: &Arc<AtomicBool>,
) -> Result<(Note, Spool), Problem> {
    let map = note.map.as_ref().map(map_from).transpose()?;
    let file = received.file.reader().map_err(|error| cannot("read from", &error))?;
    let watch = watch_of(left);
    let reading = recording::read_file(file, note.format, &note.name, map.as_ref(), &watch, room)
        .map_err(|error| Problem::invalid_recording(&error))?;
    note.report = serde_json::to_value(&reading.report).map_err(|error| {
        Problem::new(ProblemType::Internal, format!("the report cannot be written: {error}"))
    })?;
    Ok((note, received.file))
}

fn query(uri: &Uri) -> Result<ReadingQuery, Problem> {
    Query::try_from_uri(uri).map(|Query(query)| query).map_err(|error| {
        let detail = format!("the query cannot be read: {error}; it may hold `map` and `name`");
        Problem::new(ProblemType::InvalidRequest, detail)
    })
}

/// The format that the first bytes of what was received show.
fn content_of(received: &Received) -> Result<Option<Format>, Problem> {
    let mut file = received.file.reader().map_err(|error| cannot("read from", &error))?;
    Format::of_file(&mut file).map_err(|error| Problem::invalid_recording(&error))
}

/// The format that a content type stands for.
fn format_of(kind: &str) -> Result<Format, Problem> {
    Ok(match kind {
        "text/csv" | "text/tab-separated-values" => Format::Csv,
        "application/vnd.apache.parquet" | "application/x-parquet" | "application/parquet" => Format::Parquet,
        "application/mcap" | "application/x-mcap" => Format::Mcap,
        "application/x-rosbag" | "application/rosbag" => Format::Bag,
        "application/vnd.sqlite3" | "application/x-sqlite3" => Format::Db3,
        _ => {
            let found = if kind.is_empty() { "no content type".to_owned() } else { format!("`{kind}`") };
            let detail = format!(
                "a recording is text/csv, application/vnd.apache.parquet, application/mcap, application/vnd.sqlite3 or \
                 application/x-rosbag, but the request has {found}"
            );
            return Err(Problem::new(ProblemType::UnsupportedMediaType, detail));
        }
    })
}

/// Recordings at hand.
#[utoipa::path(
    get, path = "/v1/recordings", tag = "recordings",
    responses(
        (status = 200, description = "The stored recordings", body = RecordingList),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn list(
    State(engine): State<Engine>,
    tenant: Tenant,
) -> Result<Json<RecordingList>, Problem> {
    let notes = engine.recordings().list(&tenant).await?;
    Ok(Json(RecordingList { recordings: notes.iter().map(RecordingSummary::from).collect() }))
}

/// One recording and what reading it found.
#[utoipa::path(
    get, path = "/v1/recordings/{id}", tag = "recordings",
    params(("id" = String, Path, description = "Content hash of the recording")),
    responses(
        (status = 200, description = "The recording", body = RecordingAnswer),
        (status = 404, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn read(
    State(engine): State<Engine>,
    tenant: Tenant,
    Id(id): Id,
) -> Result<Json<RecordingAnswer>, Problem> {
    Ok(Json(engine.recordings().note(&tenant, &id).await?.into()))
}

/// Forget a recording. Jobs that read it already finish.
#[utoipa::path(
    delete, path = "/v1/recordings/{id}", tag = "recordings",
    params(("id" = String, Path, description = "Content hash of the recording")),
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
    engine.recordings().remove(&tenant, &id).await?;
    Ok(StatusCode::NO_CONTENT)
}
