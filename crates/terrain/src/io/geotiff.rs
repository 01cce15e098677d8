//! GeoTIFF elevation as files are: what a file says is honoured, or refused by name.
//!
//! The `tiff` crate reads the directories; tags that say how samples are laid out (`layout`), compressed (`codec`), predicted and typed
//! (`sample`), masked (`masks`) and scaled (`metadata`), and where they lie (`geokeys`, `frame`, `placement`), are read here.

mod aux_xml;
mod classes;
mod codec;
mod directory;
mod frame;
mod geokeys;
mod layout;
mod lerc;
mod masks;
mod metadata;
mod own_system;
mod placement;
mod raster;
mod sample;
mod sidecars;
mod system_keys;
mod write;

use rayon::prelude::*;

pub(crate) use self::classes::ClassRaster;
use self::{
    directory::TiffFile,
    geokeys::GeoKeys,
    layout::{Layout, dimensions},
    metadata::NoData,
    placement::{Arrangement, Placement},
    raster::Band,
    sample::Number,
};
pub use self::{sidecars::Sidecars, write::write};
use crate::{
    Error, Terrain, Warning, WarningKind,
    crs::{Crs, Size, Unwarped},
    io::heights::{BandMetadata, Heights},
    resample::Affine,
    samples::Sample,
};

/// Reads a GeoTIFF elevation model of at most so many cells.
///
/// Scale, offset, unit, nodata, masks and coordinate reference system are applied as GDAL applies them; samples that are NaN are
/// unknown ground. What had to be assumed or changed stands in [`Terrain::warnings`].
///
/// # Errors
/// A missing or unusable property by name, truncation, or an elevation out of range by cell.
pub fn read(bytes: &[u8], most_cells: u64) -> Result<Terrain, Error> {
    read_unwarped(bytes, most_cells, &Sidecars::default())?.warped()
}

/// Reads a GeoTIFF as [`read`] does, with the files beside it, but for the warp of one in degrees.
///
/// # Errors
/// As [`read`].
pub(crate) fn read_unwarped(bytes: &[u8], most_cells: u64, beside: &Sidecars) -> Result<Unwarped, Error> {
    let mut file = TiffFile::open(bytes)?;
    let (image, others) = file.main_image()?;
    let (columns, rows) = dimensions(&mut file.tags(image))?;
    let refuse_many = |columns: u64, rows: u64| {
        let too_many = Error::TooManyCells { rows, columns, limit: most_cells };
        if columns.saturating_mul(rows) > most_cells { Err(too_many) } else { Ok(()) }
    };
    refuse_many(columns as u64, rows as u64)?;
    let layout = Layout::read(&mut file.tags(image))?;
    let mut warnings = beside.warnings.clone();
    if others > 0 {
        let detail = format!("the file holds {} images: the first was read", others + 1);
        warnings.push(Warning::new(WarningKind::FirstOfSeveral, detail));
    }
    let band = elevation_band(&layout, &mut warnings)?;
    let keys = GeoKeys::read(&mut file.tags(image))?;
    let crs = system(&keys, beside, &mut warnings)?;
    let is_own = Affine::is_in(&mut file.tags(image))?;
    let affine = beside.affine(own_affine(&mut file, image, &keys), is_own, &mut warnings)?;
    let is_named = keys.name_a_system() || beside.aux.crs.is_some();
    let size = Size { columns, rows };
    let placement = Placement::of(affine, size, (is_named, &crs), most_cells, &mut warnings)?;
    placement.refuse_many(most_cells)?;
    layout.refuse_truncation(band, bytes.len() as u64)?;
    let metadata = beside.aux.over(BandMetadata::read(&mut file.tags(image), band)?)?;
    let heights = Heights::of(&metadata, &crs, "tif", &mut warnings)?;
    let nodata = match &beside.aux.nodata {
        Some(text) => NoData::parse(text, layout.sample)?,
        None => NoData::read(&mut file.tags(image), layout.sample)?,
    };
    let regridding = placement.regridding.clone();
    let reading = Reading { layout, band, nodata, heights, placement, mask: beside.mask.as_deref() };
    let terrain = if reading.layout.sample.is_exact_in_single() {
        reading.terrain::<f32>(&mut file, &mut warnings)?
    } else {
        reading.terrain::<f64>(&mut file, &mut warnings)?
    };
    let terrain = sidecars::joined(warnings).into_iter().fold(terrain, Terrain::with_warning);
    Ok(Unwarped { terrain, regridding, is_of_bytes: false })
}

/// Number of cells of a GeoTIFF, as its head has it; of one in degrees, with those of the grid that it is warped to.
///
/// # Errors
/// A file that is no TIFF.
pub fn cells(bytes: &[u8]) -> Result<u64, Error> {
    let mut file = TiffFile::open(bytes)?;
    let (image, _) = file.main_image()?;
    let (columns, rows) = dimensions(&mut file.tags(image))?;
    let size = Size { columns, rows };
    let keys = GeoKeys::read(&mut file.tags(image))?;
    let crs = keys.crs(&mut Vec::new());
    let Some(crs) = crs.ok().filter(|crs| crs.is_geographic) else { return Ok(size.pixels()) };
    let affine = own_affine(&mut file, image, &keys)?;
    let placement = Placement::of(affine, size, (true, &crs), Terrain::MAX_CELLS, &mut Vec::new());
    Ok(placement.map_or(size.pixels(), |placement| placement.numbers(size)))
}

