//! What MCAP files, SQLite files and ROS 1 bags have in common: a beginning that says what they are, and records up to where they break off.

use std::{
    io::{BufReader, Read},
    sync::LazyLock,
};

use crate::{Error, Map, format::ZSTD_MAGIC, reading::read_up_to, topic::Topics, watch::Budget};

/// Bytes read at a time.
const BUFFER_BYTES: usize = 1 << 20;

/// The file ends where a record should begin.
pub(crate) const ENDS_EARLY: &str = "the file breaks off; everything before was read";
/// The file ends within a record.
pub(crate) const BREAKS_OFF: &str = "the file breaks off in this record; what is whole was read";
/// The bytes of a chunk are not what a compressor writes.
pub(crate) const UNPACKABLE: &str = "a chunk cannot be decompressed; it was left out";

/// The map that is taken where none is given.
static HUSKY: LazyLock<Option<Map>> = LazyLock::new(|| Map::built_in("husky"));

/// The source behind its magic bytes.
pub(crate) fn opened<R: Read>(
    source: R,
    magic: &[u8],
    format: &'static str,
    otherwise: &str,
) -> Result<BufReader<R>, Error> {
    let mut source = BufReader::with_capacity(BUFFER_BYTES, source);
    let mut begins = Vec::new();
    read_up_to(&mut source, magic.len() as u64, &mut begins)?;
    if begins == magic {
        return Ok(source);
    }
    let reason = match begins.as_slice() {
        [] => "it is empty",
        packed if packed.starts_with(&ZSTD_MAGIC) => "it is compressed as a whole: unpack it with `zstd -d`",
        _ => otherwise,
    };
    let reason = reason.to_owned();
    Err(Error::NotTheFormat { format, reason })
}

/// The topics that a map names, or those of a Husky.
pub(crate) fn topics<'m>(map: Option<&'m Map>, budget: &Budget) -> Result<Topics<'m>, Error> {
    let map = map.or(HUSKY.as_ref()).ok_or(Error::Empty { found: "no map".into() })?;
    Ok(Topics::new(map, budget.clone()))
}
