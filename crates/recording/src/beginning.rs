//! The beginning of a log as columns, to show what is in it before anyone knows which of it is what.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{Cursor, Read},
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
};

use ::parquet::{
    file::reader::{ChunkReader, FileReader, SerializedFileReader},
    record::Field as Cell,
};
use serde::Serialize;

use crate::{
    Error, Format, Room, Watch, bag,
    compression::decompress_message,
    container::topics,
    csv_text::CsvText,
    definition::{Base, Count, Definition, Field},
    format::ZSTD_MAGIC,
    layout::Layout,
    mcap,
    mcap_summary::Summary,
    reading::unwatched,
    rosbag2::{db3, folder, storage},
    schema::Schema,
    stream::NS_PER_S,
    ulog,
    walk::Found,
    watch::{Budget, Looks},
};

/// Rows or messages that are shown of each column.
pub const MOST_ROWS: usize = 600;
/// Columns that are shown at most, of all topics together.
pub const MOST_COLUMNS: usize = 400;
/// Elements that are shown of an array: those of four wheels and some more.
const MOST_ELEMENTS: usize = 6;
/// Bytes that are looked at of a file that is read front to back.
const LOOKED_AT_BYTES: u64 = 16 << 20;
/// Deepest nesting of a message that is shown.
const DEEPEST: usize = 8;

/// One column of a table, or one field of a topic's messages.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct BeginningColumn {
    /// Name of the column, or path of the field, as a map names it.
    pub name: String,
    /// The topic, of a field.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub topic: Option<String>,
    /// Its first values, as they stand in the file; empty where there is none.
    pub cells: Vec<String>,
}

/// Reads the beginning of a log: columns that hold anything, in the order of the file.
///
/// # Errors
/// A file that cannot be read.
pub fn beginning(file: File, format: Format, watch: &Watch) -> Result<Vec<BeginningColumn>, Error> {
    match format {
        Format::Parquet => of_parquet(file),
        Format::Csv => of_text(file),
        _ => of_topics(file, format, watch),
    }
}

/// Reads the beginning of what is in memory as [`beginning`] does.
///
/// # Errors
/// As [`beginning`].
pub fn beginning_of_bytes(bytes: Vec<u8>, format: Format) -> Result<Vec<BeginningColumn>, Error> {
    match format {
        Format::Parquet => of_parquet(bytes::Bytes::from(bytes)),
        Format::Csv => of_text(Cursor::new(bytes)),
        _ => of_topics(Cursor::new(bytes), format, &unwatched()),
    }
}

/// The first messages of all topics.
fn of_topics(source: impl Read, format: Format, watch: &Watch) -> Result<Vec<BeginningColumn>, Error> {
    let mut topics = topics(None, &Budget { room: Room::default(), looks: Looks::new(watch) })?;
    topics.looked = Some(Looked::default());
    match format {
        Format::Mcap => mcap::read_into(source.take(LOOKED_AT_BYTES), Summary::default(), &mut topics)?,
        Format::Bag => bag::read_into(source.take(LOOKED_AT_BYTES), &mut topics)?,
        Format::Ulog => ulog::read_into(source.take(LOOKED_AT_BYTES), &mut topics)?,
        Format::Db3 => db3::read_copy_into(source, &mut topics)?,
        // Tables have no topics.
        Format::Csv | Format::Parquet => {}
    }
    Ok(topics.looked.unwrap_or_default().into_columns())
}

/// The first rows of a Parquet file. The library asserts some of what a damaged file may say.
fn of_parquet(source: impl ChunkReader + 'static) -> Result<Vec<BeginningColumn>, Error> {
    let read = AssertUnwindSafe(|| rows_of_parquet(source));
    let damaged = || Error::NotTheFormat { format: "Parquet", reason: "it is damaged".into() };
    catch_unwind(read).unwrap_or_else(|_| Err(damaged()))
}

/// The first rows of a text table.
fn of_text(source: impl Read + 'static) -> Result<Vec<BeginningColumn>, Error> {
    let mut text = CsvText::open(source)?;
    if text.advance()?.is_none() {
        return Err(Error::Empty { found: "an empty file".into() });
    }
    let headers = text.headers();
    text.refuse_what_is_no_header(&headers)?;
    let begun = |name: String| BeginningColumn { name, topic: None, cells: Vec::new() };
    let mut columns: Vec<BeginningColumn> = headers.into_iter().take(MOST_COLUMNS).map(begun).collect();
    for _ in 0..MOST_ROWS {
        if text.advance()?.is_none() {
            break;
        }
        for (index, column) in columns.iter_mut().enumerate() {
            let cell = text.record().get(index).unwrap_or_default();
            column.cells.push(String::from_utf8_lossy(cell).trim().to_owned());
        }
    }
    Ok(that_hold_anything(columns))
}

