//! Answers of the planner as they are drawn and tabulated: what `--out` writes pictures and pages from.

use std::borrow::Cow;

use model::Robot;
use routing::Reach;
use service::routes::{
    compare::CompareAnswer,
    mission::MissionAnswer,
    plan::{DrivenPath, PlanAnswer, PoseAnswer},
    reachable::ReachableAnswer,
};
use terrain::Terrain;

use crate::{
    picture::{KeyEntry, Line, Mark, Scene},
    reach_picture::{bands, tint},
    table::{energy, time},
};

/// Colours that stay apart for colour-blind eyes (Okabe & Ito, darkened to be read as text).
const BLUE: [u8; 3] = [0x00, 0x62, 0xB0];
const VERMILION: [u8; 3] = [0xD5, 0x5E, 0x00];
const PURPLE: [u8; 3] = [0x5A, 0x12, 0x5A];

/// What energies hold for: ground, standing load and regeneration.
pub(crate) fn conditions(terrain: &Terrain, robot: &Robot) -> String {
    let named = terrain.surfaces().map_or(&[][..], |surfaces| &surfaces.names);
    let ground = match named {
        [] => format!("{} (the robot's default ground)", robot.default_surface),
        names => format!("{}, and {} where the map names none", names.join(", "), robot.default_surface),
    };
    format!(
        "On {ground}, with a standing load of {} W (hotel_power_w), and {} % of what braking gives back recovered.",
        robot.hotel_power_w,
        100.0 * robot.motors.regeneration
    )
}

/// The same in short lines beside a picture.
fn short_conditions(terrain: &Terrain, robot: &Robot) -> Vec<String> {
    let default = robot.default_surface.replace('_', " ");
    let ground = match terrain.surfaces().is_some_and(|surfaces| !surfaces.names.is_empty()) {
        true => format!("the map's surfaces, else {default}"),
        false => default,
    };
    vec![
        format!("{} of {:.0} kg on {ground}", robot.name, robot.mass_kg),
        format!(
            "standing load {} W, {:.0} % of braking recovered",
            robot.hotel_power_w,
            100.0 * robot.motors.regeneration
        ),
    ]
}

/// A scene without paths.
fn empty<'a>(terrain: &'a Terrain, robot: &Robot, headline: String) -> Scene<'a> {
    Scene {
        terrain,
        caption: "Shaded relief, north up".to_owned(),
        headline,
        about: short_conditions(terrain, robot),
        lines: Vec::new(),
        marks: Vec::new(),
        ground: None,
        key: Vec::new(),
    }
}

fn ends(poses: &[PoseAnswer]) -> Vec<Mark> {
    let mark = |pose: &PoseAnswer, name: &str| Mark { place_m: [pose.x_m, pose.y_m], name: name.to_owned() };
    match poses {
        [] => Vec::new(),
        [first, .., last] => vec![mark(first, "start"), mark(last, "goal")],
        [only] => vec![mark(only, "start and goal")],
    }
}

fn figures(plan: &DrivenPath<'_>) -> Vec<String> {
    let [low, high] = plan.energy_interval_j.map(|j| j / 1e3);
    vec![
        format!("{:.1} kJ  (95 %: {low:.1} to {high:.1} kJ)", plan.energy_j / 1e3),
        format!("{:.0} m, {:.1} min", plan.distance_m, plan.duration_s / 60.0),
        format!("climbs {:.1} m, descends {:.1} m", plan.climb_m, plan.descent_m),
        format!("{:.1} kJ recovered on descents", plan.recovered_j / 1e3),
        format!("{:.1} kJ on the lattice", plan.lattice_energy_j / 1e3),
    ]
}

fn path<'a>(name: &str, color: [u8; 3], plan: &'a PlanAnswer) -> Line<'a> {
    let followed = plan.followed_path();
    let entry = KeyEntry { name: name.to_owned(), color, figures: figures(&followed) };
    Line { entry, is_dashed: false, poses: Cow::Borrowed(followed.poses) }
}

/// One path.
pub(crate) fn plan<'a>(terrain: &'a Terrain, robot: &Robot, found: &'a PlanAnswer, name: &str) -> Scene<'a> {
    let followed = found.followed_path();
    let headline = format!("{} over {:.0} m", energy(followed.energy_j), followed.distance_m);
    Scene {
        lines: vec![path(name, BLUE, found)],
        marks: ends(followed.poses),
        ..empty(terrain, robot, headline)
    }
}

