//! The check of time, which every reading passes before anything is computed.
//!
//! A drive log says power and speed often enough to follow a robot, lasts days at most, and counts from the start of a program or from
//! 1970. Times in another unit break one of these: their step, their magnitude, or both.

use std::fmt;

use crate::{
    Error, Recording, Run, TimeError,
    error::Position,
    gap::{STEP_ROUNDING, median, median_step_s},
    repeats::Repeats,
};

/// Longest median step of a run \[s\]: robots start, turn and stop within seconds, so that longer steps show none of it. Slow fleet
/// loggers write every 1 to 5 s; the same rows in milliseconds are above 10 from 100 Hz down.
pub const LONGEST_STEP_S: f64 = 10.0;

/// Shortest mean step of a run \[s\]: motor controllers log at 1 kHz, current loops run at 10 kHz. The mean is taken since messages that
/// were stamped on arrival come in bursts.
pub const SHORTEST_STEP_S: f64 = 1e-4;

/// Greatest magnitude of a time \[s\]: 2200 by Unix time. Clocks that count from 1900 or 1904 stay below it for as long.
pub const GREATEST_TIME_S: f64 = 7.258_118_4e9;

/// Unix times of the years 2000 to 2100 \[s\].
pub(crate) const UNIX_TIMES_S: [f64; 2] = [946_684_800.0, 4_102_444_800.0];

/// Steps of most loggers \[s\], 1 kHz to 0.5 Hz: what tells one unit from another by a step alone.
const USUAL_STEP_S: [f64; 2] = [1e-3, 2.0];

/// Steps that tell the rhythm of a run: of fewer, half may be pauses.
const LEAST_STEPS: usize = 3;

/// Symbol of the unit that times are kept in.
const SECONDS: &str = "s";

/// A unit that times may be in by mistake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeUnit {
    /// Its name in full.
    pub name: &'static str,
    /// Its name in maps.
    pub symbol: &'static str,
    /// Its length \[s\].
    pub length_s: f64,
}

/// Units that loggers write, but for seconds.
const UNITS: [TimeUnit; 6] = [
    TimeUnit { name: "milliseconds", symbol: "ms", length_s: 1e-3 },
    TimeUnit { name: "microseconds", symbol: "us", length_s: 1e-6 },
    TimeUnit { name: "nanoseconds", symbol: "ns", length_s: 1e-9 },
    TimeUnit { name: "minutes", symbol: "min", length_s: 60.0 },
    TimeUnit { name: "hours", symbol: "h", length_s: 3600.0 },
    TimeUnit { name: "days", symbol: "d", length_s: 86_400.0 },
];

/// Evidence that times are not seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeEvidence {
    /// The median step of a run is longer than [`LONGEST_STEP_S`].
    LongSteps {
        /// The median step \[s\].
        step_s: f64,
    },
    /// The mean step of a run is shorter than [`SHORTEST_STEP_S`].
    ShortSteps {
        /// The mean step \[s\].
        step_s: f64,
    },
    /// A time is greater than [`GREATEST_TIME_S`].
    Magnitude {
        /// The time \[s\].
        t_s: f64,
        /// The median step of its run, where there is one \[s\].
        step_s: Option<f64>,
    },
}

impl TimeEvidence {
    /// Units in which the same numbers would be the times of a drive log: by their magnitude if that is one of Unix times, else by
    /// their steps.
    pub fn likely_units(self) -> Vec<TimeUnit> {
        let within = |value: f64, [low, high]: [f64; 2]| (low..=high).contains(&value);
        let (t_s, step_s) = match self {
            TimeEvidence::LongSteps { step_s } | TimeEvidence::ShortSteps { step_s } => (None, Some(step_s)),
            TimeEvidence::Magnitude { t_s, step_s } => (Some(t_s), step_s),
        };
        let by_magnitude = |unit: &TimeUnit| t_s.is_some_and(|t| within(t * unit.length_s, UNIX_TIMES_S));
        let by_step = |unit: &TimeUnit| step_s.is_some_and(|step| within(step * unit.length_s, USUAL_STEP_S));
        let unix: Vec<TimeUnit> = UNITS.into_iter().filter(by_magnitude).collect();
        if unix.is_empty() { UNITS.into_iter().filter(by_step).collect() } else { unix }
    }
}

