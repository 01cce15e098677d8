//! Fitting the robot to recordings of power.

use model::Robot;
use recording::PowerForm;

use crate::{
    Drives, Error,
    field::{applied, known_before, with_new_ground},
    fit::{Fit, Predict, Problem},
    folds,
    noise::{LARGEST, Noise},
    power::{PowerModel, seen_w},
};

/// The robot as fitted to recordings of power.
#[derive(Clone, Debug)]
pub struct PowerFit {
    /// The robot with the values found.
    pub robot: Robot,
    /// The values and their uncertainty.
    pub fit: Fit,
}

/// Rows on which a first fit of a long recording is made, before all of them have their say.
const FIRST_ROWS: usize = 20_000;

/// One-second averages that are fitted at most, about 28 hours, spread evenly over a longer recording: chance alone would move no
/// parameter by a hundredth of what the model misses, and each takes 5 kB.
const MOST_AVERAGES: usize = 100_000;

/// Rounds of fit and noise at most, and the share of the noise before that counts as no change.
const MOST_ROUNDS: usize = 5;
const SETTLED: f64 = 0.9;

/// Fits friction per surface, motor constants, regeneration and standing powers to all rows.
///
/// # Errors
/// [`Error::Robot`] where the result does not pass the robot's own checks, [`Error::Stopped`] when the drives' watch breaks.
pub fn fit_power(robot: &Robot, drives: &Drives) -> Result<PowerFit, Error> {
    if drives.rows.len() <= FIRST_ROWS {
        return fit_from(robot, drives, None);
    }
    let first = fit_thinned(robot, drives)?.fit;
    if drives.averages.len() <= MOST_AVERAGES {
        return fit_from(robot, drives, Some(&first));
    }
    let most_rows = (drives.rows.len() as f64 * MOST_AVERAGES as f64 / drives.averages.len() as f64) as usize;
    fit_from(robot, &drives.thinned(most_rows)?, Some(&first))
}

/// Fits to a part of a long recording, spread evenly over it: what judges other runs need not be as sharp as what is kept.
///
/// # Errors
/// Those of [`fit_power`].
pub fn fit_thinned(robot: &Robot, drives: &Drives) -> Result<PowerFit, Error> {
    if drives.rows.len() <= FIRST_ROWS {
        return fit_from(robot, drives, None);
    }
    let part = drives.thinned(FIRST_ROWS)?;
    if part.averages.is_empty() { fit_from(robot, drives, None) } else { fit_from(robot, &part, None) }
}

fn fit_from(known: &Robot, drives: &Drives, before: Option<&Fit>) -> Result<PowerFit, Error> {
    let form = drives.form.unwrap_or(PowerForm::Battery);
    let robot = with_new_ground(known, drives);
    let (fields, mut parameters) = known_before(&robot, known, drives);
    for parameter in &mut parameters {
        let earlier =
            before.and_then(|fit| Some((fit, fit.parameters.iter().position(|p| p.name == parameter.name)?)));
        if let Some((fit, i)) = earlier {
            parameter.start = fit.values[i];
        }
    }
    let model = PowerModel::new(drives)?;
    let predict = |values: &[f64]| predicted(&model, &applied(&robot, &fields, values), drives, form);
    let recorded = drives.recorded_averages();
    let block = folds::blocks(drives);
    let series = folds::series(drives);
    let data = Data { recorded: &recorded, block: &block, series: &series, predict: &predict };
    let start: Vec<f64> = parameters.iter().map(|p| p.start).collect();
    let mut about = predict(&start)?;
    let mut noise = Noise::growing(&about, &recorded, drives);
    // A file that is far off makes for noise that would keep the fit there, so both are worked out in turns.
    for _ in 0..if before.is_none() { MOST_ROUNDS } else { 0 } {
        let rough = data.problem(noise, &noise.sigmas(&about)).solve(&parameters)?;
        parameters.iter_mut().zip(&rough.values).for_each(|(parameter, value)| parameter.start = *value);
        let before = noise.typical(&about);
        about = predict(&rough.values)?;
        noise = Noise::growing(&about, &recorded, drives);
        if noise.typical(&about) > SETTLED * before {
            break;
        }
    }
    let fit = data.problem(noise, &noise.sigmas(&about)).solve_determined(&parameters)?;
    let fitted = applied(&robot, &fields, &fit.values);
    fitted.validate()?;
    Ok(PowerFit { robot: fitted, fit })
}

/// What is to be explained, whatever its noise.
struct Data<'a> {
    recorded: &'a [f64],
    block: &'a [usize],
    series: &'a [usize],
    predict: Predict<'a>,
}

impl<'a> Data<'a> {
    fn problem(&self, noise: Noise, sigma: &'a [f64]) -> Problem<'a> {
        let Data { recorded, block, series, predict } = *self;
        let correlation = noise.correlation;
        Problem { recorded, block, series, sigma, correlation, largest: LARGEST, predict }
    }
}

/// One-second averages of what a recording of a candidate would show, column behind column.
fn predicted(
    model: &PowerModel<'_>,
    candidate: &Robot,
    drives: &Drives,
    form: PowerForm,
) -> Result<Vec<f64>, Error> {
    let seen = model.averages(candidate, |row, power| seen_w(candidate, form, row, power))?;
    Ok((0..drives.recorded.len()).flat_map(|column| seen.iter().map(move |watts| watts[column])).collect())
}
