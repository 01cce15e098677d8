//! Other methods beside the diagnosis.

use maud::{Markup, html};
use prove::{Rate, Scoreboard};

use super::share_of;

/// The table of methods.
pub(super) fn table(board: &Scoreboard) -> Markup {
    let [healthy, decoy] = [board.false_alarms_healthy, board.false_alarms_decoy];
    let alarms = Rate::new(healthy.hits + decoy.hits, healthy.of + decoy.of);
    let unlisted = board.unlisted_not_misnamed;
    let misnamed = Rate::new(unlisted.of - unlisted.hits, unlisted.of);
    html! {
        table.board {
            thead {
                tr {
                    th { "method" } th { "false alarms" } th { "named first" } th { "outside the list, misnamed" } th { "failed" }
                }
            }
            tbody {
                (row("diagnose", [alarms, board.named_first, misnamed], board.errors.hits))
                @for peer in &board.peers {
                    (row(&peer.peer, [peer.false_alarms, peer.named, peer.misnamed], peer.errors))
                }
            }
        }
    }
}

fn row(name: &str, rates: [Rate; 3], failed: usize) -> Markup {
    html! {
        tr {
            th scope="row" { (name) }
            @for rate in rates { td.number { (share_of(rate)) } }
            td { (failed) }
        }
    }
}
