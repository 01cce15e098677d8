//! Where a mechanism acts: the profile of its evidence over each edge of a part of the ground.

use nalgebra::DVector;
use rayon::prelude::*;

use crate::{
    Error,
    baseline::Baseline,
    candidates::{self, Candidate},
    evidence::{Evidence, System},
    onset::{Bounded, JUMP_95, cut},
    region::{EDGES, Region, extent_m, part_m},
    series::{Applied, Series},
    span::Span,
    weigh::{Weighed, system},
};

/// Places of an edge that are looked at on each side of the last.
const STEPS: i32 = 16;
/// Rounds over all edges.
const ROUNDS: usize = 3;

/// What is moved about: a mechanism that would act everywhere, cut off beyond edges.
struct Profile<'a> {
    series: &'a Series,
    base: &'a Baseline,
    system: System,
    everywhere: Vec<Vec<f64>>,
}

impl Profile<'_> {
    fn at(&self, region: Region) -> Option<(Vec<Vec<f64>>, Evidence)> {
        let columns: Vec<Vec<f64>> =
            self.everywhere.iter().map(|column| cut(self.series, column, Span::Within(region))).collect();
        let white = self.base.whitening(self.series);
        let whitened: Vec<Vec<f64>> = columns.iter().map(|column| white.of(column)).collect();
        let evidence = self.system.weigh(&whitened)?;
        Some((columns, evidence))
    }

    /// Drop of squared errors by what a candidate explains.
    fn explained(&self, evidence: &Evidence) -> f64 {
        (&evidence.own * DVector::from_column_slice(&evidence.values)).dot(self.system.left())
    }

    /// The region without edges beyond which it might as well act.
    fn opened(&self, mut region: Region, discount: f64) -> Option<Region> {
        let mut most = self.explained(&self.at(region)?.1);
        for (edge, name) in EDGES.iter().enumerate() {
            let beyond_m = if name.contains("from") { f64::NEG_INFINITY } else { f64::INFINITY };
            let wider = region.with_edge(edge, beyond_m);
            let is_part = wider.edges_m().iter().any(|edge_m| edge_m.is_finite());
            if wider == region || !is_part {
                continue;
            }
            let explained = self.at(wider).map_or(0.0, |(_, evidence)| self.explained(&evidence));
            if (most - explained) / discount <= JUMP_95 {
                (region, most) = (wider, most.max(explained));
            }
        }
        Some(region)
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
            let found = self.over(region, edge, &places_m(extent_m[edge / 2], at_m, part_m));
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

    /// Evidence by place of one edge.
    fn over(&self, region: Region, edge: usize, places_m: &[f64]) -> Vec<(f64, f64)> {
        let of = |at_m: &f64| Some((*at_m, self.explained(&self.at(region.with_edge(edge, *at_m))?.1)));
        places_m.par_iter().filter_map(of).collect()
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
    let (guess, linear) = (&first.candidate.applied, first.candidate.linear.clone());
    let always = Applied { span: Span::ALL, ..guess.clone() };
    let everywhere = candidates::of(series, &base.robot, others, &base.predicted_w, always, linear)?.columns;
    let profile = Profile { series, base, system: system(series, base), everywhere };
    let mut bounded = (region, Vec::new());
    for _ in 0..ROUNDS {
        let Some(moved) =
            profile.opened(bounded.0, discount).and_then(|r| profile.moved(r, extent_m, discount))
        else {
            return Ok(None);
        };
        bounded = moved;
    }
    let (region, limits_95) = bounded;
    let Some((columns, evidence)) = profile.at(region) else { return Ok(None) };
    let span = Span::Within(region);
    let applied = Applied { span, ..guess.clone() };
    let candidate = Candidate { applied, linear: first.candidate.linear.clone(), columns };
    Ok(Some(Bounded { weighed: first.moved_to(candidate, evidence, discount), limits_95 }))
}

/// Places of an edge about one, within what was driven.
fn places_m([low_m, high_m]: [f64; 2], at_m: f64, part_m: f64) -> Vec<f64> {
    let steps = (-STEPS..=STEPS).map(|step| at_m + part_m * f64::from(step) / f64::from(STEPS));
    steps.filter(|m| *m > low_m && *m < high_m).collect()
}
