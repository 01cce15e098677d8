//! The scoreboard of a trial as a page.

mod cases;
mod goals;
mod mechanisms;
mod methods;

use maud::{Markup, html};
use prove::{Kind, Rate, Scoreboard};

use crate::{document::document, figures::percent};

/// The page of a scoreboard: one sentence, figures beside their goals, mechanisms by strength, other methods, and every case.
pub fn scoreboard_page(board: &Scoreboard) -> String {
    let body = html! {
        h1 { (sentence(board)) }
        p.quiet {
            (board.cases) " cases from seed " (board.seed) ". The keys were committed to before the first diagnosis (SHA-256 of the list "
            code { (board.commitment) } ") and found unchanged after the last."
        }
        (wide("Figures beside their goals", &goals::table(board)))
        h2 { "By mechanism and strength" }
        (mechanisms::legend())
        (wide("By mechanism and strength", &mechanisms::table(board)))
        div.two {
            section {
                h2 { "By strength" }
                (wide("By strength", &mechanisms::strengths(board)))
            }
            section {
                h2 { "Other methods on the same files" }
                (wide("Other methods on the same files", &methods::table(board)))
            }
        }
        details {
            summary { "Every case" }
            (wide("Every case", &cases::table(board)))
        }
    };
    document("Concealed trial", &body)
}

/// A table that scrolls by itself where the screen is narrower, also by keys.
fn wide(label: &str, table: &Markup) -> Markup {
    html! { div.wide role="region" aria-label=(label) tabindex="0" { (table) } }
}

/// Everything in one sentence.
fn sentence(board: &Scoreboard) -> String {
    let alarms = false_alarms(board);
    let failed = match board.errors.hits {
        0 => String::new(),
        n => format!(", and {n} of {} diagnoses failed", board.cases),
    };
    format!(
        "{} of {} concealed effects were named; {} of {} drives that conceal nothing were not found healthy{failed}.",
        board.in_two.hits, board.in_two.of, alarms.hits, alarms.of
    )
}

/// False alarms on everything that conceals nothing.
fn false_alarms(board: &Scoreboard) -> Rate {
    let all = [board.false_alarms_healthy, board.false_alarms_decoy, board.false_alarms_twin];
    Rate::new(all.iter().map(|rate| rate.hits).sum(), all.iter().map(|rate| rate.of).sum())
}

/// A share with its counts.
fn share_of(rate: Rate) -> Markup {
    html! { (percent(rate.share())) " " small { (rate.hits) " of " (rate.of) } }
}

/// The 95 % interval of a share; empty of no cases.
fn interval(rate: Rate) -> String {
    let [low, high] = rate.interval_95.map(|bound| 100.0 * bound);
    if rate.of == 0 { String::new() } else { format!("{low:.0}–{high:.0}\u{a0}%") }
}

/// The label of a kind of case.
fn kind_label(kind: Kind) -> &'static str {
    match kind {
        Kind::Healthy => "healthy",
        Kind::Decoy => "decoy",
        Kind::One => "one effect",
        Kind::Two => "two effects",
        Kind::Unlisted => "outside the list",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trial_without_cases_is_a_page_too() {
        let page = scoreboard_page(&prove::scoreboard(7, "<hash>".into(), Vec::new()));
        assert!(page.contains("<h1>0 of 0 concealed effects were named"), "{page}");
        assert!(page.contains("&lt;hash&gt;") && page.contains("no such case"), "{page}");
        assert!(!page.contains("NaN") && !page.contains("<script"), "{page}");
    }

    #[test]
    fn ratios_of_errors_have_three_decimals() {
        let mut board = prove::scoreboard(7, "hash".into(), Vec::new());
        (board.rmse_ratio_listed_median, board.rmse_ratio_unlisted_median) = (Some(1.02), Some(1.55));
        let page = scoreboard_page(&board);
        assert!(page.contains(">1.020</td>") && page.contains(">1.550</td>"), "{page}");
    }

    #[test]
    fn what_a_failing_program_says_cannot_break_the_page() {
        let failed = prove::CaseScore {
            case: "case-0001".into(),
            kind: Kind::Healthy,
            share: 0.0,
            verdict: None,
            error: Some("<script>alert(1)</script>".into()),
            said: vec![vec!["<b>".into()]],
            alarmed: false,
            gave_a_name: false,
            sets: 0,
            rank: None,
            truths: Vec::new(),
            wrong_names: 0,
            swapped: false,
            rmse_ratio: None,
            noise_ratio: None,
            discovered: None,
            twin: None,
            peers: Vec::new(),
        };
        let page = scoreboard_page(&prove::scoreboard(7, "hash".into(), vec![failed]));
        assert!(page.contains("&lt;script&gt;") && !page.contains("<script"), "{page}");
        assert!(page.contains("&lt;b&gt;"), "{page}");
    }
}
