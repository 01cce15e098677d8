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
    sample::{Number, Shown},
};
use crate::{Error, crs::Crs, resample::Affine};

/// A raster of classes whose head was read.
pub(crate) struct ClassRaster<'a> {
    bytes: &'a [u8],
    big_endian: bool,
    layout: Layout,
    /// Images that are zero where the file leaves its classes out.
    masks: Vec<Layout>,
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
        let masks = masks(&mut file, &layout)?;
        Ok(ClassRaster { bytes, big_endian: file.big_endian, layout, masks, nodata, affine, crs })
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
        let refuse_many = |rows: usize, columns: usize| {
            let (rows, columns) = (rows as u64, columns as u64);
            let too_many = Error::TooManyCells { rows, columns, limit: most };
            if rows.saturating_mul(columns) > most { Err(too_many) } else { Ok(()) }
        };
        refuse_many(rows.len(), columns.len())?;
        for layout in self.masks.iter().chain([&self.layout]) {
            refuse_many(layout.block_rows.min(layout.rows), layout.block_columns)?;
        }
        let window = (rows, columns);
        let samples = self.samples(&self.layout, 0, &window, f64::NAN)?;
        let known =
            samples.into_iter().map(|sample| (!sample.is_nan()).then(|| self.class(sample)).flatten());
        let mut classes: Vec<Option<i64>> = known.collect();
        let alpha = masks::alpha_band(&self.layout).map(|band| (&self.layout, band));
        for (layout, band) in self.masks.iter().map(|mask| (mask, 0)).chain(alpha) {
            // A block of a mask that was never written is zero, as GDAL has it.
            let shown = self.samples(layout, band, &window, Shown(false))?;
            let hidden = classes.iter_mut().zip(shown).filter(|(_, shown)| !shown.0);
            hidden.for_each(|(class, _)| *class = None);
        }
        Ok(classes)
    }

    /// The samples of a band in a window, row-major; `absent` where a block was never written.
    fn samples<T: Number + Default>(
        &self,
        layout: &Layout,
        number: usize,
        (rows, columns): &(Range<usize>, Range<usize>),
        absent: T,
    ) -> Result<Vec<T>, Error> {
        let (height, width) = (layout.block_rows.min(layout.rows), layout.block_columns);
        let band = Band { file: self.bytes, big_endian: self.big_endian, layout, band: number };
        let mut window = vec![absent; rows.len() * columns.len()];
        for down in rows.start / height..rows.end.div_ceil(height) {
            for across in columns.start / width..columns.end.div_ceil(width) {
                let block = layout.blocks_of(number)[down * layout.across() + across];
                if is_absent(block) {
                    continue;
                }
                let (top, left) = (down * height, across * width);
                let size = [height.min(layout.rows - top), width.min(layout.columns - left)];
                let samples: Vec<T> = band.block(block, size)?;
                for row in top.max(rows.start)..(top + size[0]).min(rows.end) {
                    for column in left.max(columns.start)..(left + size[1]).min(columns.end) {
                        let at = (row - rows.start) * columns.len() + column - columns.start;
                        window[at] = samples[(row - top) * size[1] + column - left];
                    }
                }
            }
        }
        Ok(window)
    }

    /// The class that a sample stands for. Whole numbers of 53 bits are exact in double precision.
    fn class(&self, sample: f64) -> Option<i64> {
        let is_marked = self.nodata.is_some_and(|nodata| nodata.marks(sample));
        (!is_marked).then_some(sample as i64)
    }
}

/// The masks within a file, of the size of its classes.
fn masks(file: &mut TiffFile<'_>, layout: &Layout) -> Result<Vec<Layout>, Error> {
    let of_size = |mask: Layout| {
        if (mask.columns, mask.rows) == (layout.columns, layout.rows) {
            return Ok(mask);
        }
        let found = format!("a mask of {} × {} pixels", mask.columns, mask.rows);
        Err(Error::TiffSamples { found })
    };
    let length = file.bytes.len() as u64;
    let mut masks = Vec::new();
    for index in file.masks()? {
        let mask = of_size(Layout::read(&mut file.tags(index))?)?;
        if !mask.is_absent(0) {
            mask.refuse_truncation(0, length)?;
        }
        masks.push(mask);
    }
    Ok(masks)
}
