//! A SQLite file from outside: opened so that nothing in it is trusted and nothing of it is changed.

use std::{
    fs::{self, File},
    os::raw::c_int,
    path::Path,
};

use rusqlite::{Connection, ErrorCode, OpenFlags, OptionalExtension, config::DbConfig, limits::Limit};

use crate::{Error, Format, Watch, compression::LONGEST_BYTES, reading::read_up_to};

/// Steps of SQLite's machine between two looks at the watch: some milliseconds.
const STEPS_A_LOOK: c_int = 100_000;

/// The lengths of a file and of the pages that its header counts \[bytes\], where it is shorter: SQLite refuses it then without saying why.
/// <https://www.sqlite.org/fileformat.html>, section 1.3.
fn shortfall(path: &Path) -> Option<(u64, u64)> {
    let mut header = Vec::new();
    let mut file = File::open(path).ok()?;
    read_up_to(&mut file, 100, &mut header).ok()?;
    let number = |at: usize| Some(u32::from_be_bytes(header.get(at..at + 4)?.try_into().ok()?));
    let page_bytes = match u16::from_be_bytes(header.get(16..18)?.try_into().ok()?) {
        1 => 1 << 16,
        bytes => u64::from(bytes),
    };
    if Format::of_content(&header) != Some(Format::Db3) {
        return None;
    }
    // The count holds only where the last to write knew of it.
    let is_valid = number(24)? == number(92)?;
    let (found, claimed) = (file.metadata().ok()?.len(), u64::from(number(28)?) * page_bytes);
    (is_valid && found < claimed).then_some((found, claimed))
}

/// Opens a file read-only and as one that nobody changes: no locks, no journal, no file beside it is made.
pub(crate) fn open(path: &Path, watch: Watch) -> Result<Connection, Error> {
    if let Some((found, claimed)) = shortfall(path) {
        let reason = format!("the file ends here, but should have {claimed} bytes: it was cut off");
        return Err(Error::Database { place: format!("byte {found}"), reason });
    }
    let uri = format!("file://{}?mode=ro&immutable=1", encoded(&fs::canonicalize(path)?));
    let flags =
        OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let opened = Connection::open_with_flags(uri, flags).and_then(|mut connection| {
        // What a file defines may not run: views, triggers, and functions in its schema.
        connection.set_db_config(DbConfig::SQLITE_DBCONFIG_TRUSTED_SCHEMA, false)?;
        connection.set_db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, true)?;
        connection.set_db_config(DbConfig::SQLITE_DBCONFIG_ENABLE_VIEW, false)?;
        connection.set_db_config(DbConfig::SQLITE_DBCONFIG_ENABLE_TRIGGER, false)?;
        connection
            .set_limit(Limit::SQLITE_LIMIT_LENGTH, c_int::try_from(LONGEST_BYTES).unwrap_or(c_int::MAX))?;
        connection.set_limit(Limit::SQLITE_LIMIT_ATTACHED, 0)?;
        connection.pragma_update(None, "query_only", true)?;
        connection.pragma_update(None, "cell_size_check", true)?;
        connection.progress_handler(STEPS_A_LOOK, Some(move || watch(0).is_break()))?;
        Ok(connection)
    });
    opened.map_err(|error| damage("its header", &error))
}

/// Whether the file has a table of that name: a view or a virtual table is none.
pub(crate) fn has_table(connection: &Connection, name: &str) -> Result<bool, Error> {
    let query = "SELECT 1 FROM sqlite_schema WHERE type = 'table' AND rootpage > 0 AND name = ?1";
    let found = connection.query_row(query, [name], |_| Ok(())).optional();
    Ok(found.map_err(|error| damage("its list of tables", &error))?.is_some())
}

/// An error of SQLite at a place of the file.
pub(crate) fn damage(place: &str, error: &rusqlite::Error) -> Error {
    if error.sqlite_error_code() == Some(ErrorCode::OperationInterrupted) {
        return Error::Stopped;
    }
    if error.sqlite_error_code() == Some(ErrorCode::NotADatabase) {
        return Error::NotTheFormat { format: super::db3::FORMAT, reason: "it is not a database".into() };
    }
    Error::Database { place: place.to_owned(), reason: error.to_string() }
}

/// A path as a URI holds it.
fn encoded(path: &Path) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/-_.~".contains(&byte);
    let bytes = path.as_os_str().as_encoded_bytes().iter();
    bytes
        .map(|&byte| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::unwatched;

    #[test]
    fn a_file_is_opened_under_any_name_and_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a?mode=rwc#50% x.db3");
        Connection::open(&path).unwrap().execute_batch("CREATE TABLE topics(id)").unwrap();
        let connection = open(&path, unwatched()).unwrap();
        assert!(has_table(&connection, "topics").unwrap() && !has_table(&connection, "messages").unwrap());
        assert!(connection.execute_batch("INSERT INTO topics VALUES (1)").is_err());
        assert!(connection.execute_batch("ATTACH ':memory:' AS other").is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no file beside it");
    }

    #[test]
    fn views_and_virtual_tables_are_no_tables() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("view.db3");
        let hostile = "CREATE VIEW messages AS WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT x FROM n";
        Connection::open(&path).unwrap().execute_batch(hostile).unwrap();
        assert!(!has_table(&open(&path, unwatched()).unwrap(), "messages").unwrap());
    }
}