impl fmt::Display for TimeEvidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TimeEvidence::LongSteps { step_s } => {
                let step_s = rounded(*step_s);
                write!(f, "rows are {step_s} s apart, and {LONGEST_STEP_S} s at most show how a robot moves")
            }
            TimeEvidence::ShortSteps { step_s } => {
                let step_s = rounded(*step_s);
                write!(f, "rows are {step_s} s apart, closer than the {SHORTEST_STEP_S} s of any logger")
            }
            TimeEvidence::Magnitude { t_s, step_s: None } => {
                write!(f, "{t_s} s is beyond the year 2200 of any clock")
            }
            TimeEvidence::Magnitude { t_s, step_s: Some(step_s) } => {
                let step_s = rounded(*step_s);
                write!(f, "{t_s} s is beyond the year 2200 of any clock, and rows are {step_s} s apart")
            }
        }
    }
}

/// A number to six digits, for messages.
pub(crate) fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// Where times of a recording come from, for messages.
pub(crate) struct TimeSource<'a> {
    /// Name of the column.
    pub(crate) column: &'a str,
    /// Unit that a map gives, if any does.
    pub(crate) map_unit: Option<&'a str>,
    /// Rows of the file that a row stands for.
    pub(crate) weight: &'a dyn Fn(usize) -> u32,
    /// Place of a row in the file.
    pub(crate) position: &'a dyn Fn(usize) -> Position,
}

impl Recording {
    /// Checks that times are finite, are seconds by their magnitude and step, and increase within each run. Readers do this already;
    /// code that makes recordings may call it.
    ///
    /// # Errors
    /// The row, the run and the evidence.
    pub fn check_time(&self) -> Result<(), Error> {
        let position = |row: usize| Position::Row(row as u64 + 1);
        check_time(self, &TimeSource { column: "t_s", map_unit: None, weight: &|_| 1, position: &position })
    }
}

/// Checks the times of a recording that was read.
pub(crate) fn check_time(recording: &Recording, source: &TimeSource<'_>) -> Result<(), Error> {
    if let Some(row) = recording.t_s.iter().position(|t| !t.is_finite()) {
        return Err(
            TimeError::NoTime { position: (source.position)(row), column: source.column.to_owned() }.into()
        );
    }
    // The unit of all rows comes before the order of some: times too great for their steps repeat by rounding.
    for run in &recording.runs {
        check_magnitude(recording, run, source)?;
    }
    for run in &recording.runs {
        check_order(recording, run, source)?;
    }
    for run in &recording.runs {
        let weight = |row: usize| (source.weight)(run.rows.start + row);
        match implausible_steps(times(recording, run), weight) {
            // Whoever names seconds in a map knows that rows are so far apart.
            Some(TimeEvidence::LongSteps { .. }) if source.map_unit == Some(SECONDS) => {}
            Some(evidence) => return Err(not_seconds(run, run.rows.start, evidence, source)),
            None => {}
        }
    }
    Ok(())
}

fn times<'a>(recording: &'a Recording, run: &Run) -> &'a [f64] {
    recording.t_s.get(run.rows.clone()).unwrap_or_default()
}

fn check_magnitude(recording: &Recording, run: &Run, source: &TimeSource<'_>) -> Result<(), Error> {
    let t_s = times(recording, run);
    let Some(at) = t_s.iter().position(|t| t.abs() > GREATEST_TIME_S) else { return Ok(()) };
    let step_s = median_step_s(t_s).filter(|step_s| *step_s > 0.0);
    let evidence = TimeEvidence::Magnitude { t_s: t_s[at], step_s };
    Err(not_seconds(run, run.rows.start + at, evidence, source))
}

fn check_order(recording: &Recording, run: &Run, source: &TimeSource<'_>) -> Result<(), Error> {
    let t_s = times(recording, run);
    let Some(at) = t_s.windows(2).position(|pair| pair[1] <= pair[0]) else { return Ok(()) };
    if let Some(Repeats { times, step_s }) = Repeats::of(t_s) {
        return Err(TimeError::RoundedTimes {
            position: (source.position)(run.rows.start + at + 1),
            run: run.name.clone(),
            column: source.column.to_owned(),
            t_s: t_s[at],
            rows: t_s.len(),
            times,
            resolution_s: step_s.map(rounded),
        }
        .into());
    }
    Err(TimeError::TimeOrder {
        position: (source.position)(run.rows.start + at + 1),
        run: run.name.clone(),
        t_s: t_s[at + 1],
        previous_s: t_s[at],
    }
    .into())
}

