//! What healthy drives teach about a robot that was calibrated on them: how well its constants are known and what its model misses.

use std::collections::BTreeMap;

use calibration::{Calibration, FittedParameter};
use model::{
    Robot,
    knowledge::{ModelError, Posterior, PowerNoise, Provenance},
    mechanism,
    robot::Surface,
};
use recording::{PowerForm, Recording, Watch};

use crate::{
    Error, Series,
    diagnose::{NEEDED_S, impossible},
    evidence::linear_model::{Amplitudes, LinearModel, transposed},
    fit::amplitude::Healthy,
    fit::{baseline::Baseline, temperature::UNTOLD},
    observe::observations::Observations,
    report::{diagnosis::FileError, predictions::file_error},
    search::engine,
};

/// Relative standard deviation from which on a logarithm says nothing of a constant, which may as well be nothing [-].
const LARGEST_SIGMA: f64 = 1.0;

/// A calibration whose robot says how well it is known, with how far the file before and this one are off these drives among the notes.
///
/// # Errors
/// [`calibration::Error::Stopped`] soon after the watch breaks. Drives that tell nothing more leave a note.
pub fn taught(
    before: &Robot,
    calibration: Calibration,
    drives: &Recording,
    watch: &Watch,
) -> Result<Calibration, calibration::Error> {
    let mut taught = calibration;
    match learn(before, &taught.robot, drives, watch) {
        Ok(learnt) => {
            taught.notes.extend(learnt.errors.map(|errors| errors.to_string()));
            let robot = with_sources(learnt.robot, &taught.parameters);
            // No file is written that could not be read again.
            match robot.validate() {
                Ok(()) => taught.robot = robot,
                Err(error) => {
                    taught
                        .notes
                        .push(format!("how well the robot is known is left out of its file: {error}"));
                }
            }
        }
        Err(Error::Calibration(calibration::Error::Stopped)) => return Err(calibration::Error::Stopped),
        Err(error) => {
            taught.notes.push(format!("what the model misses of these drives is not known: {error}"));
        }
    }
    Ok(taught)
}

/// A robot with the constants that drives determine as fitted ones.
fn with_sources(mut robot: Robot, parameters: &[FittedParameter]) -> Robot {
    let known = robot.posterior.iter().flat_map(|posterior| &posterior.parameters);
    let fitted = known.filter(|name| parameters.iter().any(|p| p.determined && p.name == **name));
    let fitted: Vec<String> = fitted.cloned().collect();
    robot.provenance.extend(fitted.into_iter().map(|name| (name, Provenance::Fitted)));
    robot
}

/// What drives taught.
#[derive(Clone, Debug)]
pub struct Learnt {
    /// The calibrated robot, with `posterior`, `model_error` and `noise` where the drives are long enough to tell.
    pub robot: Robot,
    /// How far robots are off these drives, where they are long enough to tell.
    pub errors: Option<Errors>,
}

/// How far robots are off drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// The robot before it was calibrated.
    pub before: FileError,
    /// The calibrated one.
    pub after: FileError,
    /// See [`ModelError::fraction`].
    pub model_error: f64,
    /// Time that was looked at, spread over all drives, where they are longer [s].
    pub sampled_s: Option<f64>,
}

impl std::fmt::Display for Errors {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let off = |error: &FileError| {
            let way = if error.bias_w >= 0.0 { "low" } else { "high" };
            format!("{:.1} W too {way} on average ({:.1} W RMSE)", error.bias_w.abs(), error.rmse_w)
        };
        write!(
            f,
            "the robot file as it was predicts these drives {}, as it is now {}; noise is {:.1} W, and {:.1} % of power is missed as a smooth \
             function of the motion",
            off(&self.before),
            off(&self.after),
            self.after.noise_w,
            100.0 * self.model_error
        )?;
        match self.sampled_s {
            Some(sampled_s) => write!(f, " (by {:.0} min, spread over all drives)", sampled_s / 60.0),
            None => Ok(()),
        }
    }
}

