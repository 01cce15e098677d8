//! One storage file of a recording, by what its first bytes say it is.

use std::{
    fs::File,
    io::{self, Cursor, Read},
    path::Path,
    sync::atomic::Ordering,
};

use super::db3;
use crate::{
    Error, Format, Map, Watch, bag, container,
    format::{HEAD_BYTES, ZSTD_MAGIC, head},
    mcap,
    mcap_summary::Summary,
    reading::{Reading, read_up_to},
    topic::Topics,
    watch::{Budget, Watched},
};

/// Reads a file that is a recording for itself.
pub(crate) fn read(
    path: &Path,
    name: &str,
    map: Option<&Map>,
    watch: &Watch,
    budget: &Budget,
) -> Result<Reading, Error> {
    let mut topics = container::topics(map, budget)?;
    let format = read_into(path, &mut topics, watch)?;
    topics.finish(name, format)
}

/// Reads a file into the topics of a recording; returns its format.
pub(crate) fn read_into(path: &Path, topics: &mut Topics<'_>, watch: &Watch) -> Result<&'static str, Error> {
    let mut file = File::open(path)?;
    let head = head(&mut file)?;
    if Format::of_content(&head) == Some(Format::Db3) {
        return db3::read_into(path, topics).map(|()| db3::FORMAT);
    }
    let is_mcap = Format::of_content(&head) == Some(Format::Mcap);
    let summary = if is_mcap { Summary::of(&mut file) } else { Summary::default() };
    let file = Watched::new(file, watch.clone());
    let stopped = file.stopped();
    let read = match head.starts_with(&ZSTD_MAGIC) {
        true => unpacked(file, topics),
        false => records(file, &head, summary, topics),
    };
    if stopped.load(Ordering::Relaxed) { Err(Error::Stopped) } else { read }
}

/// When the first message of a file was written \[ns\], if that is soon found.
pub(crate) fn first_ns(path: &Path, topics: &mut Topics<'_>) -> Option<i64> {
    let mut file = File::open(path).ok()?;
    let head = head(&mut file).ok()?;
    match Format::of_content(&head) {
        Some(Format::Db3) => db3::first_ns(path, topics),
        Some(Format::Mcap) => mcap::first_ns(file),
        None if head.starts_with(&ZSTD_MAGIC) => mcap::first_ns(zstd::stream::read::Decoder::new(file).ok()?),
        _ => None,
    }
}

/// Reads a file that `--compression-mode file` compressed as a whole.
fn unpacked(packed: impl Read, topics: &mut Topics<'_>) -> Result<&'static str, Error> {
    let mut plain = UntilBroken(zstd::stream::read::Decoder::new(packed)?);
    let mut head = Vec::new();
    read_up_to(&mut plain, HEAD_BYTES, &mut head)?;
    let whole = Cursor::new(head.clone()).chain(plain);
    match Format::of_content(&head) {
        Some(Format::Db3) => db3::read_copy_into(whole, topics).map(|()| db3::FORMAT),
        _ => records(whole, &head, Summary::default(), topics),
    }
}

fn records(
    source: impl Read,
    head: &[u8],
    summary: Summary,
    topics: &mut Topics<'_>,
) -> Result<&'static str, Error> {
    match Format::of_content(head) {
        Some(Format::Mcap) => mcap::read_into(source, summary, topics).map(|()| mcap::FORMAT),
        Some(Format::Bag) => bag::read_into(source, topics).map(|()| bag::FORMAT),
        _ => {
            let reason =
                "it begins like neither MCAP nor SQLite; what else is compressed, unpack with `zstd -d`";
            Err(Error::NotTheFormat { format: "recording", reason: reason.into() })
        }
    }
}

/// What a broken compression holds before the break: a recorder that was killed leaves one.
struct UntilBroken<R>(R);

impl<R: Read> Read for UntilBroken<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.0.read(buffer) {
            Err(error) if error.kind() != io::ErrorKind::Interrupted => Ok(0),
            read => read,
        }
    }
}
