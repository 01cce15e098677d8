//! GeoTIFF elevation: one band of integers or floats, north up, in projected metres.
//!
//! The `tiff` crate decodes the image; the tags that place it on the ground (OGC GeoTIFF 1.1) are read here, and written for
//! rasters of whatever else there is by cell.

use std::io::Cursor;

use tiff::{
    ColorType,
    decoder::{Decoder, DecodingResult},
    encoder::{Compression, DeflateLevel, TiffEncoder, colortype::Gray32Float},
    tags::Tag,
};

use super::ascii::south_up;
use crate::{Error, Grid, Terrain};

type TiffDecoder<'a> = Decoder<Cursor<&'a [u8]>>;

/// Most bytes that one byte of a compressed TIFF can stand for; LZW reaches about 2700, deflate 1032.
const LARGEST_COMPRESSION: u64 = 4096;

/// Reads a GeoTIFF elevation model of at most so many cells. Samples that are NaN are unknown ground, as GIS programs
/// write it, with or without a nodata tag.
///
/// # Errors
/// A missing or unusable tag by name, truncation, or an elevation out of range by cell.
pub fn read(bytes: &[u8], most_cells: u64) -> Result<Terrain, Error> {
    let mut decoder = Decoder::new(Cursor::new(bytes))?;
    let (columns, rows) = decoder.dimensions()?;
    if u64::from(columns) * u64::from(rows) > most_cells {
        let (rows, columns) = (u64::from(rows), u64::from(columns));
        return Err(Error::TooManyCells { rows, columns, limit: most_cells });
    }
    let frame = Frame::read(&mut decoder)?;
    let north_m = frame.north_west_m[1];
    let origin_m = [frame.north_west_m[0], north_m - f64::from(rows) * frame.cell_size_m];
    let grid = Terrain::check_size(u64::from(rows), u64::from(columns), frame.cell_size_m, origin_m)?;
    refuse_truncation(&mut decoder, bytes.len() as u64, u64::from(rows) * u64::from(columns))?;
    let nodata = nodata(&mut decoder)?;
    let mut from_north = read_samples(&mut decoder, rows as usize, columns as usize)?;
    for z in &mut from_north {
        if nodata.is_some_and(|mark| marks_nodata(*z, mark)) {
            *z = f64::NAN;
        }
    }
    Terrain::new(grid, &south_up(&grid, &from_north))
}

/// Number of cells of a GeoTIFF, as its head has it.
///
/// # Errors
/// A file that is no TIFF.
pub fn cells(bytes: &[u8]) -> Result<u64, Error> {
    let (columns, rows) = Decoder::new(Cursor::new(bytes))?.dimensions()?;
    Ok(u64::from(columns) * u64::from(rows))
}

/// Writes a raster of single-precision numbers, by cell and row-major from the south, in the frame that [`read`] takes: north
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
    tags.write_tag(Tag::GeoKeyDirectoryTag, &GeoKeys::PROJECTED_METRES[..])?;
    tags.write_tag(Tag::GdalNodata, "nan")?;
    let from_north: Vec<f32> = values.chunks(grid.columns).rev().flatten().copied().collect();
    image.write_data(&from_north)?;
    Ok(file.into_inner())
}

/// Where the raster lies: north-west corner and cell size.
struct Frame {
    north_west_m: [f64; 2],
    cell_size_m: f64,
}

impl Frame {
    fn read(decoder: &mut TiffDecoder<'_>) -> Result<Self, Error> {
        let keys = GeoKeys::read(decoder)?;
        keys.refuse_other_than_projected_metres()?;
        let (corner, scale_m) = match decoder.find_tag(Tag::ModelTransformationTag)? {
            Some(value) => Self::from_transformation(&value.into_f64_vec()?)?,
            None => Self::from_tie_point(decoder)?,
        };
        if (scale_m[0] - scale_m[1]).abs() > 1e-6 * scale_m[0].abs() {
            return Err(Error::TiffFrame {
                what: "pixel height",
                value: scale_m[1],
                expected: "the pixel width",
            });
        }
        let half_m = if keys.pixel_is_point() { scale_m[0] / 2.0 } else { 0.0 };
        Ok(Frame { north_west_m: [corner[0] - half_m, corner[1] + half_m], cell_size_m: scale_m[0] })
    }

