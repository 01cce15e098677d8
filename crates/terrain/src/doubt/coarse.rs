//! Heights that are rounded more coarsely than their cells can bear.

use super::{Values, steps::Steps};
use crate::{Warning, WarningKind};

/// Rolling resistance of the hardest ground of the paper, marble (Dogru & Marques, table IV). Steps of heights that are less steep brake nothing
/// away: what a robot spends on them upwards it saves downwards.
const HARD_GROUND_RESISTANCE: f64 = 0.063;

/// Fewest levels that ground rounded to steps shows; kerbs, walls and boxes on a floor have two.
const FEWEST_LEVELS: f64 = 3.0;

/// A warning where all heights are multiples of a round step, a step from a cell to the next is a slope that costs energy, and most of the
/// steps are rounding.
///
/// Rounding to multiples of q adds an error of variance q²/12 to each height, and q²/6 to the difference of two. Where the mean square of
/// all differences is less than twice that, more than half of it is rounding.
pub(super) fn coarse_heights(values: &Values, steps: &Steps) -> Option<Warning> {
    let step_m = values.round_step_m?;
    let slope = step_m / steps.cell_size_m;
    let levels = (values.highest_m - values.lowest_m) / step_m + 1.0;
    let mean_square_m2 = steps.squares_m2 / steps.count.max(1) as f64;
    let is_rounding = mean_square_m2 < 2.0 * step_m * step_m / 6.0;
    // Edges of what is built on level ground are of any height.
    let are_single = 2 * steps.single > steps.sloped;
    let is_coarse = slope > HARD_GROUND_RESISTANCE && levels >= FEWEST_LEVELS && are_single;
    (is_rounding && is_coarse).then(|| {
        let detail = format!(
            "heights are multiples of {step_m} m, so that from a cell of {} m to the next the ground is level or as steep as {:.0}°: most of the slopes are rounding, and energies with them; give heights with more digits, or cells of {:.0} m and more",
            steps.cell_size_m,
            slope.atan().to_degrees(),
            (step_m / HARD_GROUND_RESISTANCE).ceil()
        );
        Warning::new(WarningKind::CoarseHeights, detail)
    })
}
