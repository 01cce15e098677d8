//! Blocks of LERC (Limited Error Raster Compression): each is one blob with a mask of its own.

use std::io::Read;

use lerc::{Sample, bitmask::BitMask};

use super::{
    codec::{Compression, LercPacking},
    raster::Band,
    sample::{Number, SampleType},
};
use crate::Error;

/// Pixels that a block may have if the image has fewer: 2048 × 2048, more than any writer makes.
const LARGEST_BLOCK: u64 = 1 << 22;

/// Reads a block into rows; pixels that its mask leaves out hold NaN if they are floating-point numbers, `absent` otherwise.
pub(super) fn read<'s, T: Number + 's>(
    band: &Band<'_>,
    block: (u64, u64),
    absent: T,
    rows: impl Iterator<Item = &'s mut [T]>,
) -> Result<(), Error> {
    let blob = unpacked(band, block)?;
    match band.layout.sample {
        SampleType::U8 => decoded::<u8, T>(band, &blob, absent, |v| T::from_single(f32::from(v)), rows),
        SampleType::I8 => decoded::<i8, T>(band, &blob, absent, |v| T::from_single(f32::from(v)), rows),
        SampleType::U16 => decoded::<u16, T>(band, &blob, absent, |v| T::from_single(f32::from(v)), rows),
        SampleType::I16 => decoded::<i16, T>(band, &blob, absent, |v| T::from_single(f32::from(v)), rows),
        SampleType::U32 => decoded::<u32, T>(band, &blob, absent, |v| T::from_double(f64::from(v)), rows),
        SampleType::I32 => decoded::<i32, T>(band, &blob, absent, |v| T::from_double(f64::from(v)), rows),
        SampleType::F32 => decoded::<f32, T>(band, &blob, T::from_single(f32::NAN), T::from_single, rows),
        SampleType::F64 => decoded::<f64, T>(band, &blob, T::from_single(f32::NAN), T::from_double, rows),
        other => Err(Error::TiffSamples { found: format!("samples of {} bits under LERC", other.bits()) }),
    }
}

/// The blob of a block, which is no longer than its samples would be, a header and a mask aside.
fn unpacked(band: &Band<'_>, block: (u64, u64)) -> Result<Vec<u8>, Error> {
    const HEADER_BYTES: u64 = 4096;
    let bytes = band.bytes_of(block)?;
    if band.layout.compression == Compression::Lerc(LercPacking::None) {
        return Ok(bytes.to_vec());
    }
    let layout = band.layout;
    let samples = layout.row_bytes() as u64 * layout.block_rows.min(layout.rows) as u64;
    let mut blob = Vec::new();
    let mut reader = layout.compression.open(bytes)?.take(2 * samples + HEADER_BYTES);
    reader.read_to_end(&mut blob).map_err(|why| Error::TiffBlock { why: why.to_string() })?;
    Ok(blob)
}

fn decoded<'s, S: Sample, T: Number + 's>(
    band: &Band<'_>,
    blob: &[u8],
    absent: T,
    number: impl Fn(S) -> T,
    rows: impl Iterator<Item = &'s mut [T]>,
) -> Result<(), Error> {
    let layout = band.layout;
    let damaged = |why: lerc::LercError| Error::TiffBlock { why: why.to_string() };
    let info = lerc::decode_info(blob).map_err(damaged)?;
    let (width, height) = (info.width as usize, info.height as usize);
    let (depth, bands) = (info.depth.max(1) as usize, info.bands.max(1) as usize);
    // A strip at the lower end may be cut to the image.
    let fits = width == layout.block_columns
        && height <= layout.block_rows
        && depth * bands == layout.samples_per_pixel();
    let pixels = u64::from(info.width) * u64::from(info.height);
    if !fits || pixels > layout.cells().max(LARGEST_BLOCK) {
        let why = format!("LERC block of {width} × {height} pixels and {} bands", depth * bands);
        return Err(Error::TiffBlock { why });
    }
    let image = lerc::decode(blob).map_err(damaged)?;
    let Some(values) = image.as_typed::<S>() else {
        return Err(Error::TiffBlock { why: format!("LERC block of {:?} samples", image.data_type) });
    };
    // Samples of a pixel lie side by side, or each band apart.
    let (plane, first) = if bands > 1 { (band.first(), 0) } else { (0, band.first()) };
    let mask = image.valid_masks.get(plane).or(image.valid_masks.first()).unwrap_or(&BitMask::AllValid(0));
    for (y, row) in rows.enumerate().take(height) {
        for (x, to) in row.iter_mut().enumerate() {
            let pixel = y * width + x;
            let value = values.get(plane * width * height * depth + pixel * depth + first);
            let value = value.filter(|_| mask.is_valid(pixel));
            *to = value.map_or(absent, |v| number(if band.big_endian { swapped(*v) } else { *v }));
        }
    }
    Ok(())
}

/// A sample of a big-endian file: its bytes were turned round before LERC took them for numbers, as libtiff has it.
fn swapped<S: Sample>(value: S) -> S {
    S::from_bits_u64(value.to_bits_u64().swap_bytes() >> (64 - 8 * S::BYTES))
}
