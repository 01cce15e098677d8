//! The robot's own numbers fitted to the drives, and how predictions hang on them.

use std::{
    borrow::Cow,
    sync::{Arc, OnceLock},
};

use model::Robot;

use crate::{
    Error, channel,
    discrepancy::Ground,
    driven::Driven,
    everywhere,
    knobs::Knob,
    learnt::{Fit, Learnt},
    noise::{Noise, Whitening},
    nuisance,
    reached::Reached,
    sensitivities::Sensitivities,
    series::{Applied, Look, Series},
    shared::Shared,
};

/// A robot at its best fit, with the sensitivities that a linear search needs.
#[derive(Clone)]
pub(crate) struct Baseline {
    /// The robot.
    pub robot: Robot,
    /// What was fitted.
    pub(crate) knobs: Vec<Knob>,
    /// Fitted less filed values, in widths of the file.
    pub(crate) moved: Vec<f64>,
    /// Predictions at the fit.
    pub(crate) predicted_w: Vec<f64>,
    /// How predictions hang on everything that is fitted.
    pub(crate) sensitivities: Arc<Sensitivities>,
    /// Scatter of what is recorded about the predictions, as [`Look`] says.
    pub(crate) noise: Noise,
    /// What [`Baseline::missed`] made, on even and on uneven ground.
    missed: Arc<[OnceLock<Arc<[Shared]>>; 2]>,
}

impl Baseline {
    /// Fits the knobs, with mechanisms acting. While none does, only drives that nothing is missing from are fitted: a strong
    /// effect would otherwise be shared out between the robot and the noise.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub(crate) fn fit(series: &Series, file: &Robot, applied: &[Applied]) -> Result<Self, Error> {
        let alone = &series.told().alone;
        match alone.get() {
            Some((of, fit)) if applied.is_empty() && of == file => return Ok(fit.clone()),
            _ => {}
        }
        let fit = Baseline::fit_from(series, file, applied, file)?;
        if applied.is_empty() {
            alone.get_or_init(|| (file.clone(), fit.clone()));
        }
        Ok(fit)
    }

    /// The same fit, reached from a robot that is near it.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub(crate) fn fit_from(
        series: &Series,
        file: &Robot,
        applied: &[Applied],
        near: &Robot,
    ) -> Result<Self, Error> {
        let reached = Reached::from(series, (file, applied), near, &[])?;
        Baseline::about(series, file, applied, (reached, None))
    }

    /// The same fit, reached from one that is near it with the sensitivities of that one, as far as they hold: what is tried step by step
    /// takes a fifth of the predictions. [`Baseline::about_itself`] makes up for it in the end.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub(crate) fn fit_near(
        series: &Series,
        file: &Robot,
        applied: &[Applied],
        near: &Baseline,
    ) -> Result<Self, Error> {
        if !near.sensitivities.hold_for(applied) {
            return Baseline::fit_from(series, file, applied, &near.robot);
        }
        let columns = &near.sensitivities.columns;
        let reached = Reached::from(series, (file, applied), &near.robot, columns)?;
        Baseline::about(series, file, applied, (reached, Some(&near.sensitivities)))
    }

    /// The fit with sensitivities about itself.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub(crate) fn about_itself(
        self,
        series: &Series,
        file: &Robot,
        applied: &[Applied],
    ) -> Result<Self, Error> {
        if self.sensitivities.are_about(&self.robot, applied) {
            return Ok(self);
        }
        Baseline::fit_from(series, file, applied, &self.robot)
    }

    /// What is known about a fit that was reached; `near` are sensitivities that hold for it unless it left them.
    fn about(
        series: &Series,
        file: &Robot,
        applied: &[Applied],
        (reached, near): (Reached<'_>, Option<&Arc<Sensitivities>>),
    ) -> Result<Self, Error> {
        let Reached { robot, knobs, predicted_w, mut noise, columns } = reached;
        let moved = knobs.iter().map(|k| (k.value(&robot) - k.value(file)) / k.sigma).collect();
        // Made beforehand: who waits for others to work it out with it must not come back for it.
        let fit = Fit { predicted_w: &predicted_w, columns: &columns, trusted: &series.is_trusted() };
        let told = series.told();
        if told.learnt.get().is_none() {
            let learnt = Learnt::of(series, fit, &noise);
            told.learnt.get_or_init(|| learnt);
        }
        if let Some(learnt) = told.learnt.get()
            && series.look == Look::Closer
        {
            noise = learnt.noise_of(series, fit);
        }
        let sensitivities = match (near, columns) {
            (Some(near), Cow::Borrowed(_)) => Arc::clone(near),
            (_, columns) => {
                let columns = columns.into_owned();
                Arc::new(Sensitivities::new(series, &robot, applied, &predicted_w, columns)?)
            }
        };
        if told.everywhere.get().is_none() {
            let none_w =
                if applied.is_empty() { predicted_w.clone() } else { series.predict(&robot, &[])? };
            let columns = everywhere::columns(series, &robot, &none_w)?;
            told.everywhere.get_or_init(|| columns);
        }
        Ok(Baseline { robot, knobs, moved, predicted_w, sensitivities, noise, missed: Default::default() })
    }

    /// What models miss, the same in suspect and in healthy drives, channel by channel: its averages, and columns over them with
    /// weights of one sigma 1 [W].
    fn of_channels(&self, series: &Series, ground: Ground) -> Vec<(Vec<usize>, Vec<Vec<f64>>)> {
        let averages = &series.averages;
        let of = |(channel, mean_w): (usize, f64)| {
            let places = channel::places(averages, channel);
            let columns = match series.told().learnt.get() {
                Some(learnt) => learnt.of_channel(averages, &places, (channel, mean_w), ground),
                None => nuisance::of_channel(averages, &places, mean_w),
            };
            (places, columns)
        };
        nuisance::means(averages, &self.predicted_w).into_iter().enumerate().map(of).collect()
    }

    /// The same as columns over all averages [W].
    pub(crate) fn shared(&self, series: &Series) -> Vec<Vec<f64>> {
        let spread = |(places, columns): (Vec<usize>, Vec<Vec<f64>>)| {
            channel::spread(&columns, &places, series.averages.len())
        };
        self.of_channels(series, Ground::Even).into_iter().flat_map(spread).collect()
    }

    /// The same, whitened, to be taken out of other columns. They are many and long and asked for again and again.
    pub(crate) fn missed(&self, series: &Series, ground: Ground) -> Arc<[Shared]> {
        let make = || {
            let white = self.whitening(series);
            let of = |(places, columns): (Vec<usize>, Vec<Vec<f64>>)| {
                let columns: Vec<_> =
                    columns.iter().map(|column| white.of_channel(&places, column)).collect();
                Shared::new(places, &columns)
            };
            self.of_channels(series, ground).into_iter().filter_map(of).collect()
        };
        Arc::clone(self.missed[ground as usize].get_or_init(make))
    }

    /// What terms are made of in each average.
    pub(crate) fn driven<'a>(&'a self, series: &'a Series) -> Driven<'a> {
        Driven {
            robot: &self.robot,
            averages: &series.averages,
            predicted_w: &self.predicted_w,
            rims_w_per_n: &self.sensitivities.rims_w_per_n,
        }
    }

    /// What makes errors about the fit independent and of one sigma 1.
    pub(crate) fn whitening(&self, series: &Series) -> Whitening {
        self.noise.whitening(&self.predicted_w, &series.averages)
    }
}

