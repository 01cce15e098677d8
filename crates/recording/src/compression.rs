//! Chunks of a container, decompressed no further than they claim and than is sane.

use std::io::Read;

/// The longest chunk or record that is held in memory \[bytes\]. Writers make chunks of about one to four megabytes; the
/// limit is what keeps a few hostile bytes from filling the memory.
pub(crate) const LONGEST_BYTES: u64 = 256 << 20;

/// Decompresses a chunk into `plain`. False: it is broken or cut off, and `plain` holds what came before.
///
/// # Errors
/// In words, when the compression is not known or the chunk claims to be larger than [`LONGEST_BYTES`].
pub(crate) fn decompress(
    compression: &[u8],
    packed: &[u8],
    claimed_bytes: u64,
    plain: &mut Vec<u8>,
) -> Result<bool, String> {
    plain.clear();
    if claimed_bytes > LONGEST_BYTES {
        return Err(format!(
            "a chunk claims {claimed_bytes} bytes, more than the {LONGEST_BYTES} of any writer"
        ));
    }
    let mut reader: Box<dyn Read> = match compression {
        b"" | b"none" => Box::new(packed),
        b"zstd" => match zstd::stream::read::Decoder::with_buffer(packed) {
            Ok(decoder) => Box::new(decoder),
            Err(_) => return Ok(false),
        },
        b"lz4" => match lz4::Decoder::new(packed) {
            Ok(decoder) => Box::new(decoder),
            Err(_) => return Ok(false),
        },
        b"bz2" => Box::new(bzip2::bufread::BzDecoder::new(packed)),
        other => return Err(format!("its chunks are compressed with `{}`", String::from_utf8_lossy(other))),
    };
    let whole = reader.as_mut().take(claimed_bytes).read_to_end(plain).is_ok();
    Ok(whole && plain.len() as u64 == claimed_bytes)
}
