//! What a robot file says of how well its numbers are known: where they come from, what a fit left open, and what the model misses.

use std::collections::BTreeMap;

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};
use serde_json::Value;

pub use crate::robot::Uncertainty;
use crate::{Error, Robot};

/// Where a constant comes from, by its field, as `motors.left.k2` or `surfaces.grass.mu_roll`.
pub type Sources = BTreeMap<String, Provenance>;

/// Where a constant comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Provenance {
    /// Measured on this robot by itself, as with a balance.
    Measured,
    /// Fitted to drives of this robot.
    Fitted,
    /// From the maker's data sheet.
    DataSheet,
    /// Another robot's.
    Borrowed,
}

impl Provenance {
    /// Relative standard deviation of a constant that nothing else is known of [-]: an assumption, which reports say beside what
    /// follows from it. Of fitted ones `uncertainty` and `posterior` know more.
    pub fn relative_sigma(self) -> Option<f64> {
        match self {
            Provenance::Measured => Some(0.05),
            Provenance::DataSheet => Some(0.30),
            Provenance::Borrowed => Some(1.0),
            Provenance::Fitted => None,
        }
    }

    /// Share of power that a model of such constants misses as a smooth function of the motion, one standard deviation [-]: an
    /// assumption, which reports say beside what follows from it.
    pub fn model_error(self) -> f64 {
        match self {
            Provenance::Measured | Provenance::Fitted => 0.03,
            Provenance::DataSheet => 0.15,
            Provenance::Borrowed => 0.25,
        }
    }
}

/// What a fit left open: a normal distribution of the logarithms of constants. It holds of constants that still are what was fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Posterior {
    /// Fields of the robot file, as `motors.left.k2`.
    pub parameters: Vec<String>,
    /// Mean of the logarithm of each.
    pub mean: Vec<f64>,
    /// Covariance of the logarithms, row by row.
    pub covariance: Vec<Vec<f64>>,
}

/// What the model missed of the drives that the robot was fitted to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct ModelError {
    /// Share of power that it misses as a smooth function of the motion, one standard deviation [-].
    pub fraction: f64,
    /// Duration of these drives [h].
    pub hours: f64,
    /// What these drives went through.
    #[serde(default)]
    pub regimes: Regimes,
}

/// Ranges of motion, each from its lowest to its highest hundredth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Regimes {
    /// Forward speed [m/s].
    pub speed_mps: [f64; 2],
    /// Difference of the sides' rim speeds, right less left [m/s].
    pub difference_mps: [f64; 2],
    /// Pitch, up positive [rad].
    pub pitch_rad: [f64; 2],
}

/// Noise of one-second averages of recorded power: variance `floor_w² + (gain P)²`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct PowerNoise {
    /// Standard deviation where nothing is drawn [W].
    pub floor_w: f64,
    /// Standard deviation that grows with the power, as a share of it [-].
    pub gain: f64,
    /// Time in which its correlation falls to 1/e [s].
    pub correlation_s: f64,
}

impl Posterior {
    /// Covariance of the logarithms.
    pub fn covariance(&self) -> DMatrix<f64> {
        let count = self.parameters.len();
        let at = |i: usize, j: usize| self.covariance.get(i).and_then(|row| row.get(j)).copied();
        DMatrix::from_fn(count, count, |i, j| at(i, j).unwrap_or(f64::NAN))
    }
}

impl Robot {
    /// Where a constant comes from, by its field, where the file says so.
    pub fn provenance_of(&self, field: &str) -> Option<Provenance> {
        self.provenance.get(field).copied()
    }

    /// Share of power that the model is taken to miss: what a fit found, else by the least known of its constants.
    pub fn model_error_fraction(&self) -> f64 {
        let by_source = self.provenance.values().map(|source| source.model_error());
        let found = self.model_error.as_ref().map(|found| found.fraction);
        found.unwrap_or_else(|| by_source.fold(Provenance::Measured.model_error(), f64::max))
    }
}

