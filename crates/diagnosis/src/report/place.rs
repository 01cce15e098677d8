//! Where model and recording differ: the stretches, ways of driving, places and sides that hold more than their share of the errors.

use model::Robot;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::{
    observe::{
        average::Average,
        observations::Observations,
        region::{Region, regions},
        series::Series,
        span::Span,
    },
    report::{
        diagnosis::{Place, Range},
        predictions::Corrected,
    },
    search::engine::Found,
};

/// Places with more than their share: of what the findings take away, or of what is beyond noise where nothing is named.
pub(crate) fn places(
    observed: &Observations<'_>,
    file: &Robot,
    found: &Found,
    corrected: &Corrected,
) -> Vec<Place> {
    let variance = |i: usize| {
        let channel = observed.averages()[i].channel;
        found.baseline.noise.sigma(channel, found.baseline.predicted[i]).powi(2)
    };
    let recorded = &observed.series.recorded;
    let excess = |i: usize| {
        let with = recorded[i] - corrected.predicted[i];
        match &corrected.effect {
            Some(effect) => ((with + effect[i]).powi(2) - with.powi(2)) / variance(i),
            None => with.powi(2) / variance(i) - 1.0,
        }
    };
    // Healthy drives are no place.
    let mut all: Vec<f64> = (0..observed.test_rows).map(excess).collect();
    all.resize(observed.rows(), 0.0);
    let mut places = most_of(observed.series, file, &corrected.spans, &all);
    if places.is_empty() {
        let range = Range::of("t_s", [None, None]);
        let statement = "all through the drives, nowhere in particular".into();
        places.push(Place { kind: "time", statement, range, share_of_excess: 1.0 });
    }
    places
}

/// Chance of naming any place where none differs.
const LEVEL: f64 = 0.01;
/// Parts that each drive's time is cut into; windows are runs of them, of a minute in a drive of twenty.
const PARTS: usize = 20;
/// Drives whose sequences are looked at; of more there would be too many.
const MOST_DRIVES: usize = 20;
/// Blocks that a place needs for its scatter to be known: Student's law with three degrees of freedom is wide, but not without end.
const LEAST_BLOCKS: usize = 4;
/// Averages whose excess is greater count as this much, in variances: single spikes are no place.
const MOST_VARIANCES: f64 = 50.0;

/// Speeds below are standing [m/s]. This and what follows only words a place.
const STANDING_MPS: f64 = 0.02;
/// Speeds below are slow and above are fast, as shares of the highest.
const SLOW: f64 = 0.3;
const FAST: f64 = 0.7;
/// Differences of rim speeds below are straight on [m/s].
const STRAIGHT_MPS: f64 = 0.08;
/// Slopes below are level [rad].
const LEVEL_RAD: f64 = 0.04;
/// Accelerations below are steady driving [m/s²].
const STEADY_MPS2: f64 = 0.05;

/// Rows are judged by stretches of so long \[s\], within which errors hang together.
const BLOCK_S: f64 = 20.0;

/// A part of the drives that may be told in words.
struct Cell {
    place: Place,
    inside: Box<dyn Fn(&Average) -> bool>,
}

/// A cell with how far it stands out.
struct Judged {
    place: Place,
    t: f64,
}

/// Places with significantly more excess than the rest of the drives, the clearest of each kind first.
///
/// `excess` is, by average, the squared error beyond what belongs there, in variances of the noise.
fn most_of(series: &Series, robot: &Robot, spans: &[Span], excess: &[f64]) -> Vec<Place> {
    let excess: Vec<f64> = excess.iter().map(|e| e.clamp(-MOST_VARIANCES, MOST_VARIANCES)).collect();
    let block = blocks(series);
    let groups = [times(series, spans), grounds(series), regimes(robot.max_wheel_speed_mps), sides(series)];
    let tried: usize = groups.iter().map(Vec::len).sum();
    let mut places = Vec::new();
    for cells in groups {
        let judged = cells.into_iter().filter_map(|cell| judge(series, &excess, &block, cell, tried));
        let mut judged: Vec<Judged> = judged.collect();
        judged.sort_by(|a, b| b.t.total_cmp(&a.t));
        // Windows of time overlap, ways of driving may stand out side by side.
        let most = if judged.first().is_some_and(|j| j.place.kind == "regime") { 2 } else { 1 };
        places.extend(judged.into_iter().take(most).map(|judged| judged.place));
    }
    places
}