/// Evidence that the steps of a run are not those of a log in seconds; `None` for fewer than [`LEAST_STEPS`]. `weight` is the
/// number of rows of the file that a row is the mean of.
///
/// From the middle of such a row to the middle of the next are (w₁ + w₂) / 2 steps of the file.
pub(crate) fn implausible_steps(t_s: &[f64], weight: impl Fn(usize) -> u32) -> Option<TimeEvidence> {
    if t_s.len() <= LEAST_STEPS {
        return None;
    }
    let steps_between = |row: usize| 0.5 * (f64::from(weight(row)) + f64::from(weight(row + 1)));
    let in_file = |(row, pair): (usize, &[f64])| (pair[1] - pair[0]) / steps_between(row);
    let median_s = median(t_s.windows(2).enumerate().map(in_file).collect())?;
    let mean_s = (t_s.last()? - t_s.first()?) / (0..t_s.len() - 1).map(steps_between).sum::<f64>();
    if median_s > LONGEST_STEP_S * (1.0 + STEP_ROUNDING) {
        Some(TimeEvidence::LongSteps { step_s: median_s })
    } else if mean_s < SHORTEST_STEP_S * (1.0 - STEP_ROUNDING) {
        Some(TimeEvidence::ShortSteps { step_s: mean_s })
    } else {
        None
    }
}

fn not_seconds(run: &Run, row: usize, evidence: TimeEvidence, source: &TimeSource<'_>) -> Error {
    TimeError::NotSeconds {
        position: (source.position)(row),
        run: run.name.clone(),
        column: source.column.to_owned(),
        evidence,
        map_unit: source.map_unit.map(str::to_owned),
    }
    .into()
}

