//! The scoreboard of a trial on real drives as a page.

use maud::{Markup, html};
use prove::{
    Rate,
    real::{Answers, RealBoard, RealBoards, RealScore, RealWayBoard},
};

use crate::{document::document, figures::percent};

/// The page of a scoreboard of real drives: figures beside their goals way by way, changes by strength, grounds, other methods, every case.
pub fn real_scoreboard_page(boards: &RealBoards) -> String {
    let body = html! {
        h1 { (sentence(boards)) }
        p.quiet {
            (boards.cases) " cases from seed " (boards.seed) ". The keys were committed to before the first diagnosis (SHA-256 of the list "
            code { (boards.commitment) } ") and found unchanged after the last."
        }
        (wide("Figures beside their goals", &goals(&boards.ways)))
        h2 { "Changes by strength" }
        p.quiet { "Strength z is what an ideal detector that knows robot and change would see. A field has: named, in a set of three at most, wrong, no name." }
        (wide("Changes by strength", &changes(&boards.ways)))
        div.two {
            section {
                h2 { "By onset and ground" }
                (wide("By onset and ground", &groups(&boards.ways)))
            }
            section {
                h2 { "Other methods on the same files" }
                (wide("Other methods on the same files", &methods(boards)))
            }
        }
        @for one in &boards.ways {
            details {
                summary { "Every case, " (one.way.words()) }
                (wide("Every case", &cases(&one.board)))
            }
        }
    };
    document("Trial on real drives", &body)
}

/// A table that scrolls by itself where the screen is narrower, also by keys.
fn wide(label: &str, table: &Markup) -> Markup {
    html! { div.wide role="region" aria-label=(label) tabindex="0" { (table) } }
}

/// The way with the most to go by, in one sentence.
fn sentence(boards: &RealBoards) -> String {
    boards.ways.last().map_or_else(
        || "No way was gone".to_owned(),
        |one| {
            let board = &one.board;
            format!(
                "With {}: {} of {} known changes were named or among three; {} of {} healthy splits were not found healthy.",
                one.way.words(),
                board.strong_in_three.hits,
                board.strong_in_three.of,
                board.false_alarms.hits,
                board.false_alarms.of
            )
        },
    )
}

/// A figure with the shares that reach its goal; none where no goal is set.
struct Goal {
    what: &'static str,
    figure: fn(&RealBoard) -> Rate,
    goal: &'static str,
    range: Option<[f64; 2]>,
}

/// Goals: of healthy splits one in thirty at most, half of all changes named, one in twenty wrong, six of eight borders found.
const GOALS: [Goal; 6] = [
    Goal {
        what: "False alarms: healthy splits, failures included",
        figure: |board| board.false_alarms,
        goal: "≤ 1 of 30",
        range: Some([0.0, 1.0 / 30.0]),
    },
    Goal {
        what: "Changes of z = 16 and more, named or in a set of three at most",
        figure: |board| board.strong_in_three,
        goal: "≥ 50 %",
        range: Some([0.5, 1.0]),
    },
    Goal {
        what: "The same, other names given",
        figure: |board| board.strong_wrong,
        goal: "≤ 5 %",
        range: Some([0.0, 0.05]),
    },
    Goal { what: "Splices named", figure: |board| board.splices_named, goal: "", range: None },
    Goal {
        what: "Splices named and placed within ten seconds",
        figure: |board| board.splices_placed,
        goal: "≥ 6 of 8",
        range: Some([0.75, 1.0]),
    },
    Goal { what: "Diagnoses that failed", figure: |board| board.errors, goal: "0", range: Some([0.0, 0.0]) },
];

fn goals(ways: &[RealWayBoard]) -> Markup {
    html! {
        table.board {
            thead { tr { th { "figure" } th { "goal" } @for one in ways { th { (one.way.words()) } } } }
            tbody {
                @for goal in &GOALS {
                    tr {
                        th scope="row" { (goal.what) }
                        td.number { (goal.goal) }
                        @for one in ways { (field(goal, (goal.figure)(&one.board))) }
                    }
                }
            }
        }
    }
}

fn field(goal: &Goal, rate: Rate) -> Markup {
    let class = match (rate.share(), goal.range) {
        (Some(share), Some([low, high])) if (low..=high).contains(&share) => "good",
        (Some(_), Some(_)) => "bad",
        _ => "",
    };
    html! { td class={ "number " (class) } { (share_of(rate)) } }
}

fn changes(ways: &[RealWayBoard]) -> Markup {
    let rows = ways.first().map_or(&[][..], |one| &one.board.changes);
    html! {
        table.board {
            thead { tr { th { "change" } th { "z" } th { "of power" } @for one in ways { th { (one.way.words()) } } } }
            tbody {
                @for (i, row) in rows.iter().enumerate() {
                    tr {
                        th scope="row" { (row.change.map_or("all changes", |change| change.words())) }
                        td.number { (format!("{:.0}", row.z_median.unwrap_or(row.asked_z))) }
                        td.number { (percent(row.power_change_median)) }
                        @for one in ways { td.number { @if let Some(row) = one.board.changes.get(i) { (counts(&row.answers)) } } }
                    }
                }
            }
        }
    }
}

