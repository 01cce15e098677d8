//! How drives under suspicion were driven, as smooth functions: what acts in a place has to do so whatever the robot does there.

use crate::{
    average::{Average, Input},
    series::Series,
};

/// Differences of rim speeds by which a robot keeps to a straight line [m/s].
const STEERING_MPS: f64 = 0.02;
/// Differences of rim speeds over which small turns become large ones [m/s].
const SMALL_TURN_MPS: f64 = 0.1;
/// See [`SMALL_TURN_MPS`].
const TURN_MPS: f64 = 0.3;

/// Powers by way of driving, without their sizes: forces at the rim that change with turning, speed and slope, and powers of turning
/// that change with the same.
const WAYS: [fn(&Input) -> f64; 20] = [
    |_| 1.0,
    |i| i.rim_mps.abs(),
    |i| i.rim_mps.abs() * small(i, SMALL_TURN_MPS),
    |i| i.rim_mps.abs() * small(i, STEERING_MPS),
    |i| i.rim_mps.abs() * i.difference_mps.abs(),
    |i| i.rim_mps.abs() * i.speed_mps.abs(),
    |i| i.rim_mps * i.pitch_rad,
    |i| i.rim_mps.abs() * i.pitch_rad.abs(),
    |i| i.rim_mps * i.roll_rad,
    |i| i.rim_mps.abs() * i.roll_rad.abs(),
    |i| i.rim_mps.abs() * i.accel_mps2.abs(),
    |i| i.difference_mps.abs(),
    |i| i.difference_mps.abs() * small(i, SMALL_TURN_MPS),
    |i| i.difference_mps.abs() * small(i, TURN_MPS),
    |i| i.difference_mps.abs() * small(i, STEERING_MPS),
    |i| i.difference_mps.powi(2),
    |i| i.difference_mps.abs() * i.speed_mps.abs(),
    |i| i.difference_mps.abs() * i.pitch_rad.abs(),
    |i| i.difference_mps.abs() * i.roll_rad.abs(),
    |i| i.difference_mps * i.roll_rad,
];

fn small(input: &Input, turn_mps: f64) -> f64 {
    (-input.difference_mps.abs() / turn_mps).exp()
}

/// The columns of the drives under suspicion, each channel's own.
pub(crate) fn columns(series: &Series) -> Vec<Vec<f64>> {
    let of = |channel: usize, way: fn(&Input) -> f64| {
        let value = |a: &Average| if a.suspect && a.channel == channel { way(&a.input) } else { 0.0 };
        series.averages.iter().map(value).collect()
    };
    (0..series.channels()).flat_map(|channel| WAYS.iter().map(move |way| of(channel, *way))).collect()
}
