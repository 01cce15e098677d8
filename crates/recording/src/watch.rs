//! Reading that can be followed, and stopped, from outside.

use std::{
    io::{self, Read},
    ops::ControlFlow,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use ::parquet::{errors::Result as ParquetResult, file::reader::ChunkReader, file::reader::Length};
use bytes::Bytes;

/// Is told how many more bytes were read, and stops the reading by breaking. Fits and diagnoses ask it as well, telling of no bytes.
pub type Watch = Arc<dyn Fn(u64) -> ControlFlow<()> + Send + Sync>;

/// A source whose reading is watched.
#[derive(Clone)]
pub(crate) struct Watched<R> {
    source: R,
    watch: Watch,
    stopped: Arc<AtomicBool>,
}

impl<R> Watched<R> {
    pub(crate) fn new(source: R, watch: Watch) -> Self {
        Watched { source, watch, stopped: Arc::default() }
    }

    /// Whether the watch broke the reading off, now or later.
    pub(crate) fn stopped(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stopped)
    }

    fn tell(&self, bytes: usize) -> io::Result<()> {
        match (self.watch)(bytes as u64) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => {
                self.stopped.store(true, Ordering::Relaxed);
                Err(io::Error::other("stopped"))
            }
        }
    }
}

impl<R: Read> Read for Watched<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let bytes = self.source.read(buffer)?;
        self.tell(bytes)?;
        Ok(bytes)
    }
}

impl<R: Length> Length for Watched<R> {
    fn len(&self) -> u64 {
        self.source.len()
    }
}

impl<R: ChunkReader> ChunkReader for Watched<R> {
    type T = Watched<R::T>;

    fn get_read(&self, start: u64) -> ParquetResult<Self::T> {
        let source = self.source.get_read(start)?;
        Ok(Watched { source, watch: Arc::clone(&self.watch), stopped: self.stopped() })
    }

    fn get_bytes(&self, start: u64, length: usize) -> ParquetResult<Bytes> {
        let bytes = self.source.get_bytes(start, length)?;
        self.tell(bytes.len())?;
        Ok(bytes)
    }
}