/// The stretch of each row, counted over all drives.
fn blocks(series: &Series) -> Vec<usize> {
    let names: Vec<(usize, usize)> =
        series.averages.iter().map(|a| (a.run, (a.t_s / BLOCK_S) as usize)).collect();
    let mut distinct = names.clone();
    distinct.sort_unstable();
    distinct.dedup();
    names.iter().map(|name| distinct.partition_point(|d| d < name)).collect()
}

/// A cell's excess against that of the rest, by blocks; `None` where it does not stand out.
fn judge(series: &Series, excess: &[f64], block: &[usize], cell: Cell, tried: usize) -> Option<Judged> {
    let blocks = block.iter().max().map_or(0, |b| b + 1);
    let mut sums = vec![[[0.0; 2]; 2]; blocks];
    for (i, average) in series.averages.iter().enumerate().filter(|(_, a)| a.suspect) {
        let sum = &mut sums[block[i]][usize::from((cell.inside)(average))];
        sum[0] += excess[i];
        sum[1] += 1.0;
    }
    let [outside, inside] = [0, 1].map(|which| Mean::of(sums.iter().map(|sum| sum[which])));
    if inside.blocks < LEAST_BLOCKS || outside.blocks < LEAST_BLOCKS || inside.mean <= 0.0 {
        return None;
    }
    let t = (inside.mean - outside.mean) / (inside.variance + outside.variance).sqrt().max(1e-300);
    let freedom = (inside.blocks.min(outside.blocks) - 1) as f64;
    let chance = StudentsT::new(0.0, 1.0, freedom).ok()?.sf(t) * tried as f64;
    let share = inside.sum / (inside.sum + outside.sum.max(0.0));
    let place = Place { share_of_excess: share.clamp(0.0, 1.0), ..cell.place };
    (chance < LEVEL).then_some(Judged { place, t })
}

/// A mean over averages with its variance from blocks.
struct Mean {
    mean: f64,
    variance: f64,
    sum: f64,
    blocks: usize,
}

impl Mean {
    fn of(blocks: impl Iterator<Item = [f64; 2]>) -> Self {
        let blocks: Vec<[f64; 2]> = blocks.filter(|[_, count]| *count > 0.0).collect();
        let sum: f64 = blocks.iter().map(|b| b[0]).sum();
        let count: f64 = blocks.iter().map(|b| b[1]).sum::<f64>().max(1.0);
        let mean = sum / count;
        let spread: f64 = blocks.iter().map(|b| (b[0] - mean * b[1]).powi(2)).sum();
        let few = blocks.len() as f64 / (blocks.len() as f64 - 1.0).max(1.0);
        Mean { mean, variance: spread * few / (count * count), sum, blocks: blocks.len() }
    }
}

