//! A good order of many stops, and a bound that tells how good.

use pathfinding::{kuhn_munkres::kuhn_munkres_min, matrix::Matrix};

use crate::{Error, meter::Meter};

/// A good order of places 1 to n of a cost matrix whose row 0 is the start and whose column n + 1, if there is one, the end.
///
/// Nearest neighbours from every first place, each improved by moving up to three places elsewhere (Or 1976) and by turning
/// stretches round (2-opt), as long as that pays; costs may differ by direction. `None` where no order was found.
///
/// # Errors
/// Patience that ends first.
pub(crate) fn good_order(
    cost: &[Vec<f64>],
    visits: usize,
    meter: &mut Meter<'_>,
) -> Result<Option<(f64, Vec<usize>)>, Error> {
    let mut best: Option<(f64, Vec<usize>)> = None;
    for first in 1..=visits {
        let found = improved(cost, visits, nearest_neighbours(cost, visits, first), meter)?;
        if best.as_ref().is_none_or(|(least, _)| found.0 < *least) {
            best = Some(found);
        }
    }
    Ok(best.filter(|(least, _)| *least < f64::INFINITY))
}

/// An order that no move makes cheaper, with its cost. Every move makes it cheaper, so that none comes twice.
fn improved(
    cost: &[Vec<f64>],
    visits: usize,
    mut order: Vec<usize>,
    meter: &mut Meter<'_>,
) -> Result<(f64, Vec<usize>), Error> {
    /// What a move has to save, as a share of the cost: rounding must not go round in circles.
    const LEAST_SAVING: f64 = 1e-9;
    let ends = cost.len() > visits + 1;
    let total = |order: &[usize]| -> f64 {
        let mut sum = cost[0][order[0]];
        sum += order.windows(2).map(|leg| cost[leg[0]][leg[1]]).sum::<f64>();
        sum + if ends { cost[order[order.len() - 1]][visits + 1] } else { 0.0 }
    };
    let mut best = total(&order);
    loop {
        let most = best - if best.is_finite() { LEAST_SAVING * best.abs() } else { 0.0 };
        let mut better = None;
        for next in neighbours(&order) {
            meter.spend(visits)?;
            let cost = total(&next);
            if cost < most {
                better = Some((cost, next));
                break;
            }
        }
        let Some(found) = better else { return Ok((best, order)) };
        (best, order) = found;
    }
}

fn nearest_neighbours(cost: &[Vec<f64>], visits: usize, first: usize) -> Vec<usize> {
    let mut order = vec![first];
    let mut left: Vec<usize> = (1..=visits).filter(|place| *place != first).collect();
    let mut at = first;
    while let Some(i) = (0..left.len()).min_by(|a, b| cost[at][left[*a]].total_cmp(&cost[at][left[*b]])) {
        at = left.swap_remove(i);
        order.push(at);
    }
    order
}

/// Orders a move away.
fn neighbours(order: &[usize]) -> impl Iterator<Item = Vec<usize>> + '_ {
    let count = order.len();
    let moved = (1..=3usize).flat_map(move |length| {
        (0..=count.saturating_sub(length)).flat_map(move |from| {
            (0..=count.saturating_sub(length)).filter(move |to| *to != from).map(move |to| {
                let mut rest = order.to_vec();
                let taken: Vec<usize> = rest.drain(from..(from + length).min(count)).collect();
                let to = to.min(rest.len());
                rest.splice(to..to, taken);
                rest
            })
        })
    });
    let turned = (0..count).flat_map(move |from| {
        (from + 2..=count).map(move |to| {
            let mut turned = order.to_vec();
            turned[from..to].reverse();
            turned
        })
    });
    moved.chain(turned)
}

/// No order costs less: the least assignment of a successor to every place (Balas & Toth 1985), which need not be one chain.
pub(crate) fn lower_bound(cost: &[Vec<f64>], visits: usize) -> Option<f64> {
    /// Units per joule or second; rounded down, so that the bound stays one.
    const UNITS: f64 = 1000.0;
    /// Of what cannot be; two of them are more than any order, and their sum fits.
    const NEVER: i64 = i64::MAX / 1024;
    let ends = cost.len() > visits + 1;
    let weight = |from: usize, to: usize| -> i64 {
        let value = match to {
            _ if to == from => f64::INFINITY,
            _ if to <= visits => cost[from][to],
            // The last place has no successor, or the end.
            _ if ends => cost[from][visits + 1],
            _ if from == 0 => f64::INFINITY,
            _ => 0.0,
        };
        if value == f64::INFINITY { NEVER } else { (value * UNITS).floor() as i64 }
    };
    let rows = (0..=visits).map(|from| (1..=visits + 1).map(|to| weight(from, to)).collect::<Vec<i64>>());
    let weights = Matrix::from_rows(rows).ok()?;
    let (total, _) = kuhn_munkres_min(&weights);
    (total < NEVER / 2).then(|| total as f64 / UNITS)
}

#[cfg(test)]
mod tests {
    use planner::Patience;
    use proptest::prelude::*;

    use super::*;
    use crate::{
        meter::WORK_PER_LOOK,
        mission::held_karp::{Poses, cheapest_order},
    };

    #[test]
    fn many_places_are_left_at_the_deadline() {
        // Places at random on a circle, which take many moves to put in order.
        let visits = 40;
        let place = |p: usize| (p * 17 % 41) as f64 / 41.0 * std::f64::consts::TAU;
        let away = |p: usize, q: usize| (2.0 * ((place(p) - place(q)) / 2.0).sin()).abs();
        let cost: Vec<Vec<f64>> = (0..=visits).map(|p| (0..=visits).map(|q| away(p, q)).collect()).collect();
        // No order is found before each of forty has been held against each of its neighbours, of some 40 legs each.
        let legs = 40 * (3 * 37 * 36 + 39 * 38 / 2) * 40;
        let over = Patience::for_looks((legs / WORK_PER_LOOK) as u64);
        let late = good_order(&cost, visits, &mut Meter::new(&over, "testing"));
        assert_eq!(late, Err(Error::Timeout { step: "testing" }));
    }

    proptest! {
        #[test]
        fn the_best_order_lies_between_the_bound_and_the_order_found(
            visits in 2usize..9, ends in any::<bool>(), seed in prop::collection::vec(1u32..1000, 121),
        ) {
            let count = visits + 1 + usize::from(ends);
            let cost: Vec<Vec<f64>> = (0..count).map(|p| (0..count).map(|q| {
                let (dx, dy) = (f64::from(seed[p]) - f64::from(seed[q]), f64::from(seed[p + 20]) - f64::from(seed[q + 20]));
                dx.hypot(dy) + 0.3 * (f64::from(seed[q + 40]) - f64::from(seed[p + 40]))
            }).collect()).collect();
            let places: Vec<Vec<usize>> = (0..count).map(|p| vec![p]).collect();
            let patience = Patience::default();
            let mut meter = Meter::new(&patience, "testing");
            let poses = Poses { places: &places, ends, cost: &cost };
            let (best, _) = cheapest_order(&poses, &mut meter).unwrap().unwrap();
            let bound = lower_bound(&cost, visits).unwrap();
            let (found, order) = good_order(&cost, visits, &mut meter).unwrap().unwrap();
            prop_assert!(bound <= best + 1e-6 && best <= found + 1e-6, "{} {} {}", bound, best, found);
            let mut sorted = order;
            sorted.sort_unstable();
            prop_assert_eq!(sorted, (1..=visits).collect::<Vec<_>>());
        }
    }
}
