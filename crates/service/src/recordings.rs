//! The recordings at hand: in the store, each as it was sent, beside a note of what it is.

use std::sync::Arc;

use recording::{Format, Map, Reading, Room, Watch, read_file};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use tokio::runtime::Handle;

use crate::{
    Tenant,
    problem::{Problem, ProblemType},
    store::{Noted, Pairs, Quota, Removed, Spool, Store, shown},
};

/// Recordings by content hash.
#[derive(Debug)]
pub(crate) struct RecordingStore {
    recordings: Pairs<Note>,
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
    pub(crate) fn new(store: &Store) -> Self {
        RecordingStore { recordings: Pairs::new(store, "recordings") }
    }

    /// A file for what is being received; gone again unless it is kept.
    pub(crate) fn receive(&self) -> Result<Spool, Problem> {
        self.recordings.spool()
    }

    /// Keeps a received file under its note's id for a tenant, within its quota. Returns whether it is new to the tenant.
    pub(crate) async fn keep(
        &self,
        owner: &Tenant,
        received: Spool,
        note: &Note,
        quota: &Quota,
    ) -> Result<bool, Problem> {
        self.recordings.keep(owner, &note.id, Noted { data: received, note }, quota).await
    }

    /// What a tenant knows of a recording.
    pub(crate) async fn note(&self, tenant: &Tenant, id: &str) -> Result<Note, Problem> {
        self.recordings.notes.get(tenant, id).await?.ok_or_else(|| unknown(id))
    }

    /// Reads a recording, by its own map or another, followed by a watch, into the room that there is. Waits for the store, so
    /// that it belongs on a thread for computations.
    pub(crate) fn read(
        &self,
        note: &Note,
        map: Option<&Map>,
        watch: &Watch,
        room: Room,
    ) -> Result<Reading, Problem> {
        let file = Handle::current().block_on(self.recordings.open(&note.id))?;
        let file = file.ok_or_else(|| unknown(&note.id))?;
        let own = note.map.as_ref().map(map_from).transpose()?;
        let map = map.or(own.as_ref());
        read_file(file, note.format, &note.name, map, watch, room)
            .map_err(|error| Problem::invalid_recording(&error))
    }

    /// What a tenant itself keeps, by id.
    pub(crate) async fn own(&self, owner: &Tenant) -> Result<Vec<(String, Arc<Note>)>, Problem> {
        self.recordings.notes.of(owner).list().await
    }

    /// All recordings that a tenant sees, in the order of their ids.
    pub(crate) async fn list(&self, tenant: &Tenant) -> Result<Vec<Note>, Problem> {
        Ok(self.recordings.list(tenant).await?.iter().map(|note| Note::clone(note)).collect())
    }

    /// Bytes of all recordings, whoever owns them.
    pub(crate) async fn bytes(&self) -> Result<u64, Problem> {
        Ok(self.recordings.notes.list_all().await?.iter().map(|(_, note)| note.bytes).sum())
    }

    /// Forgets a recording for a tenant, or for all if it sees all. Who reads it already can finish.
    pub(crate) async fn remove(&self, tenant: &Tenant, id: &str) -> Result<(), Problem> {
        match self.recordings.remove(tenant, id).await? {
            Removed::Nothing => Err(unknown(id)),
            Removed::Note | Removed::Data => Ok(()),
        }
    }
}

/// A map by the name of a built-in one, or in full.
pub(crate) fn map_from(choice: &Value) -> Result<Map, Problem> {
    let Value::String(name) = choice else {
        return Map::from_value(choice).map_err(|error| Problem::invalid_recording(&error));
    };
    Map::built_in(name).ok_or_else(|| {
        let known = Map::BUILT_IN.join(", ");
        let detail = format!("there is no map `{name}`: give one of {known}, or the map itself as an object");
        Problem::new(ProblemType::InvalidRequest, detail).at("/map")
    })
}

fn unknown(id: &str) -> Problem {
    let detail = format!("there is no recording `{}`: POST it to /v1/recordings first", shown(id));
    Problem::new(ProblemType::UnknownRecording, detail)
}
