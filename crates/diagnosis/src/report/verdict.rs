//! The verdict, read off the posterior.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::{
    report::diagnosis::{Probability, Verdict},
    search::explanation::{Explanation, credible},
};

/// Least probability of nothing at which drives are consistent: a fault is told at odds of 99 to 1.
const LEAST_OF_NOTHING: f64 = 0.01;
/// Held-out error over the noise up to which a model describes the drives: squares a third above those of noise.
const MOST_ERROR: f64 = 1.15;
/// Probability of the unlisted class beyond which it is the answer: likelier than all else together.
const MOSTLY_UNLISTED: f64 = 0.5;
/// Probability that one set of names has to hold: at most one answer in ten is another's.
const SURE: f64 = 0.9;
/// Most explanations that are an answer: more are no help to who looks at the robot.
const MOST_EXPLANATIONS: usize = 3;
/// Chance of parameters as far from the file where its stated uncertainty is right; that of [`LEAST_OF_NOTHING`].
const BEYOND_UNCERTAINTY: f64 = 0.01;

/// What a verdict needs besides the posterior.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Circumstances {
    /// Held-out error with nothing found, over the noise; see [`crate::fit::held_out::HeldOut::over_noise`].
    pub(crate) held_out_ratio: f64,
    /// Whether the robot's parameters left what its file states, which only counts without healthy drives.
    pub(crate) file_is_off: bool,
    /// Whether a mechanism of the likeliest explanation has no size of which zero is out of the question.
    pub(crate) size_is_untold: bool,
}

/// Probabilities of nothing, of listed mechanisms alone, and of anything unlisted.
pub(crate) fn probability(explanations: &[Explanation]) -> Probability {
    let sum = |is_own: &dyn Fn(&Explanation) -> bool| -> f64 {
        explanations.iter().filter(|one| is_own(one)).map(|one| one.probability).sum()
    };
    Probability {
        nothing: sum(&|one| one.names.is_empty() && !one.unlisted),
        listed: sum(&|one| !one.names.is_empty() && !one.unlisted),
        unlisted: sum(&|one| one.unlisted),
    }
}

/// The verdict, its rules tested in the contract's order.
pub(crate) fn verdict(explanations: &[Explanation], circumstances: Circumstances) -> Verdict {
    let probability = probability(explanations);
    let credible = credible(explanations);
    let describes = circumstances.held_out_ratio <= MOST_ERROR && !circumstances.file_is_off;
    if probability.nothing >= LEAST_OF_NOTHING && describes {
        return Verdict::Consistent;
    }
    if probability.unlisted > MOSTLY_UNLISTED || credible.len() > MOST_EXPLANATIONS {
        return Verdict::Unexplained;
    }
    let Some(first) = explanations.first().filter(|first| !first.names.is_empty()) else {
        return Verdict::Unexplained;
    };
    let of_first: f64 = explanations
        .iter()
        .filter(|one| one.names == first.names && !one.unlisted)
        .map(|one| one.probability)
        .sum();
    if of_first >= SURE && !circumstances.size_is_untold { Verdict::Explained } else { Verdict::Ambiguous }
}

/// Whether names are given: not where nothing is missing, nor where that is itself among the credible explanations, nor where it is as
/// plausible as in consistent drives and no answer is sure.
pub(crate) fn is_named(verdict: Verdict, explanations: &[Explanation]) -> bool {
    let is_nothing = |one: &Explanation| one.names.is_empty() && !one.unlisted;
    match verdict {
        Verdict::Consistent => false,
        Verdict::Explained => true,
        Verdict::Ambiguous => !credible(explanations).iter().any(is_nothing),
        Verdict::Unexplained => probability(explanations).nothing < LEAST_OF_NOTHING,
    }
}

/// Whether parameters lie farther from the file than its stated uncertainty lets them; as independent numbers of standard deviation one.
pub(crate) fn is_beyond_uncertainty(u: &[f64]) -> bool {
    let count = u.len() as f64;
    let sum: f64 = u.iter().map(|u| u * u).sum();
    ChiSquared::new(count).is_ok_and(|law| sum > law.inverse_cdf(1.0 - BEYOND_UNCERTAINTY))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FITS: Circumstances =
        Circumstances { held_out_ratio: 1.05, file_is_off: false, size_is_untold: false };

    fn explanations(parts: &[(&[&'static str], bool, f64)]) -> Vec<Explanation> {
        let explanation = |(names, unlisted, probability): &(&[&'static str], bool, f64)| Explanation {
            names: names.to_vec(),
            unlisted: *unlisted,
            log: probability.ln(),
            fitted: None,
            block: None,
            probability: *probability,
        };
        parts.iter().map(explanation).collect()
    }

    fn of(parts: &[(&[&'static str], bool, f64)], circumstances: Circumstances) -> Verdict {
        verdict(&explanations(parts), circumstances)
    }

    #[test]
    fn a_robot_is_not_accused_where_nothing_missing_is_among_the_credible_explanations() {
        let (payload, drag): (&[&str], &[&str]) = (&["payload"], &["drivetrain_drag"]);
        let poor = Circumstances { held_out_ratio: 1.3, ..FITS };
        let doubtful: &[(&[&'static str], bool, f64)] = &[(payload, false, 0.6), (&[], false, 0.4)];
        let named: &[(&[&'static str], bool, f64)] =
            &[(payload, false, 0.57), (drag, false, 0.4), (&[], false, 0.03)];
        for (parts, expected) in [(doubtful, false), (named, true)] {
            assert_eq!(of(parts, poor), Verdict::Ambiguous);
            assert_eq!(is_named(Verdict::Ambiguous, &explanations(parts)), expected);
        }
    }

    #[test]
    fn rules_are_tested_in_the_contracts_order() {
        let payload: &[&str] = &["payload"];
        let drag: &[&str] = &["drivetrain_drag"];
        assert_eq!(of(&[(payload, false, 0.98), (&[], false, 0.02)], FITS), Verdict::Consistent);
        assert_eq!(of(&[(payload, false, 0.995), (&[], false, 0.005)], FITS), Verdict::Explained);
        let untold = Circumstances { size_is_untold: true, ..FITS };
        assert_eq!(of(&[(payload, false, 0.995), (&[], false, 0.005)], untold), Verdict::Ambiguous);
        assert_eq!(of(&[(payload, false, 0.6), (drag, false, 0.4)], FITS), Verdict::Ambiguous);
        assert_eq!(of(&[(payload, true, 0.6), (drag, false, 0.4)], FITS), Verdict::Unexplained);
        let four: Vec<(&[&str], bool, f64)> = [&["payload"], &["wind"], &["inertia"], &["soft_soil"]]
            .map(|names| (&names[..], false, 0.25))
            .into();
        assert_eq!(of(&four, FITS), Verdict::Unexplained);
    }

    #[test]
    fn a_file_that_is_off_or_an_error_far_above_the_noise_is_never_consistent() {
        let nothing: &[(&[&'static str], bool, f64)] = &[(&[], false, 1.0)];
        assert_eq!(of(nothing, FITS), Verdict::Consistent);
        assert_eq!(of(nothing, Circumstances { held_out_ratio: 1.3, ..FITS }), Verdict::Unexplained);
        assert_eq!(of(nothing, Circumstances { file_is_off: true, ..FITS }), Verdict::Unexplained);
    }

    #[test]
    fn parameters_are_beyond_uncertainty_where_their_squares_are() {
        assert!(!is_beyond_uncertainty(&[1.0, -1.5, 0.5, 2.0]));
        assert!(is_beyond_uncertainty(&[1.0, -1.5, 0.5, 4.0]));
    }
}
