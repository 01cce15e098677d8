//! Fits, predictions and diagnoses end soon after who asked for them says so.

#![allow(clippy::unwrap_used)]

use std::{
    ops::ControlFlow,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};

use calibration::{Error, Options, calibrate, calibrate_watched, predict_watched};
use model::builtin;
use recording::{Recording, Watch, unwatched};

mod simulated;
use simulated::{
    drives, seeded, with_power,
    worlds::{current_truth, file, with_currents},
};

/// A watch that breaks at the question of a number, and the number of questions so far.
fn breaking_at(last: usize) -> (Watch, Arc<AtomicUsize>) {
    let asked = Arc::new(AtomicUsize::new(0));
    let count = Arc::clone(&asked);
    let watch: Watch = Arc::new(move |_| {
        let before = count.fetch_add(1, Ordering::Relaxed);
        if before + 1 >= last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    (watch, asked)
}

fn by_power() -> Recording {
    let mut random = seeded(3);
    let plain = drives(&mut random, 4, 300);
    with_power(&file(), plain, &mut random)
}

fn by_currents() -> Recording {
    let mut random = seeded(4);
    let truth = current_truth(&mut random);
    let plain = drives(&mut random, 4, 300);
    with_currents(&truth, plain, &mut random)
}

#[test]
fn a_calibration_stops_wherever_its_watch_breaks_and_asks_hardly_any_more() {
    for (robot, recording) in [(file(), by_power()), (builtin::husky_a200(), by_currents())] {
        let (never, asked) = breaking_at(usize::MAX);
        calibrate_watched(&robot, &recording, &Options::default(), &never).unwrap();
        let all = asked.load(Ordering::Relaxed);
        assert!(all > 200, "a watch is asked throughout: {all}");
        for last in [1, 2, 3, all / 10, all / 3, all / 2, all - 1] {
            let (watch, asked) = breaking_at(last);
            let stopped = calibrate_watched(&robot, &recording, &Options::default(), &watch);
            assert!(matches!(stopped, Err(Error::Stopped)), "at {last} of {all}");
            // Fits side by side each ask once more.
            let more = asked.load(Ordering::Relaxed) - last;
            assert!(more <= 8, "{more} questions after it broke at {last} of {all}");
        }
    }
}

#[test]
fn a_watch_that_never_breaks_changes_nothing() {
    let (robot, recording, options) = (file(), by_power(), Options::default());
    let watched = calibrate_watched(&robot, &recording, &options, &unwatched()).unwrap();
    assert_eq!(watched, calibrate(&robot, &recording, &options).unwrap());
}

#[test]
fn a_prediction_stops_too() {
    let recording = by_power();
    let (never, asked) = breaking_at(usize::MAX);
    predict_watched(&file(), &recording, &never).unwrap();
    for last in 1..=asked.load(Ordering::Relaxed) {
        let stopped = predict_watched(&file(), &recording, &breaking_at(last).0);
        assert!(matches!(stopped, Err(Error::Stopped)), "at {last}");
    }
}