/// Checks what a robot says of its own knowledge.
pub(crate) fn check(robot: &Robot) -> Result<(), Error> {
    let within = |field: &str, value: f64, [min, max]: [f64; 2], hint: &'static str| {
        let is_in = value.is_finite() && (min..=max).contains(&value);
        if is_in { Ok(()) } else { Err(Error::OutOfRange { field: field.to_owned(), value, min, max, hint }) }
    };
    if let Some(found) = &robot.model_error {
        within("model_error.fraction", found.fraction, [0.0, 1.0], "give a share of power, 0.03 for 3 %")?;
        within("model_error.hours", found.hours, [0.0, 1e6], "give hours of driving")?;
        let ranges = [
            ("model_error.regimes.speed_mps", found.regimes.speed_mps),
            ("model_error.regimes.difference_mps", found.regimes.difference_mps),
            ("model_error.regimes.pitch_rad", found.regimes.pitch_rad),
        ];
        for (field, [low, high]) in ranges {
            within(field, low, [-100.0, 100.0], "give the lowest, then the highest")?;
            within(field, high, [low, 100.0], "give the lowest, then the highest")?;
        }
    }
    if let Some(noise) = &robot.noise {
        within("noise.floor_w", noise.floor_w, [0.0, 1e5], "give watts")?;
        within("noise.gain", noise.gain, [0.0, 10.0], "give a share of power")?;
        within("noise.correlation_s", noise.correlation_s, [0.0, 3600.0], "give seconds")?;
    }
    check_fields(robot)?;
    robot.posterior.as_ref().map_or(Ok(()), check_posterior)
}

/// Whether every constant that something is said of is one.
fn check_fields(robot: &Robot) -> Result<(), Error> {
    let names = robot.posterior.iter().flat_map(|posterior| &posterior.parameters);
    let names = names.map(|name| ("posterior.parameters", name));
    let mut names = names.chain(robot.provenance.keys().map(|name| ("provenance", name))).peekable();
    if names.peek().is_none() {
        return Ok(());
    }
    let file = serde_json::to_value(robot).unwrap_or_default();
    match names.find(|(_, name)| !is_number(&file, name)) {
        None => Ok(()),
        Some((field, name)) => Err(Error::Knowledge {
            field: field.to_owned(),
            message: format!(
                "the robot has no number `{name}`; give the name of a field, as `motors.left.k2`"
            ),
        }),
    }
}

/// Whether a document has a number at a path, whose names may have dots in them.
fn is_number(document: &Value, path: &str) -> bool {
    let Some(fields) = document.as_object() else { return false };
    fields.iter().any(|(name, inner)| match path.strip_prefix(name.as_str()) {
        Some("") => inner.is_number(),
        Some(rest) => rest.strip_prefix('.').is_some_and(|rest| is_number(inner, rest)),
        None => false,
    })
}

fn check_posterior(posterior: &Posterior) -> Result<(), Error> {
    let wrong =
        |field: &str, message: String| Err(Error::Knowledge { field: format!("posterior.{field}"), message });
    let count = posterior.parameters.len();
    if count > MOST_PARAMETERS {
        return wrong(
            "parameters",
            format!("{count} constants are more than the {MOST_PARAMETERS} of any robot"),
        );
    }
    let numbers = posterior.mean.iter().chain(posterior.covariance.iter().flatten());
    if !numbers.clone().all(|value| value.is_finite()) {
        return wrong("covariance", "every number must be finite".into());
    }
    let rows = posterior.covariance.iter().filter(|row| row.len() == count).count();
    if posterior.mean.len() != count {
        return wrong(
            "mean",
            format!("{} numbers for {count} parameters: give one each", posterior.mean.len()),
        );
    }
    if posterior.covariance.len() != count || rows != count {
        return wrong("covariance", format!("give {count} rows of {count} numbers, one a parameter"));
    }
    let covariance = posterior.covariance();
    let is_symmetric = (0..count).all(|i| {
        (0..i).all(|j| {
            let scale = (covariance[(i, i)] * covariance[(j, j)]).abs().sqrt();
            (covariance[(i, j)] - covariance[(j, i)]).abs() <= ROUNDING * scale
        })
    });
    if (0..count).any(|i| covariance[(i, i)] > LARGEST_VARIANCE) {
        let message = format!(
            "a logarithm of variance above {LARGEST_VARIANCE} says nothing of a constant: leave it out"
        );
        return wrong("covariance", message);
    }
    if !is_symmetric || root(&covariance).is_none() {
        return wrong("covariance", "it is no covariance, which is symmetric and positive definite".into());
    }
    Ok(())
}

