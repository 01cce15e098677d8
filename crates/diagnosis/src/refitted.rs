//! How well a robot with mechanisms describes the drives, where it was fitted and where it was not.

use crate::{
    Error,
    baseline::{Baseline, differences},
    candidates,
    discovered::Discovered,
    linear::{FOLDS, Folded},
    search::Found,
    series::{Applied, Series},
    weigh::blocks,
};

/// Errors of a robot with mechanisms, average by average.
pub(crate) struct Refitted {
    /// With all fitted to all averages [W].
    pub(crate) errors_w: Vec<f64>,
    /// With all fitted to other tenths of the drives [W].
    pub(crate) held_out_w: Vec<f64>,
}

impl Refitted {
    /// Fits the robot, what models miss of healthy drives, and the mechanisms' numbers about a baseline that has them, with the
    /// sizes of terms that were discovered.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub(crate) fn new(
        series: &Series,
        base: &Baseline,
        found: &[&Found],
        discovered: &[Discovered],
    ) -> Result<Self, Error> {
        let mut columns = base.columns.clone();
        let mut before: Vec<f64> = base.moved.iter().map(|moved| -moved).collect();
        let shared = base.shared(series);
        before.extend(vec![0.0; shared.len()]);
        columns.extend(shared);
        let mut known = vec![1.0; columns.len()];
        let applied: Vec<Applied> = found.iter().map(|f| f.applied.clone()).collect();
        for (i, one) in found.iter().enumerate() {
            let others: Vec<Applied> =
                applied.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, a)| a.clone()).collect();
            let linear = linear_of(one);
            let at = candidates::of(
                series,
                &base.robot,
                &others,
                &base.predicted_w,
                one.applied.clone(),
                linear.clone(),
            )?;
            columns.extend(at.columns);
            known.extend(vec![0.0; linear.len()]);
            before.extend(vec![0.0; linear.len()]);
        }
        columns.extend(discovered.iter().map(|one| one.column_w.clone()));
        known.extend(vec![0.0; discovered.len()]);
        before.extend(vec![0.0; discovered.len()]);
        let errors_w = differences(&series.recorded, &base.predicted_w);
        let white = base.whitening(series);
        let whitened: Vec<Vec<f64>> = columns.iter().map(|column| white.of(column)).collect();
        let fold = tenths(series);
        let folded = Folded::new(&whitened, &white.of(&errors_w), &fold);
        let explained =
            [folded.fitted(&columns, &known, &before), folded.held_out(&columns, &known, &before)];
        let [errors_w, held_out_w] = explained.map(|explained_w| differences(&errors_w, &explained_w));
        Ok(Refitted { errors_w, held_out_w })
    }
}

/// The numbers of a mechanism that were fitted, not taken from a grid.
fn linear_of(found: &Found) -> Vec<usize> {
    (0..found.half_widths.len()).filter(|i| found.half_widths[*i].is_some()).collect()
}

/// Stretches of neighbouring blocks, a tenth of the drives each.
fn tenths(series: &Series) -> Vec<usize> {
    let block = blocks(series);
    let count = block.iter().max().map_or(1, |last| last + 1);
    block.iter().map(|b| b * FOLDS / count).collect()
}

/// Root mean square of errors over the drives under suspicion [W].
pub(crate) fn rmse_w(series: &Series, errors_w: &[f64]) -> f64 {
    let (sum, count) = suspect(series, errors_w).fold((0.0, 0.0), |(sum, n), e| (sum + e * e, n + 1.0));
    (sum / f64::max(count, 1.0)).sqrt()
}

/// Their mean [W].
pub(crate) fn bias_w(series: &Series, errors_w: &[f64]) -> f64 {
    let (sum, count) = suspect(series, errors_w).fold((0.0, 0.0), |(sum, n), e| (sum + e, n + 1.0));
    sum / f64::max(count, 1.0)
}

/// Errors of power in the drives under suspicion.
fn suspect<'a>(series: &'a Series, errors_w: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    let counts = |i: &usize| series.averages[*i].suspect && series.is_power(*i);
    (0..errors_w.len()).filter(counts).map(|i| errors_w[i])
}
