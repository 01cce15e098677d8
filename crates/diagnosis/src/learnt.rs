//! What models miss and how far averages scatter beside it, each learnt with the other.
//!
//! Where noise holds what models miss as well, whatever lasts or goes with turning passes for noise: of a payload of 1.2 % of power an
//! ideal detector sees 39 standard errors, and next to such noise 6 were left of them. So where nothing else is missing, what models miss is
//! taken off before noise is measured, and is learnt anew beside that noise, in turn, as long as noise becomes less by it. What is strong
//! is looked at without that: beside so little noise, the form of a mechanism alone is something else.

use nalgebra::{DMatrix, DVector};

use crate::{
    average::Average,
    baseline::differences,
    channel,
    discrepancy::{Discrepancy, Ground, Whitened},
    noise::Noise,
    nuisance,
    series::{Look, Series},
};

/// What healthy drives tell of the model, of all drives where none is known to be healthy.
#[derive(Debug)]
pub(crate) struct Learnt {
    pub(crate) missed: Discrepancy,
    /// Noise beside it, of the fit that it was learnt from.
    noise: Noise,
}

/// A fit that leaves errors.
#[derive(Clone, Copy)]
pub(crate) struct Fit<'a> {
    pub(crate) predicted_w: &'a [f64],
    /// Change of predictions with each of the robot's numbers, per width of the file.
    pub(crate) columns: &'a [Vec<f64>],
    /// Averages that noise is measured on.
    pub(crate) trusted: &'a [bool],
}

/// Rounds at most; five or six settle it.
const MOST_ROUNDS: usize = 8;
/// Noise has settled when it changes by less than this, mean of all averages.
const SETTLED: f64 = 0.02;

impl Learnt {
    /// Learns both in turn of a fit with noise that holds all errors, or only what models miss, as drives are looked at.
    pub(crate) fn of(series: &Series, fit: Fit<'_>, noise: &Noise) -> Self {
        let mut learnt = Learnt { missed: missed(series, fit, noise), noise: noise.clone() };
        let rounds = if series.look == Look::Closer { MOST_ROUNDS } else { 0 };
        for _ in 0..rounds {
            let noise = learnt.noise_of(series, fit);
            let change = noise.change_from(&learnt.noise, (&series.averages, fit.predicted_w));
            learnt = Learnt { missed: missed(series, fit, &noise), noise };
            if change < SETTLED {
                break;
            }
        }
        learnt
    }

    /// Noise of what a fit leaves beside what models miss.
    pub(crate) fn noise_of(&self, series: &Series, fit: Fit<'_>) -> Noise {
        let Fit { predicted_w, trusted, .. } = fit;
        let mut errors = differences(&series.recorded, predicted_w);
        for (channel, mean_w) in nuisance::means(&series.averages, predicted_w).into_iter().enumerate() {
            let places = channel::places(&series.averages, channel);
            let own = |column: &Vec<f64>| places.iter().map(|i| column[*i]).collect::<Vec<f64>>();
            let mut columns = self.of_channel(&series.averages, &places, (channel, mean_w), Ground::Even);
            columns.extend(fit.columns.iter().map(own).filter(|own| own.iter().any(|x| *x != 0.0)));
            let left = self.left(series, fit, (&places, &columns), &own(&errors));
            places.iter().zip(left).for_each(|(place, error)| errors[*place] = error);
        }
        Noise::of(&errors, predicted_w, &series.averages, trusted)
    }

    /// What models may miss of a channel of such a mean size [W], over its averages, with weights of one sigma 1.
    pub(crate) fn of_channel(
        &self,
        averages: &[Average],
        places: &[usize],
        (channel, mean_w): (usize, f64),
        ground: Ground,
    ) -> Vec<Vec<f64>> {
        let mut columns = nuisance::of_channel(averages, places, mean_w);
        columns.extend(self.missed.of_channel(channel, mean_w, ground));
        columns
    }