/// Windows of each drive's time, and drives that follow each other; windows begin and end where the findings do.
fn times(series: &Series, spans: &[Span]) -> Vec<Cell> {
    let mut cells = sequences(series);
    let suspects = series.averages.iter().filter(|a| a.suspect);
    let count = suspects.clone().map(|a| a.run).max().map_or(0, |run| run + 1);
    for run in 0..count {
        let last_s = suspects.clone().filter(|a| a.run == run).map(|a| a.t_s).fold(0.0, f64::max) + 1.0;
        let edges_s = edges_s(last_s, run, spans);
        for from in 0..PARTS {
            for to in from + 1..=PARTS {
                if to - from == PARTS && count == 1 {
                    continue;
                }
                let [from_s, to_s] = [from, to].map(|part| edges_s[part]);
                let name = series.names.get(run).cloned().unwrap_or_default();
                let whose = if count > 1 { format!(" of drive {name}") } else { String::new() };
                let range =
                    Range::of("t_s", [Some(from_s), Some(to_s)]).named((count > 1).then(|| name.clone()));
                cells.push(Cell {
                    place: place("time", span(from_s, to_s, last_s) + &whose, range),
                    inside: Box::new(move |a| a.run == run && a.t_s >= from_s && a.t_s < to_s),
                });
            }
        }
    }
    cells
}

/// Edges of the parts of a drive that lasts so long, in time since it began. Where a finding begins or ends, the nearest inner edge
/// is moved there, so that findings and places name one time [s].
fn edges_s(last_s: f64, run: usize, spans: &[Span]) -> [f64; PARTS + 1] {
    let part_s = last_s / PARTS as f64;
    let mut edges_s: [f64; PARTS + 1] = std::array::from_fn(|part| (part_s * part as f64).round());
    for span in spans {
        let at_s = match *span {
            Span::EachDrive(t_s) => t_s,
            Span::From { run: of, t_s } | Span::Until { run: of, t_s } if of == run => t_s,
            _ => continue,
        };
        let nearest = (at_s / part_s).round();
        if nearest >= 1.0 && nearest < PARTS as f64 {
            edges_s[nearest as usize] = at_s;
        }
    }
    edges_s
}

/// Some of several drives that follow each other.
fn sequences(series: &Series) -> Vec<Cell> {
    let line = series.timeline();
    let count = series.names.len();
    if !(3..=MOST_DRIVES).contains(&count) {
        // Of two, each is a window by itself.
        return Vec::new();
    }
    let pairs = (0..count).flat_map(|from| (from + 1..count).map(move |to| (from, to)));
    let cell = |(from, to): (usize, usize)| {
        let name = |run: usize| &series.names[run];
        let statement = match (from, to + 1 == count) {
            (_, true) => format!("from drive {} on", name(from)),
            (0, _) => format!("until the end of drive {}", name(to)),
            _ => format!("from drive {} to the end of drive {}", name(from), name(to)),
        };
        let begins_s = |run: usize| line.driven_s(Span::From { run, t_s: 0.0 });
        let range = Range::of("driven_s", [Some(begins_s(from)), Some(begins_s(to + 1))]);
        let inside = move |a: &Average| (from..=to).contains(&a.run);
        Cell { place: place("time", statement, range), inside: Box::new(inside) }
    };
    pairs.filter(|pair| *pair != (0, count - 1)).map(cell).collect()
}

fn span(from_s: f64, to_s: f64, last_s: f64) -> String {
    match (from_s <= 0.0, to_s >= last_s.round()) {
        (true, true) => "all the time".into(),
        (true, false) => format!("until {to_s:.0} s"),
        (false, true) => format!("from {from_s:.0} s on"),
        (false, false) => format!("between {from_s:.0} s and {to_s:.0} s"),
    }
}

/// Parts of the ground.
fn grounds(series: &Series) -> Vec<Cell> {
    let cell = |region: Region| Cell {
        place: place("place", region.words(), Range::within(&region)),
        inside: Box::new(move |a: &Average| region.contains(a.input.position_m)),
    };
    regions(&series.averages).into_iter().map(cell).collect()
}

