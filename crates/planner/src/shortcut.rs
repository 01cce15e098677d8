//! The cheapest way through a route's poses, skipping any number of them by curves.

use crate::{
    connection::{Connection, Waypoint},
    course::{Course, Link, Way},
    free::FreeGround,
    patience::Patience,
    rates::{LevelRates, Radii},
};

/// How many poses a curve may skip to; each twice as far, and once in between.
const SPANS: [usize; 14] = [2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 256];
/// Curves over a span start at every pose whose number is a multiple of this share of the span.
const STARTS_PER_SPAN: usize = 4;
/// So many of the curves between two poses, the best by level ground, are driven.
const DRIVEN: usize = 3;

/// The cheapest connection between two poses that can be driven and costs less than `most`.
pub(crate) fn best_link(
    ground: &FreeGround<'_>,
    rates: &LevelRates,
    [from, to]: [&Waypoint; 2],
    radii: Radii,
    most: f64,
) -> Option<Link> {
    let mut best: Option<Link> = None;
    let mut consider = |connection: Connection| {
        let bound = best.as_ref().map_or(most, |b| b.cost);
        if let Some(cost) = ground.cost(&connection, from, to).filter(|cost| *cost < bound)
            && ground.is_clear(&connection, from, to)
        {
            best = Some(Link { way: Way::Free(connection), cost });
        }
    };
    rates.connections(from, to, radii).into_iter().take(DRIVEN).for_each(&mut consider);
    best
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
            if let Some(link) =
                best_link(ground, rates, [&given.waypoints[i], &given.waypoints[j]], Radii::InTurn, most)
            {
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
