//! The tables of a rosbag2 SQLite file, as another source of messages: `topics`, `messages`, and since Iron
//! `message_definitions` (<https://github.com/ros2/rosbag2/tree/rolling/rosbag2_storage_sqlite3>).

use std::{
    collections::BTreeMap,
    io::{Read, Seek, Write},
    path::Path,
};

use rusqlite::{Connection, Row, types::ValueRef};

use super::sqlite::{damage, has_table, open};
use crate::{
    Error, Map,
    compression::LONGEST_BYTES,
    container::topics,
    reading::Reading,
    schema::{Described, Schema},
    topic::Topics,
    watch::Budget,
};

/// The format's name in reports.
pub(crate) const FORMAT: &str = "ROS 2 SQLite bag";

/// Most topics of a file, as many as MCAP numbers.
const MOST_TOPICS: usize = 1 << 16;

/// Most topics that a query names one by one.
const MOST_NAMED: usize = 1000;

/// The longest file that is copied before it is read \[bytes\].
const LONGEST_COPY_BYTES: u64 = 64 * LONGEST_BYTES;

/// Encoding and text of a type's definition.
type Definitions = BTreeMap<String, (String, Vec<u8>)>;

/// Reads what has no name of its own in a folder, as the body of a request.
pub(crate) fn read_copy(
    source: impl Read,
    name: &str,
    map: Option<&Map>,
    budget: &Budget,
) -> Result<Reading, Error> {
    let mut topics = topics(map, budget)?;
    read_copy_into(source, &mut topics)?;
    topics.finish(name, FORMAT)
}

/// Reads a copy in the folder of temporary files: SQLite reads files only, page by page.
pub(crate) fn read_copy_into(source: impl Read, topics: &mut Topics<'_>) -> Result<(), Error> {
    let mut copy = tempfile::NamedTempFile::new()?;
    let bytes = std::io::copy(&mut source.take(LONGEST_COPY_BYTES + 1), &mut copy)?;
    if bytes > LONGEST_COPY_BYTES {
        return Err(Error::TooLong { most: LONGEST_COPY_BYTES });
    }
    copy.flush()?;
    copy.rewind()?;
    read_into(copy.path(), topics)
}

/// Reads a file in the order in which its messages were written.
pub(crate) fn read_into(path: &Path, topics: &mut Topics<'_>) -> Result<(), Error> {
    let connection = open(path, topics.looks().watch())?;
    for table in ["topics", "messages"] {
        if !has_table(&connection, table)? {
            let reason = format!("it has no table `{table}`, as `ros2 bag record` makes");
            return Err(Error::NotTheFormat { format: FORMAT, reason });
        }
    }
    tell_of_unwritten(path, topics);
    let definitions = definitions(&connection)?;
    let numbers = connect(&connection, &definitions, topics)?;
    messages(&connection, &numbers, topics)
}

/// When the first message was written \[ns\].
pub(crate) fn first_ns(path: &Path, topics: &mut Topics<'_>) -> Option<i64> {
    let connection = open(path, topics.looks().watch()).ok()?;
    let first = "SELECT timestamp FROM messages ORDER BY id LIMIT 1";
    has_table(&connection, "messages")
        .ok()?
        .then(|| connection.query_row(first, [], |row| row.get(0)).ok())?
}

/// A recorder that was killed leaves messages in a file beside; they are not in the database yet.
fn tell_of_unwritten(path: &Path, topics: &mut Topics<'_>) {
    for ending in ["-wal", "-journal"] {
        let mut beside = path.as_os_str().to_owned();
        beside.push(ending);
        let beside = Path::new(&beside);
        if beside.metadata().is_ok_and(|data| data.len() > 0) {
            let what = "it holds what the recorder had not yet written into the database, which was left out; \
                        open a copy of both once with `sqlite3` to bring it in";
            let name = beside.file_name().unwrap_or_default().to_string_lossy();
            topics.tell_of(&name, what);
        }
    }
}

/// Bytes of a table that are held in memory: rows of a hostile file may share their pages.
struct Held {
    table: &'static str,
    bytes: usize,
}

impl Held {
    fn add(&mut self, bytes: usize) -> Result<(), Error> {
        self.bytes += bytes;
        if self.bytes as u64 <= LONGEST_BYTES {
            return Ok(());
        }
        let reason = format!("its texts have more than {LONGEST_BYTES} bytes, which no recorder writes");
        Err(Error::Database { place: format!("table {}", self.table), reason })
    }
}

