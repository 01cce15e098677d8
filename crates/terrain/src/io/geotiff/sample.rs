//! Samples as numbers: types, byte order, predictors.

use half::f16;

use crate::Error;

/// How a sample stands in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SampleType {
    /// Unsigned, of whole bytes.
    U8,
    U16,
    U32,
    U64,
    /// Signed.
    I8,
    I16,
    I32,
    I64,
    /// Floating point.
    F16,
    F32,
    F64,
    /// Unsigned, of so many bits, 1 to 31, packed from the most significant one.
    Packed(u16),
}

impl SampleType {
    /// The type of all bands, by BitsPerSample and SampleFormat.
    pub(super) fn read(bits: &[u64], formats: &[u64]) -> Result<Self, Error> {
        const COMPLEX_INTEGER: u64 = 5;
        const COMPLEX: u64 = 6;
        let bits_of_first = bits.first().copied().unwrap_or(1);
        // 4 means undefined: readers take it for unsigned, as the default is.
        let format = formats.first().copied().unwrap_or(1);
        if bits.iter().any(|b| *b != bits_of_first) || formats.iter().any(|f| *f != format) {
            return Err(Error::TiffSamples { found: "bands of different types".into() });
        }
        Ok(match (format, bits_of_first) {
            (1 | 4, 8) => SampleType::U8,
            (1 | 4, 16) => SampleType::U16,
            (1 | 4, 32) => SampleType::U32,
            (1 | 4, 64) => SampleType::U64,
            (1 | 4, 1..=31) => SampleType::Packed(bits_of_first as u16),
            (2, 8) => SampleType::I8,
            (2, 16) => SampleType::I16,
            (2, 32) => SampleType::I32,
            (2, 64) => SampleType::I64,
            (3, 16) => SampleType::F16,
            (3, 32) => SampleType::F32,
            (3, 64) => SampleType::F64,
            (COMPLEX_INTEGER | COMPLEX, _) => {
                return Err(Error::TiffSamples { found: "complex numbers".into() });
            }
            _ => {
                let found = format!("samples of {bits_of_first} bits in SampleFormat {format}");
                return Err(Error::TiffSamples { found });
            }
        })
    }

    /// Bits of a sample.
    pub(super) fn bits(self) -> u16 {
        match self {
            SampleType::Packed(bits) => bits,
            SampleType::U8 | SampleType::I8 => 8,
            SampleType::U16 | SampleType::I16 | SampleType::F16 => 16,
            SampleType::U32 | SampleType::I32 | SampleType::F32 => 32,
            SampleType::U64 | SampleType::I64 | SampleType::F64 => 64,
        }
    }

    /// Whether single precision holds every value exactly.
    pub(super) fn is_exact_in_single(self) -> bool {
        match self {
            SampleType::Packed(bits) => u32::from(bits) <= f32::MANTISSA_DIGITS,
            other => other.bits() <= 16 || other == SampleType::F32,
        }
    }

    pub(super) fn is_float(self) -> bool {
        matches!(self, SampleType::F16 | SampleType::F32 | SampleType::F64)
    }
}

/// What was done to the samples of a row before they were compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Predictor {
    None,
    /// Differences of neighbours (TIFF 6.0, section 14).
    Horizontal,
    /// Bytes by significance, then differences (TIFF technical note 3).
    Float,
}

impl Predictor {
    pub(super) fn read(tag: Option<u64>, sample: SampleType) -> Result<Self, Error> {
        match tag.unwrap_or(1) {
            1 => Ok(Predictor::None),
            2 if !matches!(sample, SampleType::Packed(_)) => Ok(Predictor::Horizontal),
            3 if sample.is_float() => Ok(Predictor::Float),
            other => Err(Error::TiffSamples {
                found: format!("{} bit samples under predictor {other}", sample.bits()),
            }),
        }
    }
}

/// Takes a predictor off a row of samples in the file's byte order. Returns them in the machine's order, in the row itself or in `spare`.
pub(super) fn restore<'a>(
    row: &'a mut [u8],
    spare: &'a mut Vec<u8>,
    predictor: Predictor,
    order: RowOrder,
) -> &'a [u8] {
    if predictor != Predictor::Float {
        order.to_native(row);
    }
    match (predictor, order.sample_bytes) {
        (Predictor::None, _) => {}
        (Predictor::Float, 4) if order.step == 1 => {
            spare.resize(row.len(), 0);
            restore_single(row, spare);
            return spare;
        }
        (Predictor::Float, bytes) => {
            add_up_bytes(row, order.step);
            spare.resize(row.len(), 0);
            let count = row.len() / bytes;
            gather_bytes(row, spare, count, bytes);
            return spare;
        }
        (Predictor::Horizontal, 1) => add_up::<1>(row, order.step, |a, b| [a[0].wrapping_add(b[0])]),
        (Predictor::Horizontal, 2) => add_up::<2>(row, order.step, |a, b| {
            u16::from_ne_bytes(a).wrapping_add(u16::from_ne_bytes(b)).to_ne_bytes()
        }),
        (Predictor::Horizontal, 4) => add_up::<4>(row, order.step, |a, b| {
            u32::from_ne_bytes(a).wrapping_add(u32::from_ne_bytes(b)).to_ne_bytes()
        }),
        (Predictor::Horizontal, _) => add_up::<8>(row, order.step, |a, b| {
            u64::from_ne_bytes(a).wrapping_add(u64::from_ne_bytes(b)).to_ne_bytes()
        }),
    }
    row
}

