//! The procedures that a robot can be fitted by, as a person chooses between them.

use model::Robot;
use recording::{Recording, Watch, unwatched};
use serde::{Deserialize, Serialize};

use crate::{Calibration, Error, Options, calibrate_watched, dogru_marques, doubt::POWER_LEVEL, doubts};

/// Name of the doubt that runs which were not fitted cast on a fit.
const HELD_OUT: &str = "held_out";

/// Driving of which a share of variance can be told \[s\]: of less, one manoeuvre decides.
const LEAST_JUDGED_S: f64 = 60.0;
/// Rows that are as many at ten a second, whatever their clock counts.
const LEAST_JUDGED_ROWS: usize = 600;

/// Whether a share of variance can be told of drives.
fn is_judged(recording: &Recording) -> bool {
    let of_run = |run: &recording::Run| {
        let t_s = recording.t_s.get(run.rows.clone()).unwrap_or_default();
        t_s.last().zip(t_s.first()).map_or(0.0, |(last, first)| last - first)
    };
    let driven_s: f64 = recording.runs.iter().map(of_run).sum();
    driven_s >= LEAST_JUDGED_S || recording.rows() >= LEAST_JUDGED_ROWS
}

/// What ground was taken for that the recording does not name.
fn ground_note(robot: &Robot, recording: &Recording) -> Option<String> {
    let ground = &robot.default_surface;
    let Some(labels) = &recording.surface else {
        return Some(format!(
            "the recordings do not name their ground: it was taken for `{ground}`, the robot's default"
        ));
    };
    let rows = || recording.runs.iter().flat_map(|run| run.rows.clone());
    let unnamed = rows().filter(|row| labels.get(*row).is_none()).count();
    (unnamed > 0).then(|| {
        format!(
            "{unnamed} of {} rows do not name their ground: it was taken for `{ground}`, the robot's default",
            rows().count()
        )
    })
}

impl Options {
    fn is_overruled(&self, name: &str) -> bool {
        self.despite.iter().any(|other| other == name)
    }
}

/// A procedure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// A fit of everything at once.
    #[default]
    Fit,
    /// The paper's own: friction from steady seconds, speed by speed.
    DogruMarques,
}

impl Method {
    /// Fits a robot to recordings by the procedure.
    ///
    /// # Errors
    /// As [`calibrate`] and [`dogru_marques::calibrate`].
    pub fn calibrate(
        self,
        robot: &Robot,
        recording: &Recording,
        options: &Options,
    ) -> Result<Calibration, Error> {
        self.calibrate_watched(robot, recording, options, &unwatched())
    }

    /// Fits a robot as [`Method::calibrate`] does, followed by a watch.
    ///
    /// # Errors
    /// As [`Method::calibrate`], and [`Error::Stopped`] soon after the watch breaks.
    pub fn calibrate_watched(
        self,
        robot: &Robot,
        recording: &Recording,
        options: &Options,
        watch: &Watch,
    ) -> Result<Calibration, Error> {
        let (overruled, open): (Vec<_>, Vec<_>) =
            doubts(robot, recording, watch)?.into_iter().partition(|doubt| options.is_overruled(doubt.name));
        // What may be wrong with the file is what a calibration is for.
        let (told, open): (Vec<_>, Vec<_>) = open.into_iter().partition(|doubt| doubt.name == POWER_LEVEL);
        if !open.is_empty() {
            return Err(Error::Doubtful { doubts: open });
        }
        let mut found = match self {
            Method::Fit => calibrate_watched(robot, recording, options, watch),
            Method::DogruMarques => dogru_marques::calibrate(robot, recording, watch),
        }?;
        found.notes.extend(ground_note(robot, recording));
        found.notes.extend(told.iter().map(|doubt| format!("a doubt: {doubt}")));
        found.notes.extend(overruled.iter().map(|doubt| format!("calibrated despite a doubt: {doubt}")));
        match &found.held_out {
            // Where nothing was determined nothing was fitted.
            Some(judged)
                if judged.recorded_r2() < 0.0
                    && is_judged(recording)
                    && found.parameters.iter().any(|parameter| parameter.determined)
                    && !options.is_overruled(HELD_OUT) =>
            {
                Err(Error::Contradicted { r2: judged.recorded_r2(), rmse_w: judged.rmse_w })
            }
            _ => Ok(found),
        }
    }
}
