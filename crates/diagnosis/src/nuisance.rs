//! What the model itself misses of healthy drives: smooth functions of the inputs that suspect and healthy drives share.

use crate::{
    average::{Average, Input},
    channel,
};

/// Share of mean power that a function may take [-]: about what the force balance misses of a healthy Husky.
const SHARE: f64 = 0.03;
/// The same of what is like something that may be missing, strong effects of which it would take up for themselves if it might be more.
pub(crate) const SHARE_OF_WHAT_IS_LIKE_EFFECTS: f64 = 0.01;

/// Functions of the inputs, scaled to one sigma of what they may take, over the averages of a channel of such a mean size [W].
///
/// What suspect and healthy drives share is nobody's mechanism. Without healthy drives they take the part of mechanisms that
/// act all the time as well, which then cannot be told from what the model is wrong by and are not named: with a few functions
/// only, a healthy drive alone was taken for one on soft ground.
pub(crate) fn of_channel(averages: &[Average], places: &[usize], mean_w: f64) -> Vec<Vec<f64>> {
    let column = |(function, share): (&fn(&Input) -> f64, f64)| {
        let values: Vec<f64> = places.iter().map(|i| function(&averages[*i].input)).collect();
        let size = (values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64).sqrt();
        (size > 0.0).then(|| values.iter().map(|x| x / size * share * mean_w).collect())
    };
    let known = SHARED.iter().map(|function| (function, SHARE));
    let little = OF_CURVES.iter().map(|function| (function, SHARE_OF_WHAT_IS_LIKE_EFFECTS));
    known.chain(little).filter_map(column).collect()
}

/// The same of every channel, over all averages.
pub(crate) fn columns(averages: &[Average], predicted_w: &[f64]) -> Vec<Vec<f64>> {
    let of = |(channel, mean_w): (usize, f64)| {
        let places = channel::places(averages, channel);
        channel::spread(&of_channel(averages, &places, mean_w), &places, averages.len())
    };
    means(averages, predicted_w).into_iter().enumerate().flat_map(of).collect()
}

/// Mean size of what is predicted, by channel.
pub(crate) fn means(averages: &[Average], predicted: &[f64]) -> Vec<f64> {
    let mean = |channel: usize| {
        let own = averages.iter().zip(predicted).filter(|(a, _)| a.channel == channel);
        let (sum, count) = own.fold((0.0, 0.0), |(sum, count), (_, p)| (sum + p.abs(), count + 1.0));
        sum / f64::max(count, 1.0)
    };
    (0..channel::count(averages)).map(mean).collect()
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

/// Functions of speed times turn tell what a curve that is driven faster than healthy drives did takes on top: with turn alone, half
/// circles of a robot in order passed for a gain of its meters.
const OF_CURVES: [fn(&Input) -> f64; 6] = [
    |x| sideways(x),
    |x| sideways(x) * sideways(x),
    |x| sideways(x) * x.difference_mps.abs(),
    |x| x.rim_mps * x.difference_mps,
    |x| (x.rim_mps * x.difference_mps).abs(),
    |x| x.rim_mps * x.difference_mps * x.difference_mps.abs(),
];

/// Acceleration towards the inside of a curve, times the track [m²/s²].
fn sideways(x: &Input) -> f64 {
    (x.speed_mps * x.difference_mps).abs()
}

/// 0 straight on, 1 on the spot.
fn tightness(x: &Input) -> f64 {
    let turn = x.difference_mps.abs() / 2.0;
    if turn == 0.0 { 0.0 } else { turn / (turn + x.speed_mps.abs()) }
}