/// The system by GDAL's metadata beside the file, or by its own keys.
fn system(keys: &GeoKeys, beside: &Sidecars, warnings: &mut Vec<Warning>) -> Result<Crs, Error> {
    let Some(crs) = &beside.aux.crs else { return keys.crs(warnings) };
    let own = keys.crs(&mut Vec::new()).ok().and_then(|own| own.text);
    if let Some(own) = own.filter(|own| crs.text.as_ref() != Some(own)) {
        let detail = format!(
            "the file beside it (.aux.xml) says that the GeoTIFF is in {}, its own keys that it is in {own}: the former was followed, as GDAL does",
            crs.text.as_deref().unwrap_or("another system")
        );
        warnings.push(Warning::new(WarningKind::BesideFile, detail));
    }
    Ok(crs.clone())
}

/// The placement by the file's own tags.
fn own_affine(file: &mut TiffFile<'_>, image: usize, keys: &GeoKeys) -> Result<Affine, Error> {
    let affine = Affine::read(&mut file.tags(image))?;
    Ok(if keys.pixel_is_point() { affine.with_centred_pixels() } else { affine })
}

/// The band that holds elevation: the only one, or the first of several that are no colours.
fn elevation_band(layout: &Layout, warnings: &mut Vec<Warning>) -> Result<usize, Error> {
    let colours = match layout.photometric {
        0 | 1 | 4 => None,
        2 => Some("RGB"),
        3 => Some("palette"),
        5 => Some("CMYK"),
        6 => Some("YCbCr"),
        8..=10 => Some("CIE L*a*b*"),
        _ => Some("unknown"),
    };
    if let Some(colours) = colours {
        let found = format!("colours ({colours}, PhotometricInterpretation {})", layout.photometric);
        return Err(Error::TiffSamples { found });
    }
    let bands = layout.bands - usize::from(masks::alpha_band(layout).is_some());
    if bands > 1 {
        let detail = format!(
            "the file has {bands} bands: the first was read as elevation; `gdal_translate -b N in.tif out.tif` takes another"
        );
        warnings.push(Warning::new(WarningKind::FirstOfSeveral, detail));
    }
    Ok(0)
}

/// What is known of a raster before its samples are read.
struct Reading<'a> {
    layout: Layout,
    band: usize,
    nodata: Option<NoData>,
    heights: Heights,
    placement: Placement,
    /// A mask file beside it.
    mask: Option<&'a [u8]>,
}

impl Reading<'_> {
    fn terrain<T: Number + Sample>(
        self,
        file: &mut TiffFile<'_>,
        warnings: &mut Vec<Warning>,
    ) -> Result<Terrain, Error> {
        let layout = &self.layout;
        let absent = layout.count_absent(self.band);
        // A block that was never written holds nodata, or zero where there is none (GDAL's SPARSE_OK).
        let of_absent = self.nodata.map_or(0.0, |_| f64::NAN);
        if absent > 0 && self.nodata.is_none() {
            let detail = format!(
                "{absent} blocks of the file were never written and hold 0, as GDAL reads them; \
                 `gdal_edit.py -a_nodata 0 FILE` makes unknown ground of them"
            );
            warnings.push(Warning::new(WarningKind::UnwrittenBlocks, detail));
        }
        let band = Band { file: file.bytes, big_endian: file.big_endian, layout, band: self.band };
        let mut samples: Vec<T> = band.read(T::from_double(of_absent))?;
        if let Some(nodata) = self.nodata.filter(|nodata| !nodata.mark.is_nan()) {
            samples.par_iter_mut().with_min_len(layout.columns).for_each(|sample| {
                if nodata.marks((*sample).into()) {
                    *sample = T::from_double(f64::NAN);
                }
            });
        }
        masks::apply(file, layout, self.mask, &mut samples)?;
        let grid = self.placement.grid;
        let Arrangement { rows_from_north, columns_from_east } = self.placement.arrangement;
        from_south_west(&mut samples, layout.columns, rows_from_north, columns_from_east);
        let heights = self.heights;
        let mut terrain = if heights.is_height() {
            Terrain::from_samples(grid, samples, |sample| sample)?
        } else {
            Terrain::from_samples(grid, samples, |sample| heights.height_m(sample))?
        };
        terrain.crs = self.placement.crs;
        Ok(terrain)
    }
}

/// Puts rows and columns into the order of cells, in place.
fn from_south_west<T>(samples: &mut [T], columns: usize, rows_from_north: bool, columns_from_east: bool) {
    if columns_from_east {
        samples.chunks_mut(columns).for_each(<[T]>::reverse);
    }
    if !rows_from_north {
        return;
    }
    let rows = samples.len() / columns;
    let (north, south) = samples.split_at_mut(rows / 2 * columns);
    let from_south = south.chunks_mut(columns).rev();
    north.chunks_mut(columns).zip(from_south).for_each(|(one, other)| one.swap_with_slice(other));
}

/// Whether bytes begin as a TIFF or BigTIFF.
pub fn is_tiff(bytes: &[u8]) -> bool {
    const MAGIC: [&[u8]; 4] = [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"];
    MAGIC.iter().any(|magic| bytes.starts_with(magic))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, Grid};

    #[test]
    fn a_raster_that_was_written_lies_where_it_did_and_holds_what_it_held() {
        let grid = Grid { rows: 3, columns: 5, cell_size_m: 0.5, origin_m: [500_000.0, 4_649_776.5] };
        let values: Vec<f32> = (0..15).map(|i| if i == 7 { f32::NAN } else { i as f32 * 1.5 }).collect();
        let terrain = read(&write(&grid, &values, None).unwrap(), 15).unwrap();
        assert_eq!(terrain.grid, grid);
        assert_eq!(terrain.warnings(), []);
        for (index, value) in values.iter().enumerate() {
            let held = terrain.elevation_m(grid.cell(index));
            assert_eq!(held, (!value.is_nan()).then_some(f64::from(*value)));
        }
        assert_eq!(terrain.elevation_m(Cell { row: 1, column: 2 }), None);
    }
}
