//! What a mechanism would explain in one part of the drives or another.

use nalgebra::DVector;
use rayon::prelude::*;

use crate::{
    Error,
    baseline::Baseline,
    candidates::{self, Candidate},
    evidence::System,
    noise::Whitening,
    series::{Applied, Series},
    span::Span,
    weigh::{Weighed, blocks, system, undelayed},
};

/// Parts that are weighed in one go: few enough that some dozens of them keep several processors busy.
const TOGETHER: usize = 8;

/// A mechanism that would act everywhere, to be cut off beyond one span or another.
///
/// A mechanism acts on every second by itself, so what it does in a part of the drives is what it does all the time, cut off there.
pub(crate) struct Profile<'a> {
    series: &'a Series,
    white: Whitening,
    system: System,
    first: &'a Weighed,
    everywhere: Vec<Vec<f64>>,
}

impl<'a> Profile<'a> {
    /// Prepares a candidate beside mechanisms that act.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub(crate) fn of(
        series: &'a Series,
        base: &'a Baseline,
        others: &[Applied],
        first: &'a Weighed,
    ) -> Result<Self, Error> {
        let Candidate { applied, linear, .. } = &first.candidate;
        let always = Applied { span: Span::ALL, ..applied.clone() };
        let all = candidates::of(series, &base.robot, others, &base.predicted_w, always, linear.clone())?;
        let beside = if first.name() == "clock_offset" { undelayed } else { system };
        let (white, system) = (base.whitening(series), beside(series, base));
        Ok(Profile { series, white, system, first, everywhere: all.columns })
    }

    /// Drop of squared errors by what the mechanism explains in each of some parts.
    pub(crate) fn explained(&self, spans: &[Span]) -> Vec<f64> {
        self.of_each(spans, |whitened| self.system.explained(whitened))
    }

    /// How surely it acts in each of some parts: by squares or, where it is so strong that squares are not in proportion to its size
    /// and a few seconds on ice outweigh all else, block by block.
    pub(crate) fn told(&self, spans: &[Span]) -> Vec<f64> {
        if !self.first.is_strong {
            return self.explained(spans);
        }
        self.of_each(spans, |whitened| {
            let weighed = self.system.weigh_all(whitened).into_iter();
            weighed.map(|evidence| evidence.map_or(0.0, |evidence| evidence.wald)).collect()
        })
    }

    /// Standard errors by which blocks say that the mechanism acts in a part of the drives rather than all the time.
    pub(crate) fn sigmas_against_always(&self, part: Span) -> f64 {
        let (Some(always), Some(part)) = (self.left(Span::ALL), self.left(part)) else {
            return f64::INFINITY;
        };
        let more: Vec<f64> = always.iter().zip(&part).map(|(always, part)| always - part).collect();
        more.iter().sum::<f64>() / more.iter().map(|more| more * more).sum::<f64>().max(1e-300).sqrt()
    }

    /// Squared errors that the mechanism leaves in one part of the drives, block by block.
    fn left(&self, span: Span) -> Option<Vec<f64>> {
        let evidence = self.system.weigh(&self.whitened(&self.columns(span)))?;
        let left = self.system.left() - &evidence.own * DVector::from_vec(evidence.values);
        let mut squares = vec![0.0; self.system.blocks()];
        blocks(self.series).iter().zip(&left).for_each(|(block, error)| squares[*block] += error * error);
        Some(squares)
    }

    fn of_each(&self, spans: &[Span], told: impl Fn(&[Vec<Vec<f64>>]) -> Vec<f64> + Sync + Send) -> Vec<f64> {
        let of = |spans: &[Span]| {
            let whitened: Vec<Vec<Vec<f64>>> =
                spans.iter().map(|span| self.whitened(&self.columns(*span))).collect();
            told(&whitened)
        };
        spans.par_chunks(TOGETHER).flat_map_iter(of).collect()
    }

    /// The candidate in one part, with the evidence there; `None` where it explains nothing.
    pub(crate) fn weighed(&self, span: Span, discount: f64) -> Option<Weighed> {
        let columns = self.columns(span);
        let evidence = self.system.weigh(&self.whitened(&columns))?;
        let Candidate { applied, linear, .. } = &self.first.candidate;
        let applied = Applied { span, ..applied.clone() };
        let candidate = Candidate { applied, linear: linear.clone(), columns };
        Some(self.first.moved_to(candidate, evidence, discount))
    }

    fn columns(&self, span: Span) -> Vec<Vec<f64>> {
        self.everywhere.iter().map(|column| cut(self.series, column, span)).collect()
    }

    fn whitened(&self, columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
        columns.iter().map(|column| self.white.of(column)).collect()
    }
}

/// A column without what lies beyond a span.
fn cut(series: &Series, column: &[f64], span: Span) -> Vec<f64> {
    let averages = column.iter().zip(&series.averages);
    averages.map(|(value, average)| if average.is_in(span) { *value } else { 0.0 }).collect()
}
