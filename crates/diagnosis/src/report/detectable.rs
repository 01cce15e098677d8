//! Sizes that these drives would have shown.

use crate::{hypothesis::effect::Effect, report::diagnosis::Detectable, search::explanation::log_prior};

/// Probability of nothing at which an effect is noticed: that of the verdict.
const NOTICED: f64 = 0.01;

/// By mechanism, the least size at which an effect that acts all the time makes nothing improbable, or its name where none does.
///
/// Of a size x in prior standard deviations the expected log evidence is `½ x² g²/(1 + g) − ½ ln(1 + g)`, g the reduced square of its column;
/// it has to reach ln 1/(p P), p the prior odds and P the probability that is left to nothing.
pub(crate) fn detectable(
    information: &[(&Effect, f64)],
    named: &[&str],
) -> (Vec<Detectable>, Vec<&'static str>) {
    let needed = -NOTICED.ln() - log_prior(1, false);
    let mut best: Vec<(&Effect, f64)> = Vec::new();
    for &(effect, g) in information.iter().filter(|(effect, _)| !named.contains(&effect.mechanism.name())) {
        let size = (2.0 * (needed + 0.5 * (1.0 + g).ln()) * (1.0 + g)).sqrt() / g.max(1e-12);
        match best.iter_mut().find(|(other, _)| other.mechanism.name() == effect.mechanism.name()) {
            Some(known) if known.1 <= size => {}
            Some(known) => *known = (effect, size),
            None => best.push((effect, size)),
        }
    }
    let (mut sizes, mut none) = (Vec::new(), Vec::new());
    for (effect, size) in best {
        let Some(first) = effect.free.first() else { continue };
        let parameter = &effect.mechanism.parameters()[first.parameter];
        let value = size * first.unit.abs();
        let [low, high] = parameter.bounds;
        if value.is_finite() && value < high.max(-low) {
            let mechanism = effect.mechanism.name();
            sizes.push(Detectable { mechanism, parameter: parameter.name, value, unit: parameter.unit });
        } else {
            none.push(effect.mechanism.name());
        }
    }
    (sizes, none)
}
