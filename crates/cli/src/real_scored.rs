//! A scoreboard of real drives in some lines.

use prove::{
    Rate,
    real::{Answers, ChangeRow, RealBoard, RealBoards, RealPeerRow},
};

/// Characters of a row's name and of a column.
const NAME_WIDTH: usize = 46;
const WIDTH: usize = 28;

/// Every figure on a line of its own with its goal, a column for each way; then changes by strength, and other methods.
pub(crate) fn summary(boards: &RealBoards) -> String {
    let mut lines = Vec::new();
    lines.push(line("", boards.ways.iter().map(|one| one.way.words().to_owned())));
    for (name, figure) in figures() {
        if boards.ways.iter().any(|one| figure(&one.board).of > 0) {
            lines.push(line(name, boards.ways.iter().map(|one| rate(figure(&one.board)))));
        }
    }
    lines.push(String::new());
    lines.push(line("named / in a set of three / wrong / no name", std::iter::empty()));
    let first = boards.ways.first().map(|one| &one.board);
    for (i, row) in first.map_or(&[][..], |board| &board.changes).iter().enumerate() {
        let of =
            |board: &RealBoard| board.changes.get(i).map_or_else(String::new, |row| answers(&row.answers));
        lines.push(line(&change(row), boards.ways.iter().map(|one| of(&one.board))));
    }
    for (i, name) in ["from the start", "from some time on"].into_iter().enumerate() {
        let of =
            |board: &RealBoard| board.onsets.get(i).map_or_else(String::new, |row| answers(&row.answers));
        lines.push(line(name, boards.ways.iter().map(|one| of(&one.board))));
    }
    for (i, row) in first.map_or(&[][..], |board| &board.grounds).iter().enumerate() {
        let of = |board: &RealBoard| {
            board.grounds.get(i).map_or_else(String::new, |row| {
                let alarms = row.false_alarms;
                format!("{}; alarms {}/{}", answers(&row.answers), alarms.hits, alarms.of)
            })
        };
        lines.push(line(&format!("on {}", row.ground), boards.ways.iter().map(|one| of(&one.board))));
    }
    if !boards.peers.is_empty() {
        lines.push(String::new());
        lines.push(line(
            "other methods, healthy drives beside",
            boards.peers.iter().map(|peer| peer.peer.clone()),
        ));
        for (name, figure) in peer_figures() {
            lines.push(line(name, boards.peers.iter().map(|peer| rate(figure(peer)))));
        }
        lines.push(line("cases that failed", boards.peers.iter().map(|peer| peer.errors.to_string())));
    }
    lines.join("\n")
}

type Figure<T> = (&'static str, fn(&T) -> Rate);

fn figures() -> [Figure<RealBoard>; 7] {
    [
        ("false alarms, healthy splits (asked: 1 of 30)", |board| board.false_alarms),
        ("healthy splits given a name", |board| board.false_names),
        ("z 16 and more: named or in three (asked: 50 %)", |board| board.strong_in_three),
        ("z 16 and more: wrong names (asked: 5 %)", |board| board.strong_wrong),
        ("splices named", |board| board.splices_named),
        ("splices named and placed (asked: 6 of 8)", |board| board.splices_placed),
        ("diagnoses that failed", |board| board.errors),
    ]
}

fn peer_figures() -> [Figure<RealPeerRow>; 4] {
    [
        ("false alarms, healthy splits", |peer| peer.false_alarms),
        ("z 16 and more: first name right", |peer| peer.named),
        ("z 16 and more: first name wrong", |peer| peer.wrong),
        ("splices: first name right", |peer| peer.splices_named),
    ]
}

fn change(row: &ChangeRow) -> String {
    let share = row
        .power_change_median
        .map_or_else(String::new, |share| format!(", {:.0} % of power", 100.0 * share));
    let words = row.change.map_or("all changes", |change| change.words());
    format!("{words}, z {:.0}{share}", row.z_median.unwrap_or(row.asked_z))
}

fn answers(answers: &Answers) -> String {
    format!("{} / {} / {} / {}", answers.named, answers.in_three, answers.wrong, answers.none)
}

fn line(name: &str, cells: impl Iterator<Item = String>) -> String {
    let cells: String = cells.map(|cell| format!("{cell:<WIDTH$}")).collect();
    format!("{name:<NAME_WIDTH$} {cells}").trim_end().to_owned()
}

fn rate(rate: Rate) -> String {
    let [low, high] = rate.interval_95.map(|bound| 100.0 * bound);
    match rate.of {
        0 => "-".to_owned(),
        _ => format!("{} of {} ({low:.0} to {high:.0} %)", rate.hits, rate.of),
    }
}
