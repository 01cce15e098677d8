//! What the model itself misses of healthy drives: smooth functions of the inputs that suspect and healthy drives share.

use crate::series::{Average, Input};

/// Share of mean power that a function may take [-]: about what the force balance misses of a healthy Husky.
const SHARE: f64 = 0.03;

/// Functions of the inputs, scaled to one sigma of what they may take [W].
///
/// What suspect and healthy drives share is nobody's mechanism. Without healthy drives they take the part of mechanisms that
/// act all the time as well, which then cannot be told from what the model is wrong by and are not named: with a few functions
/// only, a healthy drive alone was taken for one on soft ground.
pub(crate) fn columns(averages: &[Average], predicted_w: &[f64]) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    for (channel, mean_w) in means(averages, predicted_w).into_iter().enumerate() {
        for function in SHARED {
            let of = |a: &Average| if a.channel == channel { function(&a.input) } else { 0.0 };
            let values: Vec<f64> = averages.iter().map(of).collect();
            let count = averages.iter().filter(|a| a.channel == channel).count().max(1) as f64;
            let size = (values.iter().map(|x| x * x).sum::<f64>() / count).sqrt();
            if size > 0.0 {
                columns.push(values.iter().map(|x| x / size * SHARE * mean_w).collect());
            }
        }
    }
    columns
}

/// Mean size of what is predicted, by channel.
pub(crate) fn means(averages: &[Average], predicted: &[f64]) -> Vec<f64> {
    let channels = averages.iter().map(|a| a.channel + 1).max().unwrap_or(0);
    let mean = |channel: usize| {
        let own = averages.iter().zip(predicted).filter(|(a, _)| a.channel == channel);
        let (sum, count) = own.fold((0.0, 0.0), |(sum, count), (_, p)| (sum + p.abs(), count + 1.0));
        sum / f64::max(count, 1.0)
    };
    (0..channels).map(mean).collect()
}

const SHARED: [fn(&Input) -> f64; 14] = [
    |x| x.rim_mps.abs(),
    |x| x.rim_mps * x.rim_mps,
    |x| x.difference_mps,
    |x| x.difference_mps.abs(),
    |x| x.difference_mps * x.difference_mps,
    |x| tightness(x) * x.difference_mps.abs(),
    |x| x.rim_mps * x.pitch_rad,
    |x| x.rim_mps.abs() * x.pitch_rad * x.pitch_rad,
    |x| x.pitch_rad * x.pitch_rad,
    |x| x.difference_mps * x.roll_rad,
    |x| x.rim_mps * x.roll_rad,
    |x| x.difference_mps * x.pitch_rad,
    |x| x.rim_mps * x.accel_mps2,
    |x| x.accel_mps2.abs(),
];

/// 0 straight on, 1 on the spot.
fn tightness(x: &Input) -> f64 {
    let turn = x.difference_mps.abs() / 2.0;
    if turn == 0.0 { 0.0 } else { turn / (turn + x.speed_mps.abs()) }
}
