//! Doubts whether what a map holds is the elevation of ground, from its cells alone.
//!
//! Each doubt rests on something that ground cannot do, not on how examples look; all of them are said, and none refuses a map.

mod coarse;
mod fill;
mod picture;
mod range;
mod steps;

use std::sync::Arc;

use self::{
    coarse::coarse_heights,
    fill::fill_value,
    picture::{aspect, byte_picture, image},
    range::unusual_elevation,
    steps::{Steps, impossible_slopes},
};
use crate::{Terrain, WarningKind};

/// What all doubts ask about single cells.
struct Values {
    lowest_m: f64,
    highest_m: f64,
    /// Whether all are whole numbers.
    are_whole: bool,
    /// The largest of some round lengths that all are multiples of [m].
    round_step_m: Option<f64>,
}

/// Steps that heights are rounded to: metres, feet, and decimetres [m].
const ROUND_STEPS_M: [f64; 3] = [1.0, 0.3048, 0.1];

/// Share of a step by which single precision may miss a multiple of it.
const SINGLE_PRECISION: f64 = 1e-3;

impl Values {
    fn of(terrain: &Terrain) -> Self {
        let mut values = Values {
            lowest_m: f64::INFINITY,
            highest_m: f64::NEG_INFINITY,
            are_whole: true,
            round_step_m: None,
        };
        let mut are_multiples = [true; ROUND_STEPS_M.len()];
        for relative_m in terrain.relative_m.iter().filter(|z| !z.is_nan()) {
            let z_m = terrain.base_m + f64::from(*relative_m);
            values.lowest_m = values.lowest_m.min(z_m);
            values.highest_m = values.highest_m.max(z_m);
            values.are_whole &= z_m.fract() == 0.0;
            for (is_multiple, step_m) in are_multiples.iter_mut().zip(ROUND_STEPS_M) {
                let steps = z_m / step_m;
                *is_multiple &= (steps - steps.round()).abs() < SINGLE_PRECISION;
            }
        }
        values.round_step_m =
            are_multiples.iter().zip(ROUND_STEPS_M).find(|(is, _)| **is).map(|(_, step_m)| step_m);
        values
    }
}

impl Terrain {
    /// The ground of an 8-bit file, with the doubt whether it is a picture.
    pub(crate) fn with_doubt_of_bytes(self) -> Self {
        match byte_picture(&Values::of(&self)) {
            Some(_) if self.warnings.iter().any(|warning| warning.kind == WarningKind::Image) => self,
            Some(warning) => self.with_warning(warning),
            None => self,
        }
    }

    /// The ground with the doubts that its cells give rise to, in place of those of before.
    #[must_use]
    pub fn with_doubts(self) -> Self {
        let mut terrain = self;
        if terrain.warnings.iter().any(|warning| warning.kind.is_from_cells()) {
            let mut kept = terrain.warnings.to_vec();
            kept.retain(|warning| !warning.kind.is_from_cells());
            terrain.warnings = Arc::new(kept);
        }
        let values = Values::of(&terrain);
        let steps = Steps::of(&terrain, &values);
        let fill = fill_value(&steps);
        let picture = image(&values).or_else(|| aspect(&values, &steps));
        // A picture's slopes are no second doubt.
        let slopes = if picture.is_none() { impossible_slopes(&steps) } else { None };
        // A picture's levels are none of ground.
        let coarse = if picture.is_none() { coarse_heights(&values, &steps) } else { None };
        for warning in [fill, picture, slopes, coarse, unusual_elevation(&values)].into_iter().flatten() {
            terrain = terrain.with_warning(warning);
        }
        terrain
    }
}