    fn from_tie_point(decoder: &mut TiffDecoder<'_>) -> Result<([f64; 2], [f64; 2]), Error> {
        let numbers = |decoder: &mut TiffDecoder<'_>, tag, name, count| -> Result<Vec<f64>, Error> {
            let value = decoder.find_tag(tag)?.ok_or(Error::TiffTag { tag: name })?.into_f64_vec()?;
            if value.len() < count { Err(Error::TiffTag { tag: name }) } else { Ok(value) }
        };
        let scale = numbers(decoder, Tag::ModelPixelScaleTag, "ModelPixelScale", 2)?;
        let tie = numbers(decoder, Tag::ModelTiepointTag, "ModelTiepoint", 5)?;
        // Raster position (i, j) of the tie point lies at (x, y); the raster runs east and south.
        Ok(([tie[3] - tie[0] * scale[0], tie[4] + tie[1] * scale[1]], [scale[0], scale[1]]))
    }

    fn from_transformation(m: &[f64]) -> Result<([f64; 2], [f64; 2]), Error> {
        let &[dx, skew_x, _, x, skew_y, dy, _, y, ..] = m else {
            return Err(Error::TiffTag { tag: "ModelTransformation" });
        };
        for value in [skew_x, skew_y] {
            if value != 0.0 {
                return Err(Error::TiffFrame { what: "rotation", value, expected: "0" });
            }
        }
        Ok(([x, y], [dx, -dy]))
    }
}

/// The entries of the GeoKey directory that hold short values, and the unit size among its doubles.
struct GeoKeys {
    shorts: Vec<(u16, u16)>,
    linear_unit_m: Option<f64>,
}

impl GeoKeys {
    const MODEL_TYPE: u16 = 1024;
    const RASTER_TYPE: u16 = 1025;
    const PROJECTION: u16 = 3072;
    const LINEAR_UNITS: u16 = 3076;
    const LINEAR_UNIT_SIZE: u16 = 3077;
    const VERTICAL_UNITS: u16 = 4099;
    /// A directory that says: projected, a pixel is an area, some frame of the user's, in metres.
    #[rustfmt::skip]
    const PROJECTED_METRES: [u16; 20] = [
        1, 1, 0, 4,
        Self::MODEL_TYPE, 0, 1, 1,
        Self::RASTER_TYPE, 0, 1, 1,
        Self::PROJECTION, 0, 1, 32767,
        Self::LINEAR_UNITS, 0, 1, 9001,
    ];

    fn read(decoder: &mut TiffDecoder<'_>) -> Result<Self, Error> {
        let directory = match decoder.find_tag(Tag::GeoKeyDirectoryTag)? {
            Some(value) => value.into_u16_vec()?,
            None => Vec::new(),
        };
        let entries = || directory.get(4..).unwrap_or_default().chunks_exact(4);
        let doubles = match decoder.find_tag(Tag::GeoDoubleParamsTag)? {
            Some(value) => value.into_f64_vec()?,
            None => Vec::new(),
        };
        let size = entries().find(|e| e[0] == Self::LINEAR_UNIT_SIZE);
        Ok(GeoKeys {
            shorts: entries().filter(|e| e[1] == 0).map(|e| (e[0], e[3])).collect(),
            linear_unit_m: size.and_then(|e| doubles.get(usize::from(e[3])).copied()),
        })
    }

    fn get(&self, key: u16) -> Option<u16> {
        self.shorts.iter().find(|(k, _)| *k == key).map(|(_, value)| *value)
    }

    fn pixel_is_point(&self) -> bool {
        self.get(Self::RASTER_TYPE) == Some(2)
    }

    fn refuse_other_than_projected_metres(&self) -> Result<(), Error> {
        const GEOGRAPHIC: u16 = 2;
        const METRE: u16 = 9001;
        const USER_DEFINED: u16 = 32767;
        if self.get(Self::MODEL_TYPE) == Some(GEOGRAPHIC) {
            let value = f64::from(GEOGRAPHIC);
            return Err(Error::TiffFrame {
                what: "model type (GTModelTypeGeoKey)",
                value,
                expected: "1, projected",
            });
        }
        for (key, what) in [
            (Self::LINEAR_UNITS, "linear unit (ProjLinearUnitsGeoKey)"),
            (Self::VERTICAL_UNITS, "vertical unit (VerticalUnitsGeoKey)"),
        ] {
            match self.get(key) {
                None | Some(METRE | USER_DEFINED) => {}
                Some(unit) => {
                    let value = f64::from(unit);
                    return Err(Error::TiffFrame { what, value, expected: "9001, metres" });
                }
            }
        }
        match self.linear_unit_m {
            None | Some(1.0) => Ok(()),
            Some(value) => Err(Error::TiffFrame {
                what: "linear unit size (ProjLinearUnitSizeGeoKey)",
                value,
                expected: "1 metre",
            }),
        }
    }
}

