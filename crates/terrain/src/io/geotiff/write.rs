//! Rasters written as GeoTIFF, in the frame that the reader takes as it is.

use std::io::Cursor;

use tiff::{
    encoder::{Compression, DeflateLevel, TiffEncoder, colortype::Gray32Float},
    tags::Tag,
};

use super::system_keys::SystemKeys;
use crate::{Error, Grid, Terrain};

/// Writes a raster of single-precision numbers, by cell and row-major from the south, in the frame that [`super::read`] takes: north
/// up, NaN where there is nothing, in the map's `crs`. Coordinates are in the unit of that system, metres where nothing says another.
///
/// # Errors
/// More cells than a TIFF can hold.
pub fn write(grid: &Grid, values: &[f32], crs: Option<&str>) -> Result<Vec<u8>, Error> {
    let system = SystemKeys::of(crs);
    let north_m = grid.far_corner_m()[1];
    let in_unit = |length_m: f64| length_m / system.unit_m;
    let edge = in_unit(grid.cell_size_m);
    let corner = [in_unit(grid.origin_m[0]), in_unit(north_m)];
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
    tags.write_tag(Tag::ModelPixelScaleTag, &[edge, edge, 0.0][..])?;
    tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, corner[0], corner[1], 0.0][..])?;
    tags.write_tag(Tag::GeoKeyDirectoryTag, &system.directory[..])?;
    if let Some(citation) = &system.citation {
        tags.write_tag(Tag::GeoAsciiParamsTag, citation.as_str())?;
    }
    tags.write_tag(Tag::GdalNodata, "nan")?;
    let from_north: Vec<f32> = values.chunks(grid.columns).rev().flatten().copied().collect();
    image.write_data(&from_north)?;
    Ok(file.into_inner())
}
