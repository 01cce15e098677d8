//! Chunks of a container, decompressed no further than they claim and than is sane.

use std::io::Read;

use crate::{
    Error,
    watch::{BYTES_A_LOOK, Looks},
};

/// The longest chunk or record that is held in memory \[bytes\]. Writers make chunks of about one to four megabytes; the
/// limit is what keeps a few hostile bytes from filling the memory.
pub(crate) const LONGEST_BYTES: u64 = 256 << 20;

/// Decompresses a chunk into `plain`. False: it is broken or cut off, and `plain` holds what came before.
///
/// The outer error is [`Error::Stopped`], when the watch breaks.
///
/// # Errors
/// In words, when the compression is not known or the chunk claims to be larger than [`LONGEST_BYTES`].
pub(crate) fn decompress(
    compression: &[u8],
    packed: &[u8],
    claimed_bytes: u64,
    plain: &mut Vec<u8>,
    looks: &Looks,
) -> Result<Result<bool, String>, Error> {
    plain.clear();
    if claimed_bytes > LONGEST_BYTES {
        return Ok(Err(format!(
            "a chunk claims {claimed_bytes} bytes, more than the {LONGEST_BYTES} of any writer"
        )));
    }
    let mut reader: Box<dyn Read> = match compression {
        b"" | b"none" => Box::new(packed),
        b"zstd" => match zstd::stream::read::Decoder::with_buffer(packed) {
            Ok(decoder) => Box::new(decoder),
            Err(_) => return Ok(Ok(false)),
        },
        b"lz4" => match lz4::Decoder::new(packed) {
            Ok(decoder) => Box::new(decoder),
            Err(_) => return Ok(Ok(false)),
        },
        b"bz2" => Box::new(bzip2::bufread::BzDecoder::new(packed)),
        other => {
            let name = String::from_utf8_lossy(other);
            return Ok(Err(format!("its chunks are compressed with `{name}`")));
        }
    };
    for _ in 0..claimed_bytes.div_ceil(BYTES_A_LOOK) {
        looks.go_on()?;
        let piece_bytes = (claimed_bytes - plain.len() as u64).min(BYTES_A_LOOK);
        match reader.as_mut().take(piece_bytes).read_to_end(plain) {
            Ok(bytes) if bytes as u64 == piece_bytes => {}
            _ => return Ok(Ok(false)),
        }
    }
    Ok(Ok(plain.len() as u64 == claimed_bytes))
}
