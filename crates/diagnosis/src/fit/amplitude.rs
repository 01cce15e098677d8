//! How far the model is off of healthy drives, and ground from run to run: the likeliest of a grid of amplitudes.

use std::ops::Range;

use nalgebra::DVector;
use rayon::prelude::*;

use crate::{
    evidence::{
        linear_model::{Moments, transposed},
        noise::Whitening,
    },
    fit::{baseline::Baseline, discrepancy::run_columns, temperature::UNTOLD},
    observe::observations::Observations,
};

/// Amplitudes that healthy drives choose from, each about twice the one before, up to what a robot with borrowed constants is missed by.
const AMPLITUDES: [f64; 8] = [0.003, 0.006, 0.01, 0.02, 0.03, 0.06, 0.12, 0.25];
/// Standard deviations of ground from run to run that healthy drives choose from, as shares of resistance: none on a floor, a third on soil
/// that is wet here and dry there (BorealTC: sandy loam).
const RUN_VARIATIONS: [f64; 5] = [0.0, 0.03, 0.08, 0.18, 0.35];
/// Amplitude of the discrepancy beside which that is chosen.
const RUN_MODEL_ERROR: f64 = 0.02;

/// Rows of healthy drives, whitened and tempered as where no drives tell.
pub(crate) struct Healthy<'a> {
    pub(crate) observed: &'a Observations<'a>,
    pub(crate) baseline: &'a Baseline,
    pub(crate) whitening: &'a Whitening,
    pub(crate) rows: Range<usize>,
}

impl Healthy<'_> {
    /// The likeliest amplitude of the discrepancy beside columns that are there anyway.
    pub(crate) fn model_error(&self, common: &[Vec<f64>]) -> f64 {
        let discrepancy = self.baseline.discrepancy(self.observed, 1.0);
        let fixed = [&self.baseline.sensitivities[..], common].concat();
        self.likeliest(&AMPLITUDES, &fixed, &discrepancy)
    }

    /// The likeliest standard deviation of ground from run to run, as a share of rolling and skid resistance, with its columns.
    pub(crate) fn run_variation(&self, common: &[Vec<f64>]) -> (f64, Vec<Vec<f64>>) {
        let units = run_columns(self.observed, &self.baseline.components(self.observed));
        if units.is_empty() {
            return (0.0, units);
        }
        let discrepancy = self.baseline.discrepancy(self.observed, RUN_MODEL_ERROR);
        let fixed = [&self.baseline.sensitivities[..], &discrepancy, common].concat();
        let share = self.likeliest(&RUN_VARIATIONS, &fixed, &units);
        if share == 0.0 {
            return (0.0, Vec::new());
        }
        (share, units.iter().map(|column| column.iter().map(|by| share * by).collect()).collect())
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
