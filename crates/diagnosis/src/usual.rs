//! What mechanisms' values usually are, where that is known before any drive.

use model::Robot;
use nalgebra::{DMatrix, DVector};

use crate::series::Applied;

/// Values below this share of what is usual count as so much.
const LEAST: f64 = 0.05;

/// One value by what it usually is.
struct Known {
    /// How far it is off [sigma].
    off: f64,
    /// One sigma, in its own unit.
    sigma: f64,
}

impl Known {
    fn of(applied: &Applied, robot: &Robot, parameter: usize) -> Option<Known> {
        let [usual, factor] = applied.mechanism.usual(robot, parameter)?;
        let value = applied.values[parameter].max(LEAST * usual);
        Some(Known { off: (value / usual).ln() / factor.ln(), sigma: value * factor.ln() })
    }
}

/// What it costs that values are not what they usually are [sigma squared].
pub(crate) fn cost(applied: &[Applied], robot: &Robot) -> f64 {
    let of = |one: &Applied| -> f64 {
        let known = (0..one.values.len()).filter_map(|parameter| Known::of(one, robot, parameter));
        known.map(|known| known.off.powi(2)).sum()
    };
    applied.iter().map(of).sum()
}

/// A step of values that are free, one mechanism after the other, and their covariance, as drives tell them; with what is usual it is this.
pub(crate) fn informed(
    (step, covariance): (Vec<f64>, DMatrix<f64>),
    applied: &[Applied],
    free: &[Vec<usize>],
    robot: &Robot,
) -> (Vec<f64>, DMatrix<f64>) {
    let (mut step, mut covariance) = (DVector::from_vec(step), covariance);
    let values = applied.iter().zip(free).flat_map(|(one, free)| free.iter().map(move |i| (one, *i)));
    for (j, (one, parameter)) in values.enumerate() {
        let Some(known) = Known::of(one, robot, parameter) else { continue };
        let with = covariance.column(j) / (covariance[(j, j)] + known.sigma.powi(2));
        step += &with * (-known.off * known.sigma - step[j]);
        covariance -= &with * covariance.row(j).into_owned();
    }
    (step.iter().copied().collect(), covariance)
}

#[cfg(test)]
mod tests {
    use model::{builtin, mechanism};

    use super::*;
    use crate::span::Span;

    fn wind(drag_area_m2: f64) -> Applied {
        let mechanism = mechanism::by_name("wind").unwrap();
        Applied { mechanism, values: vec![drag_area_m2, 3.0, 0.0], span: Span::ALL }
    }

    #[test]
    fn an_area_off_by_the_usual_factor_costs_one_either_way() {
        let robot = builtin::husky_a200();
        let [usual_m2, factor] = wind(0.0).mechanism.usual(&robot, 0).unwrap();
        for (area_m2, expected) in [(usual_m2, 0.0), (usual_m2 * factor, 1.0), (usual_m2 / factor, 1.0)] {
            let found = cost(&[wind(area_m2)], &robot);
            assert!((found - expected).abs() < 1e-12, "{area_m2} m²: {found}");
        }
    }

    #[test]
    fn what_drives_leave_open_is_what_is_usual_and_what_they_tell_stays() {
        let robot = builtin::husky_a200();
        let [usual_m2, factor] = wind(0.0).mechanism.usual(&robot, 0).unwrap();
        let informed = |sigma_m2: f64| {
            let covariance = DMatrix::from_element(1, 1, sigma_m2 * sigma_m2);
            let (step, covariance) = informed((vec![0.1], covariance), &[wind(usual_m2)], &[vec![0]], &robot);
            (step[0], covariance[(0, 0)].sqrt())
        };
        let (step_m2, sigma_m2) = informed(1e-3);
        assert!((step_m2 - 0.1).abs() < 1e-4 && (sigma_m2 - 1e-3).abs() < 1e-4, "{step_m2} m² ± {sigma_m2}");
        let (step_m2, sigma_m2) = informed(1e3);
        assert!(
            step_m2.abs() < 1e-4 && (sigma_m2 - usual_m2 * factor.ln()).abs() < 1e-4,
            "{step_m2} ± {sigma_m2}"
        );
    }
}