/// A calibrated robot with what the drives taught that it was calibrated on: `posterior`, `model_error` and `noise`.
///
/// `before` is the robot before it was calibrated: its uncertainty is the prior of the constants. A robot whose drives are too short to
/// tell stays as it is.
///
/// # Errors
/// Drives that tell no power, or a surface that the robot does not know; a watch that breaks.
pub fn learn(before: &Robot, calibrated: &Robot, drives: &Recording, watch: &Watch) -> Result<Learnt, Error> {
    let about = Robot {
        uncertainty: before.uncertainty,
        provenance: before.provenance.clone(),
        posterior: before.posterior.clone(),
        model_error: None,
        ..calibrated.clone()
    };
    let thin = drives.thinned_watched(watch).map_err(calibration::Error::from)?;
    let by_current = thin.power_form() == Some(PowerForm::MotorCurrents);
    let series = Series::watched(&about, &thin, None, watch)?;
    if series.averages.iter().filter(|a| a.channel == 0).count() < NEEDED_S {
        return Ok(Learnt { robot: calibrated.clone(), errors: None });
    }
    let observed = Observations::new(&series, &about);
    let baseline = Baseline::fit(&observed, &about)?;
    let excluded = impossible(&thin);
    let library: Vec<_> = mechanism::ALL
        .into_iter()
        .filter(|one| !excluded.iter().any(|other| other.name() == one.name()))
        .collect();
    let shares = engine::healthy_columns(&observed, &baseline, &about, &library)?;
    let whitening = baseline.noise.whitening(&baseline.predicted, &observed.places);
    let rows = 0..observed.rows();
    let healthy = Healthy { observed: &observed, baseline: &baseline, whitening: &whitening, rows };
    let missed = healthy.model_error(&shares);
    let fraction = missed.power;
    let mut columns = baseline.sensitivities.clone();
    columns.extend(baseline.discrepancy(&observed, missed));
    columns.extend(shares);
    let tempered = whitening.scaled(|_| 1.0 / UNTOLD.sqrt());
    let white = columns.iter().map(|column| tempered.apply(column));
    let basis = transposed(observed.rows(), columns.len(), white);
    let model = LinearModel::new(basis, observed.rows() as f64 / UNTOLD, &Amplitudes::as_they_are());
    let error =
        |robot: &Robot| Ok::<_, Error>(file_error(&observed, &baseline, &series.predict(robot, &[])?));
    // Ground that only the calibration knows is as new to the file before as to its reader.
    let mut with_new_ground = Robot { surfaces: with_new(before, calibrated), ..before.clone() };
    // So are newtons of an ampere, without which currents cannot be compared.
    let new = [&calibrated.motors.left, &calibrated.motors.right];
    for (motor, new) in
        [&mut with_new_ground.motors.left, &mut with_new_ground.motors.right].into_iter().zip(new)
    {
        motor.force_n_per_a = motor.force_n_per_a.or(new.force_n_per_a);
        motor.idle_current_a = motor.idle_current_a.or(new.idle_current_a);
    }
    let errors = Errors {
        before: error(&with_new_ground)?,
        after: error(calibrated)?,
        model_error: fraction,
        sampled_s: series.compared_s(),
    };
    let robot = Robot {
        posterior: posterior(&baseline, &model, by_current),
        model_error: Some(ModelError {
            fraction,
            hours: thin.duration_s() / 3600.0,
            regimes: observed.covered(0..observed.rows()),
        }),
        noise: noise(&observed, &baseline),
        ..calibrated.clone()
    };
    Ok(Learnt { robot, errors: Some(errors) })
}

/// Surfaces of a robot and those that only another knows.
fn with_new(robot: &Robot, other: &Robot) -> BTreeMap<String, Surface> {
    let mut surfaces = other.surfaces.clone();
    surfaces.extend(robot.surfaces.clone());
    surfaces
}

