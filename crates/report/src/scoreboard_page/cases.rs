//! Every case of a trial.

use maud::{Markup, html};
use prove::{CaseScore, Scoreboard};

use super::kind_label;

/// The table of cases.
pub(super) fn table(board: &Scoreboard) -> Markup {
    html! {
        table.board {
            thead { tr { th { "case" } th { "kind" } th { "concealed" } th { "verdict" } th { "said" } } }
            tbody { @for case in &board.scores { (row(case)) } }
        }
    }
}

fn row(case: &CaseScore) -> Markup {
    let said: Vec<String> = case.said.iter().map(|set| set.join(" or ")).collect();
    html! {
        tr {
            th.number scope="row" { (case.case) }
            td.number { (kind_label(case.kind)) }
            td {
                @for (i, truth) in case.truths.iter().enumerate() {
                    @if i > 0 { ", " }
                    (truth.effect.name()) " " small { "z " (format!("{:.0}", truth.z)) }
                }
            }
            td {
                @if let Some(error) = &case.error { span.bad { (error) } }
                @else if let Some(verdict) = case.verdict { (format!("{verdict:?}").to_lowercase()) }
            }
            td { (said.join(", ")) }
        }
    }
}