    /// Errors of a channel's averages less what its columns take of those that are trusted, so much larger as fitting makes them smaller: n
    /// averages have n less the trace of the fit's influence of freedom.
    fn left(
        &self,
        series: &Series,
        Fit { predicted_w, trusted, .. }: Fit<'_>,
        (places, columns): (&[usize], &[Vec<f64>]),
        own: &[f64],
    ) -> Vec<f64> {
        let white = self.noise.whitening(predicted_w, &series.averages);
        let rows: Vec<usize> = (0..places.len()).filter(|k| trusted[places[*k]]).collect();
        let told = |column: &[f64]| {
            let whitened = white.of_channel(places, column);
            rows.iter().map(|k| whitened[*k]).collect::<Vec<f64>>()
        };
        let whitened: Vec<Vec<f64>> = columns.iter().map(|column| told(column)).collect();
        let columns_of = DMatrix::from_fn(rows.len(), columns.len(), |i, j| whitened[j][i]);
        let square = columns_of.tr_mul(&columns_of);
        let Some(root) = (&square + DMatrix::identity(columns.len(), columns.len())).cholesky() else {
            return own.to_vec();
        };
        let weights = root.solve(&columns_of.tr_mul(&DVector::from_vec(told(own))));
        let fitted = root.solve(&square).trace();
        let count = rows.len() as f64;
        let makes_up = (count / (count - fitted).max(0.5 * count).max(1.0)).sqrt();
        let left = |k: usize| own[k] - columns.iter().zip(weights.iter()).map(|(c, w)| c[k] * w).sum::<f64>();
        (0..places.len()).map(|k| makes_up * left(k)).collect()
    }
}

/// Learns what the model misses from what a fit leaves, by such noise.
fn missed(series: &Series, fit: Fit<'_>, noise: &Noise) -> Discrepancy {
    let Fit { predicted_w, columns, .. } = fit;
    let white = noise.whitening(predicted_w, &series.averages);
    let means = nuisance::means(&series.averages, predicted_w);
    let errors = white.of(&differences(&series.recorded, predicted_w));
    let nuisances = nuisance::columns(&series.averages, predicted_w);
    let columns = columns.iter().chain(&nuisances).map(|column| white.of(column)).collect();
    Discrepancy::learn(&series.averages, (&means, predicted_w), &Whitened { errors, columns, white: &white })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Question, Verdict,
        baseline::Baseline,
        diagnose,
        hills::missed_by,
        search::{Search, search},
        series::Applied,
        span::Span,
    };

    /// Mean noise of averages of power.
    fn noise_w(look: Look, size_w: f64) -> f64 {
        let robot = model::builtin::husky_a200();
        let [suspect, healthy] = [0.0, 1.0].map(|phase_rad| missed_by(size_w, phase_rad, &[]));
        let mut series = Series::new(&robot, &suspect, Some(&healthy)).unwrap();
        series.look = look;
        let base = Baseline::fit(&series, &robot, &[]).unwrap();
        let all: Vec<f64> = (0..series.averages.len())
            .filter(|i| series.is_power(*i))
            .map(|i| base.noise.sigma(&series.averages[i], base.predicted_w[i]))
            .collect();
        all.iter().sum::<f64>() / all.len() as f64
    }

    #[test]
    fn what_models_miss_is_no_noise_where_one_looks_closer_and_noise_stays_what_it_is() {
        let there_w = 2.0 / 10.0_f64.sqrt();
        let [usual, closer] = [Look::Usual, Look::Closer].map(|look| noise_w(look, 4.0) / there_w);
        assert!(usual > 1.6, "{usual}");
        assert!(closer < 1.25, "{closer}");
        let closer = noise_w(Look::Closer, 0.0) / there_w;
        assert!((closer - 1.0).abs() < 0.1, "{closer}");
    }

    #[test]
    fn a_load_of_one_per_cent_of_power_is_named_by_a_closer_look_only() {
        let robot = model::builtin::husky_a200();
        let mechanism = model::mechanism::by_name("payload").unwrap();
        let load = Applied { mechanism, values: vec![0.6], span: Span::ALL };
        let [suspect, healthy] = [missed_by(4.0, 0.0, &[load]), missed_by(4.0, 1.0, &[])];
        let series = Series::new(&robot, &suspect, Some(&healthy)).unwrap();
        let begun = Search::begin(&series, &robot, Some(&healthy), &|_, _| {}).unwrap();
        let usual = search(&series, &robot, begun, &|_, _| {}).unwrap();
        assert!(usual.found.is_empty() && usual.refused.is_empty(), "{:?}", usual.refused);
        let found = diagnose(&Question::new(&robot, &suspect, Some(&healthy)), &|_, _| {}).unwrap();
        let is_named = found.verdict != Verdict::Consistent && found.findings[0].mechanism == "payload";
        assert!(is_named && found.findings.len() == 1, "{}", found.sentence);
        assert!((found.findings[0].parameters[0].value - 0.6).abs() < 0.2, "{}", found.sentence);
    }
}
