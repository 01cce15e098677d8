//! Channels of a size that another unit would explain.

use super::{LEAST_ROWS, absence::present};
use crate::{
    Channel, Recording, Run,
    report::{Suspicion, SuspicionKind as Kind},
    units::si_unit,
};

/// An inertial unit whose own axes are told instead of the robot's: no robot drives a quarter or a half turn over.
pub(super) fn mounting(channel: Channel, present: &[f64]) -> Option<String> {
    /// Farther over than any robot drives, and nearer to level than a unit on its side (60 degrees).
    const ASKEW_RAD: f64 = std::f64::consts::FRAC_PI_3;
    if !matches!(channel, Channel::Roll | Channel::Pitch) {
        return None;
    }
    let mut sizes: Vec<f64> = present.iter().map(|value| value.abs()).collect();
    let [low, middle] = [sizes.len() / 10, sizes.len() / 2];
    let typical_rad = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
    // A unit on its side is so all the time; angles in degrees come by nothing as well.
    if *sizes.select_nth_unstable_by(low, f64::total_cmp).1 < ASKEW_RAD {
        return None;
    }
    (ASKEW_RAD..=std::f64::consts::PI).contains(&typical_rad).then(|| {
        let how = if typical_rad > 2.0 * ASKEW_RAD { "upside down" } else { "on its side" };
        format!(
            "it is about {:.0} degrees all the time: the IMU seems mounted {how}, and its orientation is that of its own axes and not the robot's; \
             leave its topic out of the map, or turn it by its mounting first",
            typical_rad.to_degrees()
        )
    })
}

pub(super) fn magnitude(channel: Channel, present: &[f64]) -> Option<String> {
    if mounting(channel, present).is_some() {
        return None;
    }
    let [least, greatest] = channel.plausible_magnitude();
    let high = high_magnitude(present)?;
    let unit = si_unit(channel.quantity());
    (high < least || high > greatest).then(|| {
        let is_angle = matches!(channel, Channel::Pitch | Channel::Roll);
        let asked = if is_angle { "is it in degrees?" } else { "is the unit right?" };
        format!("its 99th percentile is {high:.4} {unit}, outside {least} to {greatest:.4}: {asked}")
    })
}

/// The 99th percentile of the magnitude: the extreme would be the first outlier.
fn high_magnitude(present: &[f64]) -> Option<f64> {
    /// So many values, taken evenly, place a percentile to a thirtieth of a percent.
    const SAMPLE: usize = 100_000;
    let every = present.len().div_ceil(SAMPLE).max(1);
    let mut magnitudes: Vec<f64> = present.iter().step_by(every).map(|value| value.abs()).collect();
    let at = magnitudes.len().checked_sub(1)? * 99 / 100;
    Some(*magnitudes.select_nth_unstable_by(at, f64::total_cmp).1)
}

/// A run whose power is a thousandth or a thousand times that of the others was logged in another unit.
pub(super) fn units_of_runs(recording: &Recording) -> Vec<Suspicion> {
    /// Between the largest honest ratio of two drives of a robot (about 20) and that of kW to W.
    const RATIO: f64 = 150.0;
    let mut doubts = Vec::new();
    for (&channel, values) in recording.channels.iter().filter(|(channel, _)| channel.tells_power()) {
        let high = |run: &Run| {
            let rows = values.get(run.rows.clone()).unwrap_or_default();
            let present = present(rows);
            if present.len() < LEAST_ROWS {
                None
            } else {
                high_magnitude(&present).filter(|high| *high > 0.0)
            }
        };
        let of_runs: Vec<(&Run, f64)> =
            recording.runs.iter().filter_map(|run| high(run).map(|high| (run, high))).collect();
        let mut sorted: Vec<f64> = of_runs.iter().map(|(_, high)| *high).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let Some(&median) = sorted.get(sorted.len() / 2) else { continue };
        for (run, high) in of_runs {
            if high / median > RATIO || median / high > RATIO {
                let statement = format!(
                    "its 99th percentile is {high:.4} here and {median:.4} in most runs: mixed units?"
                );
                doubts.push(Suspicion { channel, run: Some(run.name.clone()), kind: Kind::Unit, statement });
            }
        }
    }
    doubts
}
