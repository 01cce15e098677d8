//! Effects at their prior sizes: what a form of a mechanism changes, as columns over the rows of the test drives.

use model::{
    Robot,
    mechanism::{Form, Mechanism, Scale},
};
use rayon::prelude::*;

use crate::{Applied, Error, Series, Span, evidence::reduced::Half, fit::member::Size};

/// One form of a mechanism with a column for each free parameter.
#[derive(Clone)]
pub(crate) struct Effect {
    /// The mechanism.
    pub(crate) mechanism: &'static dyn Mechanism,
    /// Share of the mechanism's prior that is this form's, as a logarithm.
    pub(crate) log_prior: f64,
    /// See [`Form::widening`].
    pub(crate) widening: f64,
    /// Values of all parameters; free ones at 0, or where they begin.
    pub(crate) values: Vec<f64>,
    /// Free parameters.
    pub(crate) free: Vec<Size>,
    /// Prior correlation ρ of the first two of them: the second is ρ x₀ + √(1 − ρ²) x₁ of its unit.
    pub(crate) correlation: f64,
    /// Change of predictions with each free parameter at one prior standard deviation, test rows first.
    pub(crate) columns: Vec<Vec<f64>>,
}

/// The forms of mechanisms as effects in the test drives, beside mechanisms that act already; the same in all drives where asked for.
///
/// # Errors
/// A surface that the robot does not know; a watch that breaks.
pub(crate) fn effects(
    library: &[&'static dyn Mechanism],
    scale: &Scale<'_>,
    beside: &Beside<'_>,
) -> Result<Vec<Effect>, Error> {
    let forms = |mechanism: &&'static dyn Mechanism| {
        let forms = mechanism.forms(scale.robot);
        let log_prior = -(forms.len() as f64).ln();
        forms.into_iter().map(|form| (*mechanism, form, log_prior)).collect::<Vec<_>>()
    };
    let all: Vec<_> = library.iter().flat_map(forms).collect();
    let effect = |(mechanism, form, log_prior): (&'static dyn Mechanism, Form, f64)| {
        let priors = mechanism.size_prior(scale);
        let free: Vec<Size> = form.free.iter().map(|i| Size::of(&form, &priors, *i)).collect();
        let columns = free.iter().map(|size| beside.column(mechanism, &form.values, size));
        let mut columns = columns.collect::<Result<Vec<_>, Error>>()?;
        let correlation = if free.len() >= 2 { mechanism.size_correlation() } else { 0.0 };
        if let [first, second, ..] = &mut columns[..] {
            first.iter_mut().zip(&*second).for_each(|(a, b)| *a += correlation * b);
            second.iter_mut().for_each(|b| *b *= (1.0 - correlation * correlation).sqrt());
        }
        Ok(Effect {
            mechanism,
            log_prior,
            widening: form.widening,
            values: form.values,
            free,
            correlation,
            columns,
        })
    };
    all.into_par_iter().map(effect).collect()
}

/// What effects are added to.
pub(crate) struct Beside<'a> {
    /// The drives.
    pub(crate) series: &'a Series,
    /// The robot.
    pub(crate) robot: &'a Robot,
    /// Mechanisms that act already.
    pub(crate) applied: &'a [Applied],
    /// Predictions with them.
    pub(crate) predicted: &'a [f64],
    /// Whether healthy drives have the effect too.
    pub(crate) everywhere: bool,
}

impl Beside<'_> {
    /// Change with one parameter by its unit, as the mean of both directions where both are possible.
    pub(crate) fn column(
        &self,
        mechanism: &'static dyn Mechanism,
        values: &[f64],
        size: &Size,
    ) -> Result<Vec<f64>, Error> {
        let change = |by: f64| -> Result<Vec<f64>, Error> {
            let mut values = values.to_vec();
            let [low, high] = mechanism.bounds(self.robot, size.parameter);
            values[size.parameter] = by.clamp(low, high);
            let one = Applied { mechanism, values, span: Span::ALL };
            let seen = if self.everywhere {
                self.series.predict_with(
                    self.robot,
                    std::slice::from_ref(&one),
                    std::slice::from_ref(&one),
                )?
            } else {
                self.series.predict(self.robot, &[self.applied, &[one]].concat())?
            };
            Ok(seen.iter().zip(self.predicted).map(|(a, b)| a - b).collect())
        };
        let up = change(size.unit)?;
        if size.half == Half::Positive {
            return Ok(up);
        }
        let down = change(-size.unit)?;
        Ok(up.iter().zip(&down).map(|(up, down)| 0.5 * (up - down)).collect())
    }
}