fn definitions(connection: &Connection) -> Result<Definitions, Error> {
    let (mut definitions, mut held) = (Definitions::new(), Held { table: "message_definitions", bytes: 0 });
    if has_table(connection, "message_definitions")? {
        let query = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions";
        each(connection, query, "message_definitions", MOST_TOPICS, |row| {
            let [name, encoding] = [text(row, 0)?, text(row, 1)?];
            if let Err(error) = held.add(name.len() + bytes(row, 2)?.len()) {
                return Ok(Err(error));
            }
            definitions.entry(name).or_insert((encoding, bytes(row, 2)?.to_vec()));
            Ok(Ok(()))
        })?;
    }
    Ok(definitions)
}

/// Connects the topics; returns their numbers by those of the table.
fn connect(
    connection: &Connection,
    definitions: &Definitions,
    topics: &mut Topics<'_>,
) -> Result<BTreeMap<i64, u32>, Error> {
    let (mut numbers, mut held) = (BTreeMap::new(), Held { table: "topics", bytes: 0 });
    let query = "SELECT id, name, type, serialization_format FROM topics";
    each(connection, query, "topics", MOST_TOPICS, |row| {
        let id: i64 = row.get(0)?;
        let [name, type_name, encoding] = [text(row, 1)?, text(row, 2)?, text(row, 3)?];
        if let Err(error) = held.add(name.len() + type_name.len()) {
            return Ok(Err(error));
        }
        let number = numbers.len() as u32;
        numbers.insert(id, number);
        let (schema_encoding, definition) = match definitions.get(&type_name) {
            Some((encoding, definition)) => (encoding.as_str(), definition.as_slice()),
            None => ("", &[][..]),
        };
        let described =
            Described { message_encoding: &encoding, schema_encoding, definition, type_name: &type_name };
        Ok(topics.connect(number, &name, &Schema::of(&described)))
    })?;
    Ok(numbers)
}

fn messages(
    connection: &Connection,
    numbers: &BTreeMap<i64, u32>,
    topics: &mut Topics<'_>,
) -> Result<(), Error> {
    let wanted: Vec<String> =
        numbers.iter().filter(|(_, number)| topics.wants(**number)).map(|(id, _)| id.to_string()).collect();
    if wanted.is_empty() {
        return Ok(());
    }
    let only = match wanted.len() <= MOST_NAMED {
        true => format!("WHERE topic_id IN ({}) ", wanted.join(", ")),
        false => String::new(),
    };
    let query = format!("SELECT id, topic_id, timestamp, data FROM messages {only}ORDER BY id");
    each(connection, &query, "messages", usize::MAX, |row| {
        let (id, topic, log_ns): (i64, i64, i64) = (row.get(0)?, row.get(1)?, row.get(2)?);
        let Some(number) = numbers.get(&topic) else { return Ok(Ok(())) };
        let message = bytes(row, 3)?;
        let read = topics.looks().worked(1).and_then(|()| topics.looks().read(message.len() as u64));
        Ok(read.and_then(|()| topics.message(*number, log_ns, message)).map_err(|error| match error {
            Error::Stopped | Error::TooLarge { .. } => error,
            error => Error::Database { place: format!("table messages, id {id}"), reason: error.to_string() },
        }))
    })
}

/// Reads a table row by row; an error says behind which row.
fn each(
    connection: &Connection,
    query: &str,
    table: &str,
    most: usize,
    mut take: impl FnMut(&Row<'_>) -> Result<Result<(), Error>, rusqlite::Error>,
) -> Result<(), Error> {
    let mut read = 0usize;
    let place = |read: usize| match read {
        0 => format!("table {table}, first row"),
        _ => format!("table {table}, behind row {read}"),
    };
    let mut statement =
        connection.prepare(query).map_err(|error| damage(&format!("table {table}"), &error))?;
    let mut rows = statement.query([]).map_err(|error| damage(&place(read), &error))?;
    while let Some(row) = rows.next().map_err(|error| damage(&place(read), &error))? {
        take(row).map_err(|error| damage(&place(read), &error))??;
        read += 1;
        if read > most {
            let reason = format!("more than {most} rows, which no recorder writes");
            return Err(Error::Database { place: place(read), reason });
        }
    }
    Ok(())
}

/// A text of whatever encoding.
fn text(row: &Row<'_>, column: usize) -> Result<String, rusqlite::Error> {
    Ok(String::from_utf8_lossy(bytes(row, column)?).into_owned())
}

/// The bytes of a text or of a blob.
fn bytes<'r>(row: &'r Row<'_>, column: usize) -> Result<&'r [u8], rusqlite::Error> {
    match row.get_ref(column)? {
        ValueRef::Text(bytes) | ValueRef::Blob(bytes) => Ok(bytes),
        other => Err(rusqlite::Error::InvalidColumnType(column, "bytes".into(), other.data_type())),
    }
}
