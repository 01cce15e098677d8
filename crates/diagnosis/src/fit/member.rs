//! A mechanism with sizes, in prior standard deviations of its parameters.

use model::{
    Robot,
    mechanism::{Form, Mechanism, Sign, SizePrior},
};

use crate::{Applied, Span, evidence::reduced::Half};

/// Sizes beyond so many prior standard deviations are not looked at: the prior gives them a chance of 2·10⁻⁹.
const FARTHEST: f64 = 6.0;

/// Size of one free parameter, in prior standard deviations of a direction that is always possible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Size {
    /// Which parameter.
    pub(crate) parameter: usize,
    /// Value at size 1; negative where only negative values are possible.
    pub(crate) unit: f64,
    /// Possible signs of the size.
    pub(crate) half: Half,
}

impl Size {
    /// Of a parameter that a form leaves free.
    pub(crate) fn of(form: &Form, priors: &[SizePrior], parameter: usize) -> Self {
        let SizePrior { sigma, sign } = priors[parameter];
        let sigma = form.widening * sigma;
        // A form that begins off zero keeps its sign.
        let begins = form.values[parameter];
        let (unit, half) = match sign {
            Sign::Negative => (-sigma, Half::Positive),
            Sign::Positive => (sigma, Half::Positive),
            Sign::Either if begins != 0.0 => (sigma.copysign(begins), Half::Positive),
            Sign::Either => (sigma, Half::Both),
        };
        Size { parameter, unit, half }
    }
}

/// A mechanism with sizes.
#[derive(Clone)]
pub(crate) struct Member {
    /// Which.
    pub(crate) mechanism: &'static dyn Mechanism,
    /// Values of all its parameters.
    pub(crate) values: Vec<f64>,
    /// Free parameters.
    pub(crate) free: Vec<Size>,
    /// Prior correlation of the first two.
    pub(crate) correlation: f64,
    /// When and where it acts.
    pub(crate) span: Span,
    /// Log prior of its form and window.
    pub(crate) log_prior: f64,
}

impl Member {
    /// As the forward model takes it.
    pub(crate) fn applied(&self) -> Applied {
        Applied { mechanism: self.mechanism, values: self.values.clone(), span: self.span }
    }

    /// Its free sizes, independent in their prior.
    pub(crate) fn sizes(&self) -> Vec<f64> {
        let mut sizes: Vec<f64> =
            self.free.iter().map(|size| self.values[size.parameter] / size.unit).collect();
        if let [first, second, ..] = &mut sizes[..] {
            *second = (*second - self.correlation * *first) / self.own_share();
        }
        sizes
    }

    /// Puts it at sizes, within what a robot can have.
    pub(crate) fn set(&mut self, file: &Robot, sizes: &[f64]) {
        let mut values = sizes.to_vec();
        if let [first, second, ..] = &mut values[..] {
            *second = self.correlation * *first + self.own_share() * *second;
        }
        for (size, x) in self.free.iter().zip(values) {
            let least = if size.half == Half::Positive { 0.0 } else { -FARTHEST };
            let [low, high] = self.mechanism.bounds(file, size.parameter);
            self.values[size.parameter] = (size.unit * x.clamp(least, FARTHEST)).clamp(low, high);
        }
    }

    /// Parameters that stand at the farthest size that is looked at.
    pub(crate) fn farthest(&self) -> Vec<&'static str> {
        let is_farthest =
            |size: &&Size| (self.values[size.parameter] / size.unit).abs() >= FARTHEST * (1.0 - f64::EPSILON);
        let name = |size: &Size| self.mechanism.parameters()[size.parameter].name;
        self.free.iter().filter(is_farthest).map(name).collect()
    }

    /// Moves one size, whatever a robot can have.
    pub(crate) fn step(&mut self, j: usize, by: f64) {
        let share = if j == 1 { self.own_share() } else { 1.0 };
        self.values[self.free[j].parameter] += share * by * self.free[j].unit;
        if let (0, [_, second, ..]) = (j, &self.free[..]) {
            self.values[second.parameter] += self.correlation * by * second.unit;
        }
    }

    fn own_share(&self) -> f64 {
        (1.0 - self.correlation * self.correlation).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_beyond_all_that_are_looked_at_ends_there_and_is_told() {
        let robot = model::builtin::husky_a200();
        let mechanism = model::mechanism::by_name("load_transfer").unwrap();
        let size = Size { parameter: 0, unit: 0.27, half: Half::Positive };
        let mut member = Member {
            mechanism,
            values: vec![0.5],
            free: vec![size],
            correlation: 0.0,
            span: Span::ALL,
            log_prior: 0.0,
        };
        assert!(member.farthest().is_empty());
        member.set(&robot, &[7.0]);
        assert!((member.values[0] - 6.0 * 0.27).abs() < 1e-12);
        assert_eq!(member.farthest(), ["height_m"]);
    }
}
