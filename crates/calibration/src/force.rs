//! Force per ampere: one quantity of the robot, whatever ground it drives on, and where its value comes from.

use model::{Robot, STANDARD_GRAVITY_MPS2, knowledge::Provenance};

use crate::{
    calibrate::FittedParameter,
    current_fit::{CurrentFit, LIFTING, prior_lifting_a},
    file_fit::{CurrentField, FileFit},
    fit::NORMAL_975,
};

/// Relative sigma of a force per ampere that the file gives and whose source it does not say, or that was fitted \[-\]: the 95 % interval
/// of 8 to 20 % that five drives over hard floor leave.
const OF_FILE: f64 = 0.1;
/// Relative sigma where the file gives none, which is what is assumed of the lifting current of a robot of a Husky's size \[-\].
pub(crate) const OF_NONE: f64 = 0.4;
/// How far below and above what was known before it may lie: beyond, slopes of the recording are none.
const MOST_FACTOR: f64 = 5.0;

/// Where the value comes from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ForceSource {
    /// What lifting the robot on the slopes of one surface takes.
    Slopes(String),
    /// The robot file.
    File,
    /// The friction of ground that the robot file knows, since slopes do not tell.
    Friction,
    /// An assumption.
    Assumed,
}

/// Force per ampere of both sides.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Force {
    /// Newtons at the rim per ampere \[N/A\].
    pub(crate) n_per_a: f64,
    /// One standard deviation over the value.
    pub(crate) relative_sigma: f64,
    /// Quantile that makes a 95 % interval of it.
    pub(crate) student: f64,
    /// Where it comes from.
    pub(crate) source: ForceSource,
    /// Nothing but the friction of known ground tells it.
    pub(crate) is_confounded: bool,
}

/// Relative sigma of the force per ampere that the robot file gives; `None` where it gives none.
pub(crate) fn known_share(robot: &Robot) -> Option<f64> {
    robot.motors.left.force_n_per_a?;
    let source = robot.provenance_of("motors.left.force_n_per_a");
    Some(source.and_then(Provenance::relative_sigma).unwrap_or(OF_FILE).min(OF_NONE))
}

impl Force {
    /// Of the fit of the surface that determines it best; by the file, or by friction of ground that it knows, where slopes do not tell.
    pub(crate) fn of(robot: &Robot, ground: &str, reference: &CurrentFit) -> Force {
        if reference.fit.determined(LIFTING) {
            let lifting_a = reference.fit.values[LIFTING];
            return Force {
                n_per_a: reference.force_n_per_a(robot),
                relative_sigma: reference.fit.sigma(LIFTING) / lifting_a,
                student: reference.fit.student[LIFTING],
                source: ForceSource::Slopes(ground.into()),
                is_confounded: false,
            };
        }
        let (source, share) = match known_share(robot) {
            Some(share) => (ForceSource::File, share),
            None if robot.surfaces.contains_key(ground) => (ForceSource::Friction, OF_NONE),
            None => (ForceSource::Assumed, OF_NONE),
        };
        Force {
            n_per_a: per_lifting(robot, prior_lifting_a(robot)),
            relative_sigma: share,
            student: NORMAL_975,
            is_confounded: source == ForceSource::Friction,
            source,
        }
    }

    /// Least and greatest value.
    pub(crate) fn bounds(&self) -> [f64; 2] {
        // What a robot file may have \[N/A\].
        [(self.n_per_a / MOST_FACTOR).max(1e-3), (self.n_per_a * MOST_FACTOR).min(1e4)]
    }

    /// What the friction of ground that the robot file knows makes of it.
    pub(crate) fn by_friction(&mut self, file: &Robot, found: &FileFit) {
        let Some(i) = found.fields.iter().position(|field| *field == CurrentField::Force) else { return };
        let (value, u) = (found.fit.values[i], &file.uncertainty);
        self.relative_sigma = (found.fit.sigma(i) / value).hypot(u.mu_roll.max(u.mu_skid));
        self.n_per_a = value;
    }

    /// Half of its 95 % interval over the value.
    pub(crate) fn relative_half(&self) -> f64 {
        // Confounded, it follows from frictions and leaves nothing more open of them.
        if self.is_confounded { 0.0 } else { self.student * self.relative_sigma }
    }

    /// It as a parameter.
    pub(crate) fn parameter(&self) -> FittedParameter {
        let half = self.student * self.relative_sigma * self.n_per_a;
        FittedParameter {
            name: "motors.force_n_per_a".into(),
            value: self.n_per_a,
            unit: "N/A".into(),
            interval_95: Some([(self.n_per_a - half).max(0.0), self.n_per_a + half]),
            determined: matches!(self.source, ForceSource::Slopes(_)),
        }
    }

    /// Where it comes from, for a person to read.
    pub(crate) fn note(&self) -> String {
        let value = format!("force per ampere, {:.1} N/A on all ground,", self.n_per_a);
        match &self.source {
            ForceSource::Slopes(ground) => {
                format!(
                    "{value} was fitted on the slopes of `{ground}`, which determines it best or was asked for"
                )
            }
            ForceSource::File => format!(
                "{value} is held at the robot's file: the slopes of these drives do not tell it from friction; drive slopes of known pitch to find it"
            ),
            ForceSource::Friction => format!(
                "{value} is what makes the friction of the robot's file of these currents, which cannot tell one from the other: drive slopes of known \
                 pitch, or give force_n_per_a in motors.left and motors.right of the robot"
            ),
            ForceSource::Assumed => format!(
                "{value} is assumed, not found, and all friction with it: drive slopes of known pitch, or give force_n_per_a in motors.left and \
                 motors.right of the robot"
            ),
        }
    }
}

/// Bounds of the lifting current about what was known of it before.
pub(crate) fn lifting_bounds_a(lifting_a: f64) -> [f64; 2] {
    [lifting_a / MOST_FACTOR, lifting_a * MOST_FACTOR]
}

/// Sigma of the lifting current before a first fit, relative to its mean.
pub(crate) fn lifting_share(robot: &Robot) -> f64 {
    known_share(robot).unwrap_or(OF_NONE)
}

/// `m g / 2 G`: a side holds half the weight on a vertical wall \[N/A\]; the relation is its own inverse.
pub(crate) fn per_lifting(robot: &Robot, lifting_a: f64) -> f64 {
    robot.mass_kg * STANDARD_GRAVITY_MPS2 / 2.0 / lifting_a
}
