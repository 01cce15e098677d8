//! Elevations beyond those of dry land.

use super::Values;
use crate::{Warning, WarningKind};

/// No dry land lies lower [m]: the deepest shore, of the Dead Sea, lies at −440, the deepest open pits end above −1000.
const DEEPEST_LAND_M: f64 = -1000.0;
/// No land lies higher [m]: Mount Everest has 8849.
const HIGHEST_LAND_M: f64 = 8849.0;

/// A warning where elevations are not of dry land on Earth: the sea floor, another planet, another unit or no elevation.
pub(super) fn unusual_elevation(values: &Values) -> Option<Warning> {
    let beyond_m = if values.lowest_m < DEEPEST_LAND_M {
        values.lowest_m
    } else if values.highest_m > HIGHEST_LAND_M {
        values.highest_m
    } else {
        return None;
    };
    let detail = format!(
        "elevations reach {beyond_m:.1} m, where Earth has no dry land ({DEEPEST_LAND_M} to {HIGHEST_LAND_M} m): right for the sea floor, Mars or the Moon, though gravity stays that of Earth; else check unit and nodata"
    );
    Some(Warning::new(WarningKind::UnusualElevation, detail))
}
