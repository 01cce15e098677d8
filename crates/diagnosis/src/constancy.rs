//! Whether what was found has one size all through the drives and acts at once, as a mechanism does; what merely stands in for something
//! else does not.

use model::mechanism::{Kind, Mechanism};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::{
    Error,
    average::Average,
    null::Null,
    polish::FORM_SIGMA,
    search::State,
    series::Series,
    span::Span,
    weigh::{Sizes, system_at},
};

/// Time over which it fades that a robot stood still [s].
pub(crate) const MOVING_S: f64 = 3.0;
/// Time over which what driving builds up does so, such as mud on wheels [s].
pub(crate) const BUILT_UP_S: f64 = 20.0;

/// Times over which it fades that something set in, or that a drive began with it [s]: what warms up or wears in does so within some minutes,
/// if it is not strong and does so at once.
const FIRST_S: f64 = 300.0;
const JUST_S: f64 = 60.0;

/// A quantity by average.
pub(crate) type Quantity = fn(&Average) -> f64;

/// What the size of something else may go with.
const WITH: [(&str, Quantity); 21] = [
    ("time", |a| a.t_s),
    ("how long ago it set in", |a| (-a.t_s / FIRST_S).exp()),
    ("how long ago it set in", |a| (-a.t_s / JUST_S).exp()),
    ("speed", |a| a.input.speed_mps.abs()),
    ("how tight it turns", |a| a.input.difference_mps.abs()),
    ("the slope", |a| a.input.pitch_rad),
    ("how steep it is", |a| a.input.pitch_rad.abs()),
    ("how fast speed changes", |a| a.input.accel_mps2.abs()),
    ("how far it leans to the side", |a| a.input.roll_rad),
    ("how far it leans to either side", |a| a.input.roll_rad.abs()),
    ("how far its wheels have turned", |a| a.input.nearness),
    ("how long ago it stood still", |a| (-a.input.moving_s / MOVING_S).exp()),
    ("how long ago it stood still", |a| (-a.input.moving_s / BUILT_UP_S).exp()),
    ("how much it drove of late", |a| a.input.of_late_m),
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

/// Change of size with one standard deviation of a quantity, as a share of it, from which it is another thing. Of mechanisms concealed in
/// worlds with forms of their own, in trials of versions before, inertia changed by 0.25 clearly, no other by more than 0.15, and of what
/// passed for a high mass and was a load that slides, 0.34.
const LEAST_CHANGE: f64 = 0.3;
/// The same of what the ground does: what the model makes of ice, the same all through, changes by 0.3 on real ground.
const LEAST_CHANGE_OF_GROUND: f64 = 0.35;
/// Mechanisms of the ground, whose forms are the least sure.
const OF_GROUND: [&str; 2] = ["surface_change", "wheel_slip"];
/// The same of [`RESISTANCES`]: of those concealed none changed by more than 0.15, and what grease or a fan does passed for soft soil that
/// changed by 0.26 and 0.34, and for a towed load that changed by 0.23.
const LEAST_CHANGE_OF_RESISTANCE: f64 = 0.2;
/// Mechanisms that hold back whatever rolls, and stand in for other things that do.
pub(crate) const RESISTANCES: [&str; 5] =
    ["soft_soil", "speed_dependent_friction", "drivetrain_drag", "towed_load", "payload"];
/// Chance, over all quantities, of as clear a change where there is none.
const LEVEL: f64 = 1e-3;
/// How much earlier or later than the model has it a mechanism may act, by what sensors and the smoothing of attitudes may be late [s].
const LEAST_LAG_S: f64 = 0.3;
/// Standard deviations beyond which a quantity counts as so many: rare extremes would rule.
const MOST_SIGMAS: f64 = 3.0;

/// Share of such a change that is too much already of what takes the place of something that was doubted: what is missing may be neither.
const OF_A_STAND_IN: f64 = 0.6;

/// What the size of one of several mechanisms goes with most clearly; of what takes the place of another, less is enough.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn doubt(
    series: &Series,
    state: &State,
    which: usize,
    (null, stands_in): (&Null, bool),
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
    let system = system_at(series, fit, Sizes::FreeBut(which), std::slice::from_ref(&effect));
    let blocks = system.blocks();
    let Ok(chance) = FisherSnedecor::new(1.0, (blocks as f64 - 2.0).max(2.0)) else { return Ok(None) };
    // Wind blows from somewhere.
    let is_asked = |with: &&str| applied[which].mechanism.name() != "wind" || **with != *HEADING;
    let judge = |column: &[f64]| {
        let evidence = system.weigh(&[white.of(column)])?;
        let p_value = chance.sf(evidence.wald / null.common_discount(blocks)) * (WITH.len() + 1) as f64;
        (p_value < LEVEL).then(|| (p_value, evidence.values[0]))
    };
    let since: Vec<Average> = series.averages.iter().map(|a| a.since(applied[which].span)).collect();
    let least_change = least_change(applied[which].mechanism.name(), stands_in);
    let of_sizes = WITH.iter().filter(|(with, _)| is_asked(with)).filter_map(|(with, of)| {
        let (p_value, change) = judge(&changing(&since, &effect, *of)?)?;
        (change.abs() > least_change).then(|| (p_value, format!("its size goes with {with}")))
    });
    let rate = rate_per_s(&series.averages, applied[which].span, &effect);
    let size = |column: &[f64]| column.iter().map(|x| x * x).sum::<f64>().sqrt();
    // A shift that changes less of it than its form leaves open tells nothing of when it comes.
    let least_s = LEAST_LAG_S.max(FORM_SIGMA * size(&effect) / size(&rate).max(1e-300));
    let of_time = judge(&rate).and_then(|(p_value, early_s)| {
        Some((p_value, at_another_time(applied[which].mechanism, early_s, least_s)?))
    });
    let clearest = of_sizes.chain(of_time).min_by(|a, b| a.0.total_cmp(&b.0));
    Ok(clearest.map(|(_, why)| why))
}

