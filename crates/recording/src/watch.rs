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

use crate::{Error, Room};

/// Is told how many more bytes were read, and stops the reading by breaking. Fits and diagnoses ask it as well, telling of no bytes.
pub type Watch = Arc<dyn Fn(u64) -> ControlFlow<()> + Send + Sync>;

/// Rows or messages that are worked on between two looks at the watch: some milliseconds of the slowest step.
pub(crate) const ROWS_A_LOOK: usize = 8192;

/// Bytes that are unpacked between two looks at the watch: some 20 ms of the slowest compression.
pub(crate) const BYTES_A_LOOK: u64 = 1 << 18;

/// A watch that is asked while work goes on that reads no bytes.
#[derive(Clone)]
pub(crate) struct Looks {
    watch: Watch,
    rows_since: usize,
}

impl Looks {
    pub(crate) fn new(watch: &Watch) -> Self {
        Looks { watch: Arc::clone(watch), rows_since: 0 }
    }

    /// Asks the watch.
    ///
    /// # Errors
    /// [`Error::Stopped`] when it breaks.
    pub(crate) fn go_on(&self) -> Result<(), Error> {
        self.read(0)
    }

    /// Takes note of bytes that were read by other means than a [`Watched`] source.
    ///
    /// # Errors
    /// As [`Looks::go_on`].
    pub(crate) fn read(&self, bytes: u64) -> Result<(), Error> {
        match (self.watch)(bytes) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Error::Stopped),
        }
    }

    /// The watch itself.
    pub(crate) fn watch(&self) -> Watch {
        Arc::clone(&self.watch)
    }

    /// Takes note of rows that were worked on, and asks the watch once there are [`ROWS_A_LOOK`] of them.
    ///
    /// # Errors
    /// As [`Looks::go_on`].
    pub(crate) fn worked(&mut self, rows: usize) -> Result<(), Error> {
        self.rows_since += rows;
        if self.rows_since < ROWS_A_LOOK {
            return Ok(());
        }
        self.rows_since = 0;
        self.go_on()
    }
}

/// Memory and patience of a reading.
#[derive(Clone)]
pub(crate) struct Budget {
    pub(crate) room: Room,
    pub(crate) looks: Looks,
}

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
