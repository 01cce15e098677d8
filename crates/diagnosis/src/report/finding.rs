//! Findings: the members of the likeliest explanation, with intervals, probabilities and what could stand in their place.

use crate::{
    Series, Span,
    evidence::reduced::Half,
    fit::{
        joint::Fitted,
        member::{Member, Size},
    },
    hypothesis::unlisted::{Block, Component, Family},
    report::diagnosis::{EvidenceFigures, Finding, FindingFit, FoundParameter, Scope},
    search::explanation::{Explanation, credible},
};

/// The name of an effect that no mechanism of the list describes.
pub const UNKNOWN: &str = "unknown";

/// Standard deviations of the sides of a 95 % interval of a normal distribution.
const NORMAL_975: f64 = 1.96;

/// What findings are read off.
pub(crate) struct Reading<'a> {
    /// The drives.
    pub(crate) series: &'a Series,
    /// Names of the test drives.
    pub(crate) drives: &'a [String],
    /// All explanations, likeliest first.
    pub(crate) explanations: &'a [Explanation],
    /// Held-out errors without and with the findings.
    pub(crate) fit: FindingFit,
    /// Unlisted blocks.
    pub(crate) blocks: &'a [Block],
}

impl Reading<'_> {
    /// Findings of the likeliest explanation; none where that is nothing.
    pub(crate) fn findings(&self) -> Vec<Finding> {
        let is_something = |one: &&Explanation| !one.names.is_empty() || one.unlisted;
        let Some(first) = self.explanations.first().filter(is_something) else { return Vec::new() };
        let members =
            first.fitted.iter().flat_map(|fitted| (0..fitted.members.len()).map(move |m| (fitted, m)));
        let mut findings: Vec<Finding> = members.map(|(fitted, m)| self.finding(first, fitted, m)).collect();
        if first.unlisted {
            findings.push(self.unlisted(first));
        }
        findings
    }

    fn finding(&self, first: &Explanation, fitted: &Fitted, m: usize) -> Finding {
        let member = &fitted.members[m];
        let name = member.mechanism.name();
        let span = member.span;
        let mut statement = member.mechanism.statement(&member.values);
        if !span.is_all() {
            statement += &format!(", {}", span.words(self.drives));
        }
        Finding {
            mechanism: name.to_owned(),
            statement,
            equation: member.mechanism.equation().to_owned(),
            parameters: self.parameters(fitted, m),
            evidence: self.evidence(|one| one.names.contains(&name)),
            indistinguishable_from: self.in_its_place(first, name),
            fit: self.fit,
            probability: Some(self.sum(|one| one.names.contains(&name))),
            scope: Some(scope(span, self.drives)),
        }
    }

    fn unlisted(&self, first: &Explanation) -> Finding {
        let block = first.block.and_then(|(i, amplitude)| Some((self.blocks.get(i)?, amplitude)));
        let words = block.map_or_else(
            || "something acts that no mechanism describes".to_owned(),
            |(block, amplitude)| {
                format!(
                    "something acts that no mechanism describes: it follows {} and is about {:.0} % of {}",
                    follows(block.family),
                    100.0 * amplitude,
                    of_what(block.component)
                )
            },
        );
        Finding {
            mechanism: UNKNOWN.to_owned(),
            statement: words,
            equation: "ΔP = component · g(regime), g a smooth function".to_owned(),
            parameters: Vec::new(),
            evidence: self.evidence(|one| one.unlisted),
            indistinguishable_from: Vec::new(),
            fit: self.fit,
            probability: Some(self.sum(|one| one.unlisted)),
            scope: Some(Scope::default()),
        }
    }

    /// Probability of the explanations of a kind.
    fn sum(&self, is_own: impl Fn(&Explanation) -> bool) -> f64 {
        self.explanations.iter().filter(|one| is_own(one)).map(|one| one.probability).sum()
    }

    /// Evidence figures: the probability that it is not there, and twice the log odds of the likeliest explanations with and without it.
    fn evidence(&self, has_it: impl Fn(&Explanation) -> bool) -> EvidenceFigures {
        let best = |with: bool| {
            let logs = self.explanations.iter().filter(|one| has_it(one) == with).map(|one| one.log);
            logs.fold(f64::NEG_INFINITY, f64::max)
        };
        let gain = 1.0 - (self.fit.held_out_rmse_after_w / self.fit.held_out_rmse_before_w).powi(2);
        EvidenceFigures {
            p_value: (1.0 - self.sum(&has_it)).clamp(0.0, 1.0),
            delta_bic: 2.0 * (best(true) - best(false)).clamp(-1e6, 1e6),
            held_out_gain: gain,
        }
    }

    /// Mechanisms that take the place of one in the credible set.
    fn in_its_place(&self, first: &Explanation, name: &str) -> Vec<String> {
        let others: Vec<&str> = first.names.iter().copied().filter(|other| *other != name).collect();
        let mut places = Vec::new();
        for one in credible(self.explanations).iter().filter(|one| one.names.len() == first.names.len()) {
            let new: Vec<&str> = one.names.iter().copied().filter(|other| !others.contains(other)).collect();
            if let [new] = new[..]
                && new != name
                && others.iter().all(|other| one.names.contains(other))
                && !places.iter().any(|known| known == new)
            {
                places.push(new.to_owned());
            }
        }
        places
    }

    /// Values with intervals, and when it acts.
    fn parameters(&self, fitted: &Fitted, m: usize) -> Vec<FoundParameter> {
        let member = &fitted.members[m];
        let first: usize = fitted.members[..m].iter().map(|before| before.free.len()).sum();
        let of = |(i, value): (usize, &f64)| {
            let parameter = &member.mechanism.parameters()[i];
            let free = member.free.iter().position(|size| size.parameter == i);
            let interval_95 =
                free.map(|j| interval(&member.free[j], *value, value_sigma(fitted, member, first, j)));
            FoundParameter { name: parameter.name, value: *value, unit: parameter.unit, interval_95 }
        };
        let mut parameters: Vec<FoundParameter> = member.values.iter().enumerate().map(of).collect();
        let bounds = self.series.bounds(member.span).into_iter();
        parameters.extend(bounds.map(|(name, value, unit)| FoundParameter {
            name,
            value,
            unit,
            interval_95: None,
        }));
        parameters
    }
}

