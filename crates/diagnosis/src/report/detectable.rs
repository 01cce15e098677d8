//! Sizes that these drives would have shown.

use std::collections::BTreeMap;

use model::{Robot, knowledge::Regimes};

use crate::{hypothesis::effect::Effect, report::diagnosis::Detectable, search::explanation::log_prior};

/// Probability of nothing at which an effect is noticed: that of the verdict.
const NOTICED: f64 = 0.01;

/// Least size in prior standard deviations at which an effect of reduced square g is noticed.
fn size_noticed(g: f64) -> f64 {
    let needed = -NOTICED.ln() - log_prior(1, false);
    (2.0 * (needed + 0.5 * (1.0 + g).ln()) * (1.0 + g)).sqrt() / g.max(1e-12)
}

/// What drives cannot tell: mechanisms that would be noticed only beyond what is plausible, with what the drives lack.
pub(crate) fn untold(information: &[(Effect, f64)], here: &Regimes, robot: &Robot) -> Option<String> {
    /// Sizes beyond so many prior standard deviations are not plausible: one in twenty.
    const PLAUSIBLE: f64 = 2.0;
    /// Least range of speeds, and of the sides' difference, as shares of what the robot can do; least range of pitch \[rad\]: an inclinometer
    /// is askew by as much (2 degrees).
    const RANGE: f64 = 0.1;
    const PITCH_RAD: f64 = 0.035;
    let mut least = BTreeMap::<&str, f64>::new();
    for (effect, g) in information {
        let known = least.entry(effect.mechanism.name()).or_insert(f64::INFINITY);
        *known = known.min(size_noticed(*g));
    }
    let names: Vec<String> =
        least.iter().filter(|(_, size)| **size > PLAUSIBLE).map(|(name, _)| format!("`{name}`")).collect();
    let most_mps = robot.max_wheel_speed_mps;
    let lacks = [
        (here.speed_mps, RANGE * most_mps, "drive at one speed only"),
        (here.difference_mps, RANGE * most_mps, "hardly turn"),
        (here.pitch_rad, PITCH_RAD, "stay on level ground"),
    ];
    let lacks: Vec<&str> = lacks
        .iter()
        .filter(|([low, high], least, _)| high - low < *least)
        .map(|(.., words)| *words)
        .collect();
    (!names.is_empty()).then(|| {
        let why = if lacks.is_empty() { String::new() } else { format!(", which {},", lacks.join(" and ")) };
        format!("these drives{why} cannot tell a plausible size of: {}", names.join(", "))
    })
}

/// By mechanism, the least size at which an effect that acts all the time makes nothing improbable, or its name where none does.
///
/// Of a size x in prior standard deviations the expected log evidence is `½ x² g²/(1 + g) − ½ ln(1 + g)`, g the reduced square of its column;
/// it has to reach ln 1/(p P), p the prior odds and P the probability that is left to nothing.
pub(crate) fn detectable(
    information: &[(&Effect, f64)],
    named: &[&str],
) -> (Vec<Detectable>, Vec<&'static str>) {
    let mut best: Vec<(&Effect, f64)> = Vec::new();
    for &(effect, g) in information.iter().filter(|(effect, _)| !named.contains(&effect.mechanism.name())) {
        let size = size_noticed(g);
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
