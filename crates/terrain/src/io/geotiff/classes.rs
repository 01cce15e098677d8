//! Rasters of classes, as land cover: whole numbers that stand for kinds of ground, of which only the part over a map is read.

use std::ops::Range;

use super::{
    directory::TiffFile,
    geokeys::GeoKeys,
    layout::{Layout, dimensions, is_absent},
    masks,
    metadata::NoData,
    own_affine,
    raster::Band,
};
use crate::{Error, crs::Crs, resample::Affine};

/// A raster of classes whose head was read.
pub(crate) struct ClassRaster<'a> {
    bytes: &'a [u8],
    big_endian: bool,
    layout: Layout,
    nodata: Option<NoData>,
    /// From pixels to coordinates in the unit of the raster's system.
    pub(crate) affine: Affine,
    pub(crate) crs: Crs,
}

impl<'a> ClassRaster<'a> {
    /// Reads the head of a GeoTIFF of classes.
    ///
    /// # Errors
    /// A missing or unusable property by name; samples that are no whole numbers of one band.
    pub(crate) fn open(bytes: &'a [u8]) -> Result<Self, Error> {
        let mut file = TiffFile::open(bytes)?;
        let (image, _) = file.main_image()?;
        dimensions(&mut file.tags(image))?;
        let layout = Layout::read(&mut file.tags(image))?;
        let bands = layout.bands - usize::from(masks::alpha_band(&layout).is_some());
        let is_plain = matches!(layout.photometric, 0 | 1 | 3) && bands == 1 && !layout.sample.is_float();
        if !is_plain {
            let found = "no classes, which are whole numbers of one band (`gdal_translate -b 1 -ot Byte in.tif out.tif`)";
            return Err(Error::TiffSamples { found: found.into() });
        }
        layout.refuse_truncation(0, bytes.len() as u64)?;
        let keys = GeoKeys::read(&mut file.tags(image))?;
        let crs = keys.crs(&mut Vec::new())?;
        let affine = own_affine(&mut file, image, &keys)?;
        let nodata = NoData::read(&mut file.tags(image), layout.sample)?;
        Ok(ClassRaster { bytes, big_endian: file.big_endian, layout, nodata, affine, crs })
    }

    /// Columns and rows.
    pub(crate) fn size(&self) -> [usize; 2] {
        [self.layout.columns, self.layout.rows]
    }

    /// The classes of a window, row-major in the order of the file's rows; `None` where the file knows none. At most `most` pixels are
    /// held at once.
    ///
    /// # Errors
    /// A block that ends early or is damaged, or too large a window.
    pub(crate) fn window(
        &self,
        rows: Range<usize>,
        columns: Range<usize>,
        most: u64,
    ) -> Result<Vec<Option<i64>>, Error> {
        let layout = &self.layout;
        let refuse_many = |rows: usize, columns: usize| {
            let (rows, columns) = (rows as u64, columns as u64);
            let too_many = Error::TooManyCells { rows, columns, limit: most };
            if rows.saturating_mul(columns) > most { Err(too_many) } else { Ok(()) }
        };
        refuse_many(rows.len(), columns.len())?;
        let (height, width) = (layout.block_rows.min(layout.rows), layout.block_columns);
        refuse_many(height, width)?;
        let band = Band { file: self.bytes, big_endian: self.big_endian, layout, band: 0 };
        let mut classes = vec![None; rows.len() * columns.len()];
        for down in rows.start / height..rows.end.div_ceil(height) {
            for across in columns.start / width..columns.end.div_ceil(width) {
                let block = layout.blocks_of(0)[down * layout.across() + across];
                let (top, left) = (down * height, across * width);
                let size = [height.min(layout.rows - top), width.min(layout.columns - left)];
                let samples = if is_absent(block) { None } else { Some(band.block(block, size)?) };
                for row in top.max(rows.start)..(top + size[0]).min(rows.end) {
                    for column in left.max(columns.start)..(left + size[1]).min(columns.end) {
                        let sample = samples
                            .as_ref()
                            .map(|samples: &Vec<f64>| samples[(row - top) * size[1] + column - left]);
                        let at = (row - rows.start) * columns.len() + column - columns.start;
                        classes[at] = sample.and_then(|sample| self.class(sample));
                    }
                }
            }
        }
        Ok(classes)
    }

    /// The class that a sample stands for. Whole numbers of 53 bits are exact in double precision.
    fn class(&self, sample: f64) -> Option<i64> {
        let is_marked = self.nodata.is_some_and(|nodata| nodata.marks(sample));
        (!is_marked).then_some(sample as i64)
    }
}
