//! A drive that tests are made of.

use std::collections::BTreeMap;

use model::Robot;
use recording::{Channel, Recording, Run};

use crate::{imitate, observe::span::Applied};

/// A quarter of an hour over hills at changing speeds and turns, with power that the model would show and 2 W of noise.
pub(crate) fn drive(robot: &Robot, phase_rad: f64, applied: &[Applied]) -> Recording {
    let rows = 9000;
    let wave =
        |period_s: f64| move |i: usize| (0.1 * i as f64 * std::f64::consts::TAU / period_s + phase_rad).sin();
    let (speed, turn, slope) = (wave(47.0), wave(31.0), wave(73.0));
    let column = |value: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..rows).map(value).collect() };
    let side = |sign: f64| column(&|i| 0.5 + 0.25 * speed(i) + sign * 0.15 * turn(i));
    let channels = BTreeMap::from([
        (Channel::LeftSpeed, side(-1.0)),
        (Channel::RightSpeed, side(1.0)),
        (Channel::Pitch, column(&|i| 0.06 * slope(i))),
        (Channel::LeftPower, vec![50.0; rows]),
        (Channel::RightPower, vec![50.0; rows]),
    ]);
    let t_s = column(&|i| 0.1 * i as f64);
    let runs = vec![Run { name: "hills".into(), rows: 0..rows, gap_s: 0.5, start_unix_s: None }];
    let mut made =
        imitate(robot, &Recording { t_s, channels, runs, ..Recording::default() }, applied).unwrap();
    let mut state = 88_172_645_463_325_252_u64 ^ phase_rad.to_bits();
    for channel in [Channel::LeftPower, Channel::RightPower] {
        for power_w in made.channels.get_mut(&channel).unwrap() {
            // Xorshift (Marsaglia, "Xorshift RNGs", J. Stat. Softw. 8(14), 2003), uniform with a deviation of 2 W.
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            *power_w += 2.0 * 12.0_f64.sqrt() * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
        }
    }
    made
}