/// Recorded less predicted.
pub(crate) fn differences(recorded: &[f64], predicted: &[f64]) -> Vec<f64> {
    recorded.iter().zip(predicted).map(|(r, p)| r - p).collect()
}

#[cfg(test)]
mod tests {
    use model::mechanism;

    use super::*;
    use crate::{hills::drive, span::Span};

    fn payload(mass_kg: f64) -> Vec<Applied> {
        let mechanism = mechanism::by_name("payload").unwrap();
        let values: Vec<f64> = mechanism.parameters().iter().map(|_| 0.0).collect();
        let values = [&[mass_kg], &values[1..]].concat();
        vec![Applied { mechanism, values, span: Span::ALL }]
    }

    #[test]
    fn a_fit_with_what_holds_nearby_ends_where_one_with_its_own_does_and_makes_its_own_where_nothing_holds() {
        let robot = model::builtin::husky_a200();
        let [suspect, healthy] =
            [(0.0, payload(6.0)), (1.0, vec![])].map(|(at, with)| drive(&robot, at, &with));
        let series = Series::new(&robot, &suspect, Some(&healthy)).unwrap();
        let anew = |mass_kg| Baseline::fit(&series, &robot, &payload(mass_kg)).unwrap();
        let (near, own) = (anew(5.9), anew(6.0));
        let tried = Baseline::fit_near(&series, &robot, &payload(6.0), &near).unwrap();
        assert!(Arc::ptr_eq(&tried.sensitivities, &near.sensitivities));
        let off =
            |one: &Baseline| own.moved.iter().zip(&one.moved).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off(&near) > 0.02 && off(&tried) < 0.005, "{} {} widths", off(&near), off(&tried));
        let itself = tried.about_itself(&series, &robot, &payload(6.0)).unwrap();
        assert!(itself.sensitivities.are_about(&itself.robot, &payload(6.0)) && off(&itself) < 0.002);
        let far = Baseline::fit_near(&series, &robot, &payload(6.0), &anew(2.0)).unwrap();
        assert!(far.sensitivities.are_about(&far.robot, &payload(6.0)));
    }
}