fn that_hold_anything(mut columns: Vec<BeginningColumn>) -> Vec<BeginningColumn> {
    columns.retain(|column| column.cells.iter().any(|cell| !cell.is_empty()));
    columns
}

fn rows_of_parquet(source: impl ChunkReader + 'static) -> Result<Vec<BeginningColumn>, Error> {
    let file = SerializedFileReader::new(source)?;
    let mut columns: Vec<BeginningColumn> = Vec::new();
    for (number, row) in file.get_row_iter(None)?.take(MOST_ROWS).enumerate() {
        for (index, (name, cell)) in row?.get_column_iter().take(MOST_COLUMNS).enumerate() {
            if number == 0 {
                columns.push(BeginningColumn { name: name.clone(), topic: None, cells: Vec::new() });
            }
            if let Some(column) = columns.get_mut(index) {
                column.cells.push(text_of(cell));
            }
        }
    }
    Ok(that_hold_anything(columns))
}

/// A cell as text; empty where it holds nothing that a column of a recording may hold.
fn text_of(cell: &Cell) -> String {
    match cell {
        Cell::Null | Cell::Group(_) | Cell::ListInternal(_) | Cell::MapInternal(_) | Cell::Bytes(_) => {
            String::new()
        }
        Cell::Str(text) => text.clone(),
        Cell::Float(value) if value.is_nan() => String::new(),
        Cell::Double(value) if value.is_nan() => String::new(),
        other => other.to_string(),
    }
}

/// What was looked at of topics.
#[derive(Default)]
pub(crate) struct Looked {
    topics: Vec<LookedTopic>,
    /// Columns of all topics.
    columns: usize,
}

struct LookedTopic {
    name: String,
    type_name: String,
    paths: Vec<String>,
    /// None where its definition cannot be read.
    layout: Option<Layout>,
    /// By path.
    cells: Vec<Vec<f64>>,
    /// All messages, whether they are looked at or not.
    messages: usize,
    /// Log times of the first and the last \[ns\].
    log_ns: [i64; 2],
}

/// A topic of a log, as far as its first messages show it.
pub(crate) struct SeenTopic {
    pub(crate) name: String,
    pub(crate) type_name: String,
    pub(crate) messages: usize,
    pub(crate) rate_hz: Option<f64>,
    /// Paths of its numbers, and these.
    pub(crate) fields: Vec<(String, Vec<f64>)>,
}

/// All topics of a log, whether a map names them or not.
///
/// # Errors
/// A file that cannot be read.
pub(crate) fn seen_topics(path: &Path) -> Result<Vec<SeenTopic>, Error> {
    let watch = unwatched();
    let mut topics = topics(None, &Budget { room: Room::default(), looks: Looks::new(&watch) })?;
    topics.looked = Some(Looked::default());
    if path.is_dir() {
        folder::read_into(path, &mut topics, &watch)?;
    } else if Format::of_file(&mut File::open(path)?)? == Some(Format::Ulog) {
        ulog::read_into(File::open(path)?, &mut topics)?;
    } else {
        storage::read_into(path, &mut topics, &watch)?;
    }
    Ok(topics.looked.unwrap_or_default().into_topics())
}

impl Looked {
    /// Begins a topic with all numbers of its messages, or goes on with it; `None` where nothing of them can be read.
    pub(crate) fn open(&mut self, topic: &str, schema: &Schema<'_>) -> Option<usize> {
        let same = |known: &LookedTopic| known.name == topic && known.type_name == schema.type_name;
        if let Some(known) = self.topics.iter().position(same) {
            return Some(known);
        }
        let mut paths = Vec::new();
        let layout = schema.parse().ok().and_then(|definition| {
            numbers_of(&definition, definition.root(), "", 0, &mut paths);
            paths.truncate(MOST_COLUMNS.saturating_sub(self.columns));
            let wanted: Vec<&str> = paths.iter().map(String::as_str).collect();
            Layout::new(&definition, &wanted, false, schema.encoding).ok()
        });
        self.columns += paths.len();
        let (name, type_name) = (topic.to_owned(), schema.type_name.to_owned());
        let cells = vec![Vec::new(); paths.len()];
        self.topics.push(LookedTopic { name, type_name, paths, layout, cells, messages: 0, log_ns: [0; 2] });
        Some(self.topics.len() - 1)
    }