/// Single-precision samples of one band, which nearly all such files hold: differences added up and planes gathered in one pass. The sums
/// of the four planes go side by side, each from where the planes before it end.
fn restore_single(planes: &[u8], samples: &mut [u8]) {
    let count = planes.len() / 4;
    let [a, b, c, d] = [0, 1, 2, 3].map(|plane| &planes[plane * count..(plane + 1) * count]);
    let total = |plane: &[u8]| plane.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte));
    let mut sums = [0, total(a), total(b), total(c)];
    for plane in 1..sums.len() {
        sums[plane] = sums[plane].wrapping_add(sums[plane - 1]);
    }
    let quarters = a.iter().zip(b).zip(c.iter().zip(d));
    for (sample, ((a, b), (c, d))) in samples.as_chunks_mut::<4>().0.iter_mut().zip(quarters) {
        for (sum, byte) in sums.iter_mut().zip([a, b, c, d]) {
            *sum = sum.wrapping_add(*byte);
        }
        *sample = u32::from_be_bytes(sums).to_ne_bytes();
    }
}

/// Samples out of planes of their bytes, the most significant plane first.
fn gather_bytes(planes: &[u8], samples: &mut [u8], count: usize, bytes: usize) {
    for (significance, plane) in planes.chunks_exact(count.max(1)).take(bytes).enumerate() {
        let at = if cfg!(target_endian = "little") { bytes - 1 - significance } else { significance };
        for (sample, byte) in samples.chunks_exact_mut(bytes).zip(plane) {
            sample[at] = *byte;
        }
    }
}

/// Each byte with all those of its band before it.
fn add_up_bytes(row: &mut [u8], step: usize) {
    if step == 1 {
        row.iter_mut().fold(0u8, |sum, byte| {
            *byte = byte.wrapping_add(sum);
            *byte
        });
        return;
    }
    for i in step..row.len() {
        row[i] = row[i].wrapping_add(row[i - step]);
    }
}

fn add_up<const N: usize>(row: &mut [u8], step: usize, add: impl Fn([u8; N], [u8; N]) -> [u8; N]) {
    let (samples, _) = row.as_chunks_mut::<N>();
    for i in step..samples.len() {
        samples[i] = add(samples[i], samples[i - step]);
    }
}

/// Bytes of a sample, their order in the file, and the samples between neighbours of a band.
#[derive(Clone, Copy)]
pub(super) struct RowOrder {
    pub(super) sample_bytes: usize,
    pub(super) big_endian: bool,
    pub(super) step: usize,
}

impl RowOrder {
    fn to_native(self, row: &mut [u8]) {
        if self.sample_bytes > 1 && self.big_endian != cfg!(target_endian = "big") {
            row.chunks_exact_mut(self.sample_bytes).for_each(<[u8]>::reverse);
        }
    }
}

/// A number that samples are turned into.
pub(super) trait Number: Copy + Send + Sync {
    fn from_single(value: f32) -> Self;
    fn from_double(value: f64) -> Self;
}

impl Number for f32 {
    fn from_single(value: f32) -> Self {
        value
    }
    fn from_double(value: f64) -> Self {
        value as f32
    }
}

impl Number for f64 {
    fn from_single(value: f32) -> Self {
        f64::from(value)
    }
    fn from_double(value: f64) -> Self {
        value
    }
}

/// Whether a mask shows what it lies over.
#[derive(Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Shown(pub(super) bool);

impl Number for Shown {
    fn from_single(value: f32) -> Self {
        Shown(value != 0.0)
    }
    fn from_double(value: f64) -> Self {
        Shown(value != 0.0)
    }
}

/// Numbers out of a row of samples in the machine's byte order: the first of every `step`, from the sample `first` on.
pub(super) fn convert<T: Number>(sample: SampleType, row: &[u8], first: usize, step: usize, to: &mut [T]) {
    macro_rules! each {
        ($type:ty, $number:expr) => {{
            let (samples, _) = row.as_chunks::<{ size_of::<$type>() }>();
            for (to, bytes) in to.iter_mut().zip(samples.iter().skip(first).step_by(step)) {
                *to = $number(<$type>::from_ne_bytes(*bytes));
            }
        }};
    }
    match sample {
        SampleType::U8 => each!(u8, |v| T::from_single(f32::from(v))),
        SampleType::I8 => each!(i8, |v| T::from_single(f32::from(v))),
        SampleType::U16 => each!(u16, |v| T::from_single(f32::from(v))),
        SampleType::I16 => each!(i16, |v| T::from_single(f32::from(v))),
        SampleType::F16 => each!(f16, |v: f16| T::from_single(v.to_f32())),
        SampleType::F32 => each!(f32, |v| T::from_single(v)),
        SampleType::F64 => each!(f64, |v| T::from_double(v)),
        SampleType::U32 => each!(u32, |v| T::from_double(f64::from(v))),
        SampleType::I32 => each!(i32, |v| T::from_double(f64::from(v))),
        SampleType::U64 => each!(u64, |v| T::from_double(v as f64)),
        SampleType::I64 => each!(i64, |v| T::from_double(v as f64)),
        SampleType::Packed(bits) => {
            for (i, to) in to.iter_mut().enumerate() {
                *to = T::from_double(f64::from(packed(row, first + i * step, usize::from(bits))));
            }
        }
    }
}

fn packed(row: &[u8], index: usize, bits: usize) -> u32 {
    (index * bits..(index + 1) * bits).fold(0, |value, bit| {
        let byte = row.get(bit / 8).copied().unwrap_or(0);
        value << 1 | u32::from(byte >> (7 - bit % 8) & 1)
    })
}
