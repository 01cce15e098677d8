//! The tables of the scoreboard's page.

use std::fmt::Write as _;

use world::Family;

use crate::{CaseScore, Cell, MechanismRow, Rate, SHARES, Scoreboard, TruthScore, page::kind};

/// What happened by mechanism and strength.
pub(crate) fn mechanisms(board: &Scoreboard) -> String {
    let mut html = String::from(
        "<h2>By mechanism and strength</h2><p class=quiet>Strength is the change of power as a share of its mean. A field \
         says in how many cases the truth was named in a set of two at most; below it z, what an ideal detector that knows \
         the effect would see. Outside the list, a field says in how many cases no wrong name was given.</p>\
         <p><span class=\"key named\">named</span> <span class=\"key some\">some named</span> \
         <span class=\"key seen\">seen, not named</span> <span class=\"key missed\">missed</span></p><table class=heat><tr><th>",
    );
    for share in SHARES {
        let _ = write!(html, "<th>{:.1} %", 100.0 * share);
    }
    html += "<th>names in set<th>error<th>coverage</tr>";
    for row in &board.mechanisms {
        html += &mechanism(row, board);
    }
    html + "</table>"
}

fn mechanism(row: &MechanismRow, board: &Scoreboard) -> String {
    let family = match row.family {
        Family::Physics => "",
        Family::Measurement => "sensor",
        Family::Unlisted => "outside the list",
    };
    let mut html = format!("<tr><th>{} <small>{family}</small>", row.mechanism.name());
    for share in SHARES {
        match row.strengths.iter().find(|cell| cell.share == share) {
            None => html += "<td class=none>",
            Some(cell) if row.family == Family::Unlisted => html += &unlisted(cell, row, board),
            Some(cell) => html += &field(cell.in_two, cell.detected, cell),
        }
    }
    let sizes: Vec<f64> = row.strengths.iter().filter_map(|cell| cell.mean_set_size).collect();
    let errors = row.strengths.iter().filter_map(|cell| cell.parameter_error_median);
    let covered = row.strengths.iter().map(|cell| cell.interval_coverage);
    let (hits, of) = covered.fold((0, 0), |(h, n), rate| (h + rate.hits, n + rate.of));
    let _ = write!(
        html,
        "<td>{}<td>{}<td>{}</tr>",
        number(crate::figures::mean(&sizes), 1),
        percent(crate::rate::median(errors)),
        if of > 0 { format!("{hits} of {of}") } else { "–".into() }
    );
    html
}

fn unlisted(cell: &Cell, row: &MechanismRow, board: &Scoreboard) -> String {
    let here = |case: &&CaseScore| {
        case.share == cell.share && case.truths.len() == 1 && case.truths[0].effect == row.mechanism
    };
    let not_misnamed = Rate::of(board.scores.iter().filter(here).map(CaseScore::misnames_nothing));
    field(not_misnamed, not_misnamed, cell)
}

fn field(right: Rate, seen: Rate, cell: &Cell) -> String {
    let class = match right.hits {
        n if n == right.of => "named",
        0 if seen.hits == 0 => "missed",
        0 => "seen",
        _ => "some",
    };
    let z = number(cell.z_median, 0);
    format!("<td class={class}>{} of {}<br><small>z {z}</small>", right.hits, right.of)
}

/// What happened by strength alone.
pub(crate) fn strengths(board: &Scoreboard) -> String {
    let mut html = String::from(
        "<section><h2>By strength</h2><table><tr><th>z from<th>effects<th>something found<th>named</tr>",
    );
    for row in &board.strengths {
        let _ = write!(
            html,
            "<tr><td>{:.0}<td>{}<td>{}<td>{} <small>{}</small></tr>",
            row.from_z,
            row.in_two.of,
            percent(row.detected.share()),
            percent(row.in_two.share()),
            interval(row.in_two)
        );
    }
    html + "</table></section>"
}

/// Other methods beside the diagnosis.
pub(crate) fn peers(board: &Scoreboard) -> String {
    let mut html = String::from(
        "<section><h2>Other methods on the same files</h2><table><tr><th><th>false alarms<th>named first\
         <th>outside the list, misnamed<th>failed</tr>",
    );
    let [healthy, decoy] = [board.false_alarms_healthy, board.false_alarms_decoy];
    let unlisted = board.unlisted_not_misnamed;
    let mut line = |name: &str, alarms: Rate, named: Rate, misnamed: Rate, errors: usize| {
        let cell =
            |rate: Rate| format!("{} <small>{} of {}</small>", percent(rate.share()), rate.hits, rate.of);
        let _ = write!(
            html,
            "<tr><td>{}<td class=number>{}<td class=number>{}<td class=number>{}<td>{errors}</tr>",
            escape(name),
            cell(alarms),
            cell(named),
            cell(misnamed)
        );
    };
    let quiet = Rate::new(healthy.hits + decoy.hits, healthy.of + decoy.of);
    let misnamed = Rate::new(unlisted.of - unlisted.hits, unlisted.of);
    line("diagnose", quiet, board.named_first, misnamed, board.errors.hits);
    for peer in &board.peers {
        line(&peer.peer, peer.false_alarms, peer.named, peer.misnamed, peer.errors);
    }
    html + "</table></section>"
}

/// Every case, folded.
pub(crate) fn cases(board: &Scoreboard) -> String {
    let mut html = String::from(
        "<details><summary>Every case</summary><table><tr><th>case<th>kind<th>concealed<th>verdict<th>said</tr>",
    );
    for case in &board.scores {
        let truth = |t: &TruthScore| format!("{} <small>z {:.0}</small>", t.effect.name(), t.z);
        let truths: Vec<String> = case.truths.iter().map(truth).collect();
        let said: Vec<String> = case.said.iter().map(|set| escape(&set.join(" or "))).collect();
        let verdict = match (&case.error, case.verdict) {
            (Some(error), _) => format!("<span class=bad>{}</span>", escape(error)),
            (None, verdict) => verdict.map_or_else(String::new, |v| format!("{v:?}").to_lowercase()),
        };
        let _ = write!(
            html,
            "<tr><td class=number>{}<td class=number>{}<td>{}<td>{verdict}<td>{}</tr>",
            escape(&case.case),
            kind(case.kind),
            truths.join(", "),
            said.join(", ")
        );
    }
    html + "</table></details>"
}

/// A share in percent.
pub(crate) fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "–".into(), |share| format!("{:.0} %", 100.0 * share))
}

/// Where a share may lie.
pub(crate) fn interval(rate: Rate) -> String {
    let [low, high] = rate.interval_95.map(|bound| 100.0 * bound);
    if rate.of == 0 { String::new() } else { format!("{low:.0}–{high:.0} %") }
}

/// A number with so many digits behind the point.
pub(crate) fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "–".into(), |value| format!("{value:.digits$}"))
}

/// Text from outside, made harmless.
pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
