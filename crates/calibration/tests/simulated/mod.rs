//! Simulated drives, and what they would record.

#![allow(dead_code)]

use std::collections::BTreeMap;

use calibration::{
    Drives,
    power::{by_row, seen_w},
};
use model::{Robot, builtin};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use recording::{Channel, Labels, PowerForm, Recording, Run};

pub(crate) mod coverage;
pub(crate) mod doubted;
pub(crate) mod worlds;

pub(crate) const RUNS: usize = 12;
pub(crate) const ROWS: usize = 400;

/// A generator of its own for each seed.
///
/// Neighbouring states of this generator begin alike, so seeds are spread by an odd number (2^128 over the golden ratio).
pub(crate) fn seeded(seed: u64) -> Pcg64Mcg {
    Pcg64Mcg::new((2 * u128::from(seed) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15_f39c_c060_5ced_c835))
}

/// A standard normal number, by Box and Muller.
pub(crate) fn normal(random: &mut Pcg64Mcg) -> f64 {
    let (a, b): (f64, f64) = (random.random(), random.random());
    (-2.0 * (1.0 - a).ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// Drives with straights, arcs, spins, slopes and halts, without power yet.
pub(crate) fn drives(random: &mut Pcg64Mcg, runs: usize, rows: usize) -> Recording {
    let mut recording = Recording::default();
    let mut channels: BTreeMap<Channel, Vec<f64>> = BTreeMap::new();
    for run in 0..runs {
        let start = recording.t_s.len();
        let (mut left, mut right) = (0.0, 0.0);
        let (mut to_left, mut to_right) = (0.0, 0.0);
        let phase = random.random::<f64>() * std::f64::consts::TAU;
        for row in 0..rows {
            if row % 40 == 0 {
                let speed: f64 = random.random_range(-0.4..0.9);
                let turn: f64 = [0.0, random.random_range(-0.4..0.4)][random.random_range(0..2)];
                let spin = random.random_range(0..4) == 0;
                let halt = random.random_range(0..6) == 0;
                let (v, d) = if halt {
                    (0.0, 0.0)
                } else if spin {
                    (0.0, turn)
                } else {
                    (speed, turn)
                };
                (to_left, to_right) = (v - d, v + d);
            }
            left += (to_left - left) * 0.3;
            right += (to_right - right) * 0.3;
            recording.t_s.push(row as f64 * 0.1);
            let pitch = 0.15 * (phase + row as f64 * 0.013).sin();
            for (channel, value) in
                [(Channel::LeftSpeed, left), (Channel::RightSpeed, right), (Channel::Pitch, pitch)]
            {
                channels.entry(channel).or_default().push(value);
            }
        }
        let rows = start..recording.t_s.len();
        recording.runs.push(Run { name: format!("run-{run}"), rows, gap_s: 0.5, start_unix_s: None });
    }
    recording.channels = channels;
    recording
}

/// The power that a robot would show on these drives, with noise of 2 W and 3 %.
pub(crate) fn with_power(robot: &Robot, mut recording: Recording, random: &mut Pcg64Mcg) -> Recording {
    for channel in [Channel::LeftPower, Channel::RightPower] {
        recording.channels.insert(channel, vec![0.0; recording.t_s.len()]);
    }
    let prepared = Drives::new(robot, &recording).unwrap();
    let seen = by_row(&prepared, robot, |i, power| seen_w(robot, PowerForm::Sides, &prepared.rows[i], power))
        .unwrap();
    for (side, channel) in [Channel::LeftPower, Channel::RightPower].into_iter().enumerate() {
        let noisy = |watts: &[f64; 2]| watts[side] + (2.0 + 0.03 * watts[side].abs()) * normal(random);
        recording.channels.insert(channel, seen.iter().map(noisy).collect());
    }
    recording
}

/// The same recording with the power of the battery alone, hotel load included, and noise of 4 W and 3 %.
pub(crate) fn with_battery_power(
    robot: &Robot,
    mut recording: Recording,
    random: &mut Pcg64Mcg,
) -> Recording {
    recording.channels.insert(Channel::Power, vec![0.0; recording.t_s.len()]);
    let prepared = Drives::new(robot, &recording).unwrap();
    let seen =
        by_row(&prepared, robot, |i, power| seen_w(robot, PowerForm::Battery, &prepared.rows[i], power))
            .unwrap();
    let noisy = |[watts, _]: &[f64; 2]| watts + (4.0 + 0.03 * watts.abs()) * normal(random);
    recording.channels.insert(Channel::Power, seen.iter().map(noisy).collect());
    recording
}

/// Motors that warm from 15-30 °C by up to 60 K in each run.
pub(crate) fn with_heat(mut recording: Recording, random: &mut Pcg64Mcg) -> Recording {
    for channel in [Channel::LeftMotorTemperature, Channel::RightMotorTemperature] {
        let mut warm_c = Vec::with_capacity(recording.t_s.len());
        for run in &recording.runs {
            let (start_c, rise_k): (f64, f64) =
                (random.random_range(15.0..30.0), random.random_range(0.0..60.0));
            let rows = run.rows.len() as f64;
            warm_c.extend((0..run.rows.len()).map(|i| start_c + rise_k * i as f64 / rows));
        }
        recording.channels.insert(channel, warm_c);
    }
    recording
}

/// Every second run on another ground.
pub(crate) fn over_two_grounds(mut recording: Recording, names: [&str; 2]) -> Recording {
    let mut index = vec![0; recording.t_s.len()];
    recording.runs.iter().skip(1).step_by(2).for_each(|run| index[run.rows.clone()].fill(1));
    recording.surface = Some(Labels { names: names.map(String::from).to_vec(), index });
    recording
}

/// Healthy drives with the yaw rate that the wheels give a Husky, and roll.
pub(crate) fn healthy() -> Recording {
    healthy_of(400)
}

/// Three healthy drives of so many rows each.
pub(crate) fn healthy_of(rows: usize) -> Recording {
    let mut random = seeded(5);
    let mut plain = drives(&mut random, 3, rows);
    let of = |recording: &Recording, channel| recording.channel(channel).unwrap().to_vec();
    let (left, right) = (of(&plain, Channel::LeftSpeed), of(&plain, Channel::RightSpeed));
    let yaw_rate =
        left.iter().zip(&right).map(|(l, r)| (r - l) / builtin::husky_a200().slip_track_m).collect();
    let roll = (0..plain.rows()).map(|i| 0.08 * (0.021 * i as f64).cos()).collect();
    plain.channels.insert(Channel::YawRate, yaw_rate);
    plain.channels.insert(Channel::Roll, roll);
    with_power(&builtin::husky_a200(), plain, &mut random)
}

/// A recording with some channels changed value by value.
pub(crate) fn changed(
    mut recording: Recording,
    channels: &[Channel],
    change: impl Fn(f64) -> f64,
) -> Recording {
    for channel in channels {
        recording.channels.get_mut(channel).unwrap().iter_mut().for_each(|value| *value = change(*value));
    }
    recording
}

/// Drives with the positions and heights that wheels and slopes bring them to.
pub(crate) fn placed(mut recording: Recording) -> Recording {
    let column = |channel| recording.channel(channel).unwrap().to_vec();
    let (left, right, pitch) =
        (column(Channel::LeftSpeed), column(Channel::RightSpeed), column(Channel::Pitch));
    let mut pose = [0.0_f64; 4];
    let places: Vec<[f64; 3]> = (0..recording.rows())
        .map(|i| {
            let [x, y, z, heading] = pose;
            let (speed, turn) =
                ((left[i] + right[i]) / 2.0, (right[i] - left[i]) / builtin::husky_a200().slip_track_m);
            let way = 0.1 * speed;
            pose = [
                x + way * heading.cos(),
                y + way * heading.sin(),
                z + way * pitch[i].sin(),
                heading + 0.1 * turn,
            ];
            [x, y, z]
        })
        .collect();
    for (axis, channel) in [Channel::X, Channel::Y, Channel::Z].into_iter().enumerate() {
        recording.channels.insert(channel, places.iter().map(|place| place[axis]).collect());
    }
    recording
}
