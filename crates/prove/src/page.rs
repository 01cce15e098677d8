//! The scoreboard as a page that is understood in a minute.

use std::fmt::Write as _;

use crate::{
    Kind, Rate, Scoreboard,
    page_parts::{self as parts, escape, interval, number, percent},
};

const STYLE: &str = include_str!("page.css");

/// The page: one sentence, figures beside their goals, mechanisms by strength, other methods, and every case.
pub fn page(board: &Scoreboard) -> String {
    let mut html = String::from("<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\">");
    html += "<meta name=\"viewport\" content=\"width=device-width\"><title>Concealed trial</title>";
    let _ = write!(html, "<style>{STYLE}</style></head><body><main><h1>{}</h1>", sentence(board));
    let _ = write!(
        html,
        "<p class=quiet>{} cases from seed {}. The keys were committed to before the first diagnosis (SHA-256 of the list \
         <code>{}</code>) and found unchanged after the last.</p>",
        board.cases,
        board.seed,
        escape(&board.commitment)
    );
    html += &goals(board);
    html += &parts::mechanisms(board);
    html += "<div class=two>";
    html += &parts::strengths(board);
    html += &parts::peers(board);
    html += "</div>";
    html += &parts::cases(board);
    html + "</main></body></html>\n"
}

/// Everything in one sentence.
fn sentence(board: &Scoreboard) -> String {
    let quiet = quiet(board);
    let failed = match board.errors.hits {
        0 => String::new(),
        n => format!(", and {n} of {} diagnoses failed", board.cases),
    };
    format!(
        "{} of {} concealed effects were named; {} of {} drives that conceal nothing were not found healthy{failed}.",
        board.in_two.hits, board.in_two.of, quiet.hits, quiet.of
    )
}

/// False alarms on everything that conceals nothing.
fn quiet(board: &Scoreboard) -> Rate {
    let all = [board.false_alarms_healthy, board.false_alarms_decoy, board.false_alarms_twin];
    Rate::new(all.iter().map(|rate| rate.hits).sum(), all.iter().map(|rate| rate.of).sum())
}

/// A figure beside its goal.
struct Line {
    what: &'static str,
    reached: Option<f64>,
    shown: String,
    interval: String,
    goal: &'static str,
    range: [f64; 2],
}

/// Goals for worlds that share nothing with the model, at z = 32 and above where strength matters.
fn goals(board: &Scoreboard) -> String {
    let strong = board.strengths.iter().filter(|row| row.from_z >= 32.0);
    let (hits, of) = strong.fold((0, 0), |(h, n), row| (h + row.in_two.hits, n + row.in_two.of));
    let lines = [
        rate(
            "False alarms: healthy drives, decoys, drives without their effect, failures included",
            quiet(board),
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
        share(
            "Held-out mismatch that discovered terms explain, median",
            board.unlisted_explained_median,
            "≥ 60 %",
            [0.6, f64::MAX],
        ),
        share("Error of an effect's numbers, median", board.parameter_error_median, "≤ 15 %", [0.0, 0.15]),
        rate("95 % intervals that hold the truth", board.interval_coverage, "90–98\u{a0}%", [0.9, 0.98]),
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
        rate("Said “consistent” although something acted", board.abstained, "", [0.0, 1.0]),
        rate("Diagnoses that failed", board.errors, "0", [0.0, 0.0]),
    ];
    let mut html = String::from("<table class=goals><tr><th><th>reached<th>95 % interval<th>goal<th></tr>");
    lines.iter().for_each(|line| html += &row(line));
    html + "</table>"
}

fn row(line: &Line) -> String {
    let [low, high] = line.range;
    let (class, mark) = match line.reached {
        _ if line.goal.is_empty() => ("", ""),
        None => ("", "no such case"),
        Some(value) if (low..=high).contains(&value) => ("good", "reached"),
        Some(_) => ("bad", "missed"),
    };
    format!(
        "<tr><td>{}<td class=number>{}<td class=quiet>{}<td>{}<td class={class:?}>{mark}</tr>",
        line.what, line.shown, line.interval, line.goal
    )
}

fn rate(what: &'static str, rate: Rate, goal: &'static str, range: [f64; 2]) -> Line {
    let shown = format!("{} <small>{} of {}</small>", percent(rate.share()), rate.hits, rate.of);
    Line { what, reached: rate.share(), shown, interval: interval(rate), goal, range }
}

fn share(what: &'static str, value: Option<f64>, goal: &'static str, range: [f64; 2]) -> Line {
    Line { what, reached: value, shown: percent(value), interval: String::new(), goal, range }
}

fn ratio(what: &'static str, value: Option<f64>, goal: &'static str) -> Line {
    let (shown, range) = (number(value, 3), [0.0, 1.03]);
    Line { what, reached: value, shown, interval: String::new(), goal, range }
}

/// A kind in plain words.
pub(crate) fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Healthy => "healthy",
        Kind::Decoy => "decoy",
        Kind::One => "one effect",
        Kind::Two => "two effects",
        Kind::Unlisted => "outside the list",
    }
}
