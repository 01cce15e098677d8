//! Figures beside their goals.

use maud::{Markup, html};
use prove::{Rate, Scoreboard};

use super::{false_alarms, interval, share_of};
use crate::figures::{decimals, percent};

/// z from which on an effect counts as strong.
const STRONG_Z: f64 = 32.0;

/// A figure beside its goal.
struct Line {
    what: &'static str,
    reached: Option<f64>,
    shown: Markup,
    interval: String,
    goal: &'static str,
    range: [f64; 2],
}

/// The table, with goals for worlds that share nothing with the model.
pub(super) fn table(board: &Scoreboard) -> Markup {
    html! {
        table.board {
            thead { tr { th { "figure" } th { "reached" } th { "95 % interval" } th { "goal" } th { "outcome" } } }
            tbody {
                @for line in rates(board).iter().chain(&medians(board)).chain(&failures(board)) { (row(line)) }
            }
        }
    }
}

fn rates(board: &Scoreboard) -> Vec<Line> {
    let strong = board.strengths.iter().filter(|row| row.from_z >= STRONG_Z);
    let (hits, of) = strong.fold((0, 0), |(h, n), row| (h + row.in_two.hits, n + row.in_two.of));
    vec![
        rate(
            "False alarms: healthy drives, decoys, drives without their effect, failures included",
            false_alarms(board),
            "≤ 2 %",
            [0.0, 0.02],
        ),
        rate(
            "Named, truth in a set of two at most, from z = 32 on",
            Rate::new(hits, of),
            "≥ 75 %",
            [0.75, 1.0],
        ),
        rate("Named, truth in a set of two at most, all strengths", board.in_two, "", [0.0, 1.0]),
        rate(
            "Of those not named, less than the report says would be noticed",
            board.missed_too_small,
            "",
            [0.0, 1.0],
        ),
        rate("Names given that were right", board.naming_precision, "≥ 95 %", [0.95, 1.0]),
        rate("Both of two effects named", board.both_of_two, "≥ 60 %", [0.6, 1.0]),
        rate("Sensor fault called physics", board.sensor_called_physics, "≤ 3 %", [0.0, 0.03]),
        rate("Physics called sensor fault", board.physics_called_sensor, "≤ 3 %", [0.0, 0.03]),
        rate("Effects outside the list not misnamed", board.unlisted_not_misnamed, "≥ 90 %", [0.9, 1.0]),
    ]
}

fn medians(board: &Scoreboard) -> Vec<Line> {
    vec![
        share(
            "Held-out mismatch that discovered terms explain, median",
            board.unlisted_explained_median,
            "≥ 60 %",
            [0.6, f64::MAX],
        ),
        share("Error of an effect's numbers, median", board.parameter_error_median, "≤ 15 %", [0.0, 0.15]),
        rate("95 % intervals that hold the truth", board.interval_coverage, "90–98 %", [0.9, 0.98]),
        ratio(
            "Held-out error after correction ÷ that of the drive without the effect, median",
            board.rmse_ratio_listed_median,
            "≤ 1.03",
        ),
        ratio("The same of the noise floor, which grows with power", board.noise_ratio_listed_median, ""),
        ratio(
            "The same of errors where an effect outside the list acts",
            board.rmse_ratio_unlisted_median,
            "",
        ),
    ]
}

fn failures(board: &Scoreboard) -> Vec<Line> {
    vec![
        rate("Said “consistent” although something acted", board.abstained, "", [0.0, 1.0]),
        rate("Diagnoses that failed", board.errors, "0", [0.0, 0.0]),
    ]
}

fn row(line: &Line) -> Markup {
    let [low, high] = line.range;
    let (class, outcome) = match line.reached {
        _ if line.goal.is_empty() => ("", ""),
        None => ("", "no such case"),
        Some(value) if (low..=high).contains(&value) => ("good", "reached"),
        Some(_) => ("bad", "missed"),
    };
    html! {
        tr {
            th scope="row" { (line.what) }
            td.number { (line.shown) }
            td.number.quiet { (line.interval) }
            td.number { (line.goal) }
            td class={ "number " (class) } { (outcome) }
        }
    }
}

fn rate(what: &'static str, rate: Rate, goal: &'static str, range: [f64; 2]) -> Line {
    Line { what, reached: rate.share(), shown: share_of(rate), interval: interval(rate), goal, range }
}

fn share(what: &'static str, value: Option<f64>, goal: &'static str, range: [f64; 2]) -> Line {
    let shown = html! { (percent(value)) };
    Line { what, reached: value, shown, interval: String::new(), goal, range }
}

fn ratio(what: &'static str, value: Option<f64>, goal: &'static str) -> Line {
    let shown = html! { (decimals(value, 3)) };
    Line { what, reached: value, shown, interval: String::new(), goal, range: [0.0, 1.03] }
}