/// Whether an explanation has a mechanism of which every interval holds zero.
pub(crate) fn size_is_untold(explanation: &Explanation) -> bool {
    let Some(fitted) = &explanation.fitted else { return false };
    let mut first = 0;
    fitted.members.iter().any(|member| {
        let own = first;
        first += member.free.len();
        let holds_zero = |(j, size): (usize, &Size)| {
            let [low, high] =
                interval(size, member.values[size.parameter], value_sigma(fitted, member, own, j));
            low <= 0.0 && high >= 0.0
        };
        !member.free.is_empty() && member.free.iter().enumerate().all(holds_zero)
    })
}

/// Standard deviation of one free value about the most probable one, of a member whose sizes begin at a column, in units of the size: where
/// forms may be off, the mean of the posterior lies elsewhere. A form that is off by the same factor everywhere is another size, which no drive
/// tells from it.
fn value_sigma(fitted: &Fitted, member: &Member, first: usize, j: usize) -> f64 {
    let off = |i: usize| fitted.evidence.mean[i] - fitted.sizes[i];
    let about = |i: usize, k: usize| fitted.evidence.covariance[(i, k)] + off(i) * off(k);
    let own = about(first + j, first + j);
    let rho = member.correlation;
    let variance = if j == 1 {
        let beside = about(first, first);
        let both = about(first, first + 1);
        rho * rho * beside + (1.0 - rho * rho) * own + 2.0 * rho * (1.0 - rho * rho).sqrt() * both
    } else {
        own
    };
    let Size { parameter, unit, .. } = member.free[j];
    let by_form = fitted.form_variance * (member.values[parameter] / unit).powi(2);
    (variance.max(0.0) + by_form).sqrt()
}

/// 95 % interval of a value, cut where a sign is impossible.
fn interval(size: &Size, value: f64, sigma: f64) -> [f64; 2] {
    let half = NORMAL_975 * sigma * size.unit.abs();
    let [low, high] = [value - half, value + half];
    match size.half {
        Half::Positive if size.unit > 0.0 => [low.max(0.0), high],
        Half::Positive => [low, high.min(0.0)],
        Half::Both => [low, high],
    }
}

/// Scope of a span.
fn scope(span: Span, drives: &[String]) -> Scope {
    let run = |run: usize| drives.get(run).cloned();
    match span {
        Span::EachDrive(from_s) if from_s > 0.0 => Scope { from_s: Some(from_s), ..Scope::default() },
        Span::EachDrive(_) => Scope::default(),
        Span::From { run: which, t_s } => Scope { from_s: Some(t_s), run: run(which), ..Scope::default() },
        Span::Until { run: which, t_s } => Scope { until_s: Some(t_s), run: run(which), ..Scope::default() },
        Span::Within(region) => Scope { region: Some(region.words()), ..Scope::default() },
    }
}

/// Members of an explanation, for the corrected robot.
pub(crate) fn members(explanation: &Explanation) -> &[Member] {
    explanation.fitted.as_ref().map_or(&[], |fitted| &fitted.members)
}

fn follows(family: Family) -> &'static str {
    match family {
        Family::Regime => "speed, turning, slope or acceleration",
        Family::Time => "the time of the drive",
        Family::Place => "the place",
        Family::SinceStart => "the time since the robot began to move",
        Family::Turn => "how far the wheels have turned",
    }
}

fn of_what(component: Component) -> &'static str {
    match component {
        Component::Rolling => "the power of rolling resistance",
        Component::Skid => "the power of skid resistance",
        Component::Power => "the power",
        Component::Constant => "the mean power, whatever the robot does",
    }
}
