//! Explanations: sets of mechanisms, with or without something unlisted, and their posterior probabilities.

use std::sync::Arc;

use crate::{
    evidence::reduced::log_sum,
    fit::joint::Fitted,
    observe::observations::{GROUND_SPEED, Observations, REST, YAW_RATE},
};

/// Prior probability of each mechanism, and of something outside the list: of drives that somebody has diagnosed about half lack nothing
/// and a third lack one of twenty mechanisms. In a trial of 128 effects and 30 healthy drives 0.1 did as well.
const MECHANISM_PRIOR: f64 = 0.03;
const UNLISTED_PRIOR: f64 = 0.03;
/// By how much an added mechanism has to change the fitted prediction for its gain to count in full, and below what it is discounted, as
/// shares of what the model misses anyway: two mechanisms that cancel are form error. Two and one and a half per cent of power for a model
/// that misses three.
const COUNTED_CHANGE: f64 = 2.0 / 3.0;
const NOTED_CHANGE: f64 = 0.5;
/// Least probability of all explanations of a credible set together, as that of every interval here.
const CREDIBLE: f64 = 0.95;

/// A set of mechanisms.
#[derive(Clone)]
pub(crate) struct Explanation {
    /// Mechanisms, sorted.
    pub(crate) names: Vec<&'static str>,
    /// Whether something unlisted acts too.
    pub(crate) unlisted: bool,
    /// Log posterior, without the constant that is the same for all.
    pub(crate) log: f64,
    /// The fit of its mechanisms, none where there are none.
    pub(crate) fitted: Option<Arc<Fitted>>,
    /// Unlisted: block and amplitude that are likeliest.
    pub(crate) block: Option<(usize, f64)>,
    /// Posterior probability.
    pub(crate) probability: f64,
}

/// ln of the prior odds of a set.
pub(crate) fn log_prior(mechanisms: usize, unlisted: bool) -> f64 {
    let odds = |prior: f64| (prior / (1.0 - prior)).ln();
    mechanisms as f64 * odds(MECHANISM_PRIOR) + if unlisted { odds(UNLISTED_PRIOR) } else { 0.0 }
}

/// Share of the root mean square of power by which two fitted predictions differ; where an effect shows in motion, the share of that.
pub(crate) fn change_share(
    observed: &Observations<'_>,
    predicted: &[f64],
    change: &[f64],
    other: &[f64],
) -> f64 {
    let share = |is_own: &dyn Fn(usize) -> bool| {
        let (mut changed, mut whole) = (0.0, 0.0);
        for i in (0..observed.test_rows).filter(|i| is_own(*i)) {
            changed += (change[i] - other[i]).powi(2);
            whole += predicted[i].powi(2);
        }
        if whole > 0.0 { (changed / whole).sqrt() } else { 0.0 }
    };
    let of_channel = |channel: usize| share(&|i| observed.averages()[i].channel == channel);
    let rest = {
        // What the battery gives beyond both sides is a share of what both take.
        let power = observed.power_rms(predicted).max(1e-9);
        let rows: Vec<usize> =
            (0..observed.test_rows).filter(|i| observed.averages()[*i].channel == REST).collect();
        let sum: f64 = rows.iter().map(|i| (change[*i] - other[*i]).powi(2)).sum();
        (sum / rows.len().max(1) as f64).sqrt() / power / 2.0
    };
    let motion = of_channel(GROUND_SPEED).max(of_channel(YAW_RATE));
    share(&|i| observed.is_power(i)).max(rest).max(motion)
}

/// How much of a gain in log evidence counts for a mechanism that changes the fitted prediction by a share, of a model that misses another.
pub(crate) fn counted(gain: f64, share: f64, missed: f64) -> f64 {
    let share = share / missed;
    let scale = (share / COUNTED_CHANGE).min(1.0).powi(2);
    let scale = if share < NOTED_CHANGE { scale * (share / NOTED_CHANGE) } else { scale };
    if gain > 0.0 { gain * scale } else { gain }
}

/// Normalises probabilities, likeliest first.
pub(crate) fn normalise(explanations: &mut [Explanation]) {
    let total = log_sum(explanations.iter().map(|one| one.log));
    explanations.iter_mut().for_each(|one| one.probability = (one.log - total).exp());
    explanations.sort_by(|a, b| b.probability.total_cmp(&a.probability));
}

/// Explanations of one search, each with the better of its evidences there and in another by the same noise; then those of the other alone, of
/// which no fit is told.
pub(crate) fn merge(own: &mut Vec<Explanation>, other: Vec<Explanation>) {
    for one in other {
        let is_same = |own: &&mut Explanation| own.names == one.names && own.unlisted == one.unlisted;
        match own.iter_mut().find(is_same) {
            Some(own) => own.log = own.log.max(one.log),
            None => own.push(Explanation { fitted: None, block: None, ..one }),
        }
    }
    normalise(own);
}

/// The likeliest explanations that hold the posterior together.
pub(crate) fn credible(explanations: &[Explanation]) -> &[Explanation] {
    let mut total = 0.0;
    let end = explanations.iter().position(|one| {
        total += one.probability;
        total >= CREDIBLE
    });
    &explanations[..end.map_or(explanations.len(), |last| last + 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn explanation(log: f64) -> Explanation {
        Explanation { names: vec![], unlisted: false, log, fitted: None, block: None, probability: 0.0 }
    }

    #[test]
    fn of_two_searches_the_better_evidence_counts_and_nothing_is_lost() {
        let named = |log: f64| Explanation { names: vec!["payload"], ..explanation(log) };
        let mut own = vec![named(10.0), explanation(2.0)];
        let unlisted = Explanation { unlisted: true, ..explanation(1.0) };
        merge(&mut own, vec![explanation(9.0), unlisted, named(3.0)]);
        let logs: Vec<f64> = own.iter().map(|one| one.log).collect();
        assert_eq!(logs, [10.0, 9.0, 1.0], "nothing missing is judged where the model is near it");
        assert!((own.iter().map(|one| one.probability).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!((own[0].probability / own[1].probability - 1.0_f64.exp()).abs() < 1e-9);
    }

    #[test]
    fn probabilities_sum_to_one_and_the_credible_set_holds_95_per_cent() {
        let mut all: Vec<Explanation> = [0.0, 3.0, -2.0, 1.0].map(explanation).into();
        normalise(&mut all);
        assert!((all.iter().map(|one| one.probability).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(all.windows(2).all(|pair| pair[0].probability >= pair[1].probability));
        let held: f64 = credible(&all).iter().map(|one| one.probability).sum();
        assert!(held >= 0.95 && credible(&all).len() == 2, "{held}");
    }

    #[test]
    fn a_gain_counts_by_what_it_changes() {
        assert_eq!(counted(10.0, 0.03, 0.03), 10.0);
        assert!((counted(10.0, 0.016, 0.03) - 6.4).abs() < 1e-9);
        assert!(counted(10.0, 0.005, 0.03) < 0.3);
        assert_eq!(counted(10.0, 0.005, 0.006), 10.0, "what a good model cannot miss counts");
        assert_eq!(counted(-4.0, 0.001, 0.03), -4.0, "what explains nothing is not made likelier");
    }
}
