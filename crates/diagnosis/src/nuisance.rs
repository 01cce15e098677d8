//! What the model itself misses of healthy drives: smooth functions of the inputs that suspect and healthy drives share.

use crate::series::{Average, Input};

/// Share of mean power that a function may take [-]: about what the force balance misses of a healthy Husky.
const SHARE: f64 = 0.03;

/// Functions of the inputs, scaled to one sigma of what they may take [W].
///
/// With healthy drives beside the suspect ones they are as many as the model could be wrong by: what both share is nobody's
/// mechanism. Without, they would take the mechanisms' own part, and only skid may bend gently with how tight a turn is.
pub(crate) fn columns(averages: &[Average], predicted_w: &[f64], healthy: bool) -> Vec<Vec<f64>> {
    let mean_w = predicted_w.iter().map(|p| p.abs()).sum::<f64>() / predicted_w.len().max(1) as f64;
    let functions: &[fn(&Input) -> f64] = if healthy { &SHARED } else { &ALONE };
    let channels = averages.iter().map(|a| a.channel).max().map_or(0, |c| c + 1);
    let mut columns = Vec::new();
    for channel in 0..channels {
        for function in functions {
            let of = |a: &Average| if a.channel == channel { function(&a.input) } else { 0.0 };
            let values: Vec<f64> = averages.iter().map(of).collect();
            let size = (values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64).sqrt();
            if size > 0.0 {
                columns.push(values.iter().map(|x| x / size * SHARE * mean_w).collect());
            }
        }
    }
    columns
}

const ALONE: [fn(&Input) -> f64; 1] = [|x| tightness(x) * x.difference_mps.abs()];

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
