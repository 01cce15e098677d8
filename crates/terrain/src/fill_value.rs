//! Numbers by which programs mark cells without an elevation.

/// Magnitude from which a number is no elevation but a limit of single precision or a constant near it, as ±3.4e38 or −1e32:
/// all of them lie far above the radius of any planet [m].
const NEVER_A_LENGTH_M: f64 = 1e9;

/// Least and greatest values of 16-bit and 32-bit integers, and the least but one, which some programs leave for nodata.
const INTEGER_LIMITS: [f64; 6] =
    [-32_768.0, -32_767.0, 32_767.0, 65_535.0, -2_147_483_648.0, 2_147_483_647.0];

/// No number that [`is_never_ground`] is smaller than this. Most elevations are, and are asked nothing more.
pub(crate) const LEAST_MAGNITUDE: f64 = 9999.0;

/// Whether a number is a conventional fill value that no ground has as its elevation: −9999 and −99 999 (nines, by habit of
/// ESRI's grids), limits of integers, and magnitudes of the limits of single precision.
pub fn is_never_ground(value: f64) -> bool {
    if value.abs() < LEAST_MAGNITUDE {
        return false;
    }
    let is_nines = value == -9999.0 || value.abs() == 99_999.0 || value.abs() == 999_999.0;
    is_nines || INTEGER_LIMITS.contains(&value) || (value.is_finite() && value.abs() > NEVER_A_LENGTH_M)
}

/// Conventional fill values that ground may have as well: nought, to which rasters are set at first, and nines.
pub const POSSIBLY_GROUND: [f64; 6] = [0.0, -99.0, 99.0, -999.0, 999.0, 9999.0];

/// Whether a number is a conventional fill value, of ground or not.
pub fn is_conventional(value: f64) -> bool {
    POSSIBLY_GROUND.contains(&value) || is_never_ground(value)
}

/// Whether a value is a nodata mark as programs write and round it: equal, both no number, or equal to single precision of
/// six digits, as text of `%g` has it.
pub fn is_mark(value: f64, mark: f64) -> bool {
    /// Half a unit of the sixth digit, of the smallest mantissa.
    const SIX_DIGITS: f64 = 5e-6;
    value == mark
        || (value.is_nan() && mark.is_nan())
        || (mark.is_finite() && (value - mark).abs() <= mark.abs() * SIX_DIGITS && is_never_ground(mark))
        || (value.is_finite() && value as f32 == mark as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_known_however_they_are_rounded_and_ground_is_not_taken_for_one() {
        let least = f64::from(f32::MIN);
        assert!(is_mark(-3.40282e38, least) && is_mark(least, -3.402_823e38));
        assert!(is_mark(-9999.0, -9999.0) && is_mark(f64::NAN, f64::NAN));
        assert!(is_mark(f64::from(0.1f32), 0.1), "a mark that was kept in single precision");
        assert!(!is_mark(300.001, 300.0) && !is_mark(0.0, -9999.0) && !is_mark(f64::NAN, -9999.0));
    }
}
