//! Recordings of many rows a second, whose wheels seem to jump by the encoder's steps.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use calibration::{Options, calibrate, predict};
use recording::{Channel, Recording, Run};

mod simulated;
use simulated::{drives, seeded, with_power, worlds::file};

/// Rows of a fast recording for each of a slow one, and by how much a wheel's speed is read off in each [m/s].
const DITHER_MPS: [f64; 5] = [0.04, -0.04, 0.04, -0.04, 0.0];

/// The same drives read five times as often, with speeds that dither about those of before.
fn read_fast(slow: &Recording) -> Recording {
    let count = DITHER_MPS.len();
    let step_s = (slow.t_s[1] - slow.t_s[0]) / count as f64;
    let often = |values: &[f64], by: [f64; 5]| -> Vec<f64> {
        values.iter().flat_map(|value| by.map(|by| value + by)).collect()
    };
    let dithers = |channel: Channel| matches!(channel, Channel::LeftSpeed | Channel::RightSpeed);
    let by = |channel: Channel| if dithers(channel) { DITHER_MPS } else { [0.0; 5] };
    let channels = slow.channels.iter().map(|(channel, values)| (*channel, often(values, by(*channel))));
    let run = |run: &Run| Run {
        name: run.name.clone(),
        rows: count * run.rows.start..count * run.rows.end,
        gap_s: run.gap_s,
        start_unix_s: run.start_unix_s,
    };
    Recording {
        t_s: often(&slow.t_s, [0.0, 1.0, 2.0, 3.0, 4.0].map(|step| step * step_s)),
        channels: channels.collect::<BTreeMap<_, _>>(),
        runs: slow.runs.iter().map(run).collect(),
        ..Recording::default()
    }
}

#[test]
fn steps_of_an_encoder_that_is_read_often_are_no_forces() {
    let mut random = seeded(5);
    let plain = drives(&mut random, 2, 600);
    let slow = with_power(&file(), plain, &mut random);
    let fast = read_fast(&slow);
    let fitted =
        |recording: &Recording| calibrate(&file(), recording, &Options::default()).unwrap().parameters;
    for (of_fast, of_slow) in fitted(&fast).iter().zip(fitted(&slow)) {
        let [fast, slow] = [of_fast.value, of_slow.value];
        assert!((fast - slow).abs() <= 1e-3 * slow.abs(), "{}: {fast}, {slow}", of_slow.name);
    }
    let [of_fast, of_slow] =
        [&fast, &slow].map(|recording| predict(&file(), recording).unwrap().prediction.total.rmse_w);
    assert!((of_fast - of_slow).abs() < 1e-3 * of_slow, "{of_fast} {of_slow}");
}

#[test]
fn drives_without_slopes_are_said_to_have_been_taken_for_level() {
    let mut random = seeded(6);
    let plain = drives(&mut random, 2, 600);
    let mut level = with_power(&file(), plain, &mut random);
    level.channels.remove(&Channel::Pitch);
    let notes =
        |recording: &Recording| calibrate(&file(), recording, &Options::default()).unwrap().notes.join("; ");
    assert!(notes(&level).contains("taken for level"), "{}", notes(&level));
    level.channels.insert(Channel::Z, vec![0.0; level.t_s.len()]);
    assert!(notes(&level).contains("those of the heights"), "{}", notes(&level));
}
