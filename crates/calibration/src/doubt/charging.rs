//! Batteries that take up power where no ground gives it back.

use recording::{PowerForm, Recording};

use super::{
    Doubt,
    second::{Second, mean, median, total_s},
};

/// Seconds of charging that are no chance \[s\]: longer than a stop takes from which a robot recovers power.
const LEAST_S: f64 = 10.0;
/// Slowing down more than this may give power back \[m/s²\]: a hundredth of what friction on hard ground slows by.
const SLOWING_MPS2: f64 = 0.05;

/// Standard deviations of what predictions miss that are no chance.
const SIGMAS: f64 = 4.0;
/// A standard deviation over the median of the magnitudes, of normal errors.
const OVER_MEDIAN: f64 = 1.4826;

/// Scatter of recorded less predicted power about its median \[W\]; `None` where no power was recorded.
fn scatter_w(seconds: &[Second]) -> Option<f64> {
    let known = seconds.iter().filter(|one| one.recorded_w.is_finite());
    let errors_w: Vec<f64> = known.map(|one| one.recorded_w - one.predicted_w).collect();
    let middle_w = median(errors_w.clone())?;
    Some(OVER_MEDIAN * median(errors_w.iter().map(|error_w| (error_w - middle_w).abs()).collect())?)
}

/// Tells of a battery that is charged while the robot stands, or drives where it has to draw power.
pub(super) fn charging(recording: &Recording, seconds: &[Second]) -> Option<Doubt> {
    let is_battery =
        matches!(recording.power_form(), Some(PowerForm::Battery | PowerForm::CurrentAndVoltage));
    // Ground that falls and wheels that brake give power back; nothing else does.
    let takes = |one: &&Second| {
        one.predicted_w >= 0.0
            && one.pitch_rad >= 0.0
            && one.accel_mps2 > -SLOWING_MPS2
            && one.recorded_w.is_finite()
    };
    let least_w = SIGMAS * scatter_w(seconds)?;
    let is_charged = |one: &&Second| one.recorded_w < (one.predicted_w - least_w).min(0.0);
    let charged: Vec<&Second> = seconds.iter().filter(takes).filter(is_charged).collect();
    if !is_battery || total_s(&charged) < LEAST_S {
        return None;
    }
    let (charged_s, charged_w) = (total_s(&charged), mean(&charged, |one| one.recorded_w));
    let predicted_w = mean(&charged, |one| one.predicted_w);
    let first = charged.first()?;
    Some(Doubt {
        name: "charging",
        statement: format!(
            "for {charged_s:.0} s, from {:.0} s of run `{}` on, the battery takes up {:.0} W on average while the robot stands or drives where it has to draw \
             {predicted_w:.0} W: it seems to be charged",
            first.t_s,
            recording.runs.get(first.run).map_or("", |run| run.name.as_str()),
            -charged_w,
        ),
        cure: "leave out what was recorded on a charger or in sunshine on solar cells (`--runs` names the runs that are read), or log the power of \
               the motors"
            .to_owned(),
    })
}
