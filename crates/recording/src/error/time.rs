//! What can be wrong with times.

use super::Position;
use crate::clock::{TimeEvidence, remedy};

/// An error about times; the message names place and column, and says how to mend it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TimeError {
    /// Time that does not increase within a run.
    #[error(
        "{position}: time {} from {previous_s} s to {t_s} s in run `{run}`; {}",
        if t_s == previous_s { "repeats" } else { "goes back" },
        order_remedy(*t_s, *previous_s)
    )]
    TimeOrder {
        /// Line or row.
        position: Position,
        /// The run.
        run: String,
        /// The time there \[s\].
        t_s: f64,
        /// The time before it \[s\].
        previous_s: f64,
    },
    /// Runs whose rows take turns on one clock.
    #[error(
        "{position}: the runs {} take turns, so that {counted_s:.1} s would be counted of the {passed_s:.1} s that passed; give all rows of a \
         drive one name in the column `run`, or remove the column",
        some_of(runs)
    )]
    RunsTakeTurns {
        /// Line or row at which a run goes on behind another.
        position: Position,
        /// The runs.
        runs: Vec<String>,
        /// Time of all runs \[s\].
        counted_s: f64,
        /// Time from the first row to the last \[s\].
        passed_s: f64,
    },
    /// Times of which many are equal.
    #[error(
        "{position}: time repeats {t_s} s in run `{run}`, whose {rows} rows have {}: its times are rounded; write `{column}` with more \
         digits, or number the drives in a column `run` if there are several",
        match resolution_s {
            Some(resolution_s) => format!("{times} different times, {resolution_s} s apart"),
            None => "one time in all".to_owned(),
        }
    )]
    RoundedTimes {
        /// Line or row of the first repeat.
        position: Position,
        /// The run.
        run: String,
        /// The time column.
        column: String,
        /// The time that repeats \[s\].
        t_s: f64,
        /// Rows of the run.
        rows: usize,
        /// Different times among them.
        times: usize,
        /// Median step from one to the next \[s\].
        resolution_s: Option<f64>,
    },
    /// Times that cannot be in seconds.
    #[error(
        "{position}, run `{run}`: {evidence}: `{column}` must be in seconds; {}",
        remedy(*evidence, column, map_unit.as_deref())
    )]
    NotSeconds {
        /// Line or row of the first such time.
        position: Position,
        /// The run.
        run: String,
        /// The time column.
        column: String,
        /// The evidence.
        evidence: TimeEvidence,
        /// The unit that a map gave for the column, if one did.
        map_unit: Option<String>,
    },
    /// Messages whose steps are not those of a drive log.
    #[error(
        "topic {topic}: {evidence}; name another topic as `base` in a map, or try the map with `\"stamp\": \"{other}\"`"
    )]
    TopicSteps {
        /// The topic whose stamps become the rows.
        topic: String,
        /// The evidence.
        evidence: TimeEvidence,
        /// The other clock that the map may ask for.
        other: &'static str,
    },
    /// A unit in a map that contradicts the type of the column.
    #[error(
        "map: the unit of column `{column}` is given as `{unit}`, but the file stores it in `{own}` by its type; leave the unit out"
    )]
    TypedUnit {
        /// The column.
        column: String,
        /// The unit in the map.
        unit: String,
        /// The unit of its type.
        own: &'static str,
    },
    /// A row without a time.
    #[error("{position}: there is no time in column `{column}`; remove the row or fill it in")]
    NoTime {
        /// Line or row.
        position: Position,
        /// The time column.
        column: String,
    },
    /// The clock of a topic was set while it was recorded.
    #[error(
        "topic {topic}, message {message}: its clock jumps by {by_s:.3} s; cut the file there, or try the map with `\"stamp\": \"{other}\"`"
    )]
    ClockJump {
        /// The topic.
        topic: String,
        /// Which of its messages, from 1.
        message: usize,
        /// How far it jumps \[s\], forwards or back.
        by_s: f64,
        /// The other clock that the map may ask for.
        other: &'static str,
    },
}

/// The first few names of several.
fn some_of(names: &[String]) -> String {
    /// Enough to find the column's mistake by.
    const MOST_SHOWN: usize = 4;
    let shown: Vec<String> = names.iter().take(MOST_SHOWN).map(|name| format!("`{name}`")).collect();
    let more = if names.len() > MOST_SHOWN { " and others" } else { "" };
    format!("{}{more}", shown.join(", "))
}

/// The remedy for a time that is not later than the one before \[s\].
///
/// Where a clock was set or a drive begins anew, rows are in order as they stand, and sorting would mix what happened at different times.
fn order_remedy(t_s: f64, previous_s: f64) -> String {
    /// How far a step back may be from the length that explains it \[s\]: a step of the slowest log, and a pause.
    const NEAR_S: f64 = 60.0;
    /// Lengths after which clocks begin anew, and what then mends it \[s\].
    const ANEW: [(f64, &str); 4] = [
        (3600.0, "an hour back is the end of summer time: write times in UTC or with their offset, "),
        (86_400.0, "a day back is midnight: write the date with the time, "),
        (
            4_294.967_296,
            "a counter of 32 bits in microseconds begins anew there: add 4294.967296 s from this line on, ",
        ),
        (
            4_294_967.296,
            "a counter of 32 bits in milliseconds begins anew there: add 4294967.296 s from this line on, ",
        ),
    ];
    let back_s = previous_s - t_s;
    if back_s == 0.0 {
        return "remove one of the rows, or number the drives in a column `run`".to_owned();
    }
    let anew =
        ANEW.iter().find(|(length_s, _)| (back_s - length_s).abs() <= NEAR_S).map_or("", |found| found.1);
    format!(
        "{anew}where a clock was set back or a drive begins, cut the file there or give the rows from this line on a `run` of their own; \
         sort the rows only where their order is wrong"
    )
}
