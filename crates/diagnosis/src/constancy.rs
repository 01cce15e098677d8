//! Whether what was found has one size all through the drives, as a mechanism has; what merely stands in for something else has not.

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::{
    Error,
    null::Null,
    search::State,
    series::{Average, Series},
    weigh::system_with,
};

/// Time over which it fades that a robot stood still [s].
pub(crate) const MOVING_S: f64 = 3.0;

/// A quantity by average.
type Quantity = fn(&Average) -> f64;

/// What the size of something else may go with.
const WITH: [(&str, Quantity); 17] = [
    ("time", |a| a.t_s),
    ("speed", |a| a.input.speed_mps.abs()),
    ("how tight it turns", |a| a.input.difference_mps.abs()),
    ("the slope", |a| a.input.pitch_rad),
    ("how steep it is", |a| a.input.pitch_rad.abs()),
    ("how fast speed changes", |a| a.input.accel_mps2.abs()),
    ("how far it leans to the side", |a| a.input.roll_rad),
    ("how far it leans to either side", |a| a.input.roll_rad.abs()),
    ("how far its wheels have turned", |a| a.input.nearness),
    ("how long ago it stood still", |a| (-a.input.moving_s / MOVING_S).exp()),
    ("height", |a| known(a.input.height_m)),
    ("how far east it is", |a| known(a.input.position_m[0])),
    ("how far north it is", |a| known(a.input.position_m[1])),
    (HEADING, |a| known(a.input.heading_rad.cos())),
    (HEADING, |a| known(a.input.heading_rad.sin())),
    (HEADING, |a| known((2.0 * a.input.heading_rad).cos())),
    (HEADING, |a| known((2.0 * a.input.heading_rad).sin())),
];

const HEADING: &str = "where it heads";

/// What was not recorded goes with nothing.
fn known(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

/// Change of size with one standard deviation of a quantity, as a share of it, from which it is another thing. What the model makes of
/// ice, the same all through, changes by 0.3 on real ground.
const LEAST_CHANGE: f64 = 0.35;
/// Chance, over all quantities, of as clear a change where there is none.
const LEVEL: f64 = 1e-4;
/// Standard deviations beyond which a quantity counts as so many: rare extremes would rule.
const MOST_SIGMAS: f64 = 3.0;

/// What the size of one of several mechanisms goes with most clearly.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn doubt(
    series: &Series,
    state: &State,
    which: usize,
    null: &Null,
) -> Result<Option<String>, Error> {
    let (fit, applied) = (&state.fit, state.applied());
    // Heat comes and goes, and a delay does all that it does where power changes.
    if let "motor_heating" | "clock_offset" = applied[which].mechanism.name() {
        return Ok(None);
    }
    let mut others = applied.clone();
    others.remove(which);
    let without_w = series.predict(&fit.robot, &others)?;
    let effect: Vec<f64> =
        fit.predicted_w.iter().zip(&without_w).map(|(with, without)| with - without).collect();
    let white = fit.whitening(series);
    let system = system_with(series, fit, std::slice::from_ref(&effect));
    let blocks = system.blocks();
    let Ok(chance) = FisherSnedecor::new(1.0, (blocks as f64 - 2.0).max(2.0)) else { return Ok(None) };
    // Wind blows from somewhere.
    let is_asked = |with: &&str| applied[which].mechanism.name() != "wind" || **with != *HEADING;
    let judged = WITH.iter().filter(|(with, _)| is_asked(with)).filter_map(|(with, of)| {
        let column = changing(series, &effect, *of)?;
        let evidence = system.weigh(&[white.of(&column)])?;
        let p_value = chance.sf(evidence.wald / null.common_discount(blocks)) * WITH.len() as f64;
        (p_value < LEVEL && evidence.values[0].abs() > LEAST_CHANGE).then_some((p_value, *with))
    });
    let clearest = judged.min_by(|a, b| a.0.total_cmp(&b.0));
    Ok(clearest.map(|(_, with)| format!("its size goes with {with}")))
}

/// An effect times how many standard deviations a quantity is from its mean, both by the effect's square; `None` where it stays.
fn changing(series: &Series, effect: &[f64], of: Quantity) -> Option<Vec<f64>> {
    let values: Vec<f64> = series.averages.iter().map(of).collect();
    let whole: f64 = effect.iter().map(|w| w * w).sum();
    let mean = |value: &dyn Fn(f64) -> f64| {
        effect.iter().zip(&values).map(|(w, x)| w * w * value(*x)).sum::<f64>() / whole.max(1e-300)
    };
    let middle = mean(&|x| x);
    let spread = mean(&|x| (x - middle).powi(2)).sqrt();
    let sigmas = |x: f64| ((x - middle) / spread).clamp(-MOST_SIGMAS, MOST_SIGMAS);
    (spread > 1e-6).then(|| effect.iter().zip(&values).map(|(w, x)| w * sigmas(*x)).collect())
}
