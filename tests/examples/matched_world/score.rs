//! What came of all cases.

use std::fmt;

use diagnosis::{Applied, Diagnosis, Verdict, report::Finding};
use model::mechanism::{self, Kind as Family};

use crate::case::Case;

/// Counts over all cases.
#[derive(Default)]
pub(crate) struct Board {
    healthy: Rate,
    named: Rate,
    noticed: Rate,
    both: Rate,
    swapped: Rate,
    covered: Rate,
    errors: Vec<f64>,
    ratios: Vec<f64>,
}

#[derive(Default)]
struct Rate {
    hits: u32,
    of: u32,
}

impl Rate {
    fn count(&mut self, hit: bool) {
        self.hits += u32::from(hit);
        self.of += 1;
    }
}

impl Board {
    /// Adds a case.
    pub(crate) fn add(&mut self, case: &Case, found: &Diagnosis) {
        let is_named = |truth: &Applied| is_in_two(truth.mechanism.name(), found);
        match &case.truths[..] {
            [] => self.healthy.count(found.verdict != Verdict::Consistent),
            [one] => {
                self.noticed.count(found.verdict != Verdict::Consistent);
                self.named.count(is_named(one));
                self.swapped.count(is_swapped(one, found));
                self.numbers(one, found);
                self.ratios.push(found.corrected.held_out_rmse_w / found.baseline.noise_floor_w);
            }
            several => self.both.count(several.iter().all(is_named)),
        }
    }

    /// Compares a finding's numbers with the truth.
    fn numbers(&mut self, truth: &Applied, found: &Diagnosis) {
        let Some(finding) = found.findings.iter().find(|f| f.mechanism == truth.mechanism.name()) else {
            return;
        };
        let parameters = truth.mechanism.parameters();
        let largest = |unit: &str| {
            let alike = parameters.iter().zip(&truth.values).filter(|(p, _)| p.unit == unit);
            alike.map(|(_, value)| value.abs()).fold(0.0, f64::max)
        };
        for (parameter, value) in parameters.iter().zip(&truth.values) {
            let Some(said) = finding.parameters.iter().find(|said| said.name == parameter.name) else {
                continue;
            };
            if largest(parameter.unit) > 0.0 {
                self.errors.push((said.value - value).abs() / largest(parameter.unit));
            }
            if let Some([low, high]) = said.interval_95 {
                self.covered.count((low..=high).contains(value));
            }
        }
    }
}

/// Whether a finding of at most two names has one.
pub(crate) fn is_in_two(name: &str, found: &Diagnosis) -> bool {
    let names =
        |f: &Finding| f.mechanism == name || f.indistinguishable_from.iter().any(|other| other == name);
    found.findings.iter().any(|f| f.indistinguishable_from.len() < 2 && names(f))
}

/// Whether a finding without the truth is of the other family.
fn is_swapped(truth: &Applied, found: &Diagnosis) -> bool {
    let family = |name: &str| mechanism::by_name(name).map(|one| one.kind() == Family::Physics);
    let wrong = found.findings.iter().filter(|f| {
        f.mechanism != truth.mechanism.name()
            && f.indistinguishable_from.iter().all(|n| n != truth.mechanism.name())
    });
    wrong
        .filter_map(|f| family(&f.mechanism))
        .any(|physics| physics != (truth.mechanism.kind() == Family::Physics))
}

impl fmt::Display for Board {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rates = [
            ("false alarms, healthy drives and decoys", &self.healthy),
            ("effects noticed", &self.noticed),
            ("effects named, set of two at most", &self.named),
            ("both of two effects named", &self.both),
            ("physics called a fault of measurement or the reverse", &self.swapped),
            ("intervals that hold the truth", &self.covered),
        ];
        for (what, Rate { hits, of }) in rates {
            writeln!(f, "{what}: {hits} of {of}")?;
        }
        if let Some(error) = median(&self.errors) {
            writeln!(f, "error of numbers, median: {:.1} %", 100.0 * error)?;
        }
        if let Some(ratio) = median(&self.ratios) {
            writeln!(f, "held-out error after over the noise floor, median: {ratio:.3}")?;
        }
        Ok(())
    }
}

fn median(values: &[f64]) -> Option<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