/// Refuses files that declare more than they can hold, before anything of the declared size is allocated.
fn refuse_truncation(decoder: &mut TiffDecoder<'_>, file_bytes: u64, cells: u64) -> Result<(), Error> {
    let bits: Vec<u64> = decoder.find_tag_unsigned_vec(Tag::BitsPerSample)?.unwrap_or_default();
    let declared_bytes = cells * bits.iter().sum::<u64>().clamp(8, 1024) / 8;
    let mut stored_bytes = 0u64;
    for (offsets, counts) in
        [(Tag::StripOffsets, Tag::StripByteCounts), (Tag::TileOffsets, Tag::TileByteCounts)]
    {
        let offsets: Vec<u64> = decoder.find_tag_unsigned_vec(offsets)?.unwrap_or_default();
        let counts: Vec<u64> = decoder.find_tag_unsigned_vec(counts)?.unwrap_or_default();
        for (offset, count) in offsets.iter().zip(&counts) {
            if offset.checked_add(*count).is_none_or(|end| end > file_bytes) {
                return Err(Error::TiffTruncated { declared_bytes, file_bytes });
            }
            stored_bytes += count;
        }
    }
    if declared_bytes > stored_bytes.min(file_bytes).saturating_mul(LARGEST_COMPRESSION) {
        return Err(Error::TiffTruncated { declared_bytes, file_bytes });
    }
    Ok(())
}

fn nodata(decoder: &mut TiffDecoder<'_>) -> Result<Option<f64>, Error> {
    let Some(value) = decoder.find_tag(Tag::GdalNodata)? else { return Ok(None) };
    let text = value.into_string()?;
    Ok(text.trim_matches(|c: char| c.is_whitespace() || c == '\0').parse().ok())
}

/// Whether a sample is the nodata mark, which writers round in their own ways.
fn marks_nodata(z: f64, mark: f64) -> bool {
    z == mark || (mark.is_finite() && (z - mark).abs() <= mark.abs() * 1e-6)
}

/// All samples, northernmost row first.
fn read_samples(decoder: &mut TiffDecoder<'_>, rows: usize, columns: usize) -> Result<Vec<f64>, Error> {
    match decoder.colortype()? {
        ColorType::Gray(8 | 16 | 32 | 64) => {}
        other => return Err(Error::TiffSamples { found: format!("{other:?} samples") }),
    }
    let mut samples = vec![f64::NAN; rows * columns];
    let (chunk_width, chunk_height) = decoder.chunk_dimensions();
    let across = columns.div_ceil(chunk_width as usize);
    let down = rows.div_ceil(chunk_height as usize);
    for index in 0..across * down {
        let Ok(chunk) = u32::try_from(index) else { break };
        let (width, height) = decoder.chunk_data_dimensions(chunk);
        let values = as_f64(decoder.read_chunk(chunk)?);
        if values.len() != width as usize * height as usize {
            let found = format!("{} samples in a chunk of {width} × {height}", values.len());
            return Err(Error::TiffSamples { found });
        }
        let left = (index % across) * chunk_width as usize;
        let top = (index / across) * chunk_height as usize;
        for (y, line) in values.chunks(width as usize).take(height as usize).enumerate() {
            let start = (top + y) * columns + left;
            if let Some(target) = samples.get_mut(start..start + line.len()) {
                target.copy_from_slice(line);
            }
        }
    }
    Ok(samples)
}

fn as_f64(samples: DecodingResult) -> Vec<f64> {
    fn wide<T: Into<f64>>(values: Vec<T>) -> Vec<f64> {
        values.into_iter().map(Into::into).collect()
    }
    match samples {
        DecodingResult::U8(v) => wide(v),
        DecodingResult::U16(v) => wide(v),
        DecodingResult::U32(v) => wide(v),
        DecodingResult::I8(v) => wide(v),
        DecodingResult::I16(v) => wide(v),
        DecodingResult::I32(v) => wide(v),
        DecodingResult::F32(v) => wide(v),
        DecodingResult::F64(v) => v,
        DecodingResult::U64(v) => v.into_iter().map(|z| z as f64).collect(),
        DecodingResult::I64(v) => v.into_iter().map(|z| z as f64).collect(),
        DecodingResult::F16(v) => v.into_iter().map(|z| f64::from(z.to_f32())).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cell;

    #[test]
    fn a_raster_that_was_written_lies_where_it_did_and_holds_what_it_held() {
        let grid = Grid { rows: 3, columns: 5, cell_size_m: 0.5, origin_m: [500_000.0, 4_649_776.5] };
        let values: Vec<f32> = (0..15).map(|i| if i == 7 { f32::NAN } else { i as f32 * 1.5 }).collect();
        let terrain = read(&write(&grid, &values).unwrap(), 15).unwrap();
        assert_eq!(terrain.grid, grid);
        for (index, value) in values.iter().enumerate() {
            let held = terrain.elevation_m(grid.cell(index));
            assert_eq!(held, (!value.is_nan()).then_some(f64::from(*value)));
        }
        assert_eq!(terrain.elevation_m(Cell { row: 1, column: 2 }), None);
    }
}
