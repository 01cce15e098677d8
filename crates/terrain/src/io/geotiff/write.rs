//! Rasters written as GeoTIFF, in the frame that the reader takes as it is.

use std::io::Cursor;

use tiff::{
    encoder::{Compression, DeflateLevel, TiffEncoder, colortype::Gray32Float},
    tags::Tag,
};

use super::geokeys::PROJECTED_METRES;
use crate::{Error, Grid, Terrain};

/// Writes a raster of single-precision numbers, by cell and row-major from the south, in the frame that [`super::read`] takes: north
/// up, projected metres, NaN where there is nothing.
///
/// # Errors
/// More cells than a TIFF can hold.
pub fn write(grid: &Grid, values: &[f32]) -> Result<Vec<u8>, Error> {
    let north_m = grid.far_corner_m()[1];
    let too_many = |_| {
        let (rows, columns) = (grid.rows as u64, grid.columns as u64);
        Error::TooManyCells { rows, columns, limit: Terrain::MAX_CELLS }
    };
    let columns = u32::try_from(grid.columns).map_err(too_many)?;
    let rows = u32::try_from(grid.rows).map_err(too_many)?;
    let mut file = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut file)?.with_compression(Compression::Deflate(DeflateLevel::Fast));
    let mut image = encoder.new_image::<Gray32Float>(columns, rows)?;
    let tags = image.encoder();
    tags.write_tag(Tag::ModelPixelScaleTag, &[grid.cell_size_m, grid.cell_size_m, 0.0][..])?;
    tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, grid.origin_m[0], north_m, 0.0][..])?;
    tags.write_tag(Tag::GeoKeyDirectoryTag, &PROJECTED_METRES[..])?;
    tags.write_tag(Tag::GdalNodata, "nan")?;
    let from_north: Vec<f32> = values.chunks(grid.columns).rev().flatten().copied().collect();
    image.write_data(&from_north)?;
    Ok(file.into_inner())
}