fn groups(ways: &[RealWayBoard]) -> Markup {
    let first = ways.first().map(|one| &one.board);
    html! {
        table.board {
            thead { tr { th { "changes" } @for one in ways { th { (one.way.words()) } } } }
            tbody {
                @for (i, row) in first.map_or(&[][..], |board| &board.onsets).iter().enumerate() {
                    tr {
                        th scope="row" { @if row.late { "from some time on" } @else { "from the start" } }
                        @for one in ways { td.number { @if let Some(row) = one.board.onsets.get(i) { (counts(&row.answers)) } } }
                    }
                }
                @for (i, row) in first.map_or(&[][..], |board| &board.grounds).iter().enumerate() {
                    tr {
                        th scope="row" { "on " (row.ground) }
                        @for one in ways {
                            td.number {
                                @if let Some(row) = one.board.grounds.get(i) {
                                    (counts(&row.answers)) br;
                                    small { "alarms " (row.false_alarms.hits) " of " (row.false_alarms.of) }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn methods(boards: &RealBoards) -> Markup {
    html! {
        table.board {
            thead { tr { th { "method" } th { "false alarms" } th { "changes named" } th { "wrong" } th { "splices named" } th { "failed" } } }
            tbody {
                @for one in &boards.ways {
                    @let board = &one.board;
                    @let rates = [board.false_alarms, board.strong_in_three, board.strong_wrong, board.splices_named];
                    (method(&format!("diagnose, {}", one.way.words()), &rates, board.errors.hits))
                }
                @for peer in &boards.peers {
                    (method(&peer.peer, &[peer.false_alarms, peer.named, peer.wrong, peer.splices_named], peer.errors))
                }
            }
        }
    }
}

fn method(name: &str, rates: &[Rate], failed: usize) -> Markup {
    html! {
        tr {
            th scope="row" { (name) }
            @for rate in rates { td.number { (share_of(*rate)) } }
            td { (failed) }
        }
    }
}

fn cases(board: &RealBoard) -> Markup {
    html! {
        table.board {
            thead { tr { th { "case" } th { "ground" } th { "done" } th { "verdict" } th { "said" } } }
            tbody { @for score in &board.scores { (case(score)) } }
        }
    }
}

fn case(score: &RealScore) -> Markup {
    let said: Vec<String> = score.said.iter().map(|set| set.join(" and ")).collect();
    html! {
        tr {
            th.number scope="row" { (score.case) }
            td { (score.ground) }
            td {
                @if let Some(change) = score.change {
                    (change.words()) " "
                    small {
                        (format!("{:.2} {}", score.size.unwrap_or_default(), change.unit())) ", z " (format!("{:.0}", score.z.unwrap_or_default()))
                        @if score.late { ", late" }
                    }
                } @else if let Some(onto) = &score.onto { "then " (onto) } @else { "nothing" }
            }
            td {
                @if let Some(error) = &score.error { span.bad { (error) } }
                @else if let Some(verdict) = score.verdict { (format!("{verdict:?}").to_lowercase()) }
            }
            td { (said.join("; or ")) @if score.placed == Some(true) { " at the border" } }
        }
    }
}

fn counts(answers: &Answers) -> String {
    format!("{} / {} / {} / {}", answers.named, answers.in_three, answers.wrong, answers.none)
}

/// A share with its counts.
fn share_of(rate: Rate) -> Markup {
    html! { (percent(rate.share())) " " small { (rate.hits) " of " (rate.of) } }
}

#[cfg(test)]
mod tests {
    use prove::{Way, real};

    use super::*;

    #[test]
    fn a_trial_without_cases_is_a_page_too_and_what_others_say_is_escaped() {
        let way = |way| RealWayBoard { way, board: real::board(Vec::new()) };
        let peer = |name: &str| real::RealPeerRow {
            peer: name.into(),
            false_alarms: Rate::new(1, 2),
            named: Rate::new(0, 0),
            wrong: Rate::new(0, 0),
            splices_named: Rate::new(0, 0),
            errors: 0,
        };
        let boards = RealBoards {
            cases: 0,
            seed: 7,
            commitment: "<hash>".into(),
            ways: Way::ALL.map(way).into(),
            peers: vec![peer("<script>")],
        };
        let page = real_scoreboard_page(&boards);
        assert!(page.contains("0 of 0 known changes were named"), "{page}");
        assert!(page.contains("&lt;hash&gt;") && page.contains("&lt;script&gt;"), "{page}");
        assert!(!page.contains("NaN") && !page.contains("<script"), "{page}");
    }
}
