//! Cells that a file leaves out: mask images beside the elevation, and alpha bands.

use super::{
    directory::TiffFile,
    layout::Layout,
    raster::Band,
    sample::{Number, Shown},
};
use crate::Error;

/// ExtraSamples of an alpha band, multiplied into the others or not.
const ALPHA: [u64; 2] = [1, 2];

/// The alpha band of an image, if it has one.
pub(super) fn alpha_band(layout: &Layout) -> Option<usize> {
    let first_extra = layout.bands.checked_sub(layout.extra.len())?;
    layout.extra.iter().position(|kind| ALPHA.contains(kind)).map(|position| first_extra + position)
}

/// Marks as NaN what an alpha band, a mask image of the same size or a mask file beside it leaves out.
///
/// # Errors
/// A mask of another size, or one that cannot be decoded.
pub(super) fn apply<T: Number>(
    file: &mut TiffFile<'_>,
    layout: &Layout,
    beside: Option<&[u8]>,
    samples: &mut [T],
) -> Result<(), Error> {
    if let Some(alpha) = alpha_band(layout) {
        hide(samples, file, layout, alpha)?;
    }
    for index in file.masks()? {
        let mask = Layout::read(&mut file.tags(index))?;
        if (mask.columns, mask.rows) != (layout.columns, layout.rows) {
            let found = format!("a mask of {} × {} pixels", mask.columns, mask.rows);
            return Err(Error::TiffSamples { found });
        }
        hide(samples, file, &mask, 0)?;
    }
    beside.map_or(Ok(()), |bytes| apply_file(bytes, layout, samples))
}

/// The same of a mask file (`.msk`), which is a TIFF of its own.
fn apply_file<T: Number>(bytes: &[u8], layout: &Layout, samples: &mut [T]) -> Result<(), Error> {
    let refused = |why: String| Error::MaskFile { why };
    let mut file = TiffFile::open(bytes).map_err(|error| refused(error.to_string()))?;
    let (image, _) = file.main_image().map_err(|error| refused(error.to_string()))?;
    let mask = Layout::read(&mut file.tags(image)).map_err(|error| refused(error.to_string()))?;
    if (mask.columns, mask.rows) != (layout.columns, layout.rows) {
        let (columns, rows) = (mask.columns, mask.rows);
        return Err(refused(format!(
            "it has {columns} × {rows} pixels, the map {} × {}",
            layout.columns, layout.rows
        )));
    }
    hide(samples, &file, &mask, 0).map_err(|error| refused(error.to_string()))
}

fn hide<T: Number>(
    samples: &mut [T],
    file: &TiffFile<'_>,
    layout: &Layout,
    band: usize,
) -> Result<(), Error> {
    let band = Band { file: file.bytes, big_endian: file.big_endian, layout, band };
    // A block of a mask that was never written is zero, as GDAL has it.
    let shown = if layout.is_absent(band.band) {
        vec![Shown(false); samples.len()]
    } else {
        layout.refuse_truncation(band.band, file.bytes.len() as u64)?;
        band.read(Shown(false))?
    };
    let hidden = samples.iter_mut().zip(shown).filter(|(_, shown)| !shown.0);
    hidden.for_each(|(sample, _)| *sample = T::from_single(f32::NAN));
    Ok(())
}
