//! A mechanism with sizes, in prior standard deviations of its parameters.

use model::{
    Robot,
    mechanism::{Form, Mechanism, Sign, SizePrior},
};

use crate::{
    Applied, Span,
    evidence::{
        reduced::Half,
        width::{self, WIDTHS},
    },
};

/// Sizes beyond so many standard deviations of the widest prior are not looked at: it gives them a chance of 2·10⁻⁹.
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
    /// Free parameters, their units those of the width.
    pub(crate) free: Vec<Size>,
    /// Factor of the prior standard deviations of the sizes.
    pub(crate) width: f64,
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

    /// Whether another is the same mechanism in the same form and span, whatever its sizes.
    pub(crate) fn differs_in_size_only(&self, other: &Member) -> bool {
        let is_free = |i: usize| self.free.iter().any(|size| size.parameter == i);
        let mut values = self.values.iter().zip(&other.values).enumerate();
        self.mechanism.name() == other.mechanism.name()
            && self.span == other.span
            && self.log_prior == other.log_prior
            && self.free.len() == other.free.len()
            && self.free.iter().zip(&other.free).all(|(a, b)| (a.parameter, a.half) == (b.parameter, b.half))
            && values.all(|(i, (a, b))| is_free(i) || a == b)
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
        let farthest = self.farthest_size();
        for (size, x) in self.free.iter().zip(values) {
            let least = if size.half == Half::Positive { 0.0 } else { -farthest };
            let [low, high] = self.mechanism.bounds(file, size.parameter);
            self.values[size.parameter] = (size.unit * x.clamp(least, farthest)).clamp(low, high);
        }
    }

    /// The size beyond which none is looked at, in units of the width.
    fn farthest_size(&self) -> f64 {
        FARTHEST * WIDTHS[WIDTHS.len() - 1] / self.width
    }

    /// The likeliest width of its sizes, and the log density of these with it.
    fn likeliest_width(&self) -> (f64, f64, f64) {
        let sizes: Vec<f64> = self.sizes().iter().map(|x| x * self.width).collect();
        width::likeliest(&sizes)
    }

    /// Log density of its sizes, whatever the width.
    pub(crate) fn log_density(&self) -> f64 {
        self.likeliest_width().2
    }

    /// Log prior of its form, window and width.
    pub(crate) fn log_prior(&self) -> f64 {
        let of_width = WIDTHS.iter().zip(width::log_priors()).find(|(by, _)| **by == self.width);
        self.log_prior + of_width.map_or(0.0, |(_, log)| log)
    }

    /// Takes the likeliest width of its sizes, and says by which factor its units grow.
    pub(crate) fn widen(&mut self) -> f64 {
        let by = self.likeliest_width().0 / self.width;
        self.width *= by;
        self.free.iter_mut().for_each(|size| size.unit *= by);
        by
    }

    /// Parameters that stand at the farthest size that is looked at.
    pub(crate) fn farthest(&self) -> Vec<&'static str> {
        let is_farthest = |size: &&Size| {
            (self.values[size.parameter] / size.unit).abs() >= self.farthest_size() * (1.0 - f64::EPSILON)
        };
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
            width: 1.0,
            correlation: 0.0,
            span: Span::ALL,
            log_prior: 0.0,
        };
        assert!(member.farthest().is_empty());
        assert_eq!(member.widen(), 1.0);
        // The bound of the mechanism is 1 m, whatever the prior.
        let [_, high_m] = mechanism.bounds(&robot, 0);
        member.set(&robot, &[7.0]);
        let reached_m = high_m.min(7.0 * 0.27);
        assert!((member.values[0] - reached_m).abs() < 1e-12);
        assert_eq!(member.widen(), 4.0);
        assert!((member.values[0] - reached_m).abs() < 1e-12 && (member.free[0].unit - 1.08).abs() < 1e-12);
        assert!(member.log_prior() < -2.0 && member.log_density() < member.log_prior());
        member.free[0].unit = high_m / 100.0;
        member.set(&robot, &[30.0]);
        assert!((member.values[0] - 0.12 * high_m).abs() < 1e-12);
        assert_eq!(member.farthest(), ["height_m"]);
    }
}