/// Change of size from which a mechanism, or what stands in for another, is another thing.
fn least_change(mechanism: &str, stands_in: bool) -> f64 {
    let least = match mechanism {
        name if RESISTANCES.contains(&name) => LEAST_CHANGE_OF_RESISTANCE,
        name if OF_GROUND.contains(&name) => LEAST_CHANGE_OF_GROUND,
        _ => LEAST_CHANGE,
    };
    if stands_in { OF_A_STAND_IN * least } else { least }
}

/// In words, that a mechanism acts so much earlier than the model has it, where that is at least so much and tells it is another thing.
fn at_another_time(mechanism: &dyn Mechanism, early_s: f64, least_s: f64) -> Option<String> {
    // What a meter adds it adds to what it reads. Treads wind up before they hold, so that what a turn loses is lost as it begins.
    let may_be = mechanism.kind() == Kind::Measurement || mechanism.name() == "wheel_slip" && early_s > 0.0;
    let when = if early_s < 0.0 { "late" } else { "early" };
    (early_s.abs() > least_s && !may_be).then(|| format!("it comes {:.1} s too {when}", early_s.abs()))
}

/// How fast an effect changes, by the seconds before and after, which are what comes of it before it does. That it sets in or ends is no
/// change of what it does: a second more or less there is a matter of since when it acts.
fn rate_per_s(averages: &[Average], acts: Span, effect: &[f64]) -> Vec<f64> {
    let place = |a: &Average| (a.run, a.channel, a.suspect, a.is_in(acts));
    let is_beside = |a: &Average, b: &Average| place(a) == place(b);
    let rate = |i: usize| {
        let before = i.checked_sub(1).filter(|j| is_beside(&averages[*j], &averages[i])).unwrap_or(i);
        let after =
            Some(i + 1).filter(|j| averages.get(*j).is_some_and(|a| is_beside(a, &averages[i]))).unwrap_or(i);
        let lasted_s = averages[after].t_s - averages[before].t_s;
        if lasted_s > 0.0 { (effect[after] - effect[before]) / lasted_s } else { 0.0 }
    };
    (0..averages.len()).map(rate).collect()
}

/// An effect times how many standard deviations a quantity is from its mean, both by the effect's square; `None` where it stays.
pub(crate) fn changing(averages: &[Average], effect: &[f64], of: Quantity) -> Option<Vec<f64>> {
    let values: Vec<f64> = averages.iter().map(of).collect();
    let whole: f64 = effect.iter().map(|w| w * w).sum();
    let mean = |value: &dyn Fn(f64) -> f64| {
        effect.iter().zip(&values).map(|(w, x)| w * w * value(*x)).sum::<f64>() / whole.max(1e-300)
    };
    let middle = mean(&|x| x);
    let spread = mean(&|x| (x - middle).powi(2)).sqrt();
    let sigmas = |x: f64| ((x - middle) / spread).clamp(-MOST_SIGMAS, MOST_SIGMAS);
    (spread > 1e-6).then(|| effect.iter().zip(&values).map(|(w, x)| w * sigmas(*x)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::average::Input;

    #[test]
    fn what_comes_late_or_early_is_another_thing_but_for_meters_and_for_turns_lost_as_they_begin() {
        let told = |name: &str, early_s: f64| {
            let mechanism = model::mechanism::by_name(name).unwrap();
            at_another_time(mechanism, early_s, 0.3)
        };
        assert_eq!(told("soft_soil", -0.6).unwrap(), "it comes 0.6 s too late");
        assert_eq!(told("soft_soil", 0.6).unwrap(), "it comes 0.6 s too early");
        assert_eq!(told("soft_soil", 0.2), None);
        assert_eq!(told("wheel_slip", 0.6), None);
        assert!(told("wheel_slip", -0.6).is_some());
        for meter in ["power_scale", "power_offset", "wheel_radius", "pitch_bias"] {
            assert_eq!([told(meter, -0.6), told(meter, 0.6)], [None, None], "{meter}");
        }
    }

    #[test]
    fn an_effect_changes_as_fast_as_its_drive_shows_it() {
        // Two drives of 4 s, on which an effect grows by 3 W and then falls by 5 W each second.
        let average = |i: usize| Average {
            channel: 0,
            run: i / 4,
            suspect: true,
            t_s: (i % 4) as f64 + 0.5,
            input: Input::default(),
        };
        let averages: Vec<Average> = (0..8).map(average).collect();
        let effect: Vec<f64> = averages.iter().map(|a| [3.0, -5.0][a.run] * a.t_s).collect();
        for (rate, average) in rate_per_s(&averages, Span::ALL, &effect).iter().zip(&averages) {
            assert!((rate - [3.0, -5.0][average.run]).abs() < 1e-12, "{rate}");
        }
        // 12 W from the third second on do not change.
        let span = Span::EachDrive(2.0);
        let offset: Vec<f64> = averages.iter().map(|a| if a.is_in(span) { 12.0 } else { 0.0 }).collect();
        assert_eq!(rate_per_s(&averages, span, &offset), [0.0; 8]);
        assert_ne!(rate_per_s(&averages, Span::ALL, &offset), [0.0; 8]);
    }
}
