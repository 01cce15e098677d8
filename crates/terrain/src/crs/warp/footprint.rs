//! How far a grid of degrees reaches in its UTM zone, and how large its cells are there.

use super::{DegreeFrame, WarpRefusal};
use crate::crs::{Earth, Size};

/// Edges of the source's middle cell, east and north [m].
pub(super) fn edges_m(source: &DegreeFrame, earth: &Earth) -> Result<[f64; 2], WarpRefusal> {
    let [column, row] = [source.size.columns, source.size.rows].map(|count| count as f64 / 2.0);
    let place_m =
        |column, row| earth.place_m(source.place_deg([column, row])).map_err(WarpRefusal::Projection);
    let apart_m = |[one, other]: [[f64; 2]; 2]| (one[0] - other[0]).hypot(one[1] - other[1]);
    Ok([
        apart_m([place_m(column - 0.5, row)?, place_m(column + 0.5, row)?]),
        apart_m([place_m(column, row - 0.5)?, place_m(column, row + 0.5)?]),
    ])
}

/// West, south, east and north of the source's footprint [m].
///
/// A parallel is furthest south or north where it crosses the zone's meridian, a meridian furthest out where it crosses the equator, and
/// both run one way from there: corners and crossings are all that counts.
pub(super) fn bounds_m(source: &DegreeFrame, earth: &Earth, epsg: u32) -> Result<[f64; 4], WarpRefusal> {
    let Size { columns, rows } = source.size;
    let (far_column, far_row) = (columns as f64, rows as f64);
    let [meridian, equator] = source.position([zone_meridian_deg(epsg), 0.0]);
    let with_crossing = |far: f64, crossing: f64| [0.0, far, crossing.clamp(0.0, far)];
    let edges = with_crossing(far_column, meridian)
        .into_iter()
        .flat_map(|column| with_crossing(far_row, equator).map(|row| [column, row]));
    let mut bounds_m = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    for position in edges {
        let place_m = earth.place_m(source.place_deg(position)).map_err(WarpRefusal::Projection)?;
        for axis in [0, 1] {
            bounds_m[axis] = bounds_m[axis].min(place_m[axis]);
            bounds_m[axis + 2] = bounds_m[axis + 2].max(place_m[axis]);
        }
    }
    Ok(bounds_m)
}

/// Longitude of the meridian of a UTM zone [°]: zones are 6° wide and counted from 180° W.
fn zone_meridian_deg(epsg: u32) -> f64 {
    f64::from(epsg % 100) * 6.0 - 183.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::warp::zone;

    #[test]
    fn bounds_hold_all_of_the_outline_and_touch_it() {
        // Across a zone's meridian, beside it, across the equator, and in the zone of the far south.
        for (west_deg, south_deg, epsg) in
            [(4.5, 47.0, 32_632), (11.0, 83.0, 32_632), (0.0, -0.5, 32_631), (148.0, -44.0, 32_755)]
        {
            let size = Size { columns: 900, rows: 100 };
            let source = DegreeFrame { south_west_deg: [west_deg, south_deg], step_deg: [0.01; 2], size };
            let earth = zone(epsg).unwrap();
            let bounds_m = bounds_m(&source, &earth, epsg).unwrap();
            let steps = (0..=900).flat_map(|column| [[column, 0], [column, 100]]);
            let outline = steps.chain((0..=100).flat_map(|row| [[0, row], [900, row]]));
            let mut furthest_m = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
            for position in outline {
                let place_m = earth.place_m(source.place_deg(position.map(f64::from))).unwrap();
                for axis in [0, 1] {
                    furthest_m[axis] = furthest_m[axis].min(place_m[axis]);
                    furthest_m[axis + 2] = furthest_m[axis + 2].max(place_m[axis]);
                }
            }
            for (bound_m, found_m) in bounds_m.iter().zip(furthest_m) {
                assert!((bound_m - found_m).abs() < 1e-3, "{epsg}: {bounds_m:?}, {furthest_m:?}");
            }
        }
    }
}
