//! How far the model is off of healthy drives, and ground from run to run: the likeliest of a grid of amplitudes.

use std::ops::Range;

use nalgebra::DVector;
use rayon::prelude::*;

use crate::{
    evidence::{
        linear_model::{Moments, transposed},
        noise::Whitening,
        width,
    },
    fit::{
        baseline::Baseline,
        discrepancy::{Shares, run_columns},
        temperature::UNTOLD,
    },
    observe::observations::Observations,
};

/// Amplitudes that healthy drives choose from, each about twice the one before, up to what a robot with borrowed constants is missed by.
const AMPLITUDES: [f64; 8] = [0.003, 0.006, 0.01, 0.02, 0.03, 0.06, 0.12, 0.25];
/// Standard deviations of ground from run to run, as shares of resistance, each about three times the one before: none on a floor, a third on
/// soil that is wet here and dry there (BorealTC: sandy loam).
const RUN_VARIATIONS: [f64; 4] = [0.0, 0.04, 0.12, 0.36];
/// Amplitude of the discrepancy beside which that is chosen.
const RUN_MODEL_ERROR: f64 = 0.02;

/// Rows of drives in which nothing is taken to act, whitened and tempered as where no drives tell.
#[derive(Clone)]
pub(crate) struct Healthy<'a> {
    pub(crate) observed: &'a Observations<'a>,
    pub(crate) baseline: &'a Baseline,
    pub(crate) whitening: &'a Whitening,
    pub(crate) rows: Range<usize>,
}

/// Ground that differs from run to run, a random effect of each run.
pub(crate) struct RunSpread {
    /// Rolling and skid resistance of every run, at one standard deviation of some amplitude.
    pub(crate) columns: Vec<Vec<f64>>,
    /// The likeliest standard deviation, as a share of resistance.
    pub(crate) share: f64,
    /// Factors of the columns at every standard deviation, the likeliest first, with their log priors.
    pub(crate) factors: Vec<(f64, f64)>,
}

impl RunSpread {
    fn new(units: Vec<Vec<f64>>, share: f64) -> Self {
        let amplitude = share.max(RUN_VARIATIONS[1]);
        let priors: [f64; RUN_VARIATIONS.len()] = width::halving_log_priors();
        let mut factors: Vec<(f64, f64)> =
            RUN_VARIATIONS.iter().zip(priors).map(|(one, log)| (one / amplitude, log)).collect();
        let likeliest = RUN_VARIATIONS.iter().position(|one| *one == share).unwrap_or(0);
        factors.swap(0, likeliest);
        let scaled = |column: Vec<f64>| column.into_iter().map(|by| amplitude * by).collect();
        RunSpread { columns: units.into_iter().map(scaled).collect(), share, factors }
    }
}

impl Healthy<'_> {
    /// The likeliest amplitudes of the discrepancy beside columns that are there anyway: those of motion beside the likeliest of power.
    pub(crate) fn model_error(&self, common: &[Vec<f64>]) -> Shares {
        let only =
            |power: f64, motion: f64| self.baseline.discrepancy(self.observed, Shares { power, motion });
        let fixed = [&self.baseline.sensitivities[..], common].concat();
        let power = self.likeliest(&AMPLITUDES, &fixed, &only(1.0, 0.0));
        let beside = [&fixed[..], &only(power, 0.0)].concat();
        Shares { power, motion: self.likeliest(&AMPLITUDES, &beside, &only(0.0, 1.0)) }
    }

    /// Ground from run to run, with its likeliest standard deviation by these rows; none where runs are few.
    pub(crate) fn run_spread(&self, common: &[Vec<f64>]) -> Option<RunSpread> {
        let units = run_columns(self.observed, &self.baseline.components(self.observed));
        if units.is_empty() {
            return None;
        }
        let discrepancy = self.baseline.discrepancy(self.observed, Shares::of_power(RUN_MODEL_ERROR));
        let fixed = [&self.baseline.sensitivities[..], &discrepancy, common].concat();
        let share = self.likeliest(&RUN_VARIATIONS, &fixed, &units);
        Some(RunSpread::new(units, share))
    }

    /// The amplitude of some columns with the highest log evidence, beside fixed ones.
    fn likeliest(&self, grid: &[f64], fixed: &[Vec<f64>], scaled: &[Vec<f64>]) -> f64 {
        let tempered = self.whitening.scaled(|_| 1.0 / UNTOLD.sqrt());
        let white = |column: &Vec<f64>| tempered.apply(column)[self.rows.clone()].to_vec();
        let (rows, count) = (self.rows.len(), fixed.len() + scaled.len());
        let columns = transposed(rows, count, fixed.iter().chain(scaled).map(white));
        let residual = DVector::from_vec(white(&self.baseline.residual));
        let moments = Moments::new(&columns, &residual, rows as f64 / UNTOLD);
        let log = |amplitude: &f64| {
            let factor = |i: usize| if i < fixed.len() { 1.0 } else { *amplitude };
            moments.log_evidence(&DVector::from_fn(count, |i, _| factor(i)))
        };
        let logs: Vec<f64> = grid.par_iter().map(log).collect();
        let best = (0..logs.len()).max_by(|a, b| logs[*a].total_cmp(&logs[*b]));
        best.map_or(grid[0], |best| grid[best])
    }
}
