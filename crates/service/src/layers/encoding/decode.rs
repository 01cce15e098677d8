//! Decoding a body as it comes, to its last byte.

use std::{io, pin::Pin};

use async_compression::{
    tokio::bufread::{BrotliDecoder, DeflateDecoder, GzipDecoder, ZlibDecoder, ZstdDecoder},
    zstd::DParameter,
};
use axum::body::{Body, Bytes};
use futures_util::{Stream, TryStreamExt, stream};
use tokio::io::{AsyncBufRead, AsyncBufReadExt, AsyncRead, AsyncReadExt};
use tokio_util::io::StreamReader;

use super::coding::{Coding, ZSTD_WINDOW_LOG};

/// Decoded bytes of one piece, after which other tasks have their turn.
const PIECE_BYTES: usize = 64 << 10;

type Encoded = Pin<Box<dyn AsyncBufRead + Send>>;

/// A body decoded by one coding. It fails where the encoded data is not valid, ends early, or something is left over.
pub(super) fn decoded(coding: Coding, body: Body) -> Body {
    let bytes = body.into_data_stream().map_err(io::Error::other);
    let encoded: Encoded = Box::pin(StreamReader::new(bytes));
    match coding {
        Coding::Gzip => {
            let mut decoder = GzipDecoder::new(encoded);
            decoder.multiple_members(true);
            Body::from_stream(pieces(coding, decoder, GzipDecoder::into_inner))
        }
        Coding::Zstd => {
            let mut decoder =
                ZstdDecoder::with_params(encoded, &[DParameter::window_log_max(ZSTD_WINDOW_LOG)]);
            decoder.multiple_members(true);
            Body::from_stream(pieces(coding, decoder, ZstdDecoder::into_inner))
        }
        Coding::Brotli => {
            Body::from_stream(pieces(coding, BrotliDecoder::new(encoded), BrotliDecoder::into_inner))
        }
        Coding::Deflate => Body::from_stream(stream::once(deflated(encoded)).try_flatten()),
    }
}

type Pieces = Pin<Box<dyn Stream<Item = io::Result<Bytes>> + Send>>;

/// Tells data with the frame of zlib from data without it.
async fn deflated(mut encoded: Encoded) -> io::Result<Pieces> {
    let first = encoded.fill_buf().await?.first().copied();
    // Compression method 8 with a window of at most 32 kB (RFC 1950, section 2.2). Without the frame, these bits would begin a
    // stored block whose length could not be right, or a block of the reserved type.
    let is_framed = first.is_some_and(|byte| byte & 0x0f == 8 && byte >> 4 <= 7);
    Ok(if is_framed {
        Box::pin(pieces(Coding::Deflate, ZlibDecoder::new(encoded), ZlibDecoder::into_inner))
    } else {
        Box::pin(pieces(Coding::Deflate, DeflateDecoder::new(encoded), DeflateDecoder::into_inner))
    })
}

/// Decoded pieces, and then the check that nothing is left over.
fn pieces<D: AsyncRead + Send + Unpin + 'static>(
    coding: Coding,
    decoder: D,
    into_rest: impl Fn(D) -> Encoded + Copy + Send + 'static,
) -> impl Stream<Item = io::Result<Bytes>> + Send {
    stream::try_unfold(decoder, move |mut decoder| async move {
        let mut piece = Vec::with_capacity(PIECE_BYTES);
        // A decoder would otherwise hold its thread for as long as there is something to decode.
        tokio::task::yield_now().await;
        let count = decoder.read_buf(&mut piece).await.map_err(|error| invalid(coding, &error))?;
        if count > 0 {
            return Ok(Some((Bytes::from(piece), decoder)));
        }
        let name = coding.name();
        match into_rest(decoder).fill_buf().await?.is_empty() {
            true => Ok(None),
            false => Err(io::Error::other(format!("bytes are left over after its {name} data"))),
        }
    })
}

