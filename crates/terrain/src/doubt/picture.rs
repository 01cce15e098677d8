//! Pictures and compass directions in the place of elevations.

use super::{Values, steps::Steps};
use crate::{Warning, WarningKind};

/// A warning where all values are whole, and reach from 0 or 1 to exactly 255: the range of a byte, to which pictures and shaded
/// reliefs are stretched. Ground has no reason to span exactly it.
pub(super) fn image(values: &Values) -> Option<Warning> {
    let is_byte = values.are_whole && (0.0..=1.0).contains(&values.lowest_m) && values.highest_m == 255.0;
    is_byte.then(|| {
        let detail = format!(
            "all values are whole numbers from {} to 255, the range of an 8-bit picture: the map looks like an image or a hillshade, not like elevation",
            values.lowest_m
        );
        Warning::new(WarningKind::Image, detail)
    })
}

/// A warning where a file of 8 bits holds whole numbers. So do pictures; and elevations in whole metres make slopes of 45° out of
/// level ground on cells of a metre.
pub(super) fn byte_picture(values: &Values) -> Option<Warning> {
    values.are_whole.then(|| {
        let detail = format!(
            "the file holds 8-bit whole numbers from {} to {}, as images and hillshades do: if they are elevations, whole metres are too coarse for slopes and energies",
            values.lowest_m, values.highest_m
        );
        Warning::new(WarningKind::Image, detail)
    })
}

/// A warning where all values lie within a circle of degrees, fill it, and some neighbours differ by more than half of it: so do
/// directions on both sides of north, and no ground that spans 360 m in all rises by half of that from a cell to the next.
pub(super) fn aspect(values: &Values, steps: &Steps) -> Option<Warning> {
    /// The nearest to a full circle that the extremes of many directions leave, where a hundred lie anywhere in it [deg].
    const NEARLY_DEG: f64 = 3.6;
    let fills_circle = (0.0..NEARLY_DEG).contains(&values.lowest_m)
        && (360.0 - NEARLY_DEG..=360.0).contains(&values.highest_m);
    (fills_circle && steps.beyond_half_circle > 0).then(|| {
        let detail = format!(
            "all values lie from 0 to 360 and {} neighbours differ by more than 180: the map looks like slope directions (aspect) in degrees, not like elevation",
            steps.beyond_half_circle
        );
        Warning::new(WarningKind::Aspect, detail)
    })
}
