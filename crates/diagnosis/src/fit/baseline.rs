//! The robot at its most probable parameters before any effect, and the linear model about it.

use model::Robot;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::{
    Error, Series,
    evidence::noise::{Noise, Whitening},
    fit::{
        discrepancy::{self, Components, Shares},
        parameter::{Parameter, Parameters, Shown},
    },
    observe::observations::{Observations, REST, YAW_RATE},
};

/// Steps of Gauss and Newton at most; what they leave stays in the residual, which is linearised about the last.
const STEPS: usize = 4;
/// A fit has settled where no parameter moves by more, in prior standard deviations: the linear model takes up what is left.
const SETTLED: f64 = 0.02;
/// Step of differences, in prior standard deviations.
const DIFFERENCE: f64 = 0.2;
/// Whitened residuals count linearly beyond so many standard deviations (Huber, Ann. Math. Stat. 35, 1964).
const HUBER: f64 = 3.0;

/// A robot fitted to drives on which nothing acts, and its sensitivities.
pub(crate) struct Baseline {
    /// The robot.
    pub(crate) robot: Robot,
    /// Its free parameters.
    pub(crate) parameters: Parameters,
    /// Their values, as the independent numbers that their prior is made of, 0 at the file.
    pub(crate) u: DVector<f64>,
    /// Predictions, row by row.
    pub(crate) predicted: Vec<f64>,
    /// Change of predictions with each parameter, per its prior standard deviation.
    per_z: Vec<Vec<f64>>,
    /// Change of predictions with each of the independent numbers.
    pub(crate) sensitivities: Vec<Vec<f64>>,
    /// Noise of the rows.
    pub(crate) noise: Noise,
    /// Recorded less what is predicted at the file's parameters, linearised about the fit.
    pub(crate) residual: Vec<f64>,
}

impl Baseline {
    /// The robot as its file has it, and the linear model about that.
    ///
    /// # Errors
    /// As [`Baseline::fit`].
    pub(crate) fn of_file(observed: &Observations<'_>, file: &Robot) -> Result<Self, Error> {
        Self::after(observed, file, 0)
    }

    /// Fits a robot to its healthy drives if there are any, else to the test drives.
    ///
    /// # Errors
    /// A surface that the robot does not know; a watch that breaks.
    pub(crate) fn fit(observed: &Observations<'_>, file: &Robot) -> Result<Self, Error> {
        Self::after(observed, file, STEPS)
    }

    /// The robot after some steps of a fit that begins at its file.
    fn after(observed: &Observations<'_>, file: &Robot, steps: usize) -> Result<Self, Error> {
        let series = observed.series;
        let shown = Shown {
            battery: series.channels() == 1 || observed.has_channel(REST),
            currents: series.watts_per_a().is_some(),
            yaw_rate: observed.has_channel(YAW_RATE),
        };
        let parameters = Parameters::of(file, &series.surfaces(), shown);
        let first_fitted = if series.has_healthy() { observed.test_rows } else { 0 };
        let mut robot = file.clone();
        let mut u = DVector::zeros(parameters.len());
        let mut predicted = series.predict(&robot, &[])?;
        let mut per_z = per_z(series, file, &parameters, &u, &predicted)?;
        let mut sensitivities = parameters.mixed(&per_z);
        for _ in 0..steps {
            let errors = differences(&series.recorded, &predicted);
            let noise = Noise::of(&errors, &predicted, &observed.places);
            let white = noise.whitening(&predicted, &observed.places);
            let step = step(&white, &errors, &sensitivities, &u, first_fitted);
            u += &step;
            robot = parameters.placed(file, &u);
            predicted = series.predict(&robot, &[])?;
            per_z = self::per_z(series, file, &parameters, &u, &predicted)?;
            sensitivities = parameters.mixed(&per_z);
            if step.amax() < SETTLED {
                break;
            }
        }
        let errors = differences(&series.recorded, &predicted);
        let noise = Noise::of(&errors, &predicted, &observed.places);
        within_reach(observed, &predicted, &noise)?;
        let mut residual = errors;
        for (column, u) in sensitivities.iter().zip(u.iter()) {
            residual.iter_mut().zip(column).for_each(|(r, by)| *r += u * by);
        }
        Ok(Baseline { robot, parameters, u, predicted, per_z, sensitivities, noise, residual })
    }

    /// The same robot with the same noise in other drives, of which nothing is recorded yet.
    ///
    /// # Errors
    /// A surface that the robot does not know; a watch that breaks.
    pub(crate) fn elsewhere(&self, series: &Series, file: &Robot) -> Result<Self, Error> {
        let predicted = series.predict(&self.robot, &[])?;
        let per_z = per_z(series, file, &self.parameters, &self.u, &predicted)?;
        Ok(Baseline {
            robot: self.robot.clone(),
            parameters: self.parameters.clone(),
            u: self.u.clone(),
            sensitivities: self.parameters.mixed(&per_z),
            noise: self.noise.clone(),
            residual: vec![0.0; predicted.len()],
            predicted,
            per_z,
        })
    }