/// The covariance of the constants' logarithms beside what the model misses, about the values that were calibrated. Where the drives
/// would have them elsewhere, it is wider by as much: a calibration weighs rows in another way.
fn posterior(baseline: &Baseline, model: &LinearModel, by_current: bool) -> Option<Posterior> {
    let parameters = &baseline.parameters;
    let count = parameters.len();
    let of_u = model.covariance_of_first(count) + &baseline.u * baseline.u.transpose();
    let of_z = parameters.covariance_of_z(&of_u);
    // Powers that were made of motor currents by the motors' constants tell nothing of these.
    let is_told = |i: usize| !(by_current && parameters.list[i].is_of_motors());
    let is_known =
        |(i, relative): &(usize, f64)| is_told(*i) && relative * of_z[(*i, *i)].sqrt() < LARGEST_SIGMA;
    let all = (0..count).filter_map(|i| Some((i, parameters.list[i].relative_sigma()?)));
    let known: Vec<(usize, f64)> = all.filter(is_known).collect();
    let covariance: Vec<Vec<f64>> =
        known.iter().map(|(i, a)| known.iter().map(|(j, b)| a * b * of_z[(*i, *j)]).collect()).collect();
    (!known.is_empty()).then(|| Posterior {
        parameters: known.iter().map(|(i, _)| parameters.list[*i].name.clone()).collect(),
        mean: known.iter().map(|(i, _)| parameters.list[*i].file().ln()).collect(),
        covariance,
    })
}

/// Noise of the channels of power, their mean.
fn noise(observed: &Observations<'_>, baseline: &Baseline) -> Option<PowerNoise> {
    let channels = baseline.noise.channels.get(..observed.series.channels())?;
    let mean = |of: &dyn Fn(&crate::evidence::noise::ChannelNoise) -> f64| {
        channels.iter().map(of).sum::<f64>() / channels.len().max(1) as f64
    };
    let correlation = mean(&|one| one.correlation);
    Some(PowerNoise {
        floor_w: mean(&|one| one.floor2).sqrt(),
        gain: mean(&|one| one.gain2).sqrt(),
        correlation_s: if correlation > 0.0 { -1.0 / correlation.ln() } else { 0.0 },
    })
}

#[cfg(test)]
mod tests {
    use calibration::{Options, calibrate};
    use recording::unwatched;

    use super::*;
    use crate::{Applied, Question, Span, Verdict, observe::hills::drive};

    #[test]
    fn a_calibrated_file_says_how_well_it_is_known_and_one_recording_then_needs_no_healthy_drive() {
        let truth = {
            let mut truth = model::builtin::husky_a200();
            truth.surfaces.get_mut("marble").unwrap().mu_roll *= 1.12;
            truth.motors.left.k2 *= 1.04;
            truth
        };
        let file = model::builtin::husky_a200();
        let healthy = drive(&truth, 1.0, &[]);
        let calibrated = calibrate(&file, &healthy, &Options::default()).unwrap().robot;
        let Learnt { robot: known, errors } = learn(&file, &calibrated, &healthy, &unwatched()).unwrap();
        let errors = errors.unwrap();
        assert_eq!(errors.sampled_s, None);
        assert!(errors.before.bias_w > 3.0 && errors.after.bias_w.abs() < 0.5, "{errors}");
        known.validate().unwrap();
        let error = known.model_error.as_ref().unwrap();
        assert!(error.fraction <= 0.02, "{error:?}");
        let posterior = known.posterior.as_ref().unwrap();
        let rolling = posterior.parameters.iter().position(|name| name == "surfaces.marble.mu_roll").unwrap();
        let sigma = posterior.covariance[rolling][rolling].sqrt();
        assert!(sigma < 0.5 * file.uncertainty.mu_roll, "{sigma}");
        let off = known.surfaces["marble"].mu_roll / truth.surfaces["marble"].mu_roll;
        assert!(off.ln().abs() < 4.0 * sigma, "{off} {sigma}");

        let drag = mechanism::by_name("drivetrain_drag").unwrap();
        let ill = [Applied { mechanism: drag, values: vec![8.0, 0.0], span: Span::ALL }];
        for (applied, expected) in [(&ill[..], Verdict::Explained), (&[], Verdict::Consistent)] {
            let suspect = drive(&truth, 0.0, applied);
            let question = Question::new(&known, &suspect, None);
            let found = crate::diagnose(&question, &|_, _| {}).unwrap();
            assert_eq!(found.verdict, expected, "{}", found.sentence);
        }
    }
}
