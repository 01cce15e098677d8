//! Fits, predictions and diagnoses end soon after who asked for them says so.

#![allow(clippy::unwrap_used)]

use std::{
    ops::ControlFlow,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};

use calibration::{
    Drives, Error, Method, Options, calibrate, calibrate_watched,
    power::{PowerModel, by_row},
    predict_watched,
};
use model::builtin;
use recording::{Channel, Recording, Watch, unwatched};

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

/// The most rows whose power was asked for between two looks at the watch.
#[test]
fn a_pass_over_the_rows_looks_at_its_watch_every_few_thousand_of_them() {
    const MOST_ROWS: usize = 4096;
    let mut random = seeded(6);
    let plain = drives(&mut random, 3, 4000);
    let recording = with_power(&file(), plain, &mut random);
    let (rows, most) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicUsize::new(0)));
    let (since, longest) = (Arc::clone(&rows), Arc::clone(&most));
    let watch: Watch = Arc::new(move |_| {
        longest.fetch_max(since.swap(0, Ordering::Relaxed), Ordering::Relaxed);
        ControlFlow::Continue(())
    });
    let drives = Drives::watched(&file(), &recording, &watch).unwrap();
    rows.store(0, Ordering::Relaxed);
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let count = || {
        rows.fetch_add(1, Ordering::Relaxed);
        [0.0]
    };
    one_thread.install(|| {
        by_row(&drives, &file(), |_, _| count()).unwrap();
        PowerModel::new(&drives).unwrap().averages(&file(), |_, _| count()).unwrap();
    });
    drives.go_on().unwrap();
    let most = most.load(Ordering::Relaxed);
    assert!(drives.rows.len() > 2 * MOST_ROWS, "{} rows are looked at at once", drives.rows.len());
    assert!((1..=MOST_ROWS).contains(&most), "{most} rows between two looks");
}

/// Preparing, predicting and fitting look the more often the more rows there are, wherever the rows are gone through.
#[test]
fn preparing_drives_looks_at_its_watch_in_proportion_to_their_rows() {
    let looks = |rows: usize| {
        let mut random = seeded(5);
        let plain = drives(&mut random, 1, rows);
        let mut recording = with_power(&file(), plain, &mut random);
        // Heights, so that slopes are worked out by them.
        let heights_m = recording.t_s.iter().map(|t_s| 0.3 * (0.05 * t_s).sin()).collect();
        recording.channels.remove(&Channel::Pitch);
        recording.channels.insert(Channel::Z, heights_m);
        let (watch, asked) = breaking_at(usize::MAX);
        Drives::watched(&file(), &recording, &watch).unwrap();
        (asked.load(Ordering::Relaxed), recording.rows())
    };
    let ((few, few_rows), (many, many_rows)) = (looks(10_000), looks(40_000));
    let more_rows = many_rows - few_rows;
    // Inputs and the noise at standstill every 4096 rows, slopes every 256.
    let expected = more_rows / 256 + 2 * (more_rows / 4096);
    assert!(many - few >= expected, "{few} looks at {few_rows} rows, {many} at {many_rows}");
}

#[test]
fn the_procedure_of_the_paper_stops_too() {
    let (recording, options) = (by_power(), Options::default());
    let (never, asked) = breaking_at(usize::MAX);
    let whole = Method::DogruMarques.calibrate_watched(&file(), &recording, &options, &never);
    let all = asked.load(Ordering::Relaxed);
    for last in [1, all / 2, all] {
        let watch = breaking_at(last).0;
        let stopped = Method::DogruMarques.calibrate_watched(&file(), &recording, &options, &watch);
        assert!(matches!(stopped, Err(Error::Stopped)), "at {last} of {all}: {whole:?}");
    }
}
