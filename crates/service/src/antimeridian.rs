//! Lines and polygons that cross the antimeridian, cut there as GeoJSON wants it (RFC 7946, 3.1.9).

/// Longitude at which geometries are cut [°].
const EDGE_DEG: f64 = 180.0;
const TURN_DEG: f64 = 360.0;

/// A line in the parts that lie on either side of the antimeridian, each of two positions or more; one part where it does not cross it.
/// What a position has besides longitude is interpolated at the cut.
pub(crate) fn cut_line<const N: usize>(line: &[[f64; N]]) -> Vec<Vec<[f64; N]>> {
    let mut parts = vec![Vec::new()];
    for (index, &position) in line.iter().enumerate() {
        let before = index.checked_sub(1).and_then(|before| line.get(before));
        if let Some(before) = before.filter(|before| (position[0] - before[0]).abs() > EDGE_DEG) {
            let side_deg = EDGE_DEG.copysign(before[0]);
            let mut unrolled = position;
            unrolled[0] += TURN_DEG.copysign(before[0]);
            let mut end = between(before, &unrolled, side_deg);
            extend(&mut parts, end);
            end[0] = -side_deg;
            parts.push(vec![end]);
        }
        extend(&mut parts, position);
    }
    parts.retain(|part| part.len() > 1);
    parts
}

/// Adds a position to the last part, unless it ends there.
fn extend<const N: usize>(parts: &mut [Vec<[f64; N]>], position: [f64; N]) {
    let Some(part) = parts.last_mut().filter(|part| part.last() != Some(&position)) else { return };
    part.push(position);
}

/// The place between two at which a longitude is reached.
fn between<const N: usize>(from: &[f64; N], to: &[f64; N], lon_deg: f64) -> [f64; N] {
    let span_deg = to[0] - from[0];
    let share = if span_deg == 0.0 { 0.0 } else { (lon_deg - from[0]) / span_deg };
    let mut place = *from;
    for (at, to) in place.iter_mut().zip(to) {
        *at += share * (to - *at);
    }
    place[0] = lon_deg;
    place
}

type Ring = Vec<[f64; 2]>;

/// A polygon, its closed rings with the exterior first, as polygons on either side of the antimeridian; one where it does not cross it.
pub(crate) fn cut_polygon(rings: Vec<Ring>) -> Vec<Vec<Ring>> {
    let crosses = |ring: &Ring| ring.array_windows().any(|[a, b]| (b[0] - a[0]).abs() > EDGE_DEG);
    let Some(first_deg) = rings.first().and_then(|ring| ring.first()).map(|place| place[0]) else {
        return vec![rings];
    };
    if !rings.iter().any(crosses) {
        return vec![rings];
    }
    let unrolled: Vec<Ring> = rings.iter().map(|ring| unrolled(ring, first_deg)).collect();
    let side_deg = EDGE_DEG.copysign(first_deg);
    let beyond = |is_beyond: bool| part(&unrolled, side_deg, is_beyond == (side_deg > 0.0));
    let turned = |mut polygons: Vec<Vec<Ring>>| {
        let places = polygons.iter_mut().flatten().flatten();
        places.for_each(|place| place[0] -= TURN_DEG.copysign(side_deg));
        polygons
    };
    beyond(false).into_iter().chain(turned(beyond(true))).collect()
}

/// A ring with longitudes that go on beyond ±180°, on the turn of a longitude.
fn unrolled(ring: &Ring, first_deg: f64) -> Ring {
    let mut before_deg = first_deg;
    let turn = |&[lon_deg, lat_deg]: &[f64; 2]| {
        let turns = ((before_deg - lon_deg) / TURN_DEG).round();
        before_deg = lon_deg + turns * TURN_DEG;
        [before_deg, lat_deg]
    };
    ring.iter().map(turn).collect()
}

/// The polygons of what of some rings lies east or else west of a meridian.
///
/// Of a ring that crosses it the chains on that side are kept. Exteriors run counter-clockwise and holes clockwise, so that the area lies left of
/// every chain; along the cut, ends in order of latitude belong together in pairs.
fn part(rings: &[Ring], at_deg: f64, is_east: bool) -> Vec<Vec<Ring>> {
    let is_kept = |place: &[f64; 2]| if is_east { place[0] >= at_deg } else { place[0] < at_deg };
    let (mut whole, mut chains): (Vec<Ring>, Vec<Ring>) = (Vec::new(), Vec::new());
    for ring in rings {
        let kept = ring.iter().filter(|place| is_kept(place)).count();
        match kept {
            0 => {}
            _ if kept == ring.len() => whole.push(ring.clone()),
            _ => chains.extend(kept_chains(ring, at_deg, &is_kept)),
        }
    }
    let mut polygons: Vec<Vec<Ring>> = joined(chains).into_iter().map(|ring| vec![ring]).collect();
    for ring in whole {
        let holder = if is_clockwise(&ring) {
            polygons.iter_mut().find(|polygon| ring.first().is_some_and(|place| holds(&polygon[0], *place)))
        } else {
            None
        };
        match holder {
            Some(polygon) => polygon.push(ring),
            None => polygons.push(vec![ring]),
        }
    }
    polygons
}

/// The chains of a closed ring whose places are kept, each from the cut to the cut.
fn kept_chains(ring: &Ring, at_deg: f64, is_kept: &impl Fn(&[f64; 2]) -> bool) -> Vec<Ring> {
    let open = &ring[..ring.len() - 1];
    let Some(start) = open.iter().position(|place| !is_kept(place)) else { return Vec::new() };
    let mut chains: Vec<Ring> = Vec::new();
    let mut before = open[start];
    for step in 1..=open.len() {
        let place = open[(start + step) % open.len()];
        match (is_kept(&before), is_kept(&place)) {
            (false, true) => chains.push(vec![between(&before, &place, at_deg), place]),
            (true, true) => chains.last_mut().into_iter().for_each(|chain| chain.push(place)),
            (true, false) => {
                let cut = between(&before, &place, at_deg);
                chains.last_mut().into_iter().for_each(|chain| chain.push(cut));
            }
            (false, false) => {}
        }
        before = place;
    }
    chains
}

