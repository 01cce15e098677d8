//! Compressions of a TIFF's blocks, each as a reader of the bytes that were compressed.

use std::io::{self, Read};

use tiff::tags::Tag;
use weezl::{BitOrder, LzwStatus, decode::Decoder as LzwDecoder};

use super::directory::Tags;
use crate::Error;

/// A compression that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compression {
    None,
    Lzw,
    Deflate,
    PackBits,
    Zstd,
    /// Esri's LERC, whose blobs may be compressed once more.
    Lerc(LercPacking),
}

/// What LERC's blobs are compressed with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LercPacking {
    None,
    Deflate,
    Zstd,
}

impl Compression {
    /// LercParameters: version, and what blobs are compressed with.
    const LERC_PARAMETERS: u16 = 50674;
    /// Most bytes that an absent block may stand for, by byte of the file.
    pub(super) const SPARSE_RATIO: u64 = 1 << 16;

    pub(super) fn read(tags: &mut Tags<'_, '_>) -> Result<Self, Error> {
        let code = tags.unsigned(Tag::Compression)?.unwrap_or(1);
        let refused = |name: &'static str| Err(Error::TiffCompression { code, name });
        match code {
            1 => Ok(Compression::None),
            5 => Ok(Compression::Lzw),
            8 | 32946 => Ok(Compression::Deflate),
            32773 => Ok(Compression::PackBits),
            50000 => Ok(Compression::Zstd),
            34887 => {
                let parameters = tags.unsigned_list(Tag::from_u16_exhaustive(Self::LERC_PARAMETERS))?;
                Ok(Compression::Lerc(match parameters.get(1) {
                    None | Some(0) => LercPacking::None,
                    Some(1) => LercPacking::Deflate,
                    Some(2) => LercPacking::Zstd,
                    Some(_) => return refused("LERC with an unknown compression"),
                }))
            }
            2..=4 => refused("CCITT"),
            6 | 7 => refused("JPEG"),
            34712 => refused("JPEG 2000"),
            34925 => refused("LZMA"),
            50001 => refused("WebP"),
            50002 | 52546 => refused("JPEG XL"),
            _ => refused("unknown"),
        }
    }

    /// Most bytes that one compressed byte can stand for.
    pub(super) fn largest_ratio(self) -> u64 {
        match self {
            Compression::None => 1,
            // Two bytes are repeated at most 128 times.
            Compression::PackBits => 64,
            // A code of 12 bits stands for a string of 4096 - 258 bytes at most.
            Compression::Lzw => 4096,
            // Two bits stand for 258 bytes at most (RFC 1951).
            Compression::Deflate => 1032,
            // Four bytes stand for a block of 128 KiB (RFC 8878).
            Compression::Zstd => 1 << 15,
            // A blob of some 100 bytes says that every pixel of a block is the same: what bounds it is the size of the block.
            Compression::Lerc(_) => u64::MAX,
        }
    }

    /// A reader of what a block's bytes stand for.
    pub(super) fn open(self, bytes: &[u8]) -> Result<Box<dyn Read + '_>, Error> {
        Ok(match self {
            Compression::None | Compression::Lerc(LercPacking::None) => Box::new(bytes),
            Compression::Deflate | Compression::Lerc(LercPacking::Deflate) => {
                Box::new(flate2::bufread::ZlibDecoder::new(bytes))
            }
            Compression::Zstd | Compression::Lerc(LercPacking::Zstd) => {
                let decoder = zstd::stream::read::Decoder::with_buffer(bytes);
                Box::new(decoder.map_err(|why| Error::TiffBlock { why: why.to_string() })?)
            }
            Compression::Lzw => Box::new(Lzw::new(bytes)),
            Compression::PackBits => Box::new(PackBits { bytes, run: Run::Literal(0) }),
        })
    }
}

/// LZW as TIFF has it. A block that lacks the code for its end is read as far as it goes.
struct Lzw<'a> {
    bytes: &'a [u8],
    decoder: LzwDecoder,
}

impl<'a> Lzw<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Lzw { bytes, decoder: LzwDecoder::with_tiff_size_switch(BitOrder::Msb, 8) }
    }
}

impl Read for Lzw<'_> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        loop {
            let step = self.decoder.decode_bytes(self.bytes, to);
            self.bytes = self.bytes.get(step.consumed_in..).unwrap_or_default();
            match step.status {
                Ok(LzwStatus::Ok) if step.consumed_out == 0 && step.consumed_in > 0 && !to.is_empty() => {}
                Ok(_) => return Ok(step.consumed_out),
                Err(why) => return Err(io::Error::new(io::ErrorKind::InvalidData, why)),
            }
        }
    }
}

/// Runs of bytes (TIFF 6.0, section 9).
struct PackBits<'a> {
    bytes: &'a [u8],
    run: Run,
}

/// What is left of a run.
enum Run {
    Literal(usize),
    Repeated(u8, usize),
}

impl Read for PackBits<'_> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        loop {
            match &mut self.run {
                Run::Literal(0) | Run::Repeated(_, 0) => {
                    let Some((head, rest)) = self.bytes.split_first() else { return Ok(0) };
                    self.bytes = rest;
                    self.run = match *head as i8 {
                        length @ 0.. => Run::Literal(length as usize + 1),
                        i8::MIN => Run::Literal(0),
                        length => {
                            let Some((byte, rest)) = rest.split_first() else { return Ok(0) };
                            self.bytes = rest;
                            Run::Repeated(*byte, (1 - isize::from(length)) as usize)
                        }
                    };
                }
                Run::Literal(left) => {
                    let count = (*left).min(to.len()).min(self.bytes.len());
                    let (literal, rest) = self.bytes.split_at(count);
                    to[..count].copy_from_slice(literal);
                    self.bytes = rest;
                    *left -= count;
                    return Ok(count);
                }
                Run::Repeated(byte, left) => {
                    let count = (*left).min(to.len());
                    to[..count].fill(*byte);
                    *left -= count;
                    return Ok(count);
                }
            }
        }
    }
}
