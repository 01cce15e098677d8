//! A band's samples, decoded block by block on all cores.

use std::io::Read;

use rayon::prelude::*;

use super::{
    codec::Compression,
    layout::{Layout, is_absent},
    lerc,
    sample::{Number, RowOrder, convert, restore},
};
use crate::Error;

/// A band of an image and the file it lies in.
pub(super) struct Band<'a> {
    pub(super) file: &'a [u8],
    pub(super) big_endian: bool,
    pub(super) layout: &'a Layout,
    /// Position of the band.
    pub(super) band: usize,
}

impl Band<'_> {
    /// All samples, row-major in the order of the file's rows; blocks that were never written hold `absent`.
    ///
    /// # Errors
    /// A block that ends early or is damaged.
    pub(super) fn read<T: Number>(&self, absent: T) -> Result<Vec<T>, Error> {
        let layout = self.layout;
        let mut samples = vec![absent; layout.columns * layout.rows];
        let across = layout.across();
        // Blocks of the same rows are decoded by one task, which alone writes these rows.
        let rows_of_blocks = samples.par_chunks_mut(layout.block_rows.min(layout.rows) * layout.columns);
        rows_of_blocks.zip(layout.blocks_of(self.band).par_chunks(across)).try_for_each(
            |(rows, blocks)| {
                let mut scratch = Scratch::default();
                for (index, block) in blocks.iter().enumerate() {
                    let left = index * layout.block_columns;
                    let width = layout.block_columns.min(layout.columns - left);
                    if is_absent(*block) {
                        continue;
                    }
                    let rows = rows.chunks_mut(layout.columns).map(|row| &mut row[left..left + width]);
                    match layout.compression {
                        Compression::Lerc(_) => lerc::read(self, *block, absent, rows)?,
                        _ => self.read_block(*block, &mut scratch, rows)?,
                    }
                }
                Ok::<(), Error>(())
            },
        )?;
        Ok(samples)
    }

    /// The samples of one block that was written, row-major, cut off at `size` rows and columns.
    ///
    /// # Errors
    /// A block that ends early or is damaged.
    pub(super) fn block<T: Number + Default>(
        &self,
        block: (u64, u64),
        [rows, columns]: [usize; 2],
    ) -> Result<Vec<T>, Error> {
        let mut samples = vec![T::default(); rows * columns];
        let lines = samples.chunks_mut(columns);
        match self.layout.compression {
            Compression::Lerc(_) => lerc::read(self, block, T::default(), lines)?,
            _ => self.read_block(block, &mut Scratch::default(), lines)?,
        }
        Ok(samples)
    }

    /// The compressed bytes of a block.
    pub(super) fn bytes_of(&self, (offset, count): (u64, u64)) -> Result<&[u8], Error> {
        let (start, end) = (offset, offset.saturating_add(count));
        let range = usize::try_from(start).ok().zip(usize::try_from(end).ok());
        let file_bytes = self.file.len() as u64;
        range
            .and_then(|(start, end)| self.file.get(start..end))
            .ok_or(Error::TiffTruncated { declared_bytes: end, file_bytes })
    }

    /// Position of the band's samples within a pixel.
    pub(super) fn first(&self) -> usize {
        if self.layout.planar { 0 } else { self.band }
    }

    fn read_block<'s, T: Number + 's>(
        &self,
        block: (u64, u64),
        scratch: &mut Scratch,
        mut rows: impl ExactSizeIterator<Item = &'s mut [T]>,
    ) -> Result<(), Error> {
        let layout = self.layout;
        let step = layout.samples_per_pixel();
        let mut reader = layout.compression.open(self.bytes_of(block)?)?;
        let bits = usize::from(layout.sample.bits());
        let order = RowOrder {
            sample_bytes: if bits.is_multiple_of(8) { bits / 8 } else { 1 },
            big_endian: self.big_endian,
            step,
        };
        let row_bytes = layout.row_bytes();
        while rows.len() > 0 {
            let rows_at_once = (PORTION_BYTES / row_bytes.max(1)).clamp(1, rows.len());
            scratch.rows.resize(rows_at_once * row_bytes, 0);
            reader.read_exact(&mut scratch.rows).map_err(|why| Error::TiffBlock { why: why.to_string() })?;
            for (from, to) in scratch.rows.chunks_exact_mut(row_bytes).zip(&mut rows) {
                let samples = restore(from, &mut scratch.spare, layout.predictor, order);
                convert(layout.sample, samples, self.first(), step, to);
            }
        }
        Ok(())
    }
}

/// Bytes decompressed at once, at least one row. A decompressor that ends within one call keeps no window of what it wrote, and
/// blocks of the usual sizes (tiles of 256 doubles) fit; a single strip as large as the image takes no more memory than this.
const PORTION_BYTES: usize = 1 << 19;

/// Room for rows of a block, used again for the next.
#[derive(Default)]
struct Scratch {
    rows: Vec<u8>,
    spare: Vec<u8>,
}
