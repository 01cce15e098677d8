//! Detection and naming by mechanism and strength.

use maud::{Markup, html};
use prove::{CaseScore, Cell, MechanismRow, Rate, SHARES, Scoreboard};
use statrs::statistics::{Data, Median, Statistics};
use world::Family;

use super::interval;
use crate::figures::{decimals, percent};

/// What the fields of the table mean.
pub(super) fn legend() -> Markup {
    html! {
        p.quiet {
            "Strength is the change of power as a share of its mean. A field says in how many cases the truth was named in a set of two at \
             most; below it z, what an ideal detector that knows the effect would see. Outside the list, a field says in how many cases no \
             wrong name was given."
        }
        p {
            span.key-box.named { "named" }
            span.key-box.some { "some named" }
            span.key-box.seen { "seen, not named" }
            span.key-box.missed { "missed" }
        }
    }
}

/// The table of mechanisms.
pub(super) fn table(board: &Scoreboard) -> Markup {
    html! {
        table.board.heat {
            thead {
                tr {
                    th { "mechanism" }
                    @for share in SHARES { th { (format!("{:.1}\u{a0}%", 100.0 * share)) } }
                    th { "names in set" } th { "error" } th { "coverage" }
                }
            }
            tbody { @for row in &board.mechanisms { (mechanism(row, board)) } }
        }
    }
}

fn mechanism(row: &MechanismRow, board: &Scoreboard) -> Markup {
    let family = match row.family {
        Family::Physics => "",
        Family::Measurement => "sensor",
        Family::Unlisted => "outside the list",
    };
    let sizes: Vec<f64> = row.strengths.iter().filter_map(|cell| cell.mean_set_size).collect();
    let errors: Vec<f64> = row.strengths.iter().filter_map(|cell| cell.parameter_error_median).collect();
    let covered = row.strengths.iter().map(|cell| cell.interval_coverage);
    let (hits, of) = covered.fold((0, 0), |(h, n), rate| (h + rate.hits, n + rate.of));
    html! {
        tr {
            th scope="row" { (row.mechanism.name()) " " small { (family) } }
            @for share in SHARES {
                @match row.strengths.iter().find(|cell| cell.share == share) {
                    None => { td {} },
                    Some(cell) if row.family == Family::Unlisted => (unlisted(cell, row, board)),
                    Some(cell) => (field(cell.in_two, cell.detected, cell)),
                }
            }
            td { (decimals((!sizes.is_empty()).then(|| sizes.mean()), 1)) }
            td { (percent((!errors.is_empty()).then(|| Data::new(errors).median()))) }
            td { @if of > 0 { (hits) " of " (of) } @else { "–" } }
        }
    }
}

fn unlisted(cell: &Cell, row: &MechanismRow, board: &Scoreboard) -> Markup {
    let is_here = |case: &&CaseScore| {
        case.share == cell.share && matches!(&case.truths[..], [truth] if truth.effect == row.mechanism)
    };
    let not_misnamed = Rate::of(board.scores.iter().filter(is_here).map(CaseScore::misnames_nothing));
    field(not_misnamed, not_misnamed, cell)
}

fn field(right: Rate, seen: Rate, cell: &Cell) -> Markup {
    let class = match right.hits {
        n if n == right.of => "named",
        0 if seen.hits == 0 => "missed",
        0 => "seen",
        _ => "some",
    };
    html! {
        td class=(class) { (right.hits) " of " (right.of) br; small { "z " (decimals(cell.z_median, 0)) } }
    }
}

/// The table of strengths, all mechanisms together.
pub(super) fn strengths(board: &Scoreboard) -> Markup {
    html! {
        table.board {
            thead { tr { th { "strength and onset" } th { "effects" } th { "something found" } th { "named" } } }
            tbody {
                @for row in &board.strengths {
                    (line(&format!("z from {:.0}", row.from_z), row.detected, row.in_two))
                }
                @for row in &board.shares {
                    (line(&format!("from {:.0}\u{a0}% of power", 100.0 * row.from_share), row.detected, row.in_two))
                }
                @for row in &board.onsets {
                    (line(if row.late { "from some time on" } else { "from the start" }, row.detected, row.in_two))
                }
            }
        }
    }
}

fn line(name: &str, detected: Rate, in_two: Rate) -> Markup {
    html! {
        tr {
            th scope="row" { (name) }
            td { (in_two.of) }
            td { (percent(detected.share())) }
            td { (percent(in_two.share())) " " small { (interval(in_two)) } }
        }
    }
}