/// Closed rings out of chains that begin and end on the cut.
fn joined(mut chains: Vec<Ring>) -> Vec<Ring> {
    let ends = |chain: &Ring| [chain.first(), chain.last()].map(|place| place.map_or(0.0, |place| place[1]));
    let mut latitudes_deg: Vec<f64> = chains.iter().flat_map(ends).collect();
    latitudes_deg.sort_by(f64::total_cmp);
    let partner = |lat_deg: f64| {
        let at = latitudes_deg.iter().position(|known| *known == lat_deg).unwrap_or(0);
        latitudes_deg.get(at ^ 1).copied().unwrap_or(lat_deg)
    };
    let mut rings = Vec::new();
    while let Some(mut ring) = chains.pop() {
        let first_deg = ends(&ring)[0];
        loop {
            let next_deg = partner(ends(&ring)[1]);
            if next_deg == first_deg {
                break;
            }
            let Some(next) = chains.iter().position(|chain| ends(chain)[0] == next_deg) else { break };
            ring.extend(chains.swap_remove(next));
        }
        ring.extend(ring.first().copied());
        rings.push(ring);
    }
    rings
}

/// Twice the signed area of a closed ring is below zero.
fn is_clockwise(ring: &Ring) -> bool {
    ring.array_windows().map(|[a, b]| a[0] * b[1] - b[0] * a[1]).sum::<f64>() < 0.0
}

/// Whether a closed ring holds a place, by the crossings of a line to the east.
fn holds(ring: &Ring, [x, y]: [f64; 2]) -> bool {
    let crosses = |[a, b]: &[[f64; 2]; 2]| {
        (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    };
    ring.array_windows().filter(|edge| crosses(edge)).count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(polygons: &[Vec<Ring>]) -> f64 {
        let of_ring =
            |ring: &Ring| ring.array_windows().map(|[a, b]| a[0] * b[1] - b[0] * a[1]).sum::<f64>() / 2.0;
        polygons.iter().flatten().map(of_ring).sum()
    }

    /// A ring as longitudes of −180 to 180.
    fn rolled(places: &[[f64; 2]]) -> Ring {
        places.iter().map(|[lon, lat]| [if *lon > 180.0 { lon - 360.0 } else { *lon }, *lat]).collect()
    }

    #[test]
    fn a_line_is_cut_where_it_crosses_and_heights_are_interpolated() {
        let parts = cut_line(&[
            [179.0, -17.0, 10.0],
            [-179.0, -16.0, 20.0],
            [-178.0, -16.0, 30.0],
            [179.0, -13.0, 0.0],
        ]);
        assert_eq!(parts.len(), 3);
        assert_eq!(parts[0], [[179.0, -17.0, 10.0], [180.0, -16.5, 15.0]]);
        assert_eq!(parts[1][0], [-180.0, -16.5, 15.0]);
        assert_eq!(parts[1][3][0], -180.0);
        assert_eq!((parts[2][0][0], parts[2][1]), (180.0, [179.0, -13.0, 0.0]));
        assert_eq!(cut_line(&[[9.0, 48.0], [10.0, 48.0]]), [[[9.0, 48.0], [10.0, 48.0]]]);
        // A line that ends on the cut has nothing beyond it.
        assert_eq!(cut_line(&[[179.0, 0.0], [180.0, 0.0]]).len(), 1);
    }

    #[test]
    fn polygons_keep_their_area_and_their_holes_on_either_side() {
        // A U that opens west: two arms and what joins them lies in the east; a hole across the cut, and one in the east.
        let exterior = [
            [178.0, 0.0],
            [184.0, 0.0],
            [184.0, 9.0],
            [178.0, 9.0],
            [178.0, 6.0],
            [182.0, 6.0],
            [182.0, 3.0],
            [178.0, 3.0],
            [178.0, 0.0],
        ];
        let across = [[179.0, 1.0], [179.0, 2.0], [181.0, 2.0], [181.0, 1.0], [179.0, 1.0]];
        let east = [[183.0, 4.0], [183.0, 5.0], [183.5, 5.0], [183.5, 4.0], [183.0, 4.0]];
        let rings = vec![rolled(&exterior), rolled(&across), rolled(&east)];
        let polygons = cut_polygon(rings);
        assert!((area(&polygons) - (54.0 - 12.0 - 2.0 - 0.5)).abs() < 1e-9, "{polygons:?}");
        for place in polygons.iter().flatten().flatten() {
            assert!(place[0].abs() <= 180.0, "{place:?}");
        }
        for polygon in &polygons {
            let span = |ring: &Ring| {
                ring.iter().map(|place| place[0].signum()).sum::<f64>().abs() == ring.len() as f64
            };
            assert!(polygon.iter().all(span), "on one side: {polygon:?}");
            assert!(polygon.iter().all(|ring| ring.first() == ring.last()));
            assert!(!is_clockwise(&polygon[0]) && polygon[1..].iter().all(is_clockwise));
        }
        assert_eq!(
            polygons.iter().map(Vec::len).sum::<usize>(),
            polygons.len() + 1,
            "one hole is left whole"
        );
        let plain = vec![rolled(&[[9.0, 48.0], [10.0, 48.0], [10.0, 49.0], [9.0, 48.0]])];
        assert_eq!(cut_polygon(plain.clone()), [plain]);
    }
}
