//! Where a mechanism acts: the profile of its evidence over each edge of a part of the ground.

use crate::{
    Error,
    baseline::Baseline,
    onset::{Bounded, JUMP_95},
    profile::Profile,
    region::{EDGES, Region, extent_m, part_m},
    series::{Applied, Series},
    span::Span,
    visits::Visits,
    weigh::{Weighed, blocks},
};

/// Places of an edge that are looked at on each side of the last.
const STEPS: i32 = 16;
/// Rounds over all edges.
const ROUNDS: usize = 3;

/// The profile over regions.
struct Regions<'a> {
    profile: Profile<'a>,
    visits: Visits<'a>,
}

impl Regions<'_> {
    /// Drop of squared errors by what the mechanism explains in each of some regions.
    fn explained(&self, regions: &[Region]) -> Vec<f64> {
        self.profile.explained(&regions.iter().copied().map(Span::Within).collect::<Vec<_>>())
    }

    /// The region without edges beyond which it might as well act.
    fn opened(&self, mut region: Region, discount: f64) -> Region {
        let mut most = self.explained(&[region])[0];
        for edge in 0..EDGES.len() {
            // Western and southern edges come before eastern and northern ones.
            let beyond_m = if edge % 2 == 0 { f64::NEG_INFINITY } else { f64::INFINITY };
            let wider = region.with_edge(edge, beyond_m);
            let is_part = wider.edges_m().iter().any(|edge_m| edge_m.is_finite());
            if wider == region || !is_part {
                continue;
            }
            let explained = self.explained(&[wider])[0];
            if (most - explained) / discount <= JUMP_95 {
                (region, most) = (wider, most.max(explained));
            }
        }
        region
    }

    /// The region with each of its edges where evidence is strongest, and their 95 % intervals.
    fn moved(
        &self,
        mut region: Region,
        extent_m: [[f64; 2]; 2],
        discount: f64,
    ) -> Option<(Region, Vec<[f64; 2]>)> {
        let mut limits_95 = Vec::new();
        for (edge, at_m) in region.edges_m().into_iter().enumerate().filter(|(_, at_m)| at_m.is_finite()) {
            let part_m = part_m(extent_m)[edge / 2];
            let places_m = places_m(extent_m[edge / 2], at_m, part_m);
            let (places_m, regions): (Vec<f64>, Vec<Region>) = places_m
                .into_iter()
                .map(|place_m| (place_m, region.with_edge(edge, place_m)))
                .filter(|(_, region)| self.visits.are_enough(*region))
                .unzip();
            let found: Vec<(f64, f64)> = places_m.into_iter().zip(self.explained(&regions)).collect();
            let (best_m, most) = found.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
            region = region.with_edge(edge, best_m);
            let within = found.iter().filter(|(_, explained)| (most - explained) / discount <= JUMP_95);
            let [low, high] = within.fold([best_m; 2], |[low, high], (m, _)| [low.min(*m), high.max(*m)]);
            // A step is as close as a place is told.
            let step_m = part_m / f64::from(STEPS);
            limits_95.push([low - step_m, high + step_m]);
        }
        Some((region, limits_95))
    }
}

/// Moves the edges of a candidate that acts in a part of the ground to where its evidence is strongest.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn refine(
    series: &Series,
    base: &Baseline,
    others: &[Applied],
    (first, region): (&Weighed, Region),
    discount: f64,
) -> Result<Option<Bounded>, Error> {
    let Some(extent_m) = extent_m(&series.averages) else { return Ok(None) };
    let profile = Profile::of(series, base, others, first)?;
    let regions = Regions { profile, visits: Visits::of(&series.averages, blocks(series)) };
    let mut bounded = (region, Vec::new());
    for _ in 0..ROUNDS {
        let opened = regions.opened(bounded.0, discount);
        let Some(moved) = regions.moved(opened, extent_m, discount) else { return Ok(None) };
        bounded = moved;
    }
    let (region, limits_95) = bounded;
    let weighed = regions.profile.weighed(Span::Within(region), discount);
    Ok(weighed.map(|weighed| Bounded { weighed, limits_95 }))
}

/// Places of an edge about one, within what was driven.
fn places_m([low_m, high_m]: [f64; 2], at_m: f64, part_m: f64) -> Vec<f64> {
    let steps = (-STEPS..=STEPS).map(|step| at_m + part_m * f64::from(step) / f64::from(STEPS));
    steps.filter(|m| *m > low_m && *m < high_m).collect()
}
