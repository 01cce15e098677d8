//! A body that goes to a file as it comes, with its hash, and never as a whole into memory.

use std::collections::BTreeMap;

use axum::{
    body::Body,
    http::{HeaderMap, header},
};
use futures_util::StreamExt;
use sha2::{Digest, Sha256};
use tokio::io::{AsyncWriteExt, BufWriter};

use crate::{
    Engine, Tenant,
    body::broken,
    problem::{Problem, ProblemType},
    store::{Spool, cannot, id_of},
};

/// Bytes that are collected before they are written.
const BUFFER_BYTES: usize = 1 << 20;

/// What was received.
pub(crate) struct Received {
    pub(crate) file: Spool,
    pub(crate) bytes: u64,
    /// Of the content.
    pub(crate) id: String,
}

/// Writes a tenant's body into a file for the store, refused once it exceeds the limits.
pub(crate) async fn receive(
    engine: &Engine,
    tenant: &Tenant,
    headers: &HeaderMap,
    body: Body,
) -> Result<Received, Problem> {
    let room = Room::of(engine, tenant).await?;
    let declared =
        headers.get(header::CONTENT_LENGTH).and_then(|v| v.to_str().ok()).and_then(|v| v.parse().ok());
    room.refuse_beyond(declared.unwrap_or(0))?;
    let file = engine.recordings().receive()?;
    let opened = file.writer().map_err(|error| cannot("write to", &error))?;
    let mut writer = BufWriter::with_capacity(BUFFER_BYTES, tokio::fs::File::from_std(opened));
    let (mut hash, mut bytes) = (Sha256::new(), 0u64);
    let mut chunks = body.into_data_stream();
    while let Some(chunk) = chunks.next().await {
        let chunk = chunk.map_err(|error| broken(&error))?;
        bytes += chunk.len() as u64;
        room.refuse_beyond(bytes)?;
        hash.update(&chunk);
        writer.write_all(&chunk).await.map_err(|error| cannot("write to", &error))?;
    }
    writer.flush().await.map_err(|error| cannot("write to", &error))?;
    let id = id_of(hash);
    room.refuse_new_beyond(&id, bytes)?;
    Ok(Received { file, bytes, id })
}

/// How many bytes may still come.
struct Room {
    /// Of one recording.
    one: u64,
    /// Of all tenants.
    free: u64,
    /// Of the tenant.
    own: u64,
    /// Lengths of what the tenant keeps already, which is no more when it comes again.
    kept: BTreeMap<String, u64>,
}

impl Room {
    async fn of(engine: &Engine, tenant: &Tenant) -> Result<Room, Problem> {
        let held = engine.recordings().bytes().await?;
        let limits = engine.limits();
        let kept = engine.recordings().own(tenant).await?;
        Ok(Room {
            one: limits.recording_bytes,
            free: limits.stored_recording_bytes.saturating_sub(held),
            own: engine.free_bytes(tenant).await?,
            kept: kept.into_iter().map(|(id, note)| (id, note.bytes)).collect(),
        })
    }

    /// Refuses what can be neither new nor kept already.
    fn refuse_beyond(&self, bytes: u64) -> Result<(), Problem> {
        if bytes > self.one {
            let detail = format!(
                "the recording exceeds {} bytes: cut it into several, or write it as Parquet, MCAP with compression or \
                 with fewer topics",
                self.one
            );
            return Err(Problem::new(ProblemType::TooLarge, detail));
        }
        if self.kept.values().any(|kept| bytes <= *kept) { Ok(()) } else { self.refuse_without_room(bytes) }
    }

    /// Refuses a whole recording that is not kept already and has no room.
    fn refuse_new_beyond(&self, id: &str, bytes: u64) -> Result<(), Problem> {
        if self.kept.contains_key(id) { Ok(()) } else { self.refuse_without_room(bytes) }
    }

    fn refuse_without_room(&self, bytes: u64) -> Result<(), Problem> {
        if bytes > self.own {
            let detail =
                format!("the recording exceeds the {} bytes that are free: delete one first", self.own);
            return Err(Problem::new(ProblemType::StoreFull, detail));
        }
        if bytes > self.free {
            // What others keep is not this tenant's to know.
            let detail = "the service has no room for the recording: delete one, send a shorter one, or ask who runs the service \
                          for room (--stored-recording-bytes)";
            return Err(Problem::new(ProblemType::StoreFull, detail));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_already_needs_no_room_and_anything_else_does() {
        let kept = BTreeMap::from([("0f".to_owned(), 100)]);
        let full = Room { one: 1000, free: 50, own: 10, kept };
        assert!(full.refuse_beyond(100).is_ok() && full.refuse_new_beyond("0f", 100).is_ok());
        let refused = |outcome: Result<(), Problem>| outcome.unwrap_err();
        for problem in [refused(full.refuse_beyond(101)), refused(full.refuse_new_beyond("1e", 100))] {
            assert_eq!(problem.kind, ProblemType::StoreFull);
            assert!(problem.detail.contains("10 bytes"), "{problem:?}");
        }
        assert!(full.refuse_new_beyond("1e", 10).is_ok());
        assert_eq!(refused(full.refuse_beyond(1001)).kind, ProblemType::TooLarge);
        let problem = refused(Room { own: 1000, ..full }.refuse_new_beyond("1e", 51));
        assert!(problem.detail.contains("--stored-recording-bytes"), "{problem:?}");
        assert!(!problem.detail.contains("50"), "{problem:?}");
    }
}
