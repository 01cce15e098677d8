//! Names of content codings, and the memory of their decoders.

/// A content coding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coding {
    /// RFC 1952, one member or several.
    Gzip,
    /// RFC 1950; RFC 1951 without its frame is taken too, because some clients send that.
    Deflate,
    /// RFC 7932.
    Brotli,
    /// RFC 8878, one frame or several.
    Zstd,
}

impl Coding {
    /// Returns the coding of a registered name, whatever its case (RFC 9110, section 8.4.1).
    pub(super) fn named(name: &str) -> Option<Coding> {
        Some(match name.to_ascii_lowercase().as_str() {
            "gzip" | "x-gzip" => Coding::Gzip,
            "deflate" => Coding::Deflate,
            "br" => Coding::Brotli,
            "zstd" => Coding::Zstd,
            _ => return None,
        })
    }

    /// Name in messages.
    pub(super) fn name(self) -> &'static str {
        match self {
            Coding::Gzip => "gzip",
            Coding::Deflate => "deflate",
            Coding::Brotli => "br",
            Coding::Zstd => "zstd",
        }
    }

    /// Most memory of its decoder [bytes]: the window that the format allows, and buffers.
    pub(super) fn decoder_bytes(self) -> u64 {
        match self {
            Coding::Gzip | Coding::Deflate => 1 << 18,
            // A window of 2^24 bytes (RFC 7932, section 9.1).
            Coding::Brotli => 17 << 20,
            Coding::Zstd => (1 << ZSTD_WINDOW_LOG) + (1 << 20),
        }
    }
}

/// Largest window of zstd as a content coding, as a power of two [bytes]: 8 MiB (RFC 9659).
pub(super) const ZSTD_WINDOW_LOG: u32 = 23;
