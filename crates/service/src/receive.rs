//! A body that goes to a file as it comes, with its hash, and never as a whole into memory.

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
    Ok(Received { file, bytes, id: id_of(hash) })
}

/// How many bytes may still come.
struct Room {
    one: u64,
    free: u64,
}

impl Room {
    async fn of(engine: &Engine, tenant: &Tenant) -> Result<Room, Problem> {
        let held = engine.recordings().bytes().await?;
        let limits = engine.limits();
        let free = limits.stored_recording_bytes.saturating_sub(held);
        let own = engine.free_bytes(tenant).await?;
        Ok(Room { one: limits.recording_bytes, free: free.min(own) })
    }

    fn refuse_beyond(&self, bytes: u64) -> Result<(), Problem> {
        if bytes > self.one {
            let detail = format!(
                "the recording exceeds {} bytes: cut it into several, or write it as Parquet, MCAP with compression or \
                 with fewer topics",
                self.one
            );
            return Err(Problem::new(ProblemType::TooLarge, detail));
        }
        if bytes > self.free {
            let detail =
                format!("the recording exceeds the {} bytes that are free: delete one first", self.free);
            return Err(Problem::new(ProblemType::StoreFull, detail));
        }
        Ok(())
    }
}