fn invalid(coding: Coding, error: &io::Error) -> io::Error {
    let name = coding.name();
    match error.kind() {
        io::ErrorKind::UnexpectedEof => io::Error::other(format!("its {name} data ends too early")),
        _ => io::Error::other(format!("its {name} data cannot be decoded: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use async_compression::tokio::bufread::{
        BrotliEncoder, DeflateEncoder, GzipEncoder, ZlibEncoder, ZstdEncoder,
    };
    use axum::body::to_bytes;

    use super::*;

    const TEXT: &[u8] = b"t_s,v_left_mps,v_right_mps\n0.0,0.5,0.5\n0.1,0.5,0.5\n";

    async fn all(mut encoder: impl AsyncRead + Unpin) -> Vec<u8> {
        let mut encoded = Vec::new();
        encoder.read_to_end(&mut encoded).await.unwrap();
        encoded
    }

    async fn encoded(coding: Coding) -> Vec<u8> {
        match coding {
            Coding::Gzip => all(GzipEncoder::new(TEXT)).await,
            Coding::Deflate => all(ZlibEncoder::new(TEXT)).await,
            Coding::Brotli => all(BrotliEncoder::new(TEXT)).await,
            Coding::Zstd => all(ZstdEncoder::new(TEXT)).await,
        }
    }

    /// Decodes what comes in pieces of a few bytes.
    async fn decode(coding: Coding, encoded: &[u8], piece: usize) -> Result<Vec<u8>, String> {
        let pieces: Vec<io::Result<Bytes>> =
            encoded.chunks(piece).map(|piece| Ok(Bytes::copy_from_slice(piece))).collect();
        let body = decoded(coding, Body::from_stream(stream::iter(pieces)));
        to_bytes(body, usize::MAX).await.map(Vec::from).map_err(|error| error.to_string())
    }

    const ALL: [Coding; 4] = [Coding::Gzip, Coding::Deflate, Coding::Brotli, Coding::Zstd];

    #[tokio::test]
    async fn every_coding_gives_back_what_was_encoded_however_it_is_cut() {
        for coding in ALL {
            let encoded = encoded(coding).await;
            for piece in [1, 7, 1000] {
                assert_eq!(decode(coding, &encoded, piece).await.as_deref(), Ok(TEXT), "{coding:?}");
            }
        }
        let bare = all(DeflateEncoder::new(TEXT)).await;
        assert_eq!(decode(Coding::Deflate, &bare, 5).await.as_deref(), Ok(TEXT));
    }

    #[tokio::test]
    async fn members_and_frames_that_follow_one_another_are_all_decoded() {
        for coding in [Coding::Gzip, Coding::Zstd] {
            let twice = encoded(coding).await.repeat(3);
            for piece in [1, 13, 1000] {
                assert_eq!(decode(coding, &twice, piece).await, Ok(TEXT.repeat(3)), "{coding:?}");
            }
        }
    }

    #[tokio::test]
    async fn data_that_is_cut_off_anywhere_is_refused() {
        for coding in ALL {
            let encoded = encoded(coding).await;
            for length in 1..encoded.len() {
                let cut = decode(coding, &encoded[..length], 9).await;
                assert!(cut.is_err(), "{coding:?} after {length} of {} bytes gave {cut:?}", encoded.len());
            }
        }
        // A second member that is cut off is no less lost than a first one.
        for coding in [Coding::Gzip, Coding::Zstd] {
            let encoded = encoded(coding).await;
            let twice = encoded.repeat(2);
            for length in encoded.len() + 1..twice.len() {
                assert!(decode(coding, &twice[..length], 9).await.is_err(), "{coding:?} after {length}");
            }
        }
    }

    #[tokio::test]
    async fn bytes_that_are_left_over_are_refused() {
        for coding in ALL {
            for rest in [&b"\0"[..], b"x", b"\x06", b"\0\0\0\0\0\0\0\0", b"and more text"] {
                for piece in [1, 9, 1000] {
                    let mut whole = encoded(coding).await;
                    whole.extend_from_slice(rest);
                    let found = decode(coding, &whole, piece).await;
                    assert!(found.is_err(), "{coding:?} and {rest:?} gave {found:?}");
                }
            }
        }
    }

    #[tokio::test]
    async fn a_window_beyond_eight_mebibytes_is_refused() {
        // A frame header that asks for 128 MiB: magic, descriptor, window descriptor (exponent 17, mantissa 0).
        let frame = [0x28, 0xb5, 0x2f, 0xfd, 0x00, 17 << 3, 0x01, 0x00, 0x00];
        assert!(decode(Coding::Zstd, &frame, 100).await.is_err());
        let small = [0x28, 0xb5, 0x2f, 0xfd, 0x00, 10 << 3, 0x01, 0x00, 0x00];
        assert_eq!(decode(Coding::Zstd, &small, 100).await, Ok(Vec::new()));
    }
}
