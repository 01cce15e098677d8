//! Answers as a short readable text.

use service::routes::{
    compare::CompareAnswer,
    plan::{DrivenPath, ObjectiveName, PlanAnswer},
};

const HEAD: [&str; 8] =
    ["", "energy", "95 % interval", "distance", "time", "climb", "recovered", "on the lattice"];

/// The path with least of an objective, a line a figure.
pub(crate) fn plan(answer: &PlanAnswer, objective: ObjectiveName) -> String {
    let [_, energy, interval, distance, time, climb, recovered, _] = cells("", &answer.lattice_path());
    let refined = refined(answer).map_or(String::new(), |text| format!("\n{text}"));
    format!(
        "energy     {energy}  ({interval})\ndistance   {distance}\ntime       {time}\nclimb      {climb} up, {:.1} m down\nrecovered  {recovered}\nclearance  {}{}\nsearch     {} states in {:.0} ms, {}{refined}",
        answer.descent_m,
        answer.clearance_m.map_or("no time was left to look".to_owned(), |room_m| format!("{room_m:.2} m")),
        steered(answer, objective),
        answer.search.expanded,
        answer.search.duration_ms,
        quality(answer, objective),
    )
}

/// What stops take, what preferences weigh, and where the path leads if that was open, a line each.
fn steered(answer: &PlanAnswer, objective: ObjectiveName) -> String {
    let mut text = String::new();
    if answer.stops > 0 {
        let word = if answer.stops == 1 { "stop" } else { "stops" };
        text.push_str(&format!(
            "\nstops      {} {word} on the way, {} beside the energy",
            answer.stops,
            energy(answer.stops_j)
        ));
    }
    if let Some(added) = answer.preferences {
        let added = match objective {
            ObjectiveName::Energy => energy(added),
            ObjectiveName::Distance => format!("{added:.1} m"),
            ObjectiveName::Time => format!("{added:.1} s"),
        };
        text.push_str(&format!("\nweighed    {added} more by prices, cost factors and risks"));
    }
    if let Some(goal) = answer.reached_goal {
        text.push_str(&format!("\ngoal       number {} of those given", goal + 1));
    }
    if let Some(short_m) = answer.short_of_goal_m {
        text.push_str(&format!(
            "\npartial    no path leads to the goal; this one ends {short_m:.1} m from it"
        ));
    }
    text
}

/// The path off the lattice, if there is one.
fn refined(answer: &PlanAnswer) -> Option<String> {
    let (path, energy_j) = (answer.refined.as_ref()?, answer.refined_energy_j?);
    Some(format!(
        "refined    {} over {:.1} m in {}, off the lattice",
        energy(energy_j),
        path.distance_m,
        time(path.duration_s)
    ))
}

/// What is proven of a path.
fn quality(answer: &PlanAnswer, objective: ObjectiveName) -> String {
    let search = &answer.search;
    let late = if search.timed_out { ", time ran out" } else { "" };
    match search.bound {
        _ if search.optimal => "proven best of the lattice".to_owned(),
        Some(bound) => format!("proven within {:.1} % of the best{late}", 100.0 * (bound - 1.0)),
        None => {
            let excess = match objective {
                ObjectiveName::Energy => energy(search.excess_at_most),
                ObjectiveName::Distance => format!("{:.1} m", search.excess_at_most),
                ObjectiveName::Time => format!("{:.1} s", search.excess_at_most),
            };
            format!("at most {excess} above the best{late}")
        }
    }
}

/// Three paths as a table, and what the energy-minimal one saves.
pub(crate) fn compare(answer: &CompareAnswer) -> String {
    let rows = compared(answer).map(|(name, path)| cells(name, &path.followed_path()));
    let head = [HEAD.map(str::to_owned)];
    let mut text = aligned(&[&head[..], &rows].concat());
    let (least, shortest) = (answer.energy.followed_path(), answer.distance.followed_path());
    let saved = energy(shortest.energy_j - least.energy_j);
    let further_m = least.distance_m - shortest.distance_m;
    text.push_str(&format!("\nThe energy-minimal path saves {saved}"));
    if shortest.energy_j > 0.0 {
        text.push_str(&format!(
            ", {:.1} % of the shortest path's energy,",
            100.0 * answer.followed_saving_fraction()
        ));
    }
    text.push_str(&format!(" by driving {further_m:.1} m further."));
    text
}

/// Paths of a comparison with their names.
pub(crate) fn compared(answer: &CompareAnswer) -> [(&'static str, &PlanAnswer); 3] {
    [("energy-minimal", &answer.energy), ("shortest", &answer.distance), ("fastest", &answer.time)]
}

/// What a path with least of an objective is called.
pub(crate) fn path_name(objective: ObjectiveName) -> &'static str {
    match objective {
        ObjectiveName::Energy => "energy-minimal",
        ObjectiveName::Distance => "shortest",
        ObjectiveName::Time => "fastest",
    }
}

/// Figures of paths, a heading first.
pub(crate) fn path_rows(paths: &[(&str, &PlanAnswer)]) -> Vec<Vec<String>> {
    let rows = paths.iter().map(|(name, path)| cells(name, &path.followed_path()).to_vec());
    std::iter::once(HEAD.map(str::to_owned).to_vec()).chain(rows).collect()
}

/// Rows under each other, the first column to the left, the others to the right.
pub(crate) fn aligned<const COLUMNS: usize>(rows: &[[String; COLUMNS]]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; COLUMNS] = std::array::from_fn(width);
    let mut text = String::new();
    for row in rows {
        let cell = |(i, (cell, width)): (usize, (&String, usize))| {
            if i == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        };
        let line: Vec<String> = row.iter().zip(widths).enumerate().map(cell).collect();
        text.push_str(line.join("  ").trim_end());
        text.push('\n');
    }
    text
}

fn cells(name: &str, path: &DrivenPath<'_>) -> [String; 8] {
    let [low, high] = path.energy_interval_j;
    [
        name.to_owned(),
        energy(path.energy_j),
        format!("{} to {}", energy(low), energy(high)),
        format!("{:.1} m", path.distance_m),
        time(path.duration_s),
        format!("{:.1} m", path.climb_m),
        energy(path.recovered_j),
        energy(path.lattice_energy_j),
    ]
}

pub(crate) fn energy(energy_j: f64) -> String {
    format!("{:.2} kJ", energy_j / 1e3)
}

/// Minutes and seconds.
pub(crate) fn time(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    format!("{}:{:02} min", whole / 60, whole % 60)
}
