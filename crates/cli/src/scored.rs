//! A scoreboard in some lines.

use prove::{Rate, Scoreboard};

/// Every figure on a line of its own, a column for each board; those of no case are left out.
pub(crate) fn summary(columns: &[(&str, &Scoreboard)]) -> String {
    let figures: Vec<Vec<(&str, Option<String>)>> = columns.iter().map(|(_, board)| figures(board)).collect();
    let mut lines = Vec::new();
    if columns.len() > 1 {
        let heads: Vec<String> = columns.iter().map(|(head, _)| format!("{head:<WIDTH$}")).collect();
        lines.push(format!("{:<34} {}", "", heads.concat().trim_end()));
    }
    for i in 0..figures.first().map_or(0, Vec::len) {
        if figures.iter().all(|column| column[i].1.is_none()) {
            continue;
        }
        let cells: Vec<String> = figures
            .iter()
            .map(|column| format!("{:<WIDTH$}", column[i].1.as_deref().unwrap_or("-")))
            .collect();
        lines.push(format!("{:<34} {}", figures[0][i].0, cells.concat().trim_end()));
    }
    lines.join("\n")
}

/// Characters of a column.
const WIDTH: usize = 28;

/// Change of power over its mean from which on effects are strong.
const STRONG_SHARE: f64 = 0.05;

fn figures(board: &Scoreboard) -> Vec<(&'static str, Option<String>)> {
    let of_share = |low: f64, high: f64| {
        let rows = board.shares.iter().filter(|row| (low..high).contains(&row.from_share));
        let (hits, of) = rows.fold((0, 0), |(h, n), row| (h + row.in_two.hits, n + row.in_two.of));
        Rate::new(hits, of)
    };
    let begun = |late: bool| {
        board.onsets.iter().find(|row| row.late == late).map_or_else(Rate::default, |row| row.in_two)
    };
    let strong = |low: f64, high: f64| {
        let rows = board.strengths.iter().filter(|row| (low..high).contains(&row.from_z));
        let (hits, of) = rows.fold((0, 0), |(h, n), row| (h + row.in_two.hits, n + row.in_two.of));
        Rate::new(hits, of)
    };
    vec![
        ("healthy drives given a name", rate(board.false_names)),
        ("true set first or second", rate(board.set_named)),
        ("true set among three at most", rate(board.set_in_three)),
        ("other names given", rate(board.set_wrong)),
        ("no name given", rate(board.set_none)),
        ("false alarms, healthy drives", rate(board.false_alarms_healthy)),
        ("false alarms, decoys", rate(board.false_alarms_decoy)),
        ("false alarms, effects taken away", rate(board.false_alarms_twin)),
        ("effects detected", rate(board.detected)),
        ("effects named, set of two at most", rate(board.in_two)),
        ("those of z = 32 to 64", rate(strong(32.0, 64.0))),
        ("those of z = 64 and more", rate(strong(64.0, f64::INFINITY))),
        ("those of less than 5 % of power", rate(of_share(0.0, STRONG_SHARE))),
        ("those of 5 to 20 % of power", rate(of_share(STRONG_SHARE, 0.20))),
        ("those of 20 % of power and more", rate(of_share(0.20, f64::INFINITY))),
        ("those from the start", rate(begun(false))),
        ("those from some time on", rate(begun(true))),
        ("both of two effects named", rate(board.both_of_two)),
        ("sensor faults called physics", rate(board.sensor_called_physics)),
        ("physics called a sensor fault", rate(board.physics_called_sensor)),
        ("intervals that hold the truth", rate(board.interval_coverage)),
        ("error of numbers, median", percent(board.parameter_error_median)),
        ("held-out error over that without", ratio(board.rmse_ratio_listed_median)),
        ("noise over that without", ratio(board.noise_ratio_listed_median)),
        ("outside the list, not misnamed", rate(board.unlisted_not_misnamed)),
        ("those of 3 % of power and more", rate(board.unlisted_strong_not_misnamed)),
        ("mismatch explained, median", percent(board.unlisted_explained_median)),
        ("the same where terms are given", percent(board.unlisted_terms_explain_median)),
        ("held-out error, outside the list", ratio(board.rmse_ratio_unlisted_median)),
        ("diagnoses that failed", rate(board.errors)),
    ]
}

fn rate(rate: Rate) -> Option<String> {
    let [low, high] = rate.interval_95.map(|bound| 100.0 * bound);
    (rate.of > 0).then(|| format!("{} of {} ({low:.0} to {high:.0} %)", rate.hits, rate.of))
}

fn percent(share: Option<f64>) -> Option<String> {
    Some(format!("{:.1} %", 100.0 * share?))
}

fn ratio(ratio: Option<f64>) -> Option<String> {
    Some(format!("{:.3}", ratio?))
}