/// Constants of a robot that knows forty kinds of ground, about.
const MOST_PARAMETERS: usize = 200;

/// Variance of a logarithm of which two standard deviations are a factor of 400.
const LARGEST_VARIANCE: f64 = 9.0;

/// By how much a covariance that was written and read may differ from one, as a share.
const ROUNDING: f64 = 1e-6;

/// Cholesky factor of a covariance; `None` of what is none.
pub fn root(covariance: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let mut padded = covariance.clone();
    (0..padded.nrows()).for_each(|i| padded[(i, i)] *= 1.0 + ROUNDING);
    padded.cholesky().map(|root| root.l())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::husky_a200;

    fn posterior(covariance: Vec<Vec<f64>>) -> Robot {
        let parameters = vec!["mass_kg".to_owned(), "motors.left.k2".to_owned()];
        Robot { posterior: Some(Posterior { parameters, mean: vec![4.5, 0.5], covariance }), ..husky_a200() }
    }

    #[test]
    fn what_is_known_survives_a_round_trip_through_json() {
        let mut robot = posterior(vec![vec![0.01, 0.002], vec![0.002, 0.0004001]]);
        robot.source = Some("fitted in a yard".into());
        robot.provenance = [("mass_kg".to_owned(), Provenance::DataSheet)].into();
        robot.noise = Some(PowerNoise { floor_w: 1.0, gain: 0.01, correlation_s: 0.5 });
        let regimes = Regimes { speed_mps: [-0.1, 0.9], ..Regimes::default() };
        robot.model_error = Some(ModelError { fraction: 0.02, hours: 1.5, regimes });
        let text = serde_json::to_string(&robot).unwrap();
        assert!(text.contains(r#""mass_kg":"data-sheet""#), "{text}");
        assert_eq!(Robot::from_json(&text).unwrap(), robot);
    }

    #[test]
    fn no_file_says_more_than_it_knows() {
        let text = serde_json::to_string(&husky_a200()).unwrap();
        assert!(!text.contains("posterior") && !text.contains("provenance"), "{text}");
    }

    #[test]
    fn what_is_no_covariance_is_refused_by_name() {
        for covariance in [
            vec![vec![0.01, 0.02], vec![0.02, 0.01]],
            vec![vec![0.01, 0.002], vec![0.003, 0.01]],
            vec![vec![0.01, 0.0]],
            vec![vec![0.01, 0.0], vec![f64::NAN, 0.01]],
            vec![vec![0.0, 0.0], vec![0.0, 0.0]],
            vec![vec![10.0, 0.0], vec![0.0, 0.1]],
        ] {
            let error = posterior(covariance).validate().unwrap_err();
            assert_eq!(error.field(), Some("posterior.covariance"), "{error}");
        }
        let mut robot = posterior(vec![vec![0.01, 0.0], vec![0.0, 0.01]]);
        assert!(robot.validate().is_ok());
        robot.posterior.as_mut().unwrap().mean.pop();
        assert_eq!(robot.validate().unwrap_err().field(), Some("posterior.mean"));
    }

    #[test]
    fn a_source_of_a_constant_that_there_is_not_is_refused() {
        let sourced = |name: &str| {
            let provenance = [(name.to_owned(), Provenance::Borrowed)].into();
            Robot { provenance, ..husky_a200() }.validate()
        };
        for name in ["mass_kg", "motors.left.k2", "surfaces.marble.mu_roll"] {
            sourced(name).unwrap();
        }
        for name in ["motor.left.k2", "motors.left", "motors.left.k2.", "name", ""] {
            let error = sourced(name).unwrap_err();
            assert!(error.field() == Some("provenance") && error.to_string().contains(name), "{error}");
        }
    }

    #[test]
    fn the_model_misses_what_a_fit_found_or_what_its_worst_source_allows() {
        let mut robot = husky_a200();
        assert_eq!(robot.model_error_fraction(), 0.03);
        robot.provenance = [("mass_kg", Provenance::Measured), ("motors.left.k2", Provenance::Borrowed)]
            .map(|(field, source)| (field.to_owned(), source))
            .into();
        assert_eq!(robot.model_error_fraction(), 0.25);
        robot.model_error = Some(ModelError { fraction: 0.012, hours: 2.0, regimes: Regimes::default() });
        assert_eq!(robot.model_error_fraction(), 0.012);
    }
}
