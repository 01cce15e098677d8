//! The best order of stops, exact over all subsets.

use crate::{Error, meter::Meter};

/// Places with the poses that stand for each, and least costs between poses.
pub(crate) struct Poses<'a> {
    /// Poses of each place: the start first, then all that are to be visited, then the end if there is one.
    pub(crate) places: &'a [Vec<usize>],
    /// Whether the last place is where the robot must end.
    pub(crate) ends: bool,
    /// From the pose of the row to that of the column; infinite where no way leads.
    pub(crate) cost: &'a [Vec<f64>],
}

/// The cheapest order that begins at the start, visits every place once and ends at the end: its cost and its poses, one for
/// each place in the order of visits. `None` where there is none.
///
/// Held & Karp, J. SIAM 10 (1962) 196, over poses instead of places: the state is the set of places visited and the pose last
/// taken, so that legs join up in every place. Time and memory grow as 2ⁿ with the places.
///
/// # Errors
/// Patience that ends first.
pub(crate) fn cheapest_order(
    poses: &Poses<'_>,
    meter: &mut Meter<'_>,
) -> Result<Option<(f64, Vec<usize>)>, Error> {
    let visits = poses.places.len() - 1 - usize::from(poses.ends);
    let place = |i: usize| &poses.places[i + 1];
    let count = poses.cost.len();
    let mut least = vec![f64::INFINITY; count << visits];
    for (i, q) in (0..visits).flat_map(|i| place(i).iter().map(move |q| (i, *q))) {
        let from_start = poses.places[0].iter().map(|&p| poses.cost[p][q]);
        least[(1 << i) * count + q] = from_start.fold(f64::INFINITY, f64::min);
    }
    for set in 1..1_usize << visits {
        for p in (0..visits).filter(|i| set >> i & 1 == 1).flat_map(place) {
            let so_far = least[set * count + p];
            if so_far == f64::INFINITY {
                continue;
            }
            let row = &poses.cost[*p];
            meter.spend(count)?;
            for i in (0..visits).filter(|i| set >> i & 1 == 0) {
                let next = (set | 1 << i) * count;
                for &q in place(i) {
                    let total = so_far + row[q];
                    if total < least[next + q] {
                        least[next + q] = total;
                    }
                }
            }
        }
    }
    Ok(trace(poses, &least, visits))
}

/// Walks back from the best end.
fn trace(poses: &Poses<'_>, least: &[f64], visits: usize) -> Option<(f64, Vec<usize>)> {
    let count = poses.cost.len();
    let mut set = (1_usize << visits) - 1;
    let of_set = |set: usize| {
        let places = (0..visits).filter(move |i| set >> i & 1 == 1);
        places.flat_map(|i| poses.places[i + 1].iter().copied())
    };
    let mut order = Vec::new();
    // What follows the last visit: nothing, or the cheapest pose of the end.
    let after = |p: usize| -> (f64, Option<usize>) {
        if !poses.ends {
            return (0.0, None);
        }
        let ends = poses.places[visits + 1].iter().map(|&q| (poses.cost[p][q], Some(q)));
        ends.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, None))
    };
    let (total, mut last) =
        of_set(set).map(|p| (least[set * count + p] + after(p).0, p)).min_by(|a, b| a.0.total_cmp(&b.0))?;
    if total == f64::INFINITY {
        return None;
    }
    order.extend(after(last).1);
    loop {
        order.push(last);
        let place = poses.places.iter().skip(1).position(|place| place.contains(&last))?;
        let here = least[set * count + last];
        set &= !(1 << place);
        if set == 0 {
            let first = poses.places[0]
                .iter()
                .copied()
                .min_by(|a, b| poses.cost[*a][last].total_cmp(&poses.cost[*b][last]))?;
            order.push(first);
            break;
        }
        let off = |p: &usize| (least[set * count + p] + poses.cost[*p][last] - here).abs();
        last = of_set(set).filter(|p| off(p).is_finite()).min_by(|a, b| off(a).total_cmp(&off(b)))?;
    }
    order.reverse();
    Some((total, order))
}

#[cfg(test)]
mod tests {
    use planner::Patience;
    use proptest::prelude::*;

    use super::*;
    use crate::meter::WORK_PER_LOOK;

    /// Every order and every choice of poses.
    fn brute_force(poses: &Poses<'_>) -> f64 {
        fn extend(poses: &Poses<'_>, at: usize, left: &mut Vec<usize>, so_far: f64, best: &mut f64) {
            if left.is_empty() {
                let end = match poses.ends {
                    false => 0.0,
                    true => poses.places[poses.places.len() - 1]
                        .iter()
                        .map(|&q| poses.cost[at][q])
                        .fold(f64::INFINITY, f64::min),
                };
                *best = best.min(so_far + end);
                return;
            }
            for i in 0..left.len() {
                let place = left.remove(i);
                for &q in &poses.places[place] {
                    extend(poses, q, left, so_far + poses.cost[at][q], best);
                }
                left.insert(i, place);
            }
        }
        let visits = poses.places.len() - 1 - usize::from(poses.ends);
        let mut best = f64::INFINITY;
        for &p in &poses.places[0] {
            extend(poses, p, &mut (1..=visits).collect(), 0.0, &mut best);
        }
        best
    }

    proptest! {
        #[test]
        fn the_order_is_that_of_brute_force(
            sizes in prop::collection::vec(1usize..3, 2..7), ends in any::<bool>(), seed in prop::collection::vec(0u32..1000, 256),
        ) {
            prop_assume!(sizes.len() > 1 + usize::from(ends));
            let mut next = 0;
            let places: Vec<Vec<usize>> =
                sizes.iter().map(|size| { next += size; (next - size..next).collect() }).collect();
            // Negative costs as of descents, and some ways that do not exist.
            let cost: Vec<Vec<f64>> = (0..next).map(|p| (0..next).map(|q| {
                let v = seed[(p * 17 + q * 5) % 256];
                if v < 40 { f64::INFINITY } else { f64::from(v) - 200.0 }
            }).collect()).collect();
            let poses = Poses { places: &places, ends, cost: &cost };
            let expected = brute_force(&poses);
            let patience = Patience::default();
            match cheapest_order(&poses, &mut Meter::new(&patience, "testing")).unwrap() {
                None => prop_assert_eq!(expected, f64::INFINITY),
                Some((total, order)) => {
                    prop_assert!((total - expected).abs() < 1e-9, "{} for {}", total, expected);
                    let driven: f64 = order.windows(2).map(|leg| cost[leg[0]][leg[1]]).sum();
                    prop_assert!((driven - total).abs() < 1e-9);
                    prop_assert_eq!(order.len(), places.len());
                }
            }
        }
    }

    #[test]
    fn twelve_places_are_left_at_the_deadline() {
        let count = 13;
        let cost: Vec<Vec<f64>> =
            (0..count).map(|p| (0..count).map(|q| ((p * 7 + q * 3) % 11) as f64).collect()).collect();
        let places: Vec<Vec<usize>> = (0..count).map(|p| vec![p]).collect();
        let poses = Poses { places: &places, ends: false, cost: &cost };
        // Each of 4095 sets has up to twelve last places, and each of those up to twelve next ones.
        let comparisons = 4095 * 6 * 6;
        let over = Patience::for_looks((comparisons / WORK_PER_LOOK) as u64);
        let late = cheapest_order(&poses, &mut Meter::new(&over, "testing"));
        assert_eq!(late, Err(Error::Timeout { step: "testing" }));
    }
}