    /// Keeps the numbers of a message while there is room; one that cannot be read shows nothing.
    pub(crate) fn message(&mut self, topic: usize, log_ns: i64, bytes: &[u8], found: &mut Found) {
        let Some(topic) = self.topics.get_mut(topic) else { return };
        let first_ns = if topic.messages == 0 { log_ns } else { topic.log_ns[0] };
        topic.log_ns = [first_ns, log_ns];
        topic.messages += 1;
        let Some(layout) = &mut topic.layout else { return };
        if topic.cells.first().is_none_or(|cells| cells.len() >= MOST_ROWS) {
            return;
        }
        let mut plain = Vec::new();
        let bytes = match layout.is_cdr() && bytes.starts_with(&ZSTD_MAGIC) {
            true => decompress_message(bytes, &mut plain),
            false => Ok(bytes),
        };
        let mut values = vec![f64::NAN; topic.paths.len()];
        if bytes.and_then(|bytes| layout.read(bytes, found, &mut values)).is_ok() {
            topic.cells.iter_mut().zip(values).for_each(|(cells, value)| cells.push(value));
        }
    }

    fn into_topics(self) -> Vec<SeenTopic> {
        let of = |topic: LookedTopic| {
            let [first_ns, last_ns] = topic.log_ns;
            let span_s = last_ns.saturating_sub(first_ns) as f64 / NS_PER_S;
            let rate_hz = (span_s > 0.0).then(|| (topic.messages - 1) as f64 / span_s);
            let fields = topic.paths.into_iter().zip(topic.cells);
            let fields = fields.filter(|(_, values)| values.iter().any(|value| !value.is_nan())).collect();
            let (name, type_name, messages) = (topic.name, topic.type_name, topic.messages);
            SeenTopic { name, type_name, messages, rate_hz, fields }
        };
        self.topics.into_iter().map(of).collect()
    }

    fn into_columns(self) -> Vec<BeginningColumn> {
        let mut by_topic: BTreeMap<String, Vec<BeginningColumn>> = BTreeMap::new();
        for topic in self.topics {
            let columns = by_topic.entry(topic.name.clone()).or_default();
            for (name, values) in topic.paths.into_iter().zip(topic.cells) {
                if values.iter().any(|value| !value.is_nan()) {
                    let text = |value: f64| if value.is_nan() { String::new() } else { value.to_string() };
                    let cells = values.into_iter().map(text).collect();
                    columns.push(BeginningColumn { name, topic: Some(topic.name.clone()), cells });
                }
            }
        }
        by_topic.into_values().flatten().collect()
    }
}

/// Paths of the numbers of a message. Of quaternions they are angles; covariances are no measurements.
fn numbers_of(
    definition: &Definition,
    fields: &[Field],
    before: &str,
    depth: usize,
    paths: &mut Vec<String>,
) {
    for field in fields.iter().filter(|field| !field.name.ends_with("covariance")) {
        if paths.len() >= MOST_COLUMNS || depth >= DEEPEST {
            return;
        }
        let elements = match field.count {
            Count::One => vec![format!("{before}{}", field.name)],
            Count::Fixed(count) => elements(before, &field.name, count.min(MOST_ELEMENTS)),
            Count::Sequence => elements(before, &field.name, MOST_ELEMENTS),
        };
        for path in elements {
            match &field.base {
                Base::Number(_) => paths.push(path),
                Base::Message(name) if name.ends_with("/Quaternion") => {
                    paths.extend(["roll", "pitch", "heading"].map(|angle| format!("{path}.{angle}")));
                }
                Base::Message(name) => {
                    let inner = definition.fields(name).unwrap_or_default();
                    numbers_of(definition, inner, &format!("{path}."), depth + 1, paths);
                }
                Base::Text | Base::WideText | Base::Time => {}
            }
        }
    }
}

fn elements(before: &str, name: &str, count: usize) -> Vec<String> {
    (0..count).map(|i| format!("{before}{name}[{i}]")).collect()
}
