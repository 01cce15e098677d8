//! What a candidate can be: no more than a robot can have, and no less than is worth a name.

use model::Robot;

use crate::{
    candidates::{self, Candidate},
    evidence::Evidence,
};

/// A delay of less than a row, but for what its estimate may be off by, is the sensors' business.
const LEAST_DELAY_ROWS: f64 = 0.8;
/// Share by which wheels turn otherwise than a robot moves, below which that is what tyres, slopes and ground make of it from drive to drive.
const LEAST_SLIP: f64 = 0.005;
/// Standard errors by which a value may lie beyond what a robot can have.
const SIGMAS: f64 = 2.0;

/// Whether a candidate may be as its evidence has it; rows are `row_s` apart.
pub(crate) fn is_plausible(robot: &Robot, candidate: &Candidate, evidence: &Evidence, row_s: f64) -> bool {
    let value = |j: usize| candidate.applied.values[candidate.linear[j]] + evidence.values[j];
    let is_possible = |j: usize| {
        let [low, high] = candidates::range(&candidate.applied, robot, candidate.linear[j]);
        let margin = SIGMAS * evidence.covariance[(j, j)].max(0.0).sqrt();
        value(j) + margin >= low && value(j) - margin <= high
    };
    let numbers = 0..candidate.linear.len();
    let most = numbers.clone().map(|j| value(j).abs()).fold(0.0, f64::max);
    numbers.clone().all(is_possible) && most >= least(candidate.applied.mechanism.name(), row_s)
}

/// The least value of a mechanism that is worth its name.
fn least(mechanism: &str, row_s: f64) -> f64 {
    match mechanism {
        "clock_offset" => LEAST_DELAY_ROWS * row_s,
        "wheel_slip" | "wheel_radius" => LEAST_SLIP,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use model::{builtin, mechanism};
    use nalgebra::DMatrix;

    use super::*;
    use crate::{series::Applied, span::Span};

    /// Whether a mechanism may have a first number, told to 1e-4, of rows a tenth of a second apart.
    fn may_be(name: &str, value: f64) -> bool {
        let mechanism = mechanism::by_name(name).unwrap();
        let applied = Applied { mechanism, values: vec![0.0; mechanism.parameters().len()], span: Span::ALL };
        let candidate = Candidate { applied, linear: vec![0], columns: Vec::new() };
        let evidence = Evidence::of_one(value, 1e-8, DMatrix::zeros(0, 1));
        is_plausible(&builtin::husky_a200(), &candidate, &evidence, 0.1)
    }

    #[test]
    fn no_more_than_a_robot_can_have_and_no_less_than_any_wheels_and_clocks_do() {
        assert!(may_be("drivetrain_drag", 20.0) && !may_be("drivetrain_drag", 301.0));
        assert!(may_be("wheel_slip", 0.006) && may_be("wheel_slip", -0.006) && !may_be("wheel_slip", 0.004));
        assert!(may_be("wheel_radius", 0.006) && !may_be("wheel_radius", -0.004));
        assert!(may_be("clock_offset", 0.09) && !may_be("clock_offset", 0.07));
    }
}
