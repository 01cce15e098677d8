//! The current model of a robot over all of its ground: what it holds beyond a robot file is for a look at what such a file leaves out.

use model::Robot;
use rayon::prelude::*;

use crate::{
    Drives, Error,
    calibrate::{FittedParameter, Options, with_slip_track},
    current::YawSource,
    current_fit::{CurrentFit, LIFTING, fit_force_alone, fit_reference, fit_surface},
    current_judge::{SurfaceVerdict, judge},
    folds,
};

/// The current model of a robot: one surface that what belongs to the robot was fitted on, and the others.
#[derive(Clone, Debug)]
pub struct CurrentCalibration {
    /// The robot that was fitted, with its measured slip track.
    pub robot: Robot,
    /// Name of the reference surface.
    pub reference: String,
    /// Fits of the halves of its runs.
    pub reference_halves: [CurrentFit; 2],
    /// Surface by surface, the reference first.
    pub surfaces: Vec<SurfaceFit>,
    /// Slip track, as fitted from wheels and gyroscope.
    pub slip_track: FittedParameter,
}

/// One surface.
#[derive(Clone, Debug)]
pub struct SurfaceFit {
    /// Its name.
    pub surface: String,
    /// The fit of all of its runs.
    pub fit: CurrentFit,
    /// The same with force per ampere left to this surface alone.
    pub force_alone: CurrentFit,
    /// How each half of the runs is judged by the other; `None` where there is one run.
    pub verdict: Option<SurfaceVerdict>,
}

/// Fits all surfaces.
///
/// # Errors
/// [`Error::NoReference`] where the surface asked for was not driven on, [`Error::TooFewRuns`] where it was driven on in one run,
/// [`Error::Stopped`] when the drives' watch breaks.
pub fn fit_currents(robot: &Robot, drives: &Drives, options: &Options) -> Result<CurrentCalibration, Error> {
    let driven = driven(drives);
    let reference = reference(robot, drives, options)?;
    let on_reference = drives.on_surface(reference)?;
    refuse_one_run(drives, reference, &on_reference)?;
    let (robot, slip_track) = with_slip_track(robot, &on_reference)?;
    let [first, second] = folds::halves(&on_reference)?;
    let fit = |drives: &Drives| fit_reference(&robot, drives);
    let (whole, (first, second)) =
        rayon::join(|| fit(&on_reference), || rayon::join(|| fit(&first), || fit(&second)));
    let (whole, reference_halves) = (whole?, [first?, second?]);
    let mut order = vec![reference];
    order.extend(driven.into_iter().filter(|&i| i != reference));
    let surfaces = order.into_par_iter().map(|i| {
        let here = drives.on_surface(i)?;
        let is_reference = i == reference;
        let fit =
            if is_reference { whole.clone() } else { fit_surface(&robot, &here, &whole, YawSource::Wheels)? };
        let judged = here.judged_runs().len() > 1;
        let judge = || judge(&robot, &here, &reference_halves, is_reference, YawSource::Wheels);
        let verdict = judged.then(judge).transpose()?.map(|(verdict, _)| verdict);
        let force_alone = fit_force_alone(&robot, &here, &whole)?;
        Ok(SurfaceFit { surface: drives.surfaces[i].clone(), fit, force_alone, verdict })
    });
    let surfaces = surfaces.collect::<Result<_, Error>>()?;
    Ok(CurrentCalibration {
        reference: drives.surfaces[reference].clone(),
        robot,
        reference_halves,
        surfaces,
        slip_track,
    })
}

/// The surfaces that were driven on.
fn driven(drives: &Drives) -> Vec<usize> {
    (0..drives.surfaces.len()).filter(|i| drives.averages.iter().any(|a| a.surface == *i)).collect()
}

/// The surface that what belongs to the robot is fitted on.
///
/// # Errors
/// [`Error::NoReference`], [`Error::Stopped`].
pub(crate) fn reference(robot: &Robot, drives: &Drives, options: &Options) -> Result<usize, Error> {
    let driven = driven(drives);
    match &options.reference_surface {
        Some(name) => driven.iter().copied().find(|&i| drives.surfaces[i] == *name).ok_or_else(|| {
            let found = driven.iter().map(|&i| drives.surfaces[i].clone()).collect();
            Error::NoReference { surface: name.clone(), found }
        }),
        None => best_reference(robot, drives, &driven),
    }
}

/// Refuses a reference surface with one run, which no other could judge.
///
/// # Errors
/// [`Error::TooFewRuns`].
pub(crate) fn refuse_one_run(drives: &Drives, reference: usize, on_reference: &Drives) -> Result<(), Error> {
    match on_reference.judged_runs().len() {
        runs @ (0 | 1) => Err(Error::TooFewRuns { surface: drives.surfaces[reference].clone(), runs }),
        _ => Ok(()),
    }
}

/// The surface with two runs or more whose lifting current is known best, relative to its size.
fn best_reference(robot: &Robot, drives: &Drives, driven: &[usize]) -> Result<usize, Error> {
    let mut enough: Vec<usize> = Vec::new();
    for &surface in driven {
        enough.extend((drives.on_surface(surface)?.judged_runs().len() > 1).then_some(surface));
    }
    let candidates = if enough.is_empty() { driven } else { &enough };
    if let [only] = candidates {
        return Ok(*only);
    }
    let doubt = |i: usize| {
        let fit = fit_reference(robot, &drives.on_surface(i)?)?;
        Ok((i, fit.fit.sigma(LIFTING) / fit.parameters.lifting_a.max(f64::MIN_POSITIVE)))
    };
    let doubts = candidates.par_iter().map(|&i| doubt(i)).collect::<Result<Vec<_>, Error>>()?;
    Ok(doubts.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(i, _)| i))
}