    /// Powers that discrepancies multiply.
    pub(crate) fn components(&self, observed: &Observations<'_>) -> Components {
        let sum = |is_own: fn(&Parameter) -> bool| {
            let mut sum = vec![0.0; observed.rows()];
            for (parameter, column) in self.parameters.list.iter().zip(&self.per_z).filter(|(p, _)| is_own(p))
            {
                let per_log = 1.0 / parameter.sigma();
                sum.iter_mut().zip(column).for_each(|(sum, by)| *sum += per_log * by);
            }
            sum
        };
        Components {
            rolling: sum(Parameter::is_rolling),
            skid: sum(Parameter::is_skid),
            total: self.with_power_at_rest(observed),
        }
    }

    /// Predictions, and where a channel is of what is left between meters, the power of both sides in its place.
    fn with_power_at_rest(&self, observed: &Observations<'_>) -> Vec<f64> {
        let averages = observed.averages();
        let mut sides = std::collections::HashMap::new();
        for (average, w) in averages.iter().zip(&self.predicted).filter(|(a, _)| a.channel < 2) {
            *sides.entry((average.suspect, average.run, average.t_s.to_bits())).or_insert(0.0) += w;
        }
        let of = |(average, value): (&crate::Average, &f64)| {
            if average.channel != REST {
                return *value;
            }
            sides.get(&(average.suspect, average.run, average.t_s.to_bits())).copied().unwrap_or(0.0)
        };
        averages.iter().zip(&self.predicted).map(of).collect()
    }

    /// Discrepancy columns of an amplitude.
    pub(crate) fn discrepancy(&self, observed: &Observations<'_>, shares: Shares) -> Vec<Vec<f64>> {
        discrepancy::columns(observed, &self.components(observed), shares)
    }
}

/// Refuses predictions whose squares, in variances of the noise, cannot be summed beside those of other rows: of these no digit would be left.
fn within_reach(observed: &Observations<'_>, predicted: &[f64], noise: &Noise) -> Result<(), Error> {
    let reach = 1.0 / f64::EPSILON.sqrt();
    let is_beyond = |(average, w): &(&crate::Average, &f64)| {
        !(w.is_finite() && w.abs() < reach * noise.sigma(average.channel, 0.0))
    };
    let Some((average, w)) = observed.averages().iter().zip(predicted).find(is_beyond) else { return Ok(()) };
    Err(Error::Beyond { drive: observed.series.run_name(average), t_s: average.t_s, power_w: *w })
}

/// Recorded less predicted.
pub(crate) fn differences(recorded: &[f64], predicted: &[f64]) -> Vec<f64> {
    recorded.iter().zip(predicted).map(|(r, p)| r - p).collect()
}

/// Change of predictions with each parameter, per its prior standard deviation.
fn per_z(
    series: &Series,
    file: &Robot,
    parameters: &Parameters,
    u: &DVector<f64>,
    predicted: &[f64],
) -> Result<Vec<Vec<f64>>, Error> {
    let z = parameters.z(u);
    let column = |i: usize| {
        let mut robot = file.clone();
        for (j, parameter) in parameters.list.iter().enumerate() {
            parameter.set(&mut robot, z[j] + if i == j { DIFFERENCE } else { 0.0 });
        }
        let moved = series.predict(&robot, &[])?;
        Ok(moved.iter().zip(predicted).map(|(a, b)| (a - b) / DIFFERENCE).collect())
    };
    (0..parameters.len()).into_par_iter().map(column).collect()
}

/// One step towards the most probable parameters.
fn step(
    white: &Whitening,
    errors: &[f64],
    sensitivities: &[Vec<f64>],
    z: &DVector<f64>,
    first_fitted: usize,
) -> DVector<f64> {
    let errors = DVector::from_vec(white.apply(errors));
    let weight =
        |i: usize| if i < first_fitted { 0.0 } else { (HUBER / errors[i].abs().max(1e-9)).min(1.0).sqrt() };
    let weights = DVector::from_fn(errors.len(), |i, _| weight(i));
    let columns: Vec<DVector<f64>> = sensitivities
        .iter()
        .map(|column| DVector::from_vec(white.apply(column)).component_mul(&weights))
        .collect();
    if columns.is_empty() {
        return DVector::zeros(0);
    }
    let columns = DMatrix::from_columns(&columns);
    let gram = columns.tr_mul(&columns) + DMatrix::identity(z.len(), z.len());
    let right = columns.tr_mul(&errors.component_mul(&weights)) - z;
    gram.cholesky().map_or_else(|| DVector::zeros(z.len()), |root| root.solve(&right))
}
