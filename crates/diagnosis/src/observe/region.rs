//! Rectangles on the ground that drives went through.

use crate::observe::average::Average;

/// A part of the ground, from west to east and from south to north; open where it reaches beyond what was driven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// From west to east [m].
    pub x_m: [f64; 2],
    /// From south to north [m].
    pub y_m: [f64; 2],
}

/// The names of the edges of a region, in the order of [`Region::edges_m`].
pub(crate) const EDGES: [&str; 4] = ["x_from_m", "x_to_m", "y_from_m", "y_to_m"];

impl Region {
    /// Whether a position lies in it; an unknown one does not.
    #[inline]
    #[must_use]
    pub fn contains(&self, [x_m, y_m]: [f64; 2]) -> bool {
        let within = |value: f64, [low, high]: [f64; 2]| value >= low && value < high;
        within(x_m, self.x_m) && within(y_m, self.y_m)
    }

    /// Its western, eastern, southern and northern edge, infinite where it is open [m].
    pub(crate) fn edges_m(&self) -> [f64; 4] {
        [self.x_m[0], self.x_m[1], self.y_m[0], self.y_m[1]]
    }

    /// It as a person would say it.
    #[must_use]
    pub fn words(&self) -> String {
        let along = |[low, high]: [f64; 2], name: &str, below: &str, above: &str| match (
            low.is_finite(),
            high.is_finite(),
        ) {
            (true, true) => Some(format!("between {name} = {low:.1} and {high:.1} m")),
            (true, false) => Some(format!("{above} of {name} = {low:.1} m")),
            (false, true) => Some(format!("{below} of {name} = {high:.1} m")),
            (false, false) => None,
        };
        let parts = [along(self.x_m, "x", "west", "east"), along(self.y_m, "y", "south", "north")];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if parts.is_empty() { "everywhere".into() } else { parts.join(" and ") }
    }
}

/// Parts that what was driven is cut into, in both directions; regions are rectangles of them.
const PARTS: usize = 4;
/// Share of the time driven that may lie beyond what counts as driven: a stray position must not stretch it.
const BEYOND: f64 = 0.01;

/// What the drives under suspicion went through, but for strays: from west to east and from south to north; `None` where fewer
/// than half of the positions are known, or the robot hardly moved \[m\].
pub(crate) fn extent_m(averages: &[Average]) -> Option<[[f64; 2]; 2]> {
    /// Drives that went less far have no places [m].
    const LEAST_M: f64 = 4.0;
    let suspects = averages.iter().filter(|a| a.suspect && a.channel == 0);
    let whole = suspects.clone().count();
    let known: Vec<[f64; 2]> =
        suspects.map(|a| a.input.position_m).filter(|at| at.iter().all(|m| m.is_finite())).collect();
    if 2 * known.len() < whole || known.is_empty() {
        return None;
    }
    let extent_m = [0, 1].map(|axis| {
        let mut values: Vec<f64> = known.iter().map(|at| at[axis]).collect();
        values.sort_by(f64::total_cmp);
        let last = values.len() - 1;
        let at = |share: f64| values[(share * last as f64).round() as usize];
        [at(BEYOND), at(1.0 - BEYOND)]
    });
    extent_m.iter().all(|[low, high]| high - low > LEAST_M).then_some(extent_m)
}

/// Rectangles of the parts of what was driven, all of it not among them; none where too few positions are known.
pub(crate) fn regions(averages: &[Average]) -> Vec<Region> {
    let Some(extent_m) = extent_m(averages) else { return Vec::new() };
    let sides = extent_m.map(|[low, high]| {
        let edge = |part: usize| match part {
            0 => f64::NEG_INFINITY,
            PARTS => f64::INFINITY,
            _ => low + (high - low) * part as f64 / PARTS as f64,
        };
        let pairs = (0..PARTS).flat_map(|from| (from + 1..=PARTS).map(move |to| [from, to]));
        pairs.map(|pair| pair.map(edge)).collect::<Vec<[f64; 2]>>()
    });
    let all = |x_m: [f64; 2]| sides[1].iter().map(move |y_m| Region { x_m, y_m: *y_m });
    let is_part = |region: &Region| region.edges_m().iter().any(|edge_m| edge_m.is_finite());
    sides[0].iter().flat_map(|x_m| all(*x_m)).filter(is_part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::average::Input;

    fn at(x_m: f64, y_m: f64) -> Average {
        let input = Input { position_m: [x_m, y_m], ..Input::default() };
        Average { channel: 0, run: 0, suspect: true, t_s: 0.0, input }
    }

    #[test]
    fn regions_are_all_rectangles_of_four_by_four_parts_but_the_whole() {
        let averages: Vec<Average> = (0..=100).map(|i| at(f64::from(i), 10.0 + 0.2 * f64::from(i))).collect();
        let regions = regions(&averages);
        assert_eq!(regions.len(), 99);
        let east = regions.iter().find(|r| r.edges_m()[1..].iter().all(|m| m.is_infinite())).unwrap();
        assert!(
            east.contains([1e6, -1e6]) && !east.contains([0.0, 10.0]) && !east.contains([f64::NAN, 10.0])
        );
    }

    #[test]
    fn unknown_positions_and_robots_that_stay_have_no_places() {
        assert!(regions(&vec![at(f64::NAN, 1.0); 50]).is_empty());
        assert!(regions(&vec![at(1.0, 1.0); 50]).is_empty());
    }

    #[test]
    fn a_region_is_said_by_its_edges() {
        let open = Region { x_m: [f64::NEG_INFINITY, f64::INFINITY], y_m: [f64::NEG_INFINITY, 3.0] };
        assert_eq!(open.words(), "south of y = 3.0 m");
        let closed = Region { x_m: [2.0, 5.0], ..open };
        assert_eq!(closed.words(), "between x = 2.0 and 5.0 m and south of y = 3.0 m");
    }
}
