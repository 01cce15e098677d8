//! Time that one core takes for the power of a million moments on one surface, as JSON.
//!
//!     cargo run --release -p joulepath-model --example power_of_moments
//!
//! The least of several rounds, for each model of power: moments one at a time, each with its surface prepared anew, and as columns.
//! It is CPU time from Linux, which other work on the machine lengthens least; elsewhere it is time by the clock.

use std::{error::Error, fs, hint::black_box, time::Instant};

use model::{
    Attitude, MomentColumns, Motion, PowerColumns, PowerModel, PreparedSurface, Robot, Sides, builtin, power,
};
use serde_json::json;

const MOMENTS: usize = 1_000_000;
const ROUNDS: usize = 15;

fn main() -> Result<(), Box<dyn Error>> {
    let husky = builtin::husky_a200();
    // Weyl sequences: multiples of irrational numbers, of which the fractions fill a range evenly.
    let spread = |irrational: f64, most: f64| -> Vec<f64> {
        (0..MOMENTS).map(|moment| most * (2.0 * (moment as f64 * irrational).fract() - 1.0)).collect()
    };
    let moments = [
        spread(std::f64::consts::SQRT_2, 1.0),
        spread(std::f64::consts::E, 1.5),
        spread(std::f64::consts::PI, 0.4),
        spread(std::f64::consts::LN_2, 0.3),
    ];
    let mut columns = [const { Vec::new() }; 5].map(|_: Vec<f64>| vec![0.0; MOMENTS]);
    for model in [PowerModel::ForceBalance, PowerModel::DogruMarques] {
        for (way, compute) in [("one at a time", one_at_a_time as Way), ("columns", as_columns as Way)] {
            let mut least_s = f64::INFINITY;
            for _ in 0..ROUNDS {
                let (began, began_s) = (Instant::now(), cpu_s());
                compute(model, &husky, &moments, &mut columns)?;
                let by_clock_s = began.elapsed().as_secs_f64();
                let taken_s = cpu_s().zip(began_s).map_or(by_clock_s, |(ended_s, began_s)| ended_s - began_s);
                least_s = least_s.min(taken_s);
            }
            let mean_w = columns[0].iter().sum::<f64>() / MOMENTS as f64;
            let least_ms = 1e3 * least_s;
            println!(
                "{}",
                json!({"power_model": model, "way": way, "moments": MOMENTS, "least_ms": least_ms, "mean_w": mean_w})
            );
        }
    }
    Ok(())
}

/// CPU time of the first thread, which does all the work [s].
fn cpu_s() -> Option<f64> {
    let ran_ns: u64 =
        fs::read_to_string("/proc/self/schedstat").ok()?.split_whitespace().next()?.parse().ok()?;
    Some(ran_ns as f64 * 1e-9)
}

type Way = fn(PowerModel, &Robot, &[Vec<f64>; 4], &mut [Vec<f64>; 5]) -> Result<(), Box<dyn Error>>;

fn one_at_a_time(
    model: PowerModel,
    husky: &Robot,
    [speeds_mps, yaw_rates_radps, pitches_rad, rolls_rad]: &[Vec<f64>; 4],
    [bus_w, left_w, right_w, left_n, right_n]: &mut [Vec<f64>; 5],
) -> Result<(), Box<dyn Error>> {
    let marble = husky.surface("marble")?;
    for i in 0..MOMENTS {
        let motion = Motion::of_body(husky, speeds_mps[i], yaw_rates_radps[i]);
        let attitude = Attitude { pitch_rad: pitches_rad[i], roll_rad: rolls_rad[i] };
        let power = power(model, husky, black_box(marble), motion, attitude, Sides::both(20.0));
        bus_w[i] = power.bus_w;
        (left_w[i], right_w[i]) = (power.side_w.left, power.side_w.right);
        (left_n[i], right_n[i]) = (power.force_n.left, power.force_n.right);
    }
    Ok(())
}

fn as_columns(
    model: PowerModel,
    husky: &Robot,
    [speeds_mps, yaw_rates_radps, pitches_rad, rolls_rad]: &[Vec<f64>; 4],
    [bus_w, left_w, right_w, left_n, right_n]: &mut [Vec<f64>; 5],
) -> Result<(), Box<dyn Error>> {
    let prepared = PreparedSurface::new(model, husky, husky.surface("marble")?);
    let moments = MomentColumns {
        speed_mps: speeds_mps,
        yaw_rate_radps: yaw_rates_radps,
        pitch_rad: pitches_rad,
        roll_rad: rolls_rad,
        motor_temperature_c: Sides::both(&[20.0]),
    };
    let (side_w, force_n) =
        (Sides { left: &mut left_w[..], right: right_w }, Sides { left: &mut left_n[..], right: right_n });
    prepared.powers(&moments, 0, PowerColumns { bus_w, side_w, force_n });
    Ok(())
}
