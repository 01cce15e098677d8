//! How far the robot's file, as it is, lies from the recorded power.

use std::collections::BTreeMap;

use crate::posterior::{
    fit::baseline::Baseline,
    observations::{Observations, REST},
};
use crate::report::FileError;

/// Error of predictions of the test drives over seconds of the whole power: of the battery where it shows, else of both sides.
pub(crate) fn of(observed: &Observations<'_>, baseline: &Baseline, predicted: &[f64]) -> FileError {
    let mut seconds = BTreeMap::<(usize, u64), [f64; 3]>::new();
    let rows = observed.averages()[..observed.test_rows].iter().zip(&observed.series.recorded).zip(predicted);
    for (i, ((average, recorded), predicted)) in rows.enumerate() {
        if observed.is_power(i) || average.channel == REST {
            let sums = seconds.entry((average.run, average.t_s.to_bits())).or_default();
            let sigma_w = baseline.noise.sigma(average.channel, baseline.predicted[i]);
            *sums = [sums[0] + recorded, sums[1] + predicted, sums[2] + sigma_w * sigma_w];
        }
    }
    let count = seconds.len().max(1) as f64;
    let mean = |value: &dyn Fn(&[f64; 3]) -> f64| seconds.values().map(value).sum::<f64>() / count;
    FileError {
        rmse_w: mean(&|[recorded, predicted, _]| (recorded - predicted).powi(2)).sqrt(),
        bias_w: mean(&|[recorded, predicted, _]| recorded - predicted),
        mean_power_w: mean(&|[recorded, ..]| *recorded),
        noise_w: mean(&|[.., variance_w2]| *variance_w2).sqrt(),
    }
}
