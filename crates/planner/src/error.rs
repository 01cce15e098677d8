//! Why there is no path.

use std::fmt;

use terrain::Cell;

use crate::hindrance::Hindrance;

/// Which place of a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Where the robot stands.
    Start,
    /// Where it is to go.
    Goal,
    /// One of several in a list of the question.
    Listed {
        /// Name of the list, as `sources`.
        list: &'static str,
        /// Position in it, from 0.
        index: usize,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Start => f.write_str("start"),
            Place::Goal => f.write_str("goal"),
            Place::Listed { list, index } => write!(f, "pose {list}[{index}]"),
        }
    }
}

/// Why the robot cannot stand in a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Blocked {
    /// Its footprint touches an obstacle.
    Obstacle {
        /// The obstacle's cell.
        cell: Cell,
    },
    /// Its footprint touches ground of unknown elevation.
    Unknown {
        /// The unknown cell.
        cell: Cell,
    },
    /// Its footprint touches a keep-out area.
    KeepOut {
        /// The area's cell.
        cell: Cell,
    },
    /// Its footprint hangs over the edge of the map.
    Edge,
    /// The ground pitches the robot further than its limit.
    Pitch {
        /// Pitch there [rad].
        pitch_rad: f64,
        /// The robot's limit [rad].
        limit_rad: f64,
    },
    /// The ground between or about the wheels rises further above the plane of the wheels than the body is off it.
    Body {
        /// How far it rises there [m].
        rises_m: f64,
        /// The robot's clearance [m].
        clearance_m: f64,
    },
    /// The ground tilts the robot further than its limit.
    Roll {
        /// Roll there [rad].
        roll_rad: f64,
        /// The robot's limit [rad].
        limit_rad: f64,
    },
}

impl fmt::Display for Blocked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let degrees = f64::to_degrees;
        match self {
            Blocked::Obstacle { cell } => {
                write!(f, "the robot would touch the obstacle at row {}, column {}", cell.row, cell.column)
            }
            Blocked::Unknown { cell } => {
                write!(f, "the robot would touch unknown ground at row {}, column {}", cell.row, cell.column)
            }
            Blocked::KeepOut { cell } => {
                write!(
                    f,
                    "the robot would touch the keep-out area at row {}, column {}",
                    cell.row, cell.column
                )
            }
            Blocked::Edge => write!(f, "the robot would reach over the edge of the map"),
            Blocked::Pitch { pitch_rad, limit_rad } => write!(
                f,
                "the ground pitches the robot by {:.1}°, its limit is {:.1}°",
                degrees(*pitch_rad),
                degrees(*limit_rad)
            ),
            Blocked::Body { rises_m, clearance_m } => write!(
                f,
                "the ground under the robot rises {rises_m:.3} m above the plane of its wheels, and the robot's ground_clearance_m is {clearance_m:.3} m (a third of the wheel radius where the file gives none)"
            ),
            Blocked::Roll { roll_rad, limit_rad } => write!(
                f,
                "the ground tilts the robot sideways by {:.1}°, its limit is {:.1}°",
                degrees(*roll_rad),
                degrees(*limit_rad)
            ),
        }
    }
}

/// A length to the centimetre [m].
fn centimetres(length_m: f64) -> f64 {
    (100.0 * length_m).round() / 100.0
}

/// A hint for places that could be degrees, on a map whose coordinates could not.
fn of_degrees(place: [f64; 2], west_south_m: [f64; 2]) -> &'static str {
    let could_be = |[x, y]: [f64; 2]| x.abs() <= 180.0 && y.abs() <= 180.0;
    match could_be(place) && !could_be(west_south_m) {
        true => {
            "; if these are degrees, write them as 46.5046N,93.9217W, or as `lat_deg` and `lon_deg` in a request"
        }
        false => "",
    }
}