/// The remedy for times that are not seconds, for messages.
pub(crate) fn remedy(evidence: TimeEvidence, column: &str, map_unit: Option<&str>) -> String {
    if let Some(unit) = map_unit.filter(|unit| *unit != SECONDS) {
        return format!("the map gives its unit as `{unit}`: correct it");
    }
    let units = evidence.likely_units();
    let names: Vec<&str> = units.iter().map(|unit| unit.name).collect();
    let seconds = match evidence {
        TimeEvidence::LongSteps { .. } => "; `s` if rows are so far apart",
        TimeEvidence::ShortSteps { .. } | TimeEvidence::Magnitude { .. } => "",
    };
    match units.first() {
        None => format!("give its unit in a map{seconds}"),
        Some(first) => format!(
            "these look like {}: give its unit in a map, as {{\"channel\": \"t_s\", \"column\": \"{column}\", \"unit\": \"{}\"}}{seconds}",
            names.join(" or "),
            first.symbol
        ),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn check(t_s: Vec<f64>) -> Result<(), Error> {
        let runs = vec![Run::new("drive".into(), 0..t_s.len(), &t_s, None)];
        Recording { t_s, runs, ..Recording::default() }.check_time()
    }

    fn even(start: f64, step: f64, rows: usize) -> Vec<f64> {
        (0..rows).map(|row| start + step * row as f64).collect()
    }

    #[test]
    fn times_of_drive_logs_pass_whatever_their_clock_rhythm_and_pauses() {
        let mut paused = even(0.0, 5.0, 100);
        paused.extend(even(40_000.0, 5.0, 100));
        let bursts: Vec<f64> = (0..200).map(|row| f64::from(row / 10) + 2e-6 * f64::from(row % 10)).collect();
        for t_s in [
            even(0.0, 0.1, 600),
            even(0.0, 1e-4, 600),
            even(0.0, 1e-3, 600),
            even(0.0, 5.0, 600),
            even(0.0, 10.0, 600),
            even(1_764_338_400.123, 0.01, 600),
            even(3_973_327_200.5, 0.1, 600),
            even(-3.0, 0.1, 600),
            even(0.0, 1.0, 1),
            vec![0.0, 5.0, 3600.0],
            vec![0.0, 3600.0],
            paused,
            bursts,
            vec![0.0, 1.0, 2.0, 1_764_338_400.0, 1_764_338_401.0],
        ] {
            assert!(check(t_s.clone()).is_ok(), "{:?}", &t_s[..t_s.len().min(3)]);
        }
    }

    #[test]
    fn other_units_are_refused_by_their_evidence_and_named() {
        for (t_s, said) in [
            (even(1_700_000_000_100_000_000.0, 1e8, 600), "nanoseconds"),
            (even(1_700_000_000_100_000_000.0, 1e3, 600), "nanoseconds"),
            (vec![1_764_338_400_000_000_000.0], "nanoseconds"),
            (even(1_764_338_400_000_000.0, 1e5, 600), "microseconds"),
            (even(1_764_338_400_000.0, 5.0, 600), "milliseconds"),
            (even(-1_764_338_400_000.0, 5.0, 600), "year 2200"),
            (even(0.0, 100.0, 600), "rows are 100 s apart"),
            (even(0.0, 100.0, 600), "look like milliseconds"),
            (even(0.0, 20.0, 600), "look like milliseconds"),
            (even(0.0, 1e5, 600), "look like microseconds"),
            (even(0.0, 1e8, 50), "look like nanoseconds"),
            (even(0.0, 1000.0, 600), "milliseconds or microseconds"),
            (even(0.0, 0.1 / 3600.0, 600), "look like minutes or hours"),
            (even(0.0, 0.1 / 86_400.0, 600), "look like hours or days"),
            (even(0.0, 1e-13, 600), "give its unit in a map"),
        ] {
            let message = check(t_s.clone()).unwrap_err().to_string();
            assert!(message.contains(said) && message.contains("must be in seconds"), "{said}: {message}");
            assert!(message.contains("row 1") && message.contains("run `drive`"), "{message}");
        }
    }

    #[test]
    fn every_run_is_checked_for_itself_and_named_with_its_row() {
        let [seconds, millis] = [even(0.0, 0.1, 50), even(0.0, 100.0, 50)];
        let t_s = [seconds, millis].concat();
        let runs = [(0..50, "first"), (50..100, "second")];
        let runs = runs.map(|(rows, name)| Run::new(name.into(), rows, &t_s, None)).into();
        let message = Recording { t_s, runs, ..Recording::default() }.check_time().unwrap_err().to_string();
        assert!(message.starts_with("row 51, run `second`: rows are 100 s apart"), "{message}");
    }

    #[test]
    fn rows_that_are_means_are_judged_by_the_steps_of_their_file() {
        let joined = |step_s: f64, weight: u32| {
            implausible_steps(&even(0.0, step_s * f64::from(weight), 600), |_| weight)
        };
        let days_at_ten_hertz = 0.1 / 86_400.0;
        assert!(matches!(joined(days_at_ten_hertz, 128), Some(TimeEvidence::ShortSteps { .. })));
        assert!(matches!(joined(20.0, 128), Some(TimeEvidence::LongSteps { step_s }) if step_s == 20.0));
        assert_eq!(joined(0.1, 128), None);
        // Of rows 1 s apart, the first 300 were joined 4:1: the step between a mean and a row is 2.5 s.
        let means = (0..300).map(|row| 1.5 + 4.0 * f64::from(row));
        let t_s: Vec<f64> = means.chain((0..300).map(|row| 1200.0 + f64::from(row))).collect();
        let weight = |row: usize| if row < 300 { 4 } else { 1 };
        let slow: Vec<f64> = t_s.iter().map(|t| 11.0 * t).collect();
        assert_eq!(implausible_steps(&t_s, weight), None);
        assert_eq!(implausible_steps(&slow, weight), Some(TimeEvidence::LongSteps { step_s: 11.0 }));
    }

    proptest! {
        #[test]
        fn a_usual_log_passes_in_seconds_and_in_no_smaller_unit_from_the_unix_epoch_on(
            start_s in 946_684_800.0..4_102_444_800.0f64, step_s in 0.001..5.0f64
        ) {
            prop_assert!(check(even(start_s, step_s, 30)).is_ok());
            for unit in UNITS.iter().filter(|unit| unit.length_s < 1.0) {
                let refused = check(even(start_s / unit.length_s, step_s / unit.length_s, 30));
                prop_assert!(refused.unwrap_err().to_string().contains(unit.name));
            }
        }
    }
}