/// The energy-minimal, shortest and fastest paths.
pub(crate) fn compare<'a>(terrain: &'a Terrain, robot: &Robot, found: &'a CompareAnswer) -> Scene<'a> {
    let headline = format!("{:.0} % less energy", 100.0 * found.followed_saving_fraction());
    let (least, shortest) = (found.energy.followed_path(), found.distance.followed_path());
    let further_m = least.distance_m - shortest.distance_m;
    let mut about = vec![format!("than the shortest path, by driving {further_m:.0} m further")];
    about.extend(short_conditions(terrain, robot));
    // The fastest path often lies on the shortest: it is drawn after it, in dashes.
    let lines = vec![
        path("shortest", VERMILION, &found.distance),
        Line { is_dashed: true, ..path("fastest", PURPLE, &found.time) },
        path("energy-minimal", BLUE, &found.energy),
    ];
    Scene { about, lines, marks: ends(least.poses), ..empty(terrain, robot, headline) }
}

/// The way over all stops.
pub(crate) fn mission<'a>(terrain: &'a Terrain, robot: &Robot, found: &MissionAnswer) -> Scene<'a> {
    let poses = joined(found);
    let success = 100.0 * found.success_probability;
    let entry = KeyEntry {
        name: "mission".to_owned(),
        color: BLUE,
        figures: vec![
            format!(
                "{}  ({} to {})",
                energy(found.energy_j.p50),
                energy(found.energy_j.p05),
                energy(found.energy_j.p95)
            ),
            format!("{:.0} m, {}", found.distance_m, time(found.duration_s)),
            format!("arrives with {:.0} % of charge", 100.0 * found.arrival_charge.p50),
            format!("{success:.1} % of the draws keep the reserve"),
        ],
    };
    let headline = format!("{} over {} stops", energy(found.energy_j.p50), found.order.len());
    Scene {
        lines: vec![Line { entry, is_dashed: false, poses: Cow::Owned(poses) }],
        marks: stops(found),
        ..empty(terrain, robot, headline)
    }
}

/// The stops of a mission, those in one place under all their names.
fn stops(found: &MissionAnswer) -> Vec<Mark> {
    let mut marks: Vec<Mark> = Vec::new();
    for stop in &found.stops {
        let place_m = [stop.x_m, stop.y_m];
        match marks.iter_mut().find(|mark| mark.place_m == place_m) {
            Some(mark) => mark.name = format!("{}, {}", mark.name, stop.name()),
            None => marks.push(Mark { place_m, name: stop.name() }),
        }
    }
    marks
}

/// The legs of a mission as one path: lengths and times go on from leg to leg.
fn joined(found: &MissionAnswer) -> Vec<PoseAnswer> {
    let mut poses: Vec<PoseAnswer> = Vec::new();
    for stop in &found.stops {
        let (from_m, from_s) = poses.last().map_or((0.0, 0.0), |last| (last.distance_m, last.t_s));
        poses.extend(stop.poses.iter().map(|pose| PoseAnswer {
            distance_m: from_m + pose.distance_m,
            t_s: from_s + pose.t_s,
            ..*pose
        }));
    }
    poses
}

/// The ground within energies of a place.
pub(crate) fn reachable<'a>(
    terrain: &'a Terrain,
    robot: &Robot,
    found: &ReachableAnswer,
    reach: &Reach,
    start_m: [f64; 2],
) -> Scene<'a> {
    let mut levels: Vec<_> = found.features.iter().map(|feature| &feature.properties).collect();
    levels.sort_by(|a, b| a.energy_j.total_cmp(&b.energy_j));
    let energies_j: Vec<f64> = levels.iter().map(|level| level.energy_j).collect();
    let key = levels.iter().enumerate().map(|(band, level)| KeyEntry {
        name: format!("within {}", energy(level.energy_j)),
        color: tint(band),
        figures: [format!("{:.0} m²", level.area_m2)]
            .into_iter()
            .chain(level.charge.map(|charge| format!("charge {charge}")))
            .collect(),
    });
    let headline = "Ground within reach".to_owned();
    Scene {
        ground: Some(bands(terrain, reach, &energies_j)),
        key: key.collect(),
        marks: vec![Mark { place_m: start_m, name: "start".to_owned() }],
        ..empty(terrain, robot, headline)
    }
}
