//! The cheapest way through a route's poses, skipping any number of them by curves.

use std::collections::HashMap;

use crate::{
    grid::heading::turn_rad,
    patience::Patience,
    refinement::{
        connection::{Connection, Waypoint},
        course::{Course, Link, Way},
        free::FreeGround,
        rates::{LevelRates, Radii},
    },
};

/// How many poses a curve may skip to; each twice as far, and once in between. Over two and three poses the lattice's own motions do as well.
const SPANS: [usize; 12] = [4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 256];
/// Curves over a span start at every pose whose number is a multiple of this share of the span.
const STARTS_PER_SPAN: usize = 4;
/// The cheapest connection between two poses that can be driven and costs less than `most`.
pub(crate) fn best_link(
    ground: &FreeGround<'_>,
    rates: &LevelRates,
    [from, to]: [&Waypoint; 2],
    radii: Radii,
    most: f64,
) -> Option<Link> {
    cheapest_driven(ground, &rates.connections(from, to, radii), [from, to], most)
}

/// The cheapest of a few connections between two poses that can be driven and costs less than `most`.
fn cheapest_driven(
    ground: &FreeGround<'_>,
    connections: &[Connection],
    [from, to]: [&Waypoint; 2],
    most: f64,
) -> Option<Link> {
    let mut best: Option<Link> = None;
    for connection in connections {
        let bound = best.as_ref().map_or(most, |b| b.cost);
        if let Some(cost) = ground.cost_below(connection, [from, to], bound)
            && ground.is_clear(connection, from, to)
        {
            best = Some(Link { way: Way::Free(*connection), cost });
        }
    }
    best
}

/// Connections by where one pose lies from the other, of which a lattice has few.
#[derive(Default)]
struct KnownConnections(HashMap<[i64; 3], Vec<Connection>>);

impl KnownConnections {
    /// Places and headings that are this near are the same [m, rad].
    const SAME: f64 = 1e-6;

    fn between(&mut self, rates: &LevelRates, [from, to]: [&Waypoint; 2]) -> &[Connection] {
        let (sin, cos) = from.heading_rad.sin_cos();
        let (east_m, north_m) = (to.x_m - from.x_m, to.y_m - from.y_m);
        let turned_rad = turn_rad(from.heading_rad, to.heading_rad);
        let seen = [east_m * cos + north_m * sin, north_m * cos - east_m * sin, turned_rad];
        self.0
            .entry(seen.map(|seen| (seen / Self::SAME).round() as i64))
            .or_insert_with(|| rates.connections(from, to, Radii::InTurn))
    }
}

/// Least sum of given steps and curves over spans of poses, by dynamic programming along the route.
pub(crate) fn shortcut(
    ground: &FreeGround<'_>,
    rates: &LevelRates,
    given: &Course,
    patience: &Patience,
) -> Course {
    let poses = given.waypoints.len();
    let mut least = vec![f64::INFINITY; poses];
    let mut arrival: Vec<Option<(usize, Link)>> = vec![None; poses];
    least[0] = 0.0;
    let mut known = KnownConnections::default();
    for i in 0..given.links.len() {
        let mut relax = |j: usize, link: Link| {
            if least[i] + link.cost < least[j] {
                least[j] = least[i] + link.cost;
                arrival[j] = Some((i, link));
            }
            least[j] - least[i]
        };
        relax(i + 1, given.links[i].clone());
        if patience.is_over() {
            continue;
        }
        let last = poses - 1;
        let spans = SPANS.into_iter().filter(|span| i % (span / STARTS_PER_SPAN).max(1) == 0);
        for j in spans.map(|span| i + span).filter(|j| *j <= last) {
            let most = relax(j, Link { way: Way::Given(0..0), cost: f64::INFINITY });
            let ends = [&given.waypoints[i], &given.waypoints[j]];
            if let Some(link) = cheapest_driven(ground, known.between(rates, ends), ends, most) {
                relax(j, link);
            }
        }
    }
    walk_back(given, arrival)
}

fn walk_back(given: &Course, mut arrival: Vec<Option<(usize, Link)>>) -> Course {
    let mut at = given.waypoints.len() - 1;
    let (mut waypoints, mut links) = (vec![given.waypoints[at]], Vec::new());
    while let Some((before, link)) = arrival[at].take() {
        waypoints.push(given.waypoints[before]);
        links.push(link);
        at = before;
    }
    waypoints.reverse();
    links.reverse();
    Course { waypoints, links }
}