/// Ways of driving.
fn regimes(fastest_mps: f64) -> Vec<Cell> {
    type Of = fn(&Average) -> f64;
    /// A range without an end.
    const EVER: f64 = f64::INFINITY;
    let speed: Of = |a| a.input.speed_mps;
    let turn: Of = |a| a.input.difference_mps;
    let grade: Of = |a| a.input.pitch_rad * a.input.speed_mps.signum();
    let gain: Of = |a| a.input.accel_mps2 * a.input.speed_mps.signum();
    // As they are told.
    let [slow_mps, fast_mps] = [SLOW, FAST].map(|share| (100.0 * share * fastest_mps).round() / 100.0);
    let [slow, middling, fast] = [
        format!("below {slow_mps} m/s forwards"),
        format!("between {slow_mps} and {fast_mps} m/s"),
        format!("above {fast_mps} m/s"),
    ];
    let bins: [(&str, &str, Of, [f64; 2]); 13] = [
        ("while standing or spinning on the spot", "speed_mps", speed, [-STANDING_MPS, STANDING_MPS]),
        ("while driving backwards", "speed_mps", speed, [-EVER, -STANDING_MPS]),
        (&slow, "speed_mps", speed, [STANDING_MPS, slow_mps]),
        (&middling, "speed_mps", speed, [slow_mps, fast_mps]),
        (&fast, "speed_mps", speed, [fast_mps, EVER]),
        ("while turning right", "rim_difference_mps", turn, [-EVER, -STRAIGHT_MPS]),
        ("while driving straight", "rim_difference_mps", turn, [-STRAIGHT_MPS, STRAIGHT_MPS]),
        ("while turning left", "rim_difference_mps", turn, [STRAIGHT_MPS, EVER]),
        ("on descents", "climb_rad", grade, [-EVER, -LEVEL_RAD]),
        ("on level ground", "climb_rad", grade, [-LEVEL_RAD, LEVEL_RAD]),
        ("on climbs", "climb_rad", grade, [LEVEL_RAD, EVER]),
        ("while slowing down", "acceleration_mps2", gain, [-EVER, -STEADY_MPS2]),
        ("while speeding up", "acceleration_mps2", gain, [STEADY_MPS2, EVER]),
    ];
    let cell = |(statement, quantity, of, [from, to]): (&str, &'static str, Of, [f64; 2])| {
        let bound = |x: f64| x.is_finite().then_some(x);
        let range = Range::of(quantity, [bound(from), bound(to)]);
        let inside = move |a: &Average| (from..to).contains(&of(a));
        Cell { place: place("regime", statement.into(), range), inside: Box::new(inside) }
    };
    bins.into_iter().map(cell).collect()
}

/// Both sides, where power was recorded by side.
fn sides(series: &Series) -> Vec<Cell> {
    if series.channels() < 2 {
        return Vec::new();
    }
    let cell = |(channel, name): (usize, &str)| {
        let range = Range::of("side", [None, None]).named(Some(name.into()));
        Cell {
            place: place("channel", format!("on the {name} side"), range),
            inside: Box::new(move |a| a.channel == channel),
        }
    };
    [(0, "left"), (1, "right")].into_iter().map(cell).collect()
}

fn place(kind: &'static str, statement: String, range: Range) -> Place {
    Place { kind, statement, range, share_of_excess: 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_meet_where_a_finding_of_that_drive_begins() {
        let onset = [Span::From { run: 1, t_s: 479.7 }];
        let [own, other] = [1, 0].map(|run| edges_s(900.0, run, &onset));
        assert_eq!(other[10..13], [450.0, 495.0, 540.0]);
        assert_eq!(own[10..13], [450.0, 479.7, 540.0], "not 495 s beside 480 s");
        assert!(own.is_sorted() && (own[0], own[PARTS]) == (0.0, 900.0));
    }

    #[test]
    fn a_finding_at_an_end_of_a_drive_moves_no_end() {
        for t_s in [0.0, 10.0, 890.0, 900.0, 2000.0] {
            let edges_s = edges_s(900.0, 0, &[Span::EachDrive(t_s)]);
            assert_eq!((edges_s[0], edges_s[1], edges_s[PARTS]), (0.0, 45.0, 900.0), "{t_s}");
        }
    }
}
