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
        let (mut columns, mut before) = always(series, base);
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
        let folded = Folded::new(&whitened, &white.of(&errors_w), &fold, &series.averages);
        let explained =
            [folded.fitted(&columns, &known, &before), folded.held_out(&columns, &known, &before)];
        let [errors_w, held_out_w] = explained.map(|explained_w| differences(&errors_w, &explained_w));
        Ok(Refitted { errors_w, held_out_w })
    }
}

/// What is fitted whatever is missing, about a baseline, and what is known of its shares before.
fn always(series: &Series, base: &Baseline) -> (Vec<Vec<f64>>, Vec<f64>) {
    let mut before: Vec<f64> = base.moved.iter().map(|moved| -moved).collect();
    let shared = base.shared(series);
    before.extend(vec![0.0; shared.len()]);
    ([base.sensitivities.columns.clone(), shared].concat(), before)
}

/// Errors held out of a robot with nothing missing that is fitted to healthy drives alone: what a great error of the others pulls off is
/// none of theirs [W].
pub(crate) fn of_healthy_alone_w(series: &Series, base: &Baseline) -> Vec<f64> {
    let (columns, before) = always(series, base);
    let known = vec![1.0; columns.len()];
    let errors_w = differences(&series.recorded, &base.predicted_w);
    let white = base.whitening(series);
    let of_healthy = |values: &Vec<f64>| -> Vec<f64> {
        let all = white.of(values).into_iter().zip(&series.averages);
        all.map(|(value, average)| if average.suspect { 0.0 } else { value }).collect()
    };
    let told: Vec<Vec<f64>> = columns.iter().map(of_healthy).collect();
    let fold = tenths(series);
    let explained_w = Folded::new(&told, &of_healthy(&errors_w), &fold, &series.averages)
        .held_out(&columns, &known, &before);
    differences(&errors_w, &explained_w)
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

#[cfg(test)]
mod tests {
    use recording::{Channel, Recording};

    use super::*;
    use crate::{hills::drive, missed::usual_w};

    /// With so much more on the left side for ten seconds of every two minutes.
    fn with_spikes(mut drives: Recording, more_w: f64) -> Recording {
        let left_w = drives.channels.get_mut(&Channel::LeftPower).unwrap();
        left_w.iter_mut().enumerate().filter(|(i, _)| i % 1200 < 100).for_each(|(_, w)| *w += more_w);
        drives
    }

    #[test]
    fn what_great_errors_of_suspect_drives_pull_off_is_no_error_of_healthy_ones() {
        let robot = model::builtin::husky_a200();
        let [suspect, healthy] = [0.0, 1.0].map(|phase_rad| drive(&robot, phase_rad, &[]));
        let usual = |more_w: f64| {
            let suspect = with_spikes(suspect.clone(), more_w);
            let series = Series::new(&robot, &suspect, Some(&healthy)).unwrap();
            let base = Baseline::fit(&series, &robot, &[]).unwrap();
            let together = Refitted::new(&series, &base, &[], &[]).unwrap();
            let usual = [together.held_out_w, of_healthy_alone_w(&series, &base)];
            usual.map(|errors_w| usual_w(&series, &base, &errors_w))
        };
        let [[_, alone], [together_of_spikes, alone_of_spikes]] = [0.0, 2000.0].map(usual);
        assert!((alone_of_spikes - alone).abs() < 0.3, "{alone} W, and beside spikes {alone_of_spikes} W");
        assert!(together_of_spikes > 3.0 * alone.max(0.3), "{together_of_spikes} W");
    }
}
