//! The recordings at hand: files in a folder, each beside a note of what it is.
//!
//! The folder is all there is, so that recordings outlive the service, and a person finds them where they lie.

use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

use recording::{Format, Map, Reading, Room, Watch, read_file};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::Value;
use tempfile::{NamedTempFile, TempDir};

use crate::problem::{Problem, ProblemType};

/// Characters of an id: 128 bits of the content's SHA-256.
pub(crate) const ID_CHARACTERS: usize = 32;

/// Recordings by content hash, on disk.
#[derive(Debug)]
pub(crate) struct RecordingStore {
    folder: PathBuf,
    /// Keeps a folder of the service's own until the service ends.
    _own: Option<TempDir>,
}

/// What is known of a stored recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Note {
    pub(crate) id: String,
    pub(crate) format: Format,
    pub(crate) bytes: u64,
    /// What its run is called where the file does not say.
    pub(crate) name: String,
    /// The map that it was read with, as JSON or the name of a built-in one.
    pub(crate) map: Option<Value>,
    /// The reading report.
    pub(crate) report: Value,
}

impl RecordingStore {
    /// Recordings in a folder, which is made; without one, in a folder that lasts as long as the service.
    pub(crate) fn open(folder: Option<&Path>) -> io::Result<Self> {
        let own =
            folder.is_none().then(|| tempfile::Builder::new().prefix("joulepath-").tempdir()).transpose()?;
        let parent = folder
            .map_or_else(|| own.as_ref().map_or(PathBuf::new(), |own| own.path().into()), PathBuf::from);
        let folder = parent.join("recordings");
        fs::create_dir_all(&folder)?;
        Ok(RecordingStore { folder, _own: own })
    }

    /// A file in the store's folder for what is being received; gone again unless it is kept.
    pub(crate) fn receive(&self) -> Result<NamedTempFile, Problem> {
        let made = tempfile::Builder::new().prefix(".received-").tempfile_in(&self.folder);
        made.map_err(|error| cannot("write to", &error))
    }

    /// Keeps a received file under its note's id. Returns whether it is new.
    pub(crate) fn keep(&self, received: NamedTempFile, note: &Note) -> Result<bool, Problem> {
        let new = self.note(&note.id).is_err();
        let write = || {
            received.persist(self.data_path(&note.id))?;
            // The note comes last, and whole: what has a note is a recording.
            let mut file = tempfile::Builder::new().prefix(".note-").tempfile_in(&self.folder)?;
            serde_json::to_writer(&mut file, note)?;
            file.persist(self.note_path(&note.id))?;
            Ok(new)
        };
        write().map_err(|error: io::Error| cannot("write to", &error))
    }

    /// What is known of a recording.
    pub(crate) fn note(&self, id: &str) -> Result<Note, Problem> {
        if id.len() != ID_CHARACTERS || !id.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            return Err(unknown(id));
        }
        parsed(&self.note_path(id)).ok_or_else(|| unknown(id))
    }

    /// Reads a recording, by its own map or another, followed by a watch, into the room that there is.
    pub(crate) fn read(
        &self,
        note: &Note,
        map: Option<&Map>,
        watch: &Watch,
        room: Room,
    ) -> Result<Reading, Problem> {
        let file = File::open(self.data_path(&note.id)).map_err(|_| unknown(&note.id))?;
        let own = note.map.as_ref().map(map_from).transpose()?;
        let map = map.or(own.as_ref());
        read_file(file, note.format, &note.name, map, watch, room)
            .map_err(|error| Problem::invalid_recording(&error))
    }

    /// All recordings, in the order of their ids.
    pub(crate) fn list(&self) -> Result<Vec<Note>, Problem> {
        let entries = fs::read_dir(&self.folder).map_err(|error| cannot("list", &error))?;
        let paths = entries.flatten().map(|entry| entry.path());
        let notes = paths.filter(|path| path.extension().is_some_and(|ending| ending == "json"));
        let mut notes: Vec<Note> = notes.filter_map(|path| parsed(&path)).collect();
        notes.sort_by(|a, b| a.id.cmp(&b.id));
        Ok(notes)
    }

    /// Bytes of all recordings.
    pub(crate) fn bytes(&self) -> Result<u64, Problem> {
        Ok(self.list()?.iter().map(|note| note.bytes).sum())
    }

    /// Forgets a recording. Who reads it already can finish.
    pub(crate) fn remove(&self, id: &str) -> Result<(), Problem> {
        let note = self.note(id)?;
        let remove = || {
            fs::remove_file(self.note_path(&note.id))?;
            fs::remove_file(self.data_path(&note.id))
        };
        remove().map_err(|error| cannot("delete from", &error))
    }

    fn data_path(&self, id: &str) -> PathBuf {
        self.folder.join(format!("{id}.data"))
    }

    fn note_path(&self, id: &str) -> PathBuf {
        self.folder.join(format!("{id}.json"))
    }
}

/// A map by the name of a built-in one, or in full.
pub(crate) fn map_from(choice: &Value) -> Result<Map, Problem> {
    let Value::String(name) = choice else {
        return Map::from_json(&choice.to_string()).map_err(|error| Problem::invalid_recording(&error));
    };
    Map::built_in(name).ok_or_else(|| {
        let known = Map::BUILT_IN.join(", ");
        let detail = format!("there is no map `{name}`: give one of {known}, or the map itself as an object");
        Problem::new(ProblemType::InvalidRequest, detail).at("/map")
    })
}

fn parsed<T: DeserializeOwned>(path: &Path) -> Option<T> {
    serde_json::from_slice(&fs::read(path).ok()?).ok()
}

/// A fault of the disk; a full one is the client's to know.
pub(crate) fn cannot(what: &str, error: &io::Error) -> Problem {
    if error.kind() == io::ErrorKind::StorageFull {
        return Problem::new(ProblemType::StoreFull, "the service's disk is full: delete a recording first");
    }
    tracing::error!(%error, "cannot {what} the store");
    Problem::new(
        ProblemType::Internal,
        format!("the service cannot {what} its store; the fault has been logged"),
    )
}

fn unknown(id: &str) -> Problem {
    let shown: String = id.chars().take(64).collect();
    let detail = format!("there is no recording `{shown}`: POST it to /v1/recordings first");
    Problem::new(ProblemType::UnknownRecording, detail)
}
