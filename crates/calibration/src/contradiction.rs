//! Fitted numbers that contradict what the robot's file said of them, or that end at a limit.

use crate::fit::Fit;

/// Prior standard deviations from which a value contradicts its file: by chance one in 370.
const FAR_SIGMAS: f64 = 3.0;
/// Share of the range between its limits within which a value is at one of them.
const AT_LIMIT: f64 = 1e-3;

/// Sentences about numbers that a person has to look at.
pub(crate) fn contradictions(fit: &Fit) -> Vec<String> {
    (0..fit.values.len()).filter(|i| !fit.parameters[*i].held).filter_map(|i| contradiction(fit, i)).collect()
}

fn contradiction(fit: &Fit, i: usize) -> Option<String> {
    let (parameter, value) = (&fit.parameters[i], fit.values[i]);
    let [low, high] = parameter.bounds;
    let name = &parameter.name;
    // Nothing is the natural end of what cannot be negative, Coulomb's law that of a slip angle's scale, and all that braking gives that of
    // what is recovered of it.
    let is_natural = |limit: f64| {
        limit == 0.0
            || (limit == low && name.ends_with("slip_angle_scale_rad"))
            || (limit == high && name.ends_with("regeneration"))
    };
    let limit = [low, high]
        .into_iter()
        .find(|limit| !is_natural(*limit) && (value - limit).abs() < AT_LIMIT * (high - low));
    if let Some(limit) = limit {
        let beside = match parameter.prior {
            Some([mean, _]) if mean > 0.0 => format!(", {:.1} times what the robot's file has", limit / mean),
            _ => String::new(),
        };
        return Some(format!(
            "`{name}` ends at its limit of {}{beside}: the drives ask for more than a robot of this file can have, and its interval does not hold \
             the truth; correct the file",
            with_unit(limit, parameter.unit)
        ));
    }
    far(name, parameter.unit, value, parameter.prior?)
}

/// A sentence about a value that lies far from what the robot's file says, as mean and sigma.
pub(crate) fn far(name: &str, unit: &str, value: f64, [mean, sigma]: [f64; 2]) -> Option<String> {
    let far = (value - mean) / sigma;
    (far.abs() > FAR_SIGMAS).then(|| {
        // A prior as wide as the distance would have it at one standard deviation.
        let widened = if mean > 0.0 { format!(" to {:.2}", (value - mean).abs() / mean) } else { String::new() };
        format!(
            "`{name}` is {}, {far:+.1} prior standard deviations from the {} of the robot's file: one of them is wrong, and the intervals of all \
             lean on both; correct the file, or widen its `uncertainty`{widened} and calibrate again",
            with_unit(value, unit),
            with_unit(mean, unit)
        )
    })
}

fn with_unit(x: f64, unit: &str) -> String {
    if unit == "1" { digits(x) } else { format!("{} {unit}", digits(x)) }
}

/// A number with four digits that count.
fn digits(x: f64) -> String {
    let places = (3.0 - x.abs().max(1e-12).log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{x:.places$}")
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::fit::{NORMAL_975, Parameter};

    fn said(value: f64, prior: [f64; 2], bounds: [f64; 2]) -> Vec<String> {
        said_of("motors.left.k2", value, prior, bounds)
    }

    fn said_of(name: &str, value: f64, prior: [f64; 2], bounds: [f64; 2]) -> Vec<String> {
        let parameter = Parameter {
            name: name.into(),
            unit: "1",
            start: prior[0],
            bounds,
            prior: Some(prior),
            held: false,
        };
        contradictions(&Fit {
            parameters: vec![parameter],
            values: vec![value],
            covariance: DMatrix::zeros(1, 1),
            student: vec![NORMAL_975],
            cost: 0.0,
        })
    }

    #[test]
    fn all_that_braking_gives_can_be_recovered() {
        assert_eq!(said_of("motors.regeneration", 1.0, [0.5, 0.5], [0.0, 1.0]), Vec::<String>::new());
    }

    #[test]
    fn a_value_far_from_its_file_or_at_a_limit_is_said_with_what_to_do() {
        assert_eq!(said(1.5, [1.4, 0.1], [0.3, 7.0]), Vec::<String>::new());
        let far = said(1.9, [1.4, 0.1], [0.3, 7.0]).remove(0);
        assert!(
            far.contains("+5.0 prior standard deviations") && far.contains("widen its `uncertainty` to 0.36"),
            "{far}"
        );
        let limit = said(6.9999, [1.4, 0.5], [0.3, 7.0]).remove(0);
        assert!(limit.contains("ends at its limit of 7.000, 5.0 times what the robot's file has"), "{limit}");
    }
}
