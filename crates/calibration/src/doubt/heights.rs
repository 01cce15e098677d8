//! Slopes by heights that power does not follow: heights of a poor receiver wander where no ground rises.

use model::Robot;
use recording::{Channel, PowerForm, Recording, Watch};

use super::{Doubt, driving::ALIKE_S};
use crate::{
    Drives, Error,
    field::with_new_ground,
    power::{by_row, seen_w},
};

/// Share of the power that slopes ask for which has to be recorded. What is left of the share of a slope with errors is
/// `var(slope) / (var(slope) + var(error))` (Fuller 1987, eq. 1.1.6): of half, slopes are as much error as ground.
const LEAST_SHARE: f64 = 0.5;
/// Standard errors by which the share lies below.
const SIGMAS: f64 = 3.0;
/// Shares in which power follows slopes of another unit or sign; of what is error alone it follows less.
const FOLLOWED: f64 = 0.2;

/// Tells of heights that are no ground.
///
/// # Errors
/// As [`crate::predict_watched()`].
pub(super) fn heights(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Option<Doubt>, Error> {
    if recording.channel(Channel::Pitch).is_some() || recording.channel(Channel::Z).is_none() {
        return Ok(None);
    }
    let drives = Drives::watched(robot, recording, watch)?.including_stuck();
    let form = drives.form.unwrap_or(PowerForm::Battery);
    if form == PowerForm::MotorCurrents {
        return Ok(None);
    }
    let robot = &with_new_ground(robot, &drives);
    let of = |drives: &Drives| {
        by_row(drives, robot, |i, power| seen_w(robot, form, &drives.rows[i], power).iter().sum::<f64>())
    };
    let with_w = of(&drives)?;
    let mut level = drives.clone();
    level.rows.iter_mut().for_each(|row| row.pitch_rad = 0.0);
    let level_w = of(&level)?;
    let means = drives.means(|i| {
        let recorded_w: f64 = drives.recorded.iter().map(|column| column[i]).sum();
        [with_w[i] - level_w[i], recorded_w - level_w[i], drives.rows[i].pitch_rad]
    });
    let Some([share, sigma]) = share(&means) else { return Ok(None) };
    if share + SIGMAS * sigma >= LEAST_SHARE {
        return Ok(None);
    }
    let steep_rad =
        (means.iter().map(|[_, _, pitch_rad]| pitch_rad.powi(2)).sum::<f64>() / means.len() as f64).sqrt();
    let joules = |watts: &[f64]| -> f64 {
        drives.averages.iter().zip(drives.averaged(watts)).map(|(average, w)| w * average.duration_s).sum()
    };
    // Power that follows slopes well, with another factor, tells of their unit or sign.
    let is_followed = share.abs() > SIGMAS * sigma && share.abs() > FOLLOWED;
    let why = match share > 0.0 {
        true if is_followed => format!("heights seem {:.1} times too large (of feet 3.3)", 1.0 / share),
        false if is_followed => "heights seem to be counted downwards".to_owned(),
        _ => "heights are more error than ground".to_owned(),
    };
    Ok(Some(Doubt {
        name: "heights",
        statement: format!(
            "slopes come from `z_m`, of {:.1} degrees on average, and power follows {:.0} % of what they ask for: {why}; predicted energy is \
             {:.1} kJ with them and {:.1} kJ on level ground",
            steep_rad.to_degrees(),
            100.0 * share,
            joules(&with_w) / 1e3,
            joules(&level_w) / 1e3
        ),
        cure: "record the pitch of an inclinometer, give heights their unit or \"scale\" in a map, or leave `z_m` out, so that the ground is taken for level".to_owned(),
    }))
}

/// Slope of a line through what is recorded beyond level ground against what slopes ask for, and its standard error.
fn share(means: &[[f64; 3]]) -> Option<[f64; 2]> {
    let count = means.len() as f64;
    let sum = means.iter().fold([0.0; 2], |[x, y], one| [x + one[0], y + one[1]]);
    let [x0, y0] = sum.map(|sum| sum / count);
    let [xx, xy] = means
        .iter()
        .fold([0.0; 2], |[xx, xy], one| [xx + (one[0] - x0).powi(2), xy + (one[0] - x0) * (one[1] - y0)]);
    let share = xy / xx;
    let rest: f64 = means.iter().map(|one| (one[1] - y0 - share * (one[0] - x0)).powi(2)).sum();
    let sigma = (ALIKE_S * rest / (count * xx)).sqrt();
    (count >= 2.0 * ALIKE_S && xx > 0.0 && share.is_finite()).then_some([share, sigma])
}
