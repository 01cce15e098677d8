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
    Ok(Ok(match compression {
        b"" | b"none" => read_whole(packed, claimed_bytes, plain, looks)?,
        b"zstd" => match zstd::stream::read::Decoder::with_buffer(packed) {
            Ok(decoder) => read_whole(decoder, claimed_bytes, plain, looks)?,
            Err(_) => false,
        },
        b"lz4" => match lz4::Decoder::new(packed) {
            Ok(decoder) => {
                read_whole(decoder, claimed_bytes, plain, looks)?
                    && lz4_frame_bytes(packed) == Some(packed.len())
            }
            Err(_) => false,
        },
        b"bz2" => read_whole(bzip2::bufread::MultiBzDecoder::new(packed), claimed_bytes, plain, looks)?,
        other => {
            let name = String::from_utf8_lossy(other);
            return Ok(Err(format!("its chunks are compressed with `{name}`")));
        }
    }))
}

/// Decompresses one message of a recording made with `--compression-mode message`.
///
/// # Errors
/// In words, when it is no whole Zstandard frame or longer than [`LONGEST_BYTES`].
pub(crate) fn decompress_message<'p>(packed: &[u8], plain: &'p mut Vec<u8>) -> Result<&'p [u8], String> {
    plain.clear();
    let broken = |_| "its compression with zstd is broken".to_owned();
    let decoder = zstd::stream::read::Decoder::with_buffer(packed).map_err(broken)?;
    decoder.take(LONGEST_BYTES + 1).read_to_end(plain).map_err(broken)?;
    match plain.len() as u64 > LONGEST_BYTES {
        true => Err(format!("it is longer than {LONGEST_BYTES} bytes when decompressed")),
        false => Ok(plain),
    }
}

/// Length of an LZ4 frame by its own account [bytes]: the decoder reads a little further. LZ4 Frame Format 1.6.
fn lz4_frame_bytes(packed: &[u8]) -> Option<usize> {
    const HEAD_BYTES: usize = 7;
    let flags = *packed.get(4)?;
    let field = |bit: u8, bytes: usize| if flags & bit == 0 { 0 } else { bytes };
    // Size of the content and id of a dictionary.
    let mut at = HEAD_BYTES + field(0x08, 8) + field(0x01, 4);
    loop {
        let size = packed.get(at..at + 4)?.try_into().map(u32::from_le_bytes).ok()?;
        at += 4;
        if size == 0 {
            // Checksum of the content.
            return Some(at + field(0x04, 4));
        }
        // The highest bit marks a block that is not packed; a checksum may follow it.
        at += usize::try_from(size & 0x7fff_ffff).ok()? + field(0x10, 4);
    }
}

/// Reads the bytes that a chunk claims. False: there are fewer, or something is left over.
fn read_whole(
    mut reader: impl Read,
    claimed_bytes: u64,
    plain: &mut Vec<u8>,
    looks: &Looks,
) -> Result<bool, Error> {
    while (plain.len() as u64) < claimed_bytes {
        looks.go_on()?;
        let piece_bytes = (claimed_bytes - plain.len() as u64).min(BYTES_A_LOOK);
        match reader.by_ref().take(piece_bytes).read_to_end(plain) {
            Ok(bytes) if bytes as u64 == piece_bytes => {}
            _ => return Ok(false),
        }
    }
    Ok(matches!(reader.read(&mut [0]), Ok(0)))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;
    use crate::reading::unwatched;

    const TEXT: &[u8] = b"a message of a topic, and another one";

    fn packed(compression: &[u8]) -> Vec<u8> {
        match compression {
            b"zstd" => zstd::encode_all(TEXT, 1).unwrap(),
            b"lz4" => {
                let mut encoder = lz4::EncoderBuilder::new().build(Vec::new()).unwrap();
                encoder.write_all(TEXT).unwrap();
                let (packed, end) = encoder.finish();
                end.unwrap();
                packed
            }
            b"bz2" => {
                let mut encoder = bzip2::write::BzEncoder::new(Vec::new(), bzip2::Compression::fast());
                encoder.write_all(TEXT).unwrap();
                encoder.finish().unwrap()
            }
            _ => TEXT.to_vec(),
        }
    }

    fn decompressed(compression: &[u8], packed: &[u8], claimed_bytes: usize) -> (bool, Vec<u8>) {
        let (mut plain, looks) = (Vec::new(), Looks::new(&unwatched()));
        let whole =
            decompress(compression, packed, claimed_bytes as u64, &mut plain, &looks).unwrap().unwrap();
        (whole, plain)
    }

    #[test]
    fn a_chunk_is_whole_when_it_holds_what_it_claims_and_nothing_more() {
        for compression in [&b"none"[..], b"zstd", b"lz4", b"bz2"] {
            let name = String::from_utf8_lossy(compression);
            let packed = packed(compression);
            assert_eq!(decompressed(compression, &packed, TEXT.len()), (true, TEXT.to_vec()), "{name}");
            let fewer = decompressed(compression, &packed, TEXT.len() - 5);
            assert_eq!(fewer, (false, TEXT[..TEXT.len() - 5].to_vec()), "{name}: bytes are left over");
            assert!(!decompressed(compression, &packed, TEXT.len() + 1).0, "{name}: bytes are missing");
            let rest = [&packed[..], b"rest"].concat();
            assert!(!decompressed(compression, &rest, TEXT.len()).0, "{name}: packed bytes are left over");
            assert!(
                !decompressed(compression, &packed[..packed.len() - 2], TEXT.len()).0,
                "{name}: it is cut off"
            );
        }
    }
}
