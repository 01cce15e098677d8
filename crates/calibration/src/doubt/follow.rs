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
    /// Squared correlation with its sign, and the same about the mean of each run.
    pub(crate) r2: f64,
    pub(crate) within_runs_r2: f64,
    /// Recorded over predicted, at best; of motor currents none.
    pub(crate) ratio: Option<f64>,
    /// How the power of all sides varies as recorded and as predicted; of motor currents none.
    pub(crate) varies: Option<Varies>,
    /// Time that is compared \[s\].
    pub(crate) driven_s: f64,
}

/// How the power of all sides varies over a recording.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Varies {
    /// Correlation of recorded and predicted.
    pub(crate) r: f64,
    /// Standard deviation of recorded over that of predicted.
    pub(crate) over_predicted: f64,
    /// Standard deviation of predicted over its mean.
    pub(crate) of_mean: f64,
    /// Coefficient of determination of the prediction as it is.
    pub(crate) determined: f64,
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
    let runs: Vec<usize> = drives.averages.iter().map(|average| average.run).collect();
    let (mut whole, mut within) = (Sums::default(), Sums::default());
    for (predicted, recorded) in [&sides.0, &sides.1].into_iter().zip(&drives.recorded) {
        // Currents come without a sign.
        let recorded = drives.averaged_by(|i| if is_current { recorded[i].abs() } else { recorded[i] });
        let all = runs.iter().zip(drives.averaged(predicted).into_iter().zip(recorded));
        let mut pairs: Vec<(usize, (f64, f64))> = all.map(|(run, pair)| (*run, pair)).collect();
        pairs.retain(|(_, (p, r))| p.is_finite() && r.is_finite());
        // Sides differ by constants: only what varies within one tells how it is followed.
        whole.add(pairs.iter().map(|(_, pair)| *pair));
        pairs.chunk_by(|a, b| a.0 == b.0).for_each(|run| within.add(run.iter().map(|(_, pair)| *pair)));
    }
    let ratio = (!is_current && whole.of[4] > 0.0).then(|| whole.of[3] / whole.of[4]);
    let varies = (!is_current).then(|| {
        let total = |columns: [&[f64]; 2]| drives.averaged_by(|i| columns[0][i] + columns[1][i]);
        let predicted = total([&sides.0, &sides.1]);
        let recorded = drives.averaged_by(|i| drives.recorded.iter().map(|column| column[i]).sum());
        let pairs = predicted.into_iter().zip(recorded).filter(|(p, r)| p.is_finite() && r.is_finite());
        varies(&pairs.collect::<Vec<_>>())
    });
    let driven_s = drives.averages.iter().map(|average| average.duration_s).sum();
    Ok(Followed { r2: whole.r2(), within_runs_r2: within.r2(), ratio, varies: varies.flatten(), driven_s })
}

/// How predicted and recorded vary together; `None` where either is constant.
fn varies(pairs: &[(f64, f64)]) -> Option<Varies> {
    let count = pairs.len() as f64;
    let p0 = pairs.iter().map(|(p, _)| p).sum::<f64>() / count;
    let mut sums = Sums::default();
    sums.add(pairs.iter().copied());
    let [both, recorded, predicted, ..] = sums.of;
    let missed: f64 = pairs.iter().map(|(p, r)| (r - p).powi(2)).sum();
    (recorded > 0.0 && predicted > 0.0).then(|| Varies {
        r: both / (recorded * predicted).sqrt(),
        over_predicted: (recorded / predicted).sqrt(),
        of_mean: (predicted / count).sqrt() / p0.abs(),
        determined: 1.0 - missed / recorded,
    })
}

/// Sums of products of predicted and recorded, about means of their own.
#[derive(Default)]
struct Sums {
    /// Of both, of recorded, of predicted, and of both and of predicted about zero.
    of: [f64; 5],
}

impl Sums {
    fn add(&mut self, pairs: impl Iterator<Item = (f64, f64)> + Clone) {
        let count = pairs.clone().count().max(1) as f64;
        let (p0, r0) = pairs.clone().fold((0.0, 0.0), |(p0, r0), (p, r)| (p0 + p / count, r0 + r / count));
        for (p, r) in pairs {
            let by = [(r - r0) * (p - p0), (r - r0).powi(2), (p - p0).powi(2), r * p, p * p];
            self.of.iter_mut().zip(by).for_each(|(sum, x)| *sum += x);
        }
    }

    fn r2(&self) -> f64 {
        let r = self.of[0] / (self.of[1] * self.of[2]).sqrt().max(f64::MIN_POSITIVE);
        r * r.abs()
    }
}