/// An error of the planner crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A place off the map.
    #[error(
        "the {place} ({x_m:.2}, {y_m:.2}) lies outside the map, which spans x {} to {} m and y {} to {} m{}",
        centimetres(west_south_m[0]), centimetres(east_north_m[0]), centimetres(west_south_m[1]), centimetres(east_north_m[1]),
        of_degrees([*x_m, *y_m], *west_south_m)
    )]
    OutsideMap {
        /// Which place.
        place: Place,
        /// Its x [m].
        x_m: f64,
        /// Its y [m].
        y_m: f64,
        /// South-west corner of the map [m].
        west_south_m: [f64; 2],
        /// North-east corner of the map [m].
        east_north_m: [f64; 2],
    },
    /// A place where the robot cannot stand.
    #[error(
        "the robot cannot stand at the {place} ({x_m:.2}, {y_m:.2}) nor within {snap_radius_m} m of it: {reason}"
    )]
    PlaceBlocked {
        /// Which place.
        place: Place,
        /// Its x [m].
        x_m: f64,
        /// Its y [m].
        y_m: f64,
        /// How far around was searched [m].
        snap_radius_m: f64,
        /// What is wrong at the place itself.
        reason: Blocked,
    },
    /// The goal cannot be reached.
    #[error("no path from the start to the goal: {}", no_path(*gap_m, [*x_m, *y_m], hindrance))]
    NoPath {
        /// Distance from the start to the nearest cell that the goal can be reached from [m].
        gap_m: f64,
        /// Its x [m].
        x_m: f64,
        /// Its y [m].
        y_m: f64,
        /// What is in the way.
        hindrance: Hindrance,
    },
    /// Ground connects start and goal, but no chain of motions does.
    #[error(
        "no path: open ground joins the start ({x_m:.2}, {y_m:.2}) and the goal, but no chain of motions does; there may be no room to turn: leave the headings open, allow reverse, or give more room"
    )]
    NoRoomToTurn {
        /// Start, x [m].
        x_m: f64,
        /// Start, y [m].
        y_m: f64,
    },
    /// The search was told to stop before it had an answer.
    #[error(
        "the search stopped at its deadline after {expanded} expansions, before there was any path; allow more time or plan a shorter way"
    )]
    Timeout {
        /// States expanded.
        expanded: u64,
    },
    /// A path whose costs do not lead back to its start, or that cannot be driven; it rules out a wrong answer.
    #[error(
        "a path was found, but it could not be followed from start to goal: the costs of this robot on this map lie too close together; raise the friction of its surfaces or change the ends"
    )]
    Untraceable,
    /// The map names a surface that the robot has no friction for.
    #[error("the map's ground is `{name}` in places, but the robot knows only {}: add it to the robot's surfaces", known.join(", "))]
    UnknownSurface {
        /// The name on the map.
        name: String,
        /// The robot's surfaces.
        known: Vec<String>,
    },
    /// A heading beyond a full turn, most often in degrees.
    #[error(
        "the heading of the {place} is {heading_rad} rad, but must lie in -{0} to {0} rad, a full turn: give radians, 1.571 for 90 degrees",
        crate::grid::heading::MAX_HEADING_RAD
    )]
    Heading {
        /// Which place.
        place: Place,
        /// The heading found [rad].
        heading_rad: f64,
    },
    /// A number in the query that cannot be.
    #[error("{field} is {value}, but must lie in {min} to {max}")]
    OutOfRange {
        /// The field, as `goal.tolerance_m`.
        field: &'static str,
        /// The value found.
        value: f64,
        /// Smallest accepted.
        min: f64,
        /// Largest accepted.
        max: f64,
    },
    /// A goal that snapping may move farther than the tolerance accepts.
    #[error(
        "goal.tolerance_m is {tolerance_m}, but snap_radius_m {snap_radius_m} lets the goal move farther: raise the tolerance, or leave out snap_radius_m"
    )]
    ConflictingTolerance {
        /// Distance from the goal that will do [m].
        tolerance_m: f64,
        /// How far ends may be moved [m].
        snap_radius_m: f64,
    },
    /// A map whose states cannot be told apart in 32 bits.
    #[error(
        "{rows} × {columns} cells are too many to plan over: crop the map to 16 000 × 16 000 cells or use larger ones"
    )]
    TooManyStates {
        /// Rows of the map.
        rows: usize,
        /// Columns of the map.
        columns: usize,
    },
    /// More surface classes than the steps of all motions can be prepared for.
    #[error(
        "the map has {surfaces} surface classes, but on cells of {cell_size_m} m this robot can be prepared for {most} at most: merge classes or resample the map to larger cells"
    )]
    TooManySurfaces {
        /// Classes of the map, the robot's default surface included.
        surfaces: usize,
        /// Most classes for these cells.
        most: usize,
        /// The map's cell size [m].
        cell_size_m: f64,
    },
    /// Areas that cannot be laid over the map.
    #[error("{0}")]
    Areas(String),
    /// More kinds of ground than a byte tells apart.
    #[error(
        "surfaces and areas come to {found} kinds of ground, but at most {most} are told apart: name fewer surfaces, or let fewer areas lie over each other"
    )]
    TooManyGrounds {
        /// Kinds found.
        found: usize,
        /// Most that are told apart.
        most: usize,
    },
    /// A grid too coarse or too fine for this robot's lattice.
    #[error(
        "cells of {cell_size_m} m are too fine for a robot of this size: resample the map to {least_m:.3} m or coarser"
    )]
    CellsTooFine {
        /// The map's cell size [m].
        cell_size_m: f64,
        /// Smallest usable cell [m].
        least_m: f64,
    },
}

/// Where the connected ground ends, unless a limit explains by itself that there is no path.
fn no_path(gap_m: f64, [x_m, y_m]: [f64; 2], hindrance: &Hindrance) -> String {
    match hindrance {
        Hindrance::OneLimit { .. } | Hindrance::SeveralLimits => hindrance.to_string(),
        Hindrance::Ground | Hindrance::Unexplained => format!(
            "ground from which the goal can be reached comes no nearer to the start than {gap_m:.1} m, at ({x_m:.2}, {y_m:.2}); {hindrance}"
        ),
    }
}
