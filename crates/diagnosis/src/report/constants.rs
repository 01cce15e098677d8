//! Constants of the corrected robot: those that predict best what was recorded.
//!
//! Constants are fitted beside a smooth discrepancy, which no robot file holds: what they leave to it, a file alone gets wrong. So the
//! refitted constants are taken only where a robot with them and with what was found predicts the drives better than one with the file's own.

use model::Robot;

use crate::{
    Applied, Error,
    report::{diagnosis::FileError, document::Subject, predictions::file_error},
    search::{engine::Found, explanation::Explanation},
};

/// A robot without what was found, and what to say of it.
pub(crate) struct Constants {
    /// The file's robot, or the refitted one.
    pub(crate) robot: Robot,
    /// How well it predicts the drives with what was found.
    pub(crate) note: String,
}

/// The better of the file's constants and of the refitted ones.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn constants(
    subject: &Subject<'_>,
    found: &Found,
    first: Option<&Explanation>,
    applied: &[Applied],
) -> Result<Constants, Error> {
    let refitted = refitted(subject.file, found, first);
    let error = |robot: &Robot| -> Result<FileError, Error> {
        let predicted = subject.observed.series.predict(robot, applied)?;
        Ok(file_error(subject.observed, &found.baseline, &predicted))
    };
    let [of_file, of_refitted] = [error(subject.file)?, error(&refitted)?];
    let is_refitted = of_refitted.rmse_w < of_file.rmse_w;
    let (robot, best, whose) = match is_refitted {
        true => (refitted, of_refitted, "the refitted ones"),
        false => {
            (subject.file.clone(), of_file, "those of its file, since refitted ones would predict them worse")
        }
    };
    let way = if best.bias_w >= 0.0 { "low" } else { "high" };
    let note = format!(
        "the corrected robot predicts these drives {:.1} W too {way} on average ({:.1} W RMSE); its constants are {whose}",
        best.bias_w.abs(),
        best.rmse_w
    );
    Ok(Constants { robot, note })
}

/// The robot at its parameters beside an explanation, or beside nothing.
fn refitted(file: &Robot, found: &Found, explanation: Option<&Explanation>) -> Robot {
    let nothing = found.explanations.iter().find(|one| one.names.is_empty());
    let fitted = explanation.or(nothing).and_then(|one| one.fitted.as_ref());
    fitted.map_or_else(|| file.clone(), |fitted| found.baseline.parameters.placed(file, &fitted.u))
}
