//! How the samples of an image are laid out in a file: its blocks (strips or tiles), bands and compression.

use tiff::tags::Tag;

use super::{
    codec::Compression,
    directory::Tags,
    sample::{Predictor, SampleType},
};
use crate::Error;

/// Longest row of a block in bytes: 8192 samples of 64 bits in 1024 bands, far more than any writer makes.
const LONGEST_ROW_BYTES: u64 = 1 << 26;

/// The samples of one image and where they lie.
pub(super) struct Layout {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) block_columns: usize,
    pub(super) block_rows: usize,
    /// Samples of a pixel.
    pub(super) bands: usize,
    /// Whether each band has blocks of its own.
    pub(super) planar: bool,
    pub(super) sample: SampleType,
    pub(super) predictor: Predictor,
    pub(super) compression: Compression,
    /// PhotometricInterpretation.
    pub(super) photometric: u64,
    /// ExtraSamples: the kinds of the bands beyond those of the photometric interpretation.
    pub(super) extra: Vec<u64>,
    /// Offset and length of each block [bytes].
    pub(super) blocks: Vec<(u64, u64)>,
}

impl Layout {
    /// Reads and checks the layout; nothing of the declared size is allocated.
    pub(super) fn read(tags: &mut Tags<'_, '_>) -> Result<Self, Error> {
        let (columns, rows) = dimensions(tags)?;
        let bands = tags.unsigned(Tag::SamplesPerPixel)?.unwrap_or(1).max(1) as usize;
        let sample = SampleType::read(
            &tags.unsigned_list(Tag::BitsPerSample)?,
            &tags.unsigned_list(Tag::SampleFormat)?,
        )?;
        let compression = Compression::read(tags)?;
        let predictor = Predictor::read(tags.unsigned(Tag::Predictor)?, sample)?;
        if tags.unsigned(Tag::FillOrder)?.unwrap_or(1) != 1 {
            return Err(Error::TiffSamples { found: "bytes with their bits reversed (FillOrder 2)".into() });
        }
        let planar = tags.unsigned(Tag::PlanarConfiguration)?.unwrap_or(1) == 2;
        let tiled = tags.unsigned(Tag::TileWidth)?.is_some();
        let (offsets, counts, block_columns, block_rows) = if tiled {
            let width = tags.unsigned(Tag::TileWidth)?.unwrap_or(0);
            let height = tags.unsigned(Tag::TileLength)?.unwrap_or(0);
            (Tag::TileOffsets, Tag::TileByteCounts, width, height)
        } else {
            let height = tags.unsigned(Tag::RowsPerStrip)?.unwrap_or(rows as u64).min(rows as u64);
            (Tag::StripOffsets, Tag::StripByteCounts, columns as u64, height)
        };
        let offsets = tags.unsigned_list(offsets)?;
        let counts = tags.unsigned_list(counts)?;
        let row_bytes =
            block_columns.saturating_mul(bands as u64).saturating_mul(u64::from(sample.bits())) / 8;
        if block_columns == 0 || block_rows == 0 || row_bytes > LONGEST_ROW_BYTES {
            let found = format!("blocks of {block_columns} × {block_rows} pixels in {bands} bands");
            return Err(Error::TiffSamples { found });
        }
        let layout = Layout {
            columns,
            rows,
            block_columns: block_columns as usize,
            // A block may reach beyond the image, by less than its own height.
            block_rows: usize::try_from(block_rows).unwrap_or(usize::MAX),
            bands,
            planar,
            sample,
            predictor,
            compression,
            photometric: tags.unsigned(Tag::PhotometricInterpretation)?.unwrap_or(1),
            extra: tags.unsigned_list(Tag::ExtraSamples)?,
            blocks: offsets.into_iter().zip(counts).collect(),
        };
        let needed =
            layout.across().saturating_mul(layout.down()).saturating_mul(if planar { bands } else { 1 });
        if layout.blocks.len() < needed {
            let found = format!("{} blocks where its size needs {needed}", layout.blocks.len());
            return Err(Error::TiffSamples { found });
        }
        Ok(layout)
    }

    /// Number of blocks side by side.
    pub(super) fn across(&self) -> usize {
        self.columns.div_ceil(self.block_columns)
    }

    /// Number of blocks one above the other.
    pub(super) fn down(&self) -> usize {
        self.rows.div_ceil(self.block_rows)
    }

    /// Number of cells.
    pub(super) fn cells(&self) -> u64 {
        self.columns as u64 * self.rows as u64
    }

    /// Samples that lie between neighbours of a row within a block.
    pub(super) fn samples_per_pixel(&self) -> usize {
        if self.planar { 1 } else { self.bands }
    }

    /// Bytes of a block's row as it lies uncompressed in the file.
    pub(super) fn row_bytes(&self) -> usize {
        let bits = usize::from(self.sample.bits());
        (self.block_columns * self.samples_per_pixel() * bits).div_ceil(8)
    }

    /// The blocks of a band, row-major.
    pub(super) fn blocks_of(&self, band: usize) -> &[(u64, u64)] {
        let each = self.across() * self.down();
        let first = if self.planar { band * each } else { 0 };
        self.blocks.get(first..first + each).unwrap_or_default()
    }

    /// Number of a band's blocks that were never written.
    pub(super) fn count_absent(&self, band: usize) -> usize {
        self.blocks_of(band).iter().filter(|block| is_absent(**block)).count()
    }

    /// Whether nothing of a band was ever written.
    pub(super) fn is_absent(&self, band: usize) -> bool {
        self.count_absent(band) == self.blocks_of(band).len()
    }

    /// Refuses files that declare more than they can hold, before anything of the declared size is allocated.
    pub(super) fn refuse_truncation(&self, band: usize, file_bytes: u64) -> Result<(), Error> {
        let bits = u64::from(self.sample.bits()) * self.samples_per_pixel() as u64;
        let declared_bytes = self.cells().saturating_mul(bits) / 8;
        let truncated = Error::TiffTruncated { declared_bytes, file_bytes };
        let mut stored_bytes = 0u64;
        let mut sparse = false;
        for &(offset, count) in self.blocks_of(band) {
            if offset.checked_add(count).is_none_or(|end| end > file_bytes) {
                return Err(truncated);
            }
            sparse |= is_absent((offset, count));
            stored_bytes = stored_bytes.saturating_add(count);
        }
        // What was not written is told by its absence; the whole file bounds how much that can be.
        let held_bytes = if sparse { file_bytes } else { stored_bytes.min(file_bytes) };
        let most = self.compression.largest_ratio().max(if sparse { Compression::SPARSE_RATIO } else { 1 });
        if self.is_absent(band) {
            return Err(Error::AllUnknown);
        }
        if declared_bytes > held_bytes.saturating_mul(most) { Err(truncated) } else { Ok(()) }
    }
}

/// Whether a block was never written (GDAL's SPARSE_OK).
pub(super) fn is_absent((offset, count): (u64, u64)) -> bool {
    offset == 0 && count == 0
}

/// Columns and rows of an image.
pub(super) fn dimensions(tags: &mut Tags<'_, '_>) -> Result<(usize, usize), Error> {
    let mut side = |tag, name, field| -> Result<usize, Error> {
        let value = tags.unsigned(tag)?.ok_or(Error::TiffTag { tag: name })?;
        match u32::try_from(value) {
            Ok(0) | Err(_) => Err(Error::Empty { field, value }),
            Ok(value) => Ok(value as usize),
        }
    };
    Ok((side(Tag::ImageWidth, "ImageWidth", "columns")?, side(Tag::ImageLength, "ImageLength", "rows")?))
}
