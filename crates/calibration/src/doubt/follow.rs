//! How a robot's predictions follow what was recorded.

use model::Robot;
use recording::{PowerForm, Recording, Watch};

use crate::{
    Drives, Error,
    field::with_new_ground,
    power::{columns_by_row, seen_w},
};

/// Predictions beside what was recorded, over one-second averages of all sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Followed {
    /// Squared correlation with its sign.
    pub(crate) r2: f64,
    /// Recorded over predicted, at best; of motor currents none.
    pub(crate) ratio: Option<f64>,
}

/// How a robot's predictions follow a recording.
///
/// # Errors
/// As [`crate::predict_watched()`].
pub(crate) fn of(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Followed, Error> {
    let drives = Drives::watched(robot, recording, watch)?.including_stuck();
    // Ground that the file does not know feels like ground of which nothing is known.
    let robot = &with_new_ground(robot, &drives);
    let form = drives.form.unwrap_or(PowerForm::Battery);
    let sides = columns_by_row(&drives, robot, |i, power| {
        let [first, second] = seen_w(robot, form, &drives.rows[i], power);
        (first, second)
    })?;
    let is_current = form == PowerForm::MotorCurrents;
    let mut sums = [0.0; 5];
    for (predicted, recorded) in [&sides.0, &sides.1].into_iter().zip(&drives.recorded) {
        // Currents come without a sign.
        let recorded = drives.averaged_by(|i| if is_current { recorded[i].abs() } else { recorded[i] });
        let mut pairs: Vec<(f64, f64)> = drives.averaged(predicted).into_iter().zip(recorded).collect();
        pairs.retain(|(p, r)| p.is_finite() && r.is_finite());
        // Sides differ by constants: only what varies within one tells how it is followed.
        let count = pairs.len().max(1) as f64;
        let mean = |value: fn(&(f64, f64)) -> f64| pairs.iter().map(value).sum::<f64>() / count;
        let (p0, r0) = (mean(|pair| pair.0), mean(|pair| pair.1));
        for (p, r) in &pairs {
            let of = [(r - r0) * (p - p0), (r - r0).powi(2), (p - p0).powi(2), r * p, p * p];
            sums.iter_mut().zip(of).for_each(|(sum, x)| *sum += x);
        }
    }
    let r = sums[0] / (sums[1] * sums[2]).sqrt().max(f64::MIN_POSITIVE);
    let ratio = (!is_current && sums[4] > 0.0).then(|| sums[3] / sums[4]);
    Ok(Followed { r2: r * r.abs(), ratio })
}
